"""Studies of the module: what accuracy costs, measured."""
