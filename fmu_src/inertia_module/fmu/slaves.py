"""The slaves, one for each Python FMU: the name of a class is the model identifier."""

from __future__ import annotations

from .. import module
from .slave import PythonSlave


class InertiaModulePy(PythonSlave):
    """The inertia module."""

    instance_type = module.Module
