"""From the kernel's Python to C and to machine code that can be called."""


class CompilationUnavailable(RuntimeError):
    """No compiled kernel is available, and none can be made; the message gives the reason."""
