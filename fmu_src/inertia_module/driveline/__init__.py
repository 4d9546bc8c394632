"""Environment of an FMU, simulated together with the FMU.

Loads, controllers and engines are discrete-time systems of python-control (DiscreteSystem). connect joins
them, also with other systems of python-control. ClosedLoop simulates them with an FMU.
"""

from typing import TYPE_CHECKING, Any

from ..common.deprecated import renamed_names
from . import closed_loop, connection, controllers, engine, loads, sources
from .closed_loop import *
from .connection import *
from .controllers import *
from .engine import *
from .loads import *
from .sources import *

if TYPE_CHECKING:
    from .discrete_system import DiscreteSystem

__all__ = [  # noqa: PLE0604
    "DiscreteSystem",
    *closed_loop.__all__,
    *connection.__all__,
    *controllers.__all__,
    *engine.__all__,
    *loads.__all__,
    *sources.__all__,
]

_renamed = renamed_names(__name__, Sampled="DiscreteSystem")


def __getattr__(name: str) -> Any:
    # The module of DiscreteSystem imports python-control, so it is imported at its first use.
    if name == "DiscreteSystem":
        from .discrete_system import DiscreteSystem

        return DiscreteSystem
    if name == "Sampled":
        return _renamed(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
