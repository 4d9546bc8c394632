"""Systems of python-control: discrete-time FMUs and the continuous-time averaged module."""

from .fmu_system import FmuSystem, fmu_system
from .small_signal import (
    OperatingPoint,
    SmallSignal,
    TransientInertia,
    averaged_response,
    averaged_system,
    carried_range,
    measured_response,
    operating_point,
    operating_points,
    transient_inertia,
)

__all__ = [
    "FmuSystem",
    "OperatingPoint",
    "SmallSignal",
    "TransientInertia",
    "averaged_response",
    "averaged_system",
    "carried_range",
    "fmu_system",
    "measured_response",
    "operating_point",
    "operating_points",
    "transient_inertia",
]
