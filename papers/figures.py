"""Figures of the papers: curves in panels, mechanisms to scale, and the data of the curves.

Each figure of a wrong equation shows the printed and the exact form. Karetin's figures use scene R1 with 40
teeth on wheel 17. Then s = 2, and one turn of the pinion shaft is one period of the motion in link 1, as in
the paper.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION

from . import karetin, lysenko, stelmashchuk
from .engine import Row, read_file
from .karetin import DYNAMIC, GENERAL, MOVING, PAPER, STOP, Geometry, exact, period
from .lysenko import EXAMPLE as M
from .lysenko import EXAMPLE_SPEED as W
from .stelmashchuk import KAPPA2, PHASES, Criteria, law_of_motion, phase_starts, response

DASHED, DOTTED, CHAIN = (0, (4, 2)), (0, (1, 1)), (0, (8, 3, 2, 3))
SMALL: dict[str, Any] = {"fontsize": 8, "frameon": False}
CENTRED: dict[str, Any] = {"fontsize": 11, "ha": "center", "va": "center"}
COLOURS = (BLUE, GREEN, ORANGE, VERMILION, PURPLE, SKY)
# line styles by label; other curves use COLOURS in order
STYLES: Mapping[str, Mapping[str, Any]] = {
    "exact": {"color": BLUE, "linewidth": 2.0},
    "as printed": {"color": VERMILION, "linewidth": 1.3, "linestyle": DASHED},
    "mirrored": {"color": BLACK, "linewidth": 1.0, "linestyle": DASHED},
    "sine": {"color": BLACK, "linewidth": 1.0, "linestyle": DASHED, "zorder": 3},
}
TURNS = np.linspace(0.0, 1.0, 1441)
# turns between the instants at which D is on an axis or the page divides by zero
BETWEEN = (np.arange(5760) + 0.5) / 5760
MODES = (("stop mode", STOP), ("dynamic mode, i = 2", DYNAMIC))
SHIFTS = np.linspace(0.0, 0.5 * np.pi, 25)
# Stelmashchuk does not state the dwell of his figures
KAPPA = np.linspace(0.0, 3.5, 1401)
STIFFNESSES = {f"ν = {nu:g}": Criteria(nu, 0.5) for nu in stelmashchuk.STIFFNESSES}
DAMPINGS = {f"Π = {Pi:g}": Criteria(8.0, Pi) for Pi in (0.0, 0.5, 1.0, 2.0, 3.0, 5.0)}
# parameters of Lysenko's mechanism, and the speed of wheel 1 on the carrier
WHEELS = (
    f"R, r, l = {1e3 * M.R0:g}, {1e3 * M.r:g}, {1e3 * M.arm:g} mm, b = {M.b:.3g}, m = {M.m:g} kg, "
    f"J of carrier and wheel {M.J_carrier:g} and {M.J_wheel:g} kg·m², ω = {W:g} rad/s."
)


def mechanism(g: Geometry, offsets: bool = True) -> str:
    """Return the text of the parameters of Karetin's mechanism and motions.

    Args:
        g: Mechanism.
        offsets: True to include the offsets of the imbalance.
    """
    teeth = f"z2, z16, z17, z6 = {g.z2}, {g.z16}, {g.z17}, {g.z6}"
    lengths = f"OrΠ = {1e3 * g.wheel_radius:g} mm, Σ = {math.degrees(g.shaft_angle):g}°"
    places = f"a, b, c = {g.a:g}, {g.b:g}, {g.c:g}"
    places += f"; ε, γ = {g.epsilon:g}, {g.gamma:g} rad" if offsets else ""
    return f"{teeth}; {lengths}; {places}; ω1 = {STOP.omega1:g} rad/s, i = 2 in the dynamic mode."


# --- curves ---

CURVES = tomllib.loads(read_file("figures.toml"))


class Panel(NamedTuple):
    """Panel of a figure.

    Attributes:
        ordinate: Label of the ordinate with its unit.
        curves: Values, shape (n,), by label.
        title: Title above the panel.
    """

    ordinate: str
    curves: Mapping[str, Any]
    title: str = ""


def two_forms(ordinate: str, exact: Any, printed: Any, title: str = "") -> Panel:
    """Return a panel with the exact and the printed values of a quantity.

    Args:
        ordinate: Label of the ordinate with its unit.
        exact: Exact values, shape (n,).
        printed: Printed values, shape (n,).
        title: Title of the panel.
    """
    return Panel(ordinate, {"exact": exact, "as printed": printed}, title)


def new_figure(width: float, height: float, caption: str) -> Figure:
    """Return an empty figure with a caption below.

    Args:
        width: Width, inches.
        height: Height, inches.
        caption: Text of the caption.
    """
    figure = Figure(figsize=(width, height), dpi=150, layout="constrained")
    figure.set_label(caption)
    return figure


def add_labels(axes: Axes, abscissa: str, ordinate: str, title: str = "") -> None:
    """Set labels, a title at the left and a light grid, and remove the box.

    Args:
        axes: Axes to change.
        abscissa: Label of the abscissa.
        ordinate: Label of the ordinate.
        title: Title.
    """
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)
    axes.set_title(title, loc="left", fontsize=10)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def draw(axes: Axes, panel: Panel, x: Any, abscissa: str = "") -> None:
    """Draw the curves of a panel.

    Args:
        axes: Axes to draw on.
        panel: The panel.
        x: Values of the abscissa, shape (n,).
        abscissa: Label of the abscissa.
    """
    axes.set_prop_cycle(color=COLOURS)
    for label, values in panel.curves.items():
        axes.plot(x, values, label=label, **{"linewidth": 1.4, **STYLES.get(label, {})})
    add_labels(axes, abscissa, panel.ordinate, panel.title)
    axes.margins(x=0.0)
    axes.axhline(0.0, color=BLACK, linewidth=0.6)


def panels(rows: Sequence[Sequence[Panel]], x: Any, abscissa: str, caption: str, **shared: Any) -> Figure:
    """Draw rows of panels over one abscissa.

    Args:
        rows: Panels by row.
        x: Values of the abscissa, shape (n,).
        abscissa: Label of the abscissa.
        caption: Text of the caption.
        shared: Arguments of subplots, such as sharey.
    """
    figure = new_figure(max(5.8, 3.1 * len(rows[0])), 0.7 + 2.2 * len(rows), caption)
    grid = figure.subplots(len(rows), len(rows[0]), sharex=True, squeeze=False, **shared)
    for row, cells in zip(grid, rows, strict=True):
        for axes, panel in zip(row, cells, strict=True):
            draw(axes, panel, x, abscissa if row[0] is grid[-1, 0] else "")
    # one legend if all panels show the same curves
    alike = len({tuple(panel.curves) for row in rows for panel in row}) == 1
    for axes in grid.flat[:1] if alike else grid.flat:
        axes.legend(**SMALL)
    return figure


# figures of equations by paper: module, abscissa, visible part, label, text of the parameters
SHEETS: dict[str, tuple[ModuleType, Any, slice, str, str]] = {
    "karetin": (
        karetin,
        karetin.STOPPED.t * karetin.STOPPED.omega16 / (2.0 * np.pi),
        slice(0, karetin.SAMPLES // GENERAL.turns_in_period, 10),
        CURVES["karetin_3"]["label"],
        mechanism(GENERAL),
    ),
    "lysenko": (
        lysenko,
        np.degrees(lysenko.INSIDE),
        slice(0, None, 18),
        CURVES["lysenko_2"]["label"],
        WHEELS,
    ),
    "stelmashchuk": (
        stelmashchuk,
        stelmashchuk.RISE,
        slice(0, None, 15),
        "relative time κ in phase I [1]",
        f"ν = 8, Π = 0.5, κ2 = {KAPPA2:g}.",
    ),
}


def equation(name: str, row: Row) -> Figure:
    """Draw a panel for each component of an equation: exact, and as printed with exact inputs.

    Args:
        name: Name of the paper.
        row: Row of the equation.
    """
    paper, x, visible, label, case = SHEETS[name]
    printed_values, exact_values, _ = np.broadcast_arrays(*paper.EQUATIONS[row.number].forms()[:2], x)
    components = row.drawn.split(", ")
    forms = zip(components, np.atleast_2d(exact_values), np.atleast_2d(printed_values), strict=False)
    cells = [two_forms(component, right[visible], page[visible]) for component, right, page in forms]
    return panels([cells], x[visible], label, f"Equation {row.number}, exact and as printed. {case}")


def in_period(motion: Any, turns: Any = TURNS, geometry: Any = PAPER) -> Any:
    """Return Karetin's exact forms over a period.

    Args:
        motion: Speeds.
        turns: Times over the period, shape (n,).
        geometry: Mechanism.
    """
    return exact(geometry, motion, turns * period(geometry, motion))


def components(symbol: str, vector: Any) -> dict[str, Any]:
    """Return the curves of the components and of the modulus of a vector, by label.

    Args:
        symbol: Symbol of the vector.
        vector: Values, shape (3, n).
    """
    parts = {f"${symbol}_{axis}$": part for axis, part in zip("xyz", vector, strict=True)}
    return parts | {f"$|{symbol}|$": karetin.modulus(vector)}


def moduli(name: str, motion: Any, scale: float = 1.0) -> tuple[Any, Any]:
    """Return the exact and the printed modulus of velocity or acceleration over a period.

    Args:
        name: "velocity" or "acceleration", with or without "_in_link1".
        motion: Speeds.
        scale: Factor to the displayed unit.
    """
    k = in_period(motion, BETWEEN)
    velocity = "velocity" if motion.carrier else "velocity_in_link1"
    page = karetin.printed(PAPER, motion, k.t, velocity)
    if name == "acceleration":
        step = 1e-3 * k.t[0]
        after, before = (karetin.printed(PAPER, motion, k.t + h, velocity) for h in (step, -step))
        page = (after - before) / (2.0 * step)
    return scale * karetin.modulus(k[name]), scale * karetin.modulus(page)


def angles(motion: Any) -> dict[str, Any]:
    """Return the curves of the angles of D about Oz, Ox, Oy and of the angle of link 1, degrees, by label.

    Args:
        motion: Speeds.
    """
    k = in_period(motion, BETWEEN)
    beta, about = np.degrees(np.unwrap(k.angles)), zip("HPF", "zxy", strict=True)
    lines = {f"$β_{index}$, about $O{axis}$": beta[n] for n, (index, axis) in enumerate(about)}
    return lines | {"$-ω_1t$": -np.degrees(motion.carrier * k.t)}


def mirrored_speed(title: str, motion: Any, epsilon: float, gamma: float) -> Panel:
    """Return a panel of |V| with offsets of the imbalance, and of its mirror image.

    Args:
        title: Name of the motion.
        motion: Speeds.
        epsilon: Offset about QA, rad.
        gamma: Offset about OQ, rad.
    """
    geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
    span = period(geometry, motion)

    def speed(t: Any) -> Any:
        return exact(geometry, motion, t).speed

    share, instant = karetin.best_mirror(speed, span)
    both = {"exact": speed(TURNS * span), "mirrored": speed(2.0 * instant - TURNS * span)}
    heading = f"ε = {epsilon:g}, γ = {gamma:g}: asymmetry {100.0 * share:.1f} %"
    return Panel(f"|V| [m/s], {title}", both, heading)


def asymmetries(name: str, motion: Any) -> Any:
    """Return the asymmetry of a modulus over SHIFTS, percent of its range.

    Args:
        name: Name of the modulus.
        motion: Speeds.
    """
    half = [
        100.0 * karetin.asymmetry(name, replace(PAPER, gamma=gamma), motion) for gamma in SHIFTS[:13].tolist()
    ]
    # even function with period pi/s, the rotation of the pinion shaft while B turns by pi
    return np.array([*half, *half[-2::-1]])


def with_and_without_balancer(cases: Mapping[str, Criteria]) -> list[list[Panel]]:
    """Return panels of a'' of the driven mass with and without the balancer, one above the other.

    Args:
        cases: Criteria by label.
    """
    rows = []
    for title, beta in (("with the balancer", 1.0), ("without the balancer", 0.0)):
        sine = {"sine": law_of_motion(KAPPA, KAPPA2)[2]}
        motions = {name: response(KAPPA, case, KAPPA2, beta).acceleration for name, case in cases.items()}
        rows.append([Panel("a″ [1]", sine | motions, title)])
    return rows


def curves(name: str) -> Figure:
    """Draw a figure of CURVES.

    Args:
        name: Name of the figure.
    """
    row, scope = CURVES[name], globals().copy()
    for variable, formula in row.get("names", {}).items():
        scope[variable] = eval(formula, scope)
    captions = {
        "paper": mechanism(PAPER),
        "without_offsets": mechanism(PAPER, offsets=False),
        "wheels": WHEELS,
    }
    caption, shared = row["caption"].format_map(captions), {"sharey": row.get("sharey", "none")}
    figure = panels(eval(row["panels"], scope), eval(row["x"], scope), row["label"], caption, **shared)
    for axes, limits in zip(figure.axes, row.get("limits", ()), strict=False):
        axes.set_ylim(*limits)
    edges = [*phase_starts(KAPPA2), KAPPA[-1]]
    for axes in figure.axes if "phases" in row else ():
        for number, phase in enumerate(PHASES):
            start, end = edges[number : number + 2]
            if number % 2:
                axes.axvspan(start, end, color=GREY, alpha=0.10, linewidth=0)
            at = 0.5 * (start + end), 0.98
            axes.text(*at, phase, transform=axes.get_xaxis_transform(), ha="center", va="top", color=GREY)
        if "symlog" in row:
            axes.set_yscale("symlog", linthresh=row["symlog"], linscale=2.0)
    return figure


# --- mechanisms to scale ---

SKETCHES = tomllib.loads(read_file("sketches.toml"))

# a, b and c differ from 1, so that no points coincide
LAYOUT = replace(GENERAL, epsilon=0.0, gamma=0.0)
# instant of the drawn dynamic mode, turns of the pinion shaft
INSTANT = 0.08
# angle of the drawn mechanism of Lysenko, rad
DRAWN_ANGLE = np.radians(130.0)
AT, TURN = lysenko.exact(M, DRAWN_ANGLE, W), np.exp(1j * M.b * DRAWN_ANGLE)


class Sketch:
    """Drawing in the plane of two coordinates; positions are complex numbers, mm.

    Args:
        axes: Axes to draw on.
        plane: Names of the two coordinates, such as "xz".
        view: View limits as in axes.axis(), mm.
        title: Title.
    """

    def __init__(self, axes: Axes, plane: str, view: Any, title: str = "") -> None:
        self.axes, self.plane = axes, plane
        axes.set_aspect("equal")
        axes.axis(view)
        add_labels(axes, f"${plane[0]}$ [mm]", f"${plane[1]}$ [mm]", title)

    def projected(self, place: Any) -> Any:
        """Project positions onto the plane, mm.

        Args:
            place: Positions x, y, z, m, shape (3,) or (3, n).
        """
        right, up = (place["xyz".index(axis)] for axis in self.plane)
        return 1e3 * (right + 1j * up)

    def line(self, *places: complex, colour: str = BLACK, **look: Any) -> None:
        """Draw a line.

        Args:
            places: Points of the line, mm.
            colour: Colour.
            look: Arguments of axes.plot.
        """
        self.axes.plot(np.real(places), np.imag(places), color=colour, **{"linewidth": 1.3, **look})

    def write(self, place: complex, text: str, colour: str = BLACK) -> None:
        """Write a centred text.

        Args:
            place: Position, mm.
            text: Text.
            colour: Colour.
        """
        self.axes.text(place.real, place.imag, text, color=colour, **CENTRED)

    def point(self, place: complex, name: str, offset: complex, colour: str = BLACK) -> None:
        """Draw a point with its name.

        Args:
            place: Position, mm.
            name: Name.
            offset: Position of the name relative to the point, mm.
            colour: Colour.
        """
        self.line(place, colour=colour, marker="o", markersize=4, zorder=4)
        self.write(place + offset, name, colour)

    def arrow(self, start: complex, along: complex, colour: str, name: str = "", line: Any = "-") -> None:
        """Draw an arrow with its name beyond the tip.

        Args:
            start: Start, mm.
            along: Vector from start to end, mm.
            colour: Colour.
            name: Name.
            line: Line style.
        """
        end = start + along
        look = {"color": colour, "linestyle": line, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}
        tip, tail = (end.real, end.imag), (start.real, start.imag)
        self.axes.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", **look})
        self.write(end + 7.0 * along / abs(along), name, colour)

    def arc(self, corner: complex, start: complex, angle: float, radius: float, name: str) -> None:
        """Draw an angle with its name in the middle.

        Args:
            corner: Vertex, mm.
            start: Direction of the first side.
            angle: Angle, rad.
            radius: Radius of the arc, mm.
            name: Name.
        """
        turned = start / abs(start) * np.exp(1j * np.linspace(0.0, angle, 41))
        self.line(*(corner + radius * turned))
        self.write(corner + (radius + 7.0) * turned[20], name)

    def lever(
        self, of: complex, through: complex, along: complex, colour: str, name: str, offset: complex
    ) -> None:
        """Draw the perpendicular from a point to a line, with its name.

        Args:
            of: The point, mm.
            through: A point of the line, mm.
            along: Direction of the line, length 1.
            colour: Colour.
            name: Name.
            offset: Position of the name relative to the middle, mm.
        """
        foot = through + ((of - through) * np.conj(along)).real * along
        self.line(through, foot, colour=colour, linestyle=DASHED)
        self.line(of, foot, colour=colour, linestyle=DOTTED)
        self.write(0.5 * (of + foot) + offset, name, colour)

    def parts(self, *names: str, **values: Any) -> None:
        """Draw parts of SKETCHES; each part can use the names of the parts before it.

        Args:
            names: Names of the parts.
            values: Values that the formulas of the parts use, by name.
        """
        scope = globals() | {"projected": self.projected, "plane": self.plane} | values
        for part in map(SKETCHES.__getitem__, names):
            for name, formula in part.get("names", {}).items():
                scope[name] = eval(formula, scope)
            for kind, arguments, *condition in part["rows"]:
                if all(eval(text, scope) for text in condition):
                    eval(f"method({arguments})", scope | {"method": getattr(self, kind)})


def figure_1() -> Figure:
    """Draw Karetin's figure 1: section of the layout at time 0, and both modes along the central axis."""
    g, instant = LAYOUT, f"b, c: one revolution of the pinion shaft, drawn after {INSTANT:g} revolutions"
    figure = new_figure(12.0, 4.2, f"All exact. {instant}; P is the projection of D on yOz. {mechanism(g)}")
    layout = f"a) layout: AD, QA, OQ = {1e3 * g.AD:.1f}, {1e3 * g.QA:.1f}, {1e3 * g.OQ:.1f} mm"
    views = (
        (layout, "xz", "section", STOP, 0.0),
        ("b) stop mode: ω2 = 0, OQ at rest", "yz", "path", STOP, INSTANT),
        ("c) dynamic mode: OQ turns about Ox", "yz", "path", DYNAMIC, INSTANT),
    )
    for axes, (title, plane, part, motion, share) in zip(figure.subplots(1, 3), views, strict=True):
        drawn = Sketch(axes, plane, (-130.0, 140.0, -125.0, 90.0), title)
        drawn.parts("linkage", part, motion=motion, share=share)
    return figure


def pitch_cones(g: Geometry) -> tuple[Any, Any, Any]:
    """Return apex and rims of the pitch cones at time 0.

    Args:
        g: Mechanism.

    Returns:
        Q, m, shape (3,); rims of wheel 17 and of the satellite, m, shape (3, 121) each.
    """
    up, turn = np.array([0.0, 0.0, 1.0]), np.array([np.cos(g.gamma), np.sin(g.gamma), 0.0])
    sideways = np.cross(up, turn)
    around = np.linspace(0.0, 2.0 * np.pi, 121)

    def rim(half: float, axis: Any) -> Any:
        circle = np.outer(np.cross(axis, sideways), np.cos(around)) + np.outer(sideways, np.sin(around))
        return (g.OQ * up + g.L * np.cos(half) * axis)[:, None] + g.L * np.sin(half) * circle

    satellite = np.sin(g.shaft_angle) * turn - np.cos(g.shaft_angle) * up
    return g.OQ * up, rim(g.psi, -up), rim(g.phi, satellite)


def trajectories() -> Figure:
    """Draw Karetin's figure 2: trajectory of D in the stop and in the dynamic mode, with the pitch cones."""
    caption = f"Trajectory of D over a period and position at the start, exact. {mechanism(PAPER)}"
    figure = new_figure(10.4, 5.2, caption)
    apex, *rims = pitch_cones(PAPER)
    start = exact(PAPER, STOP, [0.0])
    centre, A, D = np.zeros(3), start.centre_of_satellite[:, 0], start.position[:, 0]
    for n, (title, motion) in enumerate(MODES, 1):
        axes: Any = figure.add_subplot(1, 2, n, projection="3d", computed_zorder=False)
        path = exact(PAPER, motion, np.linspace(0.0, period(PAPER, motion), 1441)).position
        look: dict[str, Any] = {"color": GREY, "linewidth": 0.9, "linestyle": DASHED}
        axes.plot(path[0], path[1], 0.0 * path[2], label="H: D on xOy", **look)
        for rim, colour in zip(rims, (GREY, BLUE), strict=True):
            axes.plot(*rim, color=colour, linewidth=1.3)
            for place in rim[:, ::20].T:
                axes.plot(*np.stack([apex, place], axis=1), color=colour, linewidth=0.4)
        axes.plot(*path, color=VERMILION, linewidth=2.2, label="D")
        axes.plot(*np.stack([centre, apex, A], axis=1), color=BLACK, linewidth=1.2)
        axes.plot(*np.stack([A, D], axis=1), color=ORANGE, linewidth=2.0)
        reach = 1.2 * np.abs(path).max()
        for axis, name in zip(np.eye(3), "xyz", strict=True):
            axes.plot(*np.stack([centre, reach * axis], axis=1), color=BLACK, linewidth=0.9)
            axes.text(*(1.08 * reach * axis), f"${name}$", **CENTRED)
        for place, name in ((centre, "O"), (apex, "Q"), (A, "A"), (D, "D")):
            axes.plot(*place[:, None], "o", color=BLACK, markersize=4)
            axes.text(*(place + 0.09 * reach), f"${name}$", **CENTRED)
        axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", aspect="equal")
        axes.set_title(f"{'ab'[n - 1]}) {title}", loc="left", fontsize=10)
        axes.legend(**SMALL, loc="lower left")
        axes.view_init(elev=24, azim=-46)
    return figure


def arms() -> Figure:
    """Draw Karetin's (26) to (31): projections of V at one instant, arms and speeds over a turn."""
    turn, at = slice(0, len(MOVING.t) // int(GENERAL.turns_in_period), 5), 112
    turns = MOVING.t[turn] * MOVING.omega16 / (2.0 * np.pi)
    caption = "Projections of V and their arms about O, exact; (26) to (30) are right as printed, in (31) the"
    caption += f" printed y_N is the x of N. V: 1 m/s is 4 mm; planes drawn at {turns[at]:.2f} revolutions"
    figure = new_figure(9.6, 8.0, f"{caption}. {mechanism(GENERAL)}")
    grid = figure.subplots(3, 3, height_ratios=(2.2, 1.0, 1.0)).T
    look: dict[str, Any] = {"color": GREY, "linewidth": 0.8}
    names = zip(("xOy", "yOz", "xOz"), "HPF", "LMN", strict=True)
    for n, (axes, (plane, point, foot)) in enumerate(zip(grid, names, strict=True)):
        drawn = Sketch(axes[0], plane[::2], (-200, 200, -200, 200), plane)
        vectors = MOVING.position, 4e-3 * MOVING.velocity, MOVING.feet[n]
        path, V, foot_of_O = (drawn.projected(v)[turn] for v in vectors)
        mass, end = path[at], foot_of_O[at]
        drawn.axes.plot(path.real, path.imag, label=f"${point}$", **look)
        drawn.axes.axline((mass.real, mass.imag), (end.real, end.imag), linestyle=DASHED, **look)
        drawn.line(0j, end, colour=BLUE)
        drawn.arrow(mass, V[at], VERMILION)
        for place, name in ((0j, "O"), (mass, point), (end, foot)):
            drawn.point(place, f"${name}$", 9 + 9j)
        draw(axes[1], Panel(f"O{foot} [mm]", {f"O{foot}": 1e3 * MOVING.arms[n, turn]}), turns)
        draw(
            axes[2],
            Panel("speed [m/s]", {plane: MOVING.plane_speeds[n, turn]}),
            turns,
            CURVES["karetin_3"]["label"],
        )
    return figure


def epicycloid() -> Figure:
    """Draw the figure of Lysenko to scale: wheels 1 and 2, carrier 3, epicycloid 4, distance and angles."""
    figure = new_figure(
        5.6, 6.0, f"Wheel 1 rolls around the fixed wheel 2 (exact), drawn at α = 130°. {WHEELS}"
    )
    Sketch(figure.subplots(), "XY", (-105, 105, -105, 105)).parts("wheels", "links")
    return figure


def speeds_and_forces() -> Figure:
    """Draw Lysenko's angles and speeds, (6) to (8) and (13), and his forces and arms, at one angle."""
    page = lysenko.printed(M, DRAWN_ANGLE, W)
    printed_arms = f"with the printed arms k1 = {1e3 * page.k1:.1f} and k2 = {1e3 * page.k2:.1f} mm"
    caption = f"exact (Fk is in line with F1, so k1 = 0); grey: Fk as printed, {printed_arms}"
    figure = new_figure(9.4, 5.0, f"At α = 130°, {caption}. {WHEELS}")
    speeds = f"{AT.V1:.2f}, {AT.V2:.2f}, {AT.V:.2f} m/s"
    forces = f"{AT.F1:.0f}, {AT.F2:.0f}, {AT.Fk:.0f} N (printed {page.Fk:.0f} N)"
    titles = {
        "speeds": f"angles and speeds: $V_1, V_2, V$ = {speeds}",
        "forces": f"forces and arms: $F_1, F_2, F_k$ = {forces}",
    }
    for axes, (part, title) in zip(figure.subplots(1, 2), titles.items(), strict=True):
        Sketch(axes, "XY", (-12, 132, -12, 112)).parts("wheels", part, page=page)
        axes.set_title(title, loc="left", fontsize=9)
    return figure


# --- all of them ---

FIGURES: dict[str, Callable[[], Figure]] = {
    "karetin_1": figure_1,
    "karetin_2": trajectories,
    "karetin_arms": arms,
    "lysenko_1": epicycloid,
    "lysenko_forces": speeds_and_forces,
    **{name: partial(curves, name) for name in CURVES},
    **{
        f"{name}_equation_{''.join(filter(str.isalnum, row.number))}": partial(equation, name, row)
        for name, (paper, *_) in SHEETS.items()
        for row in paper.ROWS
        if row.drawn
    },
}


def numbers(figure: Figure) -> dict[str, Any]:
    """Return the data of the labelled curves of a figure by column name, each of shape (n,).

    Args:
        figure: The figure.
    """
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
