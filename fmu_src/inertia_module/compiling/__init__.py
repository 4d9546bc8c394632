"""Translation of the kernel from Python to C, and compilation to machine code."""

from ..common.deprecated import renamed_names
from ..common.errors import InertiaModuleError


class CompilationError(InertiaModuleError, RuntimeError):
    """No compiled kernel is available, and none can be compiled; the message contains the reason."""


__getattr__ = renamed_names(__name__, CompilationUnavailable="CompilationError")
