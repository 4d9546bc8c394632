"""Environment of an FMU, simulated together with the FMU.

Loads, controllers and sources are discrete-time systems. closed_loop.py connects them, also with systems of
python-control. engine.py contains the torque map and the governor of an engine upstream of the module.
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
