"""What the figures of the papers share: size, colours, dress, and how parameters are told in a caption."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from inertia_module.common.colours import BLACK, BLUE, VERMILION

from ..karetin import Geometry
from ..karetin.cases import STOP
from ..lysenko.mechanism import Mechanism
from ..stelmashchuk.criteria import Criteria

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


def caption(figure: Figure, text: str) -> None:
    """What is drawn, with parameters and units, below the figure."""
    figure.supxlabel(textwrap.fill(text, round(16 * figure.get_figwidth())), fontsize=8)


def mechanism(g: Geometry, offsets: bool = True) -> str:
    """Parameters of Karetin's mechanism and motions, with or without the offsets of the imbalance."""
    teeth = f"z2, z16, z17, z6 = {g.z2}, {g.z16}, {g.z17}, {g.z6}"
    lengths = f"OrΠ = {1e3 * g.wheel_radius:g} mm, Σ = {math.degrees(g.shaft_angle):g}°"
    places = f"a, b, c = {g.a:g}, {g.b:g}, {g.c:g}"
    places += f"; ε, γ = {g.epsilon:g}, {g.gamma:g} rad" if offsets else ""
    return f"{teeth}; {lengths}; {places}; ω1 = {STOP.omega1:g} rad/s, i = 2 in the dynamic mode."


def wheels(m: Mechanism, omega: float) -> str:
    """Parameters of Lysenko's mechanism and the speed of wheel 1 on the carrier, rad/s."""
    lengths = f"R, r, l = {1e3 * m.R0:g}, {1e3 * m.r:g}, {1e3 * m.arm:g} mm, b = {m.b:.3g}"
    inertias = f"J of carrier and wheel {m.J_carrier:g} and {m.J_wheel:g} kg·m²"
    return f"{lengths}, m = {m.m:g} kg, {inertias}, ω = {omega:g} rad/s."


def criteria(c: Criteria, kappa2: float) -> str:
    """Criteria of Stelmashchuk's driven mass and the dwell."""
    return f"ν = {c.nu:g}, Π = {c.Pi:g}, κ2 = {kappa2:g}."
