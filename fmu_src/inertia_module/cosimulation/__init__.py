"""The drive side as a partner: an engine coupled to the FMU through omega1 and the input torque.

An engine (engine.py), the power bond between both (bond.py), schemes that couple them (schemes.py,
master.py), their limits of stability from theory (amplification.py), a communication step driven by the
residual of the bond (adaptive.py), and an engine whose rotor is in a torque-driven module
(torque_driven.py). What the numbers are is measured in studies/coupling and told in
docs/coupling.md.
"""

from .adaptive import ErrorControl, run_adaptive
from .amplification import amplification, inertia_limit
from .bond import Exchange, Ledger
from .engine import Engine, EngineMap, EngineState, Governor
from .interface import InterfaceInertia, interface_inertia
from .master import CoupledEngine
from .plant import ENGINE_READINGS, EnginePlant
from .schemes import SCHEMES, Scheme
from .torque_driven import TorqueDrivenEngine, torque_driven

__all__ = [
    "ENGINE_READINGS",
    "SCHEMES",
    "CoupledEngine",
    "Engine",
    "EngineMap",
    "EnginePlant",
    "EngineState",
    "ErrorControl",
    "Exchange",
    "Governor",
    "InterfaceInertia",
    "Ledger",
    "Scheme",
    "TorqueDrivenEngine",
    "amplification",
    "inertia_limit",
    "interface_inertia",
    "run_adaptive",
    "torque_driven",
]
