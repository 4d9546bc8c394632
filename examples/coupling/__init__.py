"""Engine coupled to the module: a plant with an engine, and the comparison of couplings."""
