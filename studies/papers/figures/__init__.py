"""Figures of the papers, drawn anew: each function returns a figure and its numbers by column."""

from . import equations, karetin, karetin_arms, karetin_layout, lysenko, stelmashchuk
from .style import Drawings


def all_figures() -> Drawings:
    """The functions that draw all figures, by name."""
    modules = karetin_layout, karetin, karetin_arms, lysenko, stelmashchuk, equations
    return {name: draw for module in modules for name, draw in module.FIGURES.items()}
