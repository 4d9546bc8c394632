"""Picture of a sweep: curves over one key, maps over two, parallel coordinates over more."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..harness.picture import Picture
from ..jobs.axes import Axis
from ..jobs.sweep import SweepResult
from .panels import DPI, dress, titled

# shown, where they vary and nothing else is asked for
USUAL = ("efficiency", "omega_out_final", "output_torque_mean", "input_torque_mean", "satellite_force_peak")
MOST = 3

Array = NDArray[np.float64]


def shown_figures(sweep: SweepResult, figures: Sequence[str] = ()) -> list[str]:
    """The figures to show: those asked for, or of the usual ones at most MOST that vary.

    Raises:
        Refused: the sweep has no such figure.
    """
    if figures:
        return [name for name in figures if sweep.figure(name).size]
    usual = [name for name in (*USUAL, *sweep.figures) if name in sweep.figures]
    return [name for name in dict.fromkeys(usual) if _varies(sweep.figure(name))][:MOST]


def _varies(values: Array) -> bool:
    known = values[np.isfinite(values)]
    return known.size > 1 and float(np.ptp(known)) > 1e-9 * float(np.abs(known).max())


def label(sweep: SweepResult, name: str) -> str:
    """Name of a key or figure with its unit."""
    return titled(name, sweep.units.get(name, ""))


def sweep_figure(sweep: SweepResult, figures: Sequence[str] = ()) -> Figure:
    """Picture of a sweep.

    Args:
        sweep: what it gave. figures: names of those to show, by default some that vary.

    Raises:
        Refused: the sweep has no such figure.
    """
    names = shown_figures(sweep, figures)
    if len(sweep.axes) > 2:
        return _parallel(sweep, names)
    rows = max(len(names), 1)
    picture = Picture(figsize=(9.0, 1.0 + 2.8 * rows), dpi=DPI, layout="constrained")
    panels = picture.subplots(rows, 1, squeeze=False)[:, 0]
    for panel, name in zip(panels, names, strict=False):
        if len(sweep.axes) == 1:
            _curve(panel, sweep, name)
        else:
            _map(picture, panel, sweep, name)
    return picture


def _values(sweep: SweepResult, axis: Axis) -> tuple[Array, list[str]]:
    """Places of the points on an axis, and the names of these places where they are no numbers."""
    found = [row.point[axis.name] for row in sweep.rows]
    if any(isinstance(value, str) for value in found):
        known = [str(value) for value in axis.values]
        return np.array([known.index(str(value)) for value in found], dtype=float), known
    return np.array(found, dtype=float), []


def _scale(panel: Axes, sweep: SweepResult, axis: Axis, names: list[str], side: str) -> None:
    """Label one side, x or y, of a panel by an axis."""
    getattr(panel, f"set_{side}label")(label(sweep, axis.name))
    if names:
        getattr(panel, f"set_{side}ticks")(range(len(names)), names)
    elif axis.logarithmic:
        getattr(panel, f"set_{side}scale")("log")


def _curve(panel: Axes, sweep: SweepResult, name: str) -> None:
    (axis,) = sweep.axes
    places, names = _values(sweep, axis)
    order = np.argsort(places, kind="stable")
    panel.plot(places[order], sweep.figure(name)[order], marker="o", markersize=3.5, linewidth=1.2)
    dress(panel, label(sweep, name))
    _scale(panel, sweep, axis, names, "x")


def _map(picture: Figure, panel: Axes, sweep: SweepResult, name: str) -> None:
    """A grid as a map, other samples as dots; what was refused stays white."""
    (x, x_names), (y, y_names) = (_values(sweep, axis) for axis in sweep.axes)
    values = sweep.figure(name)
    across, up = np.unique(x), np.unique(y)
    if across.size * up.size == values.size:
        table = np.full((up.size, across.size), np.nan)
        table[np.searchsorted(up, y), np.searchsorted(across, x)] = values
        drawn: Any = panel.pcolormesh(across, up, table, shading="nearest")
    else:
        drawn = panel.scatter(x, y, c=values, s=14)
    picture.colorbar(drawn, ax=panel, label=label(sweep, name))
    for axis, names, side in zip(sweep.axes, (x_names, y_names), "xy", strict=True):
        _scale(panel, sweep, axis, names, side)


def _parallel(sweep: SweepResult, names: Sequence[str]) -> Figure:
    """Parallel coordinates: a line for each row, coloured by the first figure."""
    places = [_values(sweep, axis) for axis in sweep.axes]
    table = [values for values, _ in places] + [sweep.figure(name) for name in names]
    titles = [label(sweep, axis.name) for axis in sweep.axes] + [label(sweep, name) for name in names]
    ends = [(float(np.nanmin(column)), float(np.nanmax(column))) for column in table]
    shares = np.array([_share(column, *end) for column, end in zip(table, ends, strict=True)]).T
    picture = Picture(figsize=(2.2 + 1.8 * len(table), 5.5), dpi=DPI, layout="constrained")
    panel = picture.subplots()
    colours = colormaps["viridis"]
    by = shares[:, len(sweep.axes)] if names else shares[:, 0]
    for line, share in zip(shares, by, strict=True):
        if np.isfinite(line).all():
            panel.plot(line, color=colours(share), alpha=0.5, linewidth=0.9)
    panel.set_xticks(range(len(table)), [title.replace(" [", "\n[") for title in titles])
    panel.set_yticks([])
    for place, ((low, high), column_names) in enumerate(
        zip(ends, [*(known for _, known in places), *[[]] * len(names)], strict=True)
    ):
        panel.axvline(place, color="0.3", linewidth=0.8)
        for value, height in ((low, -0.03), (high, 1.03)):
            text = column_names[int(value)] if column_names else f"{value:.4g}"
            panel.annotate(text, (place, height), ha="center", va="center", fontsize=8)
    for side in panel.spines.values():
        side.set_visible(False)
    return picture


def _share(values: Array, low: float, high: float) -> Array:
    """Where values are between the ends, 0 to 1."""
    return (values - low) / (high - low) if high > low else np.full(values.shape, 0.5)
