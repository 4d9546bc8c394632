"""Fidelity levels of a scene: measured accuracy and run time, and the choice of a level."""
