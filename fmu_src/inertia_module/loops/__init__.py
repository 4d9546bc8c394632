"""Loads, controllers and sources as python-control systems, stepped together with an FMU."""

from .closed_loop import ClosedLoop, connect, initial_inputs
from .controllers import driver_brake, pi_speed_controller
from .coupling import Coupling
from .loads import Load, shaft_load, torque_source, vehicle_load
from .sources import Table, source

__all__ = [
    "ClosedLoop",
    "Coupling",
    "Load",
    "Table",
    "connect",
    "driver_brake",
    "initial_inputs",
    "pi_speed_controller",
    "shaft_load",
    "source",
    "torque_source",
    "vehicle_load",
]
