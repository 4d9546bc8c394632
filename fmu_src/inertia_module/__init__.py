"""The inertia module: an inertial torque transformer as an FMI 2.0 co-simulation FMU."""

__version__ = "0.1.0"
