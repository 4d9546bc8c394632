"""Libraries of the extras: imported on demand, so that the package runs without them."""

from __future__ import annotations

import importlib
from typing import Any

from .deprecated import renamed_names
from .errors import MissingDependencyError


def library(module: str, extra: str, name: str = "") -> Any:
    """Import a module of an extra.

    Args:
        module: name of the module.
        extra: name of the extra.
        name: name of the package to install, or "" if it follows from the name of the module.

    Raises:
        MissingDependencyError: the module is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        missing = name or module.partition(".")[0].replace("_", "-")
        raise MissingDependencyError(
            f"{missing} is not installed ({error}). Run pip install 'inertia-module[{extra}]'."
        ) from None


__getattr__ = renamed_names(__name__, NotInstalled="common.errors:MissingDependencyError")
