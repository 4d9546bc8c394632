"""Surroundings of an FMU, stepped together with it.

Loads, controllers and sources are systems of python-control, which closed_loop.py connects. An engine is
coupled to the module by engine.py; docs/coupling.md tells what its schemes are worth.
"""

from .closed_loop import ClosedLoop, connect, initial_inputs
from .controllers import driver_brake, pi_speed_controller
from .engine import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EngineMap,
    EnginePlant,
    EngineState,
    Governor,
    InterfaceInertia,
    Ledger,
    Scheme,
    TorqueDrivenEngine,
    interface_inertia,
    torque_driven,
)
from .loads import Coupling, Load, shaft_load, vehicle_load
from .sources import Table, source

__all__ = [
    "SCHEMES",
    "ClosedLoop",
    "CoupledEngine",
    "Coupling",
    "Engine",
    "EngineMap",
    "EnginePlant",
    "EngineState",
    "Governor",
    "InterfaceInertia",
    "Ledger",
    "Load",
    "Scheme",
    "Table",
    "TorqueDrivenEngine",
    "connect",
    "driver_brake",
    "initial_inputs",
    "interface_inertia",
    "pi_speed_controller",
    "shaft_load",
    "source",
    "torque_driven",
    "vehicle_load",
]
