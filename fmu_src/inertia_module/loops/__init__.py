"""What stands around an FMU and is stepped together with it.

Loads, controllers and sources are python-control systems, closed_loop.py connects them. An engine (engine.py)
is coupled through its speed (by_speed.py) or, its rotor being in the module, through its torque
(by_torque.py); the ledger of either counts the energy lost between both. What the schemes are worth is
measured in studies/coupling and described in docs/coupling.md.
"""

from .by_speed import SCHEMES, CoupledEngine, Scheme
from .by_torque import TorqueDrivenEngine, torque_driven
from .closed_loop import ClosedLoop, connect, initial_inputs
from .controllers import driver_brake, pi_speed_controller
from .coupling import Coupling
from .engine import Engine, EngineMap, EngineState, Governor
from .interface import InterfaceInertia, interface_inertia
from .loads import Load, shaft_load, torque_source, vehicle_load
from .plant import EnginePlant, Exchange, Ledger
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
    "Exchange",
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
    "torque_source",
    "vehicle_load",
]
