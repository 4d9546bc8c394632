"""Analyses of the mechanism itself: steady state and torque converter charts."""
