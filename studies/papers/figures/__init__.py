"""Figures of the papers, drawn anew: each function returns a figure and its numbers by column."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from matplotlib.figure import Figure

from . import curves, sketches
from .drawing import numbers


def all_figures() -> dict[str, Callable[[], tuple[Figure, dict[str, Any]]]]:
    """The functions that draw all figures, by name."""
    return {name: partial(_drawn, draw) for name, draw in (sketches.FIGURES | curves.FIGURES).items()}


def _drawn(draw: Callable[[], Figure]) -> tuple[Figure, dict[str, Any]]:
    figure = draw()
    return figure, numbers(figure)
