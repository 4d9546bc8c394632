"""Surroundings of an FMU, stepped together with it.

Loads, controllers and sources are systems in discrete time, which closed_loop.py connects, with systems of
python-control too. What an engine in front of the module needs is in engine.py.
"""

from . import closed_loop, controllers, engine, loads, sources
from .closed_loop import *
from .controllers import *
from .engine import *
from .loads import *
from .sources import *

__all__ = [  # noqa: PLE0604
    *closed_loop.__all__,
    *controllers.__all__,
    *engine.__all__,
    *loads.__all__,
    *sources.__all__,
]
