"""Figures of the papers, drawn anew: each function returns a figure and its numbers by column."""

from . import karetin, lysenko, stelmashchuk
from .style import Drawings


def all_figures() -> Drawings:
    """The functions that draw all figures, by name."""
    return karetin.FIGURES | lysenko.FIGURES | stelmashchuk.FIGURES
