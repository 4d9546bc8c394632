"""Each equation that is wrong as printed, beside its exact form: what it gives over a turn or a cycle."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..karetin import equations as karetin
from ..karetin.cases import GENERAL
from ..lysenko import equations as lysenko
from ..lysenko.mechanism import EXAMPLE, EXAMPLE_SPEED
from ..report import Equation
from ..stelmashchuk import equations as stelmashchuk
from . import style
from .style import Columns, Drawings, dress, sheet

POINTS = 200


class Sheet(NamedTuple):
    """What the figures of a paper have in common.

    Attributes:
        equations: of the paper. x: abscissa of their forms, shape (n,). end: how much of it is shown.
        label: of the abscissa. case: mechanism and motion. gives: by equation, its components with units.
    """

    equations: Mapping[str, Equation]
    x: Any
    end: float
    label: str
    case: str
    gives: Mapping[str, tuple[str, ...]]


SHEETS = {
    "karetin": Sheet(
        karetin.EQUATIONS,
        karetin.STOPPED.t * karetin.STOPPED.omega16 / (2.0 * np.pi),
        1.0,
        "turns of the drive",
        style.mechanism(GENERAL),
        {
            "(2)": ("x_D [m]", "y_D [m]", "z_D [m]"),
            "(5)": ("β_H [rad]", "β_P [rad]", "β_F [rad]"),
            "(9)": ("ω_{6x} [rad/s]", "ω_{6y} [rad/s]", "ω_{6z} [rad/s]"),
            "(11)": ("V_{QAx} [m/s]", "V_{QAy} [m/s]", "V_{QAz} [m/s]"),
            "(14)": ("λ [1/(m·s)]",),
            "(15)": ("V_{Ozx} [m/s]", "V_{Ozy} [m/s]"),
            "(19)": ("α [rad]",),
            "(21)": ("v·x_D [rad/s]",),
            "(22)": ("V_{Oxx} [m/s]", "V_{Oxy} [m/s]", "V_{Oxz} [m/s]"),
            "(24)": ("V_x [m/s]", "V_y [m/s]", "V_z [m/s]"),
            "(31)": ("x_N [m]", "y_N [m]", "z_N [m]"),
        },
    ),
    "lysenko": Sheet(
        lysenko.EQUATIONS,
        np.degrees(lysenko.INSIDE),
        360.0,
        "angle α of wheel 1 on the carrier [°]",
        style.wheels(EXAMPLE, EXAMPLE_SPEED),
        {
            "(2), note": ("ρ [m]",),
            "(5)": ("F_k [N]",),
            "(8)": ("β_1 [rad]",),
            "(10)": ("M [N·m]",),
            "(13)": ("k_1 [m]",),
            "(14)": ("k_2 [m]",),
            "(15)": ("M_1 [N·m]",),
            "(16)": ("M [N·m]",),
        },
    ),
    "stelmashchuk": Sheet(
        stelmashchuk.EQUATIONS,
        stelmashchuk.RISE,
        0.5,
        "relative time κ in phase I [1]",
        style.criteria(stelmashchuk.REFERENCE, stelmashchuk.KAPPA2),
        {"R″": ("R_κ'' [1]",)},
    ),
}


def drawn(paper: Sheet, number: str) -> tuple[Figure, Columns]:
    """A panel for each component of an equation: exact and as printed, fed with exact values of all it takes.

    Returns:
        The figure, and columns of one length: the abscissa, then both forms of each component.
    """
    kept = np.flatnonzero(paper.x <= paper.end)
    kept = kept[:: max(1, kept.size // POINTS)]
    x, names = paper.x[kept], paper.gives[number]
    printed, exact, _ = np.broadcast_arrays(*paper.equations[number].forms()[:2], paper.x)
    figure, columns = sheet(2.9 * max(2, len(names)), 2.5), {paper.label: x}
    panels = figure.subplots(1, len(names), squeeze=False)[0]
    for axes, name, right, page in zip(
        panels, names, np.atleast_2d(exact), np.atleast_2d(printed), strict=False
    ):
        symbol, _, unit = name.partition(" ")
        columns |= style.compare(axes, x, name.translate({123: None, 125: None}), right[kept], page[kept])
        dress(axes, f"${symbol}$ {unit}", zero=True)
        axes.set_xlabel(paper.label, fontsize=8)
    panels[0].legend(**style.SMALL)
    style.caption(figure, f"Equation {number}, exact and as printed. {paper.case}")
    return figure, columns


def file_name(paper: str, number: str) -> str:
    """Of the figure of an equation, without ending: the paper, and letters and digits of its number."""
    return f"{paper}_equation_{''.join(filter(str.isalnum, number))}"


FIGURES: Drawings = {
    file_name(name, number): partial(drawn, paper, number)
    for name, paper in SHEETS.items()
    for number in paper.gives
}
