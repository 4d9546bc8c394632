"""Style of all figures: the colours, sizes and lines, and a figure that a notebook displays without a call.

Colour-blind people can distinguish the colours: Okabe and Ito (2008), Color Universal Design.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

from cycler import cycler
from matplotlib import rc_context
from matplotlib.figure import Figure

from .files import picture_of

BLACK, ORANGE, SKY, GREEN = "#222222", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#8A8A8A"

# parameters of matplotlib that differ from its defaults
STYLE: dict[Any, Any] = {
    "axes.grid": True,
    "axes.prop_cycle": cycler(color=[VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY, BLACK]),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 11,
    "figure.titlesize": 15,
    "figure.titleweight": "bold",
    "grid.alpha": 0.25,
    "legend.columnspacing": 1.2,
    "legend.fontsize": 9,
    "legend.frameon": False,
    "legend.handlelength": 1.3,
}


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """Use the style; as a decorator, ``@styled()``, for all figures that a function draws."""
    with rc_context(STYLE):
        yield


class Picture(Figure):
    """A matplotlib Figure in the style, which a notebook displays as PNG."""

    @styled()
    def draw(self, renderer: Any) -> None:
        """Draw the figure in the style; matplotlib creates ticks and grid lines at the time of drawing.

        Args:
            renderer: Renderer of matplotlib.
        """
        super().draw(renderer)

    def _repr_png_(self) -> bytes:
        return picture_of(self, ".png")
