"""The drive side as a partner: an engine coupled to the FMU through omega1 and the input torque.

An engine (engine.py), the power bond between both (bond.py), schemes that couple them (schemes.py,
master.py), their limits of stability from theory (amplification.py), and a communication step driven by the
residual of the bond (adaptive.py). What the numbers are is measured in studies/coupling and told in
docs/coupling.md.
"""

from .adaptive import ErrorControl, run_adaptive
from .amplification import amplification, inertia_limit
from .bond import Exchange, Ledger
from .engine import Engine, EngineMap, EngineState, Governor
from .interface import InterfaceInertia, interface_inertia
from .master import ENGINE_READINGS, CoupledEngine
from .schemes import SCHEMES, Scheme

__all__ = [
    "ENGINE_READINGS",
    "SCHEMES",
    "CoupledEngine",
    "Engine",
    "EngineMap",
    "EngineState",
    "ErrorControl",
    "Exchange",
    "Governor",
    "InterfaceInertia",
    "Ledger",
    "Scheme",
    "amplification",
    "inertia_limit",
    "interface_inertia",
    "run_adaptive",
]
