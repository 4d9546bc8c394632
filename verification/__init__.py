"""Studies of the module by the project itself: papers, references, extremes, peers, couplings, benchmarks."""
