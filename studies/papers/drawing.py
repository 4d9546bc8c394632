"""Drawing of the figures of the papers: panels of curves, sketches to scale, and the numbers in them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inertia_module.common.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION

from .karetin import STOP, Geometry
from .lysenko import EXAMPLE, EXAMPLE_SPEED

BROKEN, DOTTED, CHAIN = (0, (4, 2)), (0, (1, 1)), (0, (8, 3, 2, 3))
SMALL: dict[str, Any] = {"fontsize": 8, "frameon": False}
CENTRED: dict[str, Any] = {"fontsize": 11, "ha": "center", "va": "center"}
COLOURS = (BLUE, GREEN, ORANGE, VERMILION, PURPLE, SKY)
# of curves with these labels; others take the colours in turn
LOOKS: Mapping[str, Mapping[str, Any]] = {
    "exact": {"color": BLUE, "linewidth": 2.0},
    "as printed": {"color": VERMILION, "linewidth": 1.3, "linestyle": BROKEN},
    "mirrored": {"color": BLACK, "linewidth": 1.0, "linestyle": BROKEN},
    "sine": {"color": BLACK, "linewidth": 1.0, "linestyle": BROKEN, "zorder": 3},
}


class Panel(NamedTuple):
    """One of the panels of a figure.

    Attributes:
        ordinate: its label with the unit. curves: values over the abscissa by label, each of shape (n,).
        title: at the left above it.
    """

    ordinate: str
    curves: Mapping[str, Any]
    title: str = ""


def sheet(width: float, height: float, told: str) -> Figure:
    """An empty figure of this size, inches, with what is drawn below it; needs no window."""
    figure = Figure(figsize=(width, height), dpi=150, layout="constrained")
    figure.supxlabel(textwrap.fill(told, round(16 * width)), fontsize=8)
    return figure


def dress(axes: Axes, abscissa: str, ordinate: str, title: str = "") -> None:
    """Labels, title at the left, light grid, no box."""
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)
    axes.set_title(title, loc="left", fontsize=10)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def draw(axes: Axes, panel: Panel, x: Any, abscissa: str = "") -> None:
    """Draw the curves of a panel over x, shape (n,)."""
    axes.set_prop_cycle(color=COLOURS)
    for label, values in panel.curves.items():
        axes.plot(x, values, label=label, **{"linewidth": 1.4, **LOOKS.get(label, {})})
    dress(axes, abscissa, panel.ordinate, panel.title)
    axes.margins(x=0.0)
    axes.axhline(0.0, color=BLACK, linewidth=0.6)


def panels(rows: Sequence[Sequence[Panel]], x: Any, abscissa: str, told: str, **shared: Any) -> Figure:
    """Draw rows of panels over one abscissa, x of shape (n,), with a caption.

    Args:
        rows: of panels. shared: scales, as sharey of Figure.subplots.
    """
    figure = sheet(max(5.8, 3.1 * len(rows[0])), 0.7 + 2.2 * len(rows), told)
    grid = figure.subplots(len(rows), len(rows[0]), sharex=True, squeeze=False, **shared)
    for row, cells in zip(grid, rows, strict=True):
        for axes, panel in zip(row, cells, strict=True):
            draw(axes, panel, x, abscissa if row[0] is grid[-1, 0] else "")
    # one legend will do where all panels show the same
    alike = len({tuple(panel.curves) for row in rows for panel in row}) == 1
    for axes in grid.flat[:1] if alike else grid.flat:
        axes.legend(**SMALL)
    return figure


def numbers(figure: Figure) -> dict[str, Any]:
    """The numbers of the curves with a label by column, each of one shape (n,)."""
    columns: dict[str, Any] = {}
    for axes in figure.axes:
        names = [axes.get_xlabel() or figure.axes[-1].get_xlabel(), axes.get_ylabel()]
        names += [axes.get_zlabel()] if hasattr(axes, "get_zlabel") else []
        for line in axes.get_lines():
            label = str(line.get_label())
            if label.startswith("_"):
                continue
            data = line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()
            for name, values in zip(names, data, strict=True):
                shared = name == names[0] and np.array_equal(columns.get(name, values), values)
                parts = [name] if shared else [name, axes.get_title("left"), label]
                columns[", ".join(filter(None, parts))] = np.asarray(values)
    return {name.replace("$", ""): values for name, values in columns.items()}


def mechanism(g: Geometry, offsets: bool = True) -> str:
    """Parameters of Karetin's mechanism and motions, with or without the offsets of the imbalance."""
    teeth = f"z2, z16, z17, z6 = {g.z2}, {g.z16}, {g.z17}, {g.z6}"
    lengths = f"OrΠ = {1e3 * g.wheel_radius:g} mm, Σ = {math.degrees(g.shaft_angle):g}°"
    places = f"a, b, c = {g.a:g}, {g.b:g}, {g.c:g}"
    places += f"; ε, γ = {g.epsilon:g}, {g.gamma:g} rad" if offsets else ""
    return f"{teeth}; {lengths}; {places}; ω1 = {STOP.omega1:g} rad/s, i = 2 in the dynamic mode."


def wheels() -> str:
    """Parameters of Lysenko's mechanism and the speed of wheel 1 on the carrier."""
    m = EXAMPLE
    lengths = f"R, r, l = {1e3 * m.R0:g}, {1e3 * m.r:g}, {1e3 * m.arm:g} mm, b = {m.b:.3g}"
    inertias = f"J of carrier and wheel {m.J_carrier:g} and {m.J_wheel:g} kg·m²"
    return f"{lengths}, m = {m.m:g} kg, {inertias}, ω = {EXAMPLE_SPEED:g} rad/s."
