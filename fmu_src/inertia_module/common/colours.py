"""Style of all figures: the colours, and a figure that a notebook displays without a call.

Colour-blind people can distinguish the colours: Okabe and Ito (2008), Color Universal Design.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from .files import picture_of

BLACK, ORANGE, SKY, GREEN = "#222222", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#8A8A8A"


class Picture(Figure):
    """A matplotlib Figure that a notebook displays as PNG."""

    def _repr_png_(self) -> bytes:
        return picture_of(self, ".png")
