"""Systems of python-control: FMUs in discrete time, the averaged module in continuous time."""

from .fmu_system import FmuSystem, fmu_system
from .small_signal import (
    SmallSignal,
    TransientInertia,
    averaged_response,
    averaged_system,
    measured_response,
    operating_point,
    transient_inertia,
)

__all__ = [
    "FmuSystem",
    "SmallSignal",
    "TransientInertia",
    "averaged_response",
    "averaged_system",
    "fmu_system",
    "measured_response",
    "operating_point",
    "transient_inertia",
]
