"""Which kernel a model runs on: the compiled one, or plain Python."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable

from ..common.errors import Refused, must_be
from ..compiling import load as compiled
from ..compiling.kernels import MODULE, CompilationUnavailable


def choose_kernel(kernel: str, name: str = MODULE) -> tuple[Callable[..., int] | None, str]:
    """The compiled entry, or None for the plain kernel, and why.

    Args:
        kernel: "compiled", "plain", or "auto": what the environment variable INERTIA_MODULE_KERNEL
            says, else compiled where there is such a kernel.
        name: which of kernels.ENTRIES.

    Raises:
        CompilationUnavailable: "compiled" was asked for and there is none.
        Refused: kernel is none of these.
    """
    if kernel == "auto":
        kernel = os.environ.get("INERTIA_MODULE_KERNEL", "auto")
    if kernel == "plain":
        return None, "plain Python, as asked for"
    if kernel == "compiled":
        return compiled.load(name), "compiled"
    if kernel != "auto":
        raise Refused(must_be("kernel", "auto, compiled or plain", repr(kernel)))
    try:
        return compiled.load(name), "compiled"
    except CompilationUnavailable as error:
        warnings.warn(
            f"the kernel runs as plain Python, a hundred times slower: there is no compiled one ({error})",
            RuntimeWarning,
            stacklevel=4,
        )
        return None, f"plain Python, for there is no compiled one ({error})"
