"""What the figures of the papers share: size, colours and dress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...common.colours import BLACK, BLUE, VERMILION

# the numbers of a figure by column, each of shape (n,)
Columns = dict[str, NDArray[Any]]
Drawings = dict[str, Callable[[], tuple[Figure, Columns]]]

BROKEN = (0, (4, 2))
SMALL: dict[str, Any] = {"fontsize": 9, "frameon": False}
CENTRED: dict[str, Any] = {"fontsize": 11, "ha": "center", "va": "center"}

DPI = 150


def sheet(width: float, height: float) -> Figure:
    """An empty figure of this size, inches; needs no window."""
    return Figure(figsize=(width, height), dpi=DPI, layout="constrained")


def dress(axes: Axes, label: str, title: str = "", zero: bool = False) -> None:
    """Label of the ordinate, title at the left, light grid, no box; a line at zero if asked for."""
    axes.set_ylabel(label)
    axes.set_title(title, loc="left", fontsize=10)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.margins(x=0.0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if zero:
        axes.axhline(0.0, color=BLACK, linewidth=0.6)


def compare(axes: Axes, x: Any, name: str, right: Any, page: Any) -> Columns:
    """Exact in full, printed in broken line; the columns of both."""
    axes.plot(x, right, color=BLUE, linewidth=2.0, label="exact")
    axes.plot(x, page, color=VERMILION, linewidth=1.3, linestyle=BROKEN, label="as printed")
    return {f"{name}, exact": right, f"{name}, as printed": page}
