"""Translation of the kernel from Python to C, and compilation to machine code."""

from ..common.errors import InertiaModuleError


class CompilationError(InertiaModuleError, RuntimeError):
    """No compiled kernel is available, and none can be compiled; the message contains the reason."""
