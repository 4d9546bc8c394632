"""The drive side as a partner of the FMU: an engine in front of it.

An engine (engine.py) is coupled through its speed (by_speed.py) or, its rotor being in the module, through
its torque (by_torque.py); the ledger of either counts the energy lost between both. What the schemes are
worth is measured in studies/coupling and described in docs/coupling.md.
"""

from .by_speed import SCHEMES, CoupledEngine, Scheme
from .by_torque import TorqueDrivenEngine, torque_driven
from .engine import Engine, EngineMap, EngineState, Governor
from .interface import InterfaceInertia, interface_inertia
from .plant import EnginePlant, Exchange, Ledger

__all__ = [
    "SCHEMES",
    "CoupledEngine",
    "Engine",
    "EngineMap",
    "EnginePlant",
    "EngineState",
    "Exchange",
    "Governor",
    "InterfaceInertia",
    "Ledger",
    "Scheme",
    "TorqueDrivenEngine",
    "interface_inertia",
    "torque_driven",
]
