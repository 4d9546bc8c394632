"""What the figures of the papers share: size, colours and dress."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

# colours that the colour-blind tell apart: Okabe and Ito (2008), Color Universal Design
BLACK, ORANGE, SKY, GREEN = "#222222", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#8A8A8A"

DPI = 150


def sheet(width: float, height: float) -> Figure:
    """An empty figure of this size, inches; needs no window."""
    return Figure(figsize=(width, height), dpi=DPI, layout="constrained")


def dress(axes: Axes, label: str, title: str = "") -> None:
    """Label of the ordinate, title at the left, light grid, no box."""
    axes.set_ylabel(label)
    axes.set_title(title, loc="left", fontsize=10)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.margins(x=0.0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
