"""Figures 2 and 3 of Stelmashchuk, accelerations of the driven mass, and what he prints beside the exact."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from inertia_module.loops.stepping import PHASES, law_of_motion, phase_starts

from ..stelmashchuk.as_printed import acceleration, printed
from ..stelmashchuk.criteria import Criteria
from ..stelmashchuk.exact import response
from . import style
from .style import Columns, Drawings, dress, sheet

# the paper does not give the dwell of its figures
KAPPA2 = 1.0
END = 3.5
KAPPA = np.linspace(0.0, END, 1401)
# accelerations up to here are drawn to a linear scale: the peaks of the exact ones
LINEAR = 10.0

STIFFNESSES = ((4.4, VERMILION), (8.0, BLUE), (100.0, GREEN))
DAMPINGS = (
    (0.0, GREEN),
    (0.5, BLUE),
    (1.0, SKY),
    (2.0, ORANGE),
    (3.0, PURPLE),
    (5.0, VERMILION),
)


def _phases(axes: Axes) -> None:
    """Boundaries and numbers of the phases, along the top."""
    starts = [*phase_starts(KAPPA2), END]
    for number, name in enumerate(PHASES):
        start, end = starts[number : number + 2]
        if number % 2:
            axes.axvspan(start, end, color=GREY, alpha=0.10, linewidth=0)
        look: dict[str, Any] = {"ha": "center", "va": "top", "fontsize": 10, "color": GREY}
        axes.text(0.5 * (start + end), 0.98, name, transform=axes.get_xaxis_transform(), **look)


def _accelerations(curves: list[tuple[Criteria, str, str]], title: str) -> tuple[Figure, Columns]:
    """The accelerations with the balancer above those without it, to one scale."""
    figure, sine = sheet(7.2, 7.0), law_of_motion(KAPPA, KAPPA2)[2]
    figure.suptitle(f"Acceleration of the driven mass over the {title}, exact", fontsize=11)
    style.caption(
        figure, f"κ2 = {KAPPA2:g}. Accelerations in φ/T², times in T; phases I to IV along the top."
    )
    panels, columns = figure.subplots(2, 1, sharex=True, sharey=True), {"kappa [1]": KAPPA, "sine [1]": sine}
    for axes, beta, name in ((panels[0], 1.0, "with the balancer"), (panels[1], 0.0, "without the balancer")):
        axes.plot(
            KAPPA,
            sine,
            color=BLACK,
            linewidth=1.0,
            linestyle=style.BROKEN,
            label="sine $S_κ$",
            zorder=3,
        )
        for criteria, label, colour in curves:
            values = response(KAPPA, criteria, KAPPA2, beta).acceleration
            axes.plot(KAPPA, values, color=colour, linewidth=1.4, label=f"${label}$")
            columns[f"a'' [1], {label}, balancer {beta:g}"] = values
        _phases(axes)
        dress(axes, "acceleration invariant $\\ddot a_{mκ}$", name, zero=True)
    panels[1].set_xlabel("relative time $κ = t/T$")
    panels[0].legend(**style.SMALL, loc="lower right", ncols=2)
    return figure, columns


def over_stiffness() -> tuple[Figure, Columns]:
    """Figure 2: kappa, the sine, and a'' for nu = 4.4, 8, 100 at Pi = 0.5, with and without the balancer."""
    curves = [(Criteria(nu, 0.5), f"ν = {nu:g}", colour) for nu, colour in STIFFNESSES]
    return _accelerations(curves, "stiffness, Π = 0.5")


def over_damping() -> tuple[Figure, Columns]:
    """Figure 3: kappa, the sine and a'' for Pi from 0 to 5 at nu = 8, with and without the balancer."""
    curves = [(Criteria(8.0, Pi), f"Π = {Pi:g}", colour) for Pi, colour in DAMPINGS]
    return _accelerations(curves, "damping, ν = 8")


def as_printed() -> tuple[Figure, Columns]:
    """Acceleration with the balancer as the page computes it, its equations in a row, beside the exact."""
    figure, columns = sheet(7.2, 7.6), {"kappa [1]": KAPPA}
    panels = figure.subplots(len(STIFFNESSES), 1, sharex=True)
    for axes, (nu, _) in zip(panels, STIFFNESSES, strict=True):
        case = Criteria(nu, 0.5)
        exact, page = response(KAPPA, case, KAPPA2).acceleration, acceleration(printed(case, KAPPA2), KAPPA)
        columns |= style.compare(axes, KAPPA, f"a'' [1], ν = {nu:g}", exact, page)
        axes.set_yscale("symlog", linthresh=LINEAR, linscale=2.0)
        _phases(axes)
        dress(axes, "$\\ddot a_{mκ}$", f"ν = {nu:g}", zero=True)
    panels[0].legend(**style.SMALL, loc="lower left")
    panels[-1].set_xlabel("relative time $κ = t/T$")
    told = (
        f"with the balancer, Π = 0.5, κ2 = {KAPPA2:g}. Accelerations in φ/T², logarithmic beyond ±{LINEAR:g}"
    )
    style.caption(figure, f"Acceleration of the driven mass {told}, where the printed C1 of phase III leads.")
    return figure, columns


FIGURES: Drawings = {
    "stelmashchuk_2": over_stiffness,
    "stelmashchuk_3": over_damping,
    "stelmashchuk_printed": as_printed,
}
