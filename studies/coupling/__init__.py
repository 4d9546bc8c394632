"""How well an engine couples to the module: a map over communication step and inertia ratio."""
