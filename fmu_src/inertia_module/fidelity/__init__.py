"""Cost of accuracy, measured: levels of fidelity, the trade of a scene, the choice of a level."""
