"""The slaves, one for each Python FMU: the name of a class is the model identifier."""

from __future__ import annotations

from .. import memory
from ..compiling.kernels import source_hash
from .slave import PythonSlave

# while the files are there: later instances in the process share this code, when its own folder may be gone
source_hash()


class InertiaModulePy(PythonSlave):
    """The inertia module."""

    instance_type = memory.Module
