"""From the kernel's Python to machine code that can be called."""


class CompilationUnavailable(RuntimeError):
    """There is no compiled kernel here, and what it takes to make one is not installed or fails.

    All that translates, compiles or links raises it, with the reason.
    """
