"""Picture of a design: what was searched, what no other design is better than, what was checked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from ..jobs.design import DesignResult
from ..jobs.evaluation import Row
from ..jobs.spec import unit_of
from .panels import dress, sheet, titled

Array = NDArray[np.float64]


def design_figure(found: DesignResult) -> Figure:
    """Picture of a design: one goal over the designs in their order, or the other goals over the first.

    Args:
        found: of design.
    """
    names = list(found.spec.goals)
    across, up = (None, names) if len(names) == 1 else (names[0], names[1:])
    picture = sheet(found.spec.scene.title, 1.0 + 4.8 * len(up))
    for panel, name in zip(picture.subplots(len(up), 1, squeeze=False)[:, 0], up, strict=True):
        _panel(panel, found, across, name)
    return picture


def _panel(panel: Axes, found: DesignResult, across: str | None, up: str) -> None:
    """One goal over another, or over the number of the design."""
    place = {str(row.point): n for n, row in enumerate(found.rows, 1)}

    def points(rows: Sequence[Row]) -> tuple[Array, Array]:
        """Where rows are; NaN without the figure."""
        x = [place[str(row.point)] if across is None else row.figures.get(across, np.nan) for row in rows]
        return np.array(x, dtype=float), np.array([row.figures.get(up, np.nan) for row in rows])

    meets = [found.judge.meets(row) for row in found.rows]
    for label, wanted, colour in (("beyond a limit", False, "0.8"), ("meets all limits", True, "tab:blue")):
        rows = [row for row, one in zip(found.rows, meets, strict=True) if one is wanted]
        panel.plot(*points(rows), ".", color=colour, markersize=4, label=label)
    style = "k*" if across is None else "k-"
    panel.plot(*points(found.front), style, linewidth=1.0, markersize=9, label="none is better")
    for side, one in enumerate(found.finalists):
        chosen = found.judge.meets(one.checked)
        (x,), (y,) = points([one.checked])
        panel.plot(x, y, "o" if chosen else "x", color="tab:green" if chosen else "tab:red", markersize=8)
        # those beside each other to both sides
        shift = (-14, -14) if side % 2 else (6, 6)
        panel.annotate(one.file.stem.rpartition("_")[2], (x, y), xytext=shift, textcoords="offset points")
    panel.plot([], [], "o", color="tab:green", label=f"checked {found.spec.search.check}")
    dress(panel, _label(found, up))
    x, y = points(found.rows)
    _stretch(panel, "y", y)
    if across is not None:
        _stretch(panel, "x", x)
    panel.margins(0.03)
    panel.set_xlabel("design, in the order of the search" if across is None else _label(found, across))


def _stretch(panel: Axes, side: str, values: Array) -> None:
    """Make a side logarithmic, with plain numbers: the first designs of a search are far from the best."""
    if (values < 0.0).any():
        getattr(panel, f"set_{side}scale")("symlog")
        return
    getattr(panel, f"set_{side}scale")("log")
    axis = getattr(panel, f"{side}axis")
    axis.set_major_formatter("{x:g}")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0, 7.0)))
    axis.set_minor_formatter(NullFormatter())


def _label(found: DesignResult, name: str) -> str:
    return titled(name, unit_of(name, found.judge.units))
