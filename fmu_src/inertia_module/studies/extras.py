"""The libraries of the extra `peers`: imported late, so that the package runs without them."""

from __future__ import annotations

import importlib
from typing import Any

from .trajectory import Unavailable


def library(module: str, name: str = "") -> Any:
    """A module of the extra.

    Args:
        module: to import. name: what to install, if it is not called like the module.

    Raises:
        Unavailable: it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        missing = name or module.partition(".")[0]
        raise Unavailable(
            f"{missing} is not installed ({error}): pip install 'inertia-module[peers]'"
        ) from None
