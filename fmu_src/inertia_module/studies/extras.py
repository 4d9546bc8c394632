"""The libraries of the extra `peers`."""

from __future__ import annotations

from typing import Any

from ..common import extras
from .trajectory import Unavailable


def library(module: str, name: str = "") -> Any:
    """A module of the extra; see common.extras.library.

    Raises:
        Unavailable: it is not installed.
    """
    try:
        return extras.library(module, "peers", name)
    except extras.NotInstalled as missing:
        raise Unavailable(str(missing)) from None
