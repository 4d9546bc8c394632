"""The inertia module: an inertial torque transformer as an FMI 2.0 co-simulation FMU."""

__version__ = "0.1.0"
# the day this version stands for: in what is built, for the same source gives the same bytes
__date__ = "2026-11-21"
