"""Libraries of the extras: imported late, so that the package runs without them."""

from __future__ import annotations

import importlib
from typing import Any


class NotInstalled(RuntimeError):
    """A library of an extra is not installed: which one, and how to get it."""


def library(module: str, extra: str, name: str = "") -> Any:
    """A module of an extra, or NotInstalled; name: what to install, if it is not called like the module."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        missing = name or module.partition(".")[0].replace("_", "-")
        raise NotInstalled(
            f"{missing} is not installed ({error}). Run pip install 'inertia-module[{extra}]'."
        ) from None
