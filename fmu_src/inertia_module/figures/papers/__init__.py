"""Figures of the papers, drawn anew: each function returns a figure and its numbers by column."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from . import karetin, lysenko, stelmashchuk

Columns = dict[str, NDArray[np.float64]]


def all_figures() -> dict[str, Callable[[], tuple[Figure, Columns]]]:
    """The functions that draw all figures, by name."""
    return {**karetin.FIGURES, **lysenko.FIGURES, **stelmashchuk.FIGURES}
