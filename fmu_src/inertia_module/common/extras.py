"""Libraries of the extras: imported on demand, so that the package runs without them."""

from __future__ import annotations

import importlib
from typing import Any


class NotInstalled(RuntimeError):
    """A library of an extra is not installed; the message contains its name and the command to install it."""


def library(module: str, extra: str, name: str = "") -> Any:
    """Import a module of an extra.

    Args:
        module: name of the module.
        extra: name of the extra.
        name: name of the package to install, or "" if it follows from the name of the module.

    Raises:
        NotInstalled: the module is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        missing = name or module.partition(".")[0].replace("_", "-")
        raise NotInstalled(
            f"{missing} is not installed ({error}). Run pip install 'inertia-module[{extra}]'."
        ) from None
