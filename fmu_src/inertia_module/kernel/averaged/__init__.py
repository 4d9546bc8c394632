"""Fidelity `averaged`: the mean motion of the output shaft over a map of the torque."""
