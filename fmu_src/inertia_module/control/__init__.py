"""FMUs as discrete-time systems of python-control."""

from .fmu_system import FmuSystem, fmu_system

__all__ = ["FmuSystem", "fmu_system"]
