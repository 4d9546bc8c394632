"""Figures 2 and 3 of Stelmashchuk: accelerations of the driven mass over nu and over Pi."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...papers.stelmashchuk.criteria import Criteria
from ...papers.stelmashchuk.exact import response
from ...papers.stelmashchuk.law import PHASES, driving_acceleration, phase_starts
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, dress, sheet

Array = NDArray[np.float64]
Columns = dict[str, Array]

# the dwell of the paper's figures is not told
KAPPA2 = 1.0
END = 3.5
POINTS = 1401

STIFFNESSES = ((4.4, VERMILION), (8.0, BLUE), (100.0, GREEN))
DAMPINGS = ((0.0, GREEN), (0.5, BLUE), (1.0, SKY), (2.0, ORANGE), (3.0, PURPLE), (5.0, VERMILION))


def _phases(axes: Axes) -> None:
    """Boundaries and numbers of the phases, along the top."""
    starts = [*phase_starts(KAPPA2), END]
    for number, name in enumerate(PHASES):
        if number % 2:
            axes.axvspan(starts[number], starts[number + 1], color=GREY, alpha=0.10, linewidth=0)
        middle = 0.5 * (starts[number] + starts[number + 1])
        axes.annotate(
            name,
            (middle, 0.98),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="top",
            fontsize=10,
            color=GREY,
        )


def _panel(axes: Axes, kappa: Array, curves: list[tuple[Criteria, str, str]], beta: float) -> Columns:
    """One panel of accelerations with the sine; returns its columns."""
    columns: Columns = {}
    axes.plot(
        kappa,
        driving_acceleration(kappa, KAPPA2),
        color=BLACK,
        linewidth=1.0,
        linestyle=(0, (4, 2)),
        label="sine $S_κ$",
        zorder=3,
    )
    for criteria, label, colour in curves:
        columns[f"{label}, balancer {beta:g}"] = values = response(kappa, criteria, KAPPA2, beta).acceleration
        axes.plot(kappa, values, color=colour, linewidth=1.4, label=f"${label}$")
    axes.axhline(0.0, color=BLACK, linewidth=0.6)
    _phases(axes)
    return columns


def _both(curves: list[tuple[Criteria, str, str]], title: str) -> tuple[Figure, Columns]:
    """The accelerations with the balancer above those without it, to one scale."""
    kappa = np.linspace(0.0, END, POINTS)
    figure = sheet(7.2, 7.0)
    figure.suptitle(title, fontsize=11)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    columns: Columns = {"kappa": kappa, "sine": driving_acceleration(kappa, KAPPA2)}
    for axes, beta, name in ((panels[0], 1.0, "with the balancer"), (panels[1], 0.0, "without the balancer")):
        columns |= _panel(axes, kappa, curves, beta)
        dress(axes, "acceleration invariant $\\ddot a_{mκ}$", name)
    panels[1].set_xlabel("relative time $κ = t/T$")
    panels[0].legend(loc="lower right", ncols=2, fontsize=9, frameon=False)
    return figure, columns


def over_stiffness() -> tuple[Figure, Columns]:
    """Figure 2: nu = 4.4, 8 and 100 at Pi = 0.5, with and without the balancer.

    Returns:
        The figure, and columns of shape (1401,): kappa, the sine, and a'' of each curve, without unit.
    """
    curves = [(Criteria(nu, 0.5), f"ν = {nu:g}", colour) for nu, colour in STIFFNESSES]
    return _both(curves, "Acceleration of the driven mass over the stiffness, Π = 0.5, $κ_2$ = 1")


def over_damping() -> tuple[Figure, Columns]:
    """Figure 3: Pi from 0 to 5 at nu = 8, with and without the balancer.

    Returns:
        The figure, and columns of shape (1401,): kappa, the sine, and a'' of each curve, without unit.
    """
    curves = [(Criteria(8.0, Pi), f"Π = {Pi:g}", colour) for Pi, colour in DAMPINGS]
    return _both(curves, "Acceleration of the driven mass over the damping, ν = 8, $κ_2$ = 1")


FIGURES: dict[str, Callable[[], tuple[Figure, Columns]]] = {
    "stelmashchuk_2": over_stiffness,
    "stelmashchuk_3": over_damping,
}
