"""The claims in the text of Karetin, in the order of page.md: figures found, and whether what is said is so.

Conclusion 2 is about instants of symmetry. With q = omega16 t the angles are A = q + gamma and
B = s q + epsilon. About q = (n pi - epsilon)/s, where B is a multiple of pi, the radial place of D is even
and the tangential one odd. So only A there, gamma - epsilon/s + n pi/s, decides: epsilon and gamma count
through gamma - epsilon/s alone, and not at all in the moduli of the stop mode, for which no direction
across OQ is special.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from ..forms import rate
from ..report import ROUNDING, Finding, shown, worst
from .equations import (
    EQUATIONS,
    PRINTED,
    STOPPED_IN_TIME,
    exact,
    feet_of,
    lengths,
    modulus,
    over_period,
    printed,
    turned_x,
)
from .equations import MOVING as M
from .equations import STOPPED as S
from .mechanism import DYNAMIC, PAPER, STANDARD, STOP, Geometry, Motion, dynamic_mode, period
from .mechanism import GENERAL as G

Rows = Iterator[tuple[str, Finding]]
Function = Callable[[Any], Any]
MODES = STOP, DYNAMIC
OFFSET = 0.5
# grid of the search for an instant of symmetry, and times on either side of it that are compared
INSTANTS, COMPARED = 400, 250


def best_mirror(f: Function, span: float, sign: float = 1.0) -> tuple[float, float]:
    """Find the instant about which a periodic function is mirrored best.

    Args:
        f: of times, s, shape (n,), to values, shape (n,). span: period of the function, s.
        sign: 1 for mirrored, -1 for mirrored with the opposite sign (a function of mean 0).

    Returns:
        The largest |f(instant + u) - sign f(instant - u)| over the range of f, the least that any instant
        gives, 0 for a constant; and that instant, s.
    """
    dt, index = span / INSTANTS, np.arange(INSTANTS)
    samples, u = f(dt * index), np.linspace(0.0, 0.5 * span, COMPARED)
    if np.ptp(samples) <= ROUNDING * np.abs(samples).max():
        return 0.0, 0.0

    def difference(instant: float) -> float:
        return float(np.abs(f(instant + u) - sign * f(instant - u)).max())

    mirrored = samples[(index[:, None] - index) % INSTANTS]
    coarse = np.abs(samples - sign * mirrored).max(axis=1)
    found = [
        minimize_scalar(
            difference, bounds=(0.5 * dt * (m - 2), 0.5 * dt * (m + 2)), options={"xatol": 1e-9 * span}
        )
        for m in np.argsort(coarse)[:4]
    ]
    best = min(found, key=lambda one: one.fun)
    return float(best.fun / np.ptp(samples)), float(best.x)


def asymmetry(name: str, g: Geometry, motion: Motion) -> float:
    """Asymmetry of one of the exact moduli over the period of the motion in link 1."""
    return best_mirror(lambda t: getattr(exact(g, motion, t), name), period(g, motion))[0]


def asymmetry_of_components(g: Geometry, motion: Motion) -> float:
    """Largest asymmetry of V_x, V_y, V_z over that period, mirrored with either sign."""
    span = period(g, motion)
    components = [lambda t, axis=axis: exact(g, motion, t).velocity[axis] for axis in range(3)]
    return max(min(best_mirror(v, span, sign)[0] for sign in (1.0, -1.0)) for v in components)


def swings(g: Geometry, motion: Motion) -> tuple[Any, Any]:
    """Whole turns gained (0 is a swing to and fro) and half the range, rad, of D about Ox, Oy, Oz."""
    beta = np.unwrap(over_period(g, motion).angles)[[1, 2, 0]]
    turns = np.rint((beta[:, -1] - beta[:, 0]) / (2.0 * np.pi))
    return turns.astype(int), 0.5 * np.ptp(beta, axis=1)


def largest(values: Any) -> float:
    """Largest magnitude."""
    return float(np.abs(values).max())


def moments(v: Any) -> Any:
    """The vectors r x v of the dynamic mode about the normals of xOy, yOz and xOz."""
    return np.cross(M.position, v, axis=0)[[2, 0, 1]]


def of_the_abstract() -> Rows:
    """Layout, the three rotations, projections, and what is calculated."""
    others = replace(G, a=0.5), replace(G, b=0.5), replace(G, c=0.5)
    moved = [largest(exact(other, STOP, S.t).position - S.position) for other in others]
    across = np.ptp(over_period(STANDARD, STOP).position[0])
    says: Any = (*(move > 0.01 for move in moved), across < ROUNDING)
    yield "layout", Finding(*says, across=across, longest=Geometry(shaft_angle=1e-6).L)

    agreed = EQUATIONS["(23)"].difference
    yield "superposition", Finding(agreed < ROUNDING, agreed=shown(agreed))

    v, most = S.about_satellite, S.speed_about_satellite.max()
    along = largest((v * S.spin_of_satellite / S.omega6).sum(axis=0)) / most
    off, through = abs(1.0 - 1.0 / G.b) * G.QA, largest(v[2]) / most
    figures = {"along": shown(along), "b": G.b, "off": 1e3 * off, "through": 100 * through}
    yield "base_plane", Finding(along < ROUNDING, off < ROUNDING, **figures)

    share = largest(turned_x(M.about_drive, M.theta)[2]) / M.speed_about_drive.max()
    says = largest(S.about_drive[2]) < ROUNDING, share < ROUNDING
    yield "drive_velocity_in_plane", Finding(*says, share=100 * share)
    yield "central_velocity_in_plane", Finding(largest(turned_x(M.about_centre, M.theta)[0]) < ROUNDING)

    held, locked = (exact(G, motion, 0.0).speeds for motion in (STOP, dynamic_mode(100.0, 1.0)))
    says = held[0] == held[1], locked[0] == locked[1]
    yield "stop_condition", Finding(*says, held=held, locked=locked, needed=1 + 1 / G.k)

    moment = moments(M.velocity)
    agreed, negative = worst(M.arms * M.plane_speeds, np.abs(moment)), (moment < 0.0).mean()
    says = agreed < ROUNDING, negative == 0.0
    yield "moments_from_arms", Finding(*says, agreed=shown(agreed), negative=100 * negative)

    moment, planes = np.abs(moments(M.acceleration)), lengths(M.acceleration)
    of_a = np.sqrt((feet_of(M.position, M.acceleration) ** 2).sum(axis=1))
    off, agreed = worst(M.arms * planes, moment), worst(of_a * planes, moment)
    yield "arms_of_acceleration", Finding(off < ROUNDING, off=100 * off, agreed=shown(agreed))

    names = "velocity", "angular_velocities", "acceleration", "angular_accelerations"
    about_drive = largest(rate(STOPPED_IN_TIME.angular_velocities[0]))
    body = S.omega16 * S.omega6 * math.sin(G.shaft_angle)
    figures = {"about_drive": 1e-3 * about_drive, "body": 1e-3 * body}
    yield "angular_accelerations", Finding(*(name in PRINTED for name in names), **figures)


def of_the_links() -> Rows:
    """Links and what they carry, freewheel and ratio: before (1)."""
    page = modulus(PRINTED["sum_of_three"](M))
    on_link2 = exact(G, Motion(DYNAMIC.omega1, DYNAMIC.omega2, DYNAMIC.omega2), M.t).speed
    says = (worst(page, speed) < ROUNDING for speed in (M.speed, on_link2))
    yield "carrier", Finding(*says, change=100 * largest(on_link2 - M.speed) / M.speed.max())

    relative = DYNAMIC.omega2 - DYNAMIC.omega1
    yield "freewheel", Finding(DYNAMIC.omega2 >= 0.0, relative >= 0.0, relative=relative)

    drives = [exact(G, dynamic_mode(100.0, i), 0.0).omega16 for i in (0.5, 1.0, 2.0, math.inf)]
    yield "dynamic_range", Finding(*(drive >= 0.0 for drive in drives), backwards=drives[0])


def of_the_modes() -> Rows:
    """Angles, places and velocities of the stop and the dynamic mode: before (2) to before (19)."""
    beta = PRINTED["angles"](S)
    jumps = np.count_nonzero(np.abs(np.diff(beta[0])) > 3.0)
    says: Any = jumps == 0, EQUATIONS["(6)"].difference < ROUNDING
    figures = {"fold": worst(beta, S.angles), "below": 100 * np.mean(S.position[2] < 0.0)}
    yield "differentiable_angles", Finding(*says, jumps=jumps, turns=G.turns_in_period, **figures)

    # with a = 0 D only turns about Oz
    case = over_period(replace(G, a=0.0), STOP)
    about = case.angular_velocities
    says = (largest(omega - turn) < 1e-9 for omega, turn in zip(about, (0.0, 0.0, case.omega16), strict=True))
    figures = {"mean": about[0].mean(), "steady": shown(np.ptp(about[0]) / case.omega16)}
    figures |= {"drive": case.omega16, "varies": np.ptp(about[1:], axis=1)}
    yield "axes_of_the_angles", Finding(*says, **figures)

    A = M.centre_of_satellite
    yield "height_of_A", Finding(np.ptp(A[2]) < ROUNDING, moving=np.ptp(turned_x(A, M.theta)[2]))

    # OQ on link 1, which turns while link 2 is held
    turning = exact(G, dynamic_mode(100.0, math.inf), S.t).speed
    off = largest(turning - S.speed_in_link1) / turning.max()
    says = worst(S.speed_in_link1, S.speed) < ROUNDING, off < ROUNDING
    yield "absolute_in_stop_mode", Finding(*says, off=100 * off)

    cosine = (turned_x(M.velocity_in_link1, M.theta) * M.velocity).sum(axis=0) / (M.speed_in_link1 * M.speed)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    yield "only_modulus", Finding(angle.max() < 1e-3, mean=angle.mean(), most=angle.max())

    total = np.arctan2(*M.position_in_link1[1:]) - M.alpha
    place = M.projections[1] * np.array([np.sin(total), np.cos(total)])
    of_place = worst(place, M.position[1:])
    off = [largest(alpha - M.alpha) for alpha in (PRINTED["alpha"](M), printed(G, DYNAMIC, M.t, "alpha"))]
    says = of_place < ROUNDING, off[0] < ROUNDING
    yield "angle_of_turn", Finding(*says, off=off, span=M.t[-1], of_place=shown(of_place))
    yield "abscissa", Finding(largest(M.position[0] - M.position_in_link1[0]) < ROUNDING)

    changes = []
    for g in (PAPER, STANDARD):
        first = over_period(g, STOP)
        following = exact(g, STOP, first.t + 2.0 * math.pi / STOP.omega1)
        changes.append(largest(first.speed - following.speed) / first.speed.max())
    figures = {"whole": shown(changes[0]), "broken": 100 * changes[1], "turns": STANDARD.turns_in_period}
    yield "period_of_a_turn", Finding(*(change < ROUNDING for change in changes), **figures)


def of_the_conclusions() -> Rows:
    """Continuity, symmetry and swing."""
    divisors = M.position[0], M.velocity[1], M.velocity[0]
    poles = [np.count_nonzero(np.diff(np.sign(u))) for u in divisors]
    steps = [largest(np.diff(v)) / largest(v) for v in (M.position, M.velocity, M.acceleration)]
    yield "continuous_functions", Finding(max(steps) < 0.05, sum(poles) == 0, poles=poles)

    offsets = {"epsilon": (OFFSET, 0.0), "gamma": (0.0, OFFSET), "both": (OFFSET, OFFSET / PAPER.s)}
    found = {
        name: [100 * asymmetry("speed", replace(PAPER, epsilon=e, gamma=g), motion) for motion in MODES]
        for name, (e, g) in offsets.items()
    }
    components = 100 * asymmetry_of_components(replace(PAPER, gamma=OFFSET), STOP)
    says = (value > 1.0 for value in found["epsilon"] + found["gamma"])
    yield "asymmetry_from_offsets", Finding(*says, components=components, **found)

    swung = [swings(g, motion) for motion in MODES for g in (PAPER, G)]
    turns = [f"Ox {Ox:+d}, Oy {Oy:+d}, Oz {Oz:+d}" for (Ox, Oy, Oz), _ in swung]
    says = (turn == 0 for gained, _ in swung for turn in gained[:2])
    yield "swing_about_axes", Finding(*says, turns=turns, amplitude=math.degrees(swung[0][1][0]))

    vectors = [(k.position, v) for k in (S, M) for v in (k.velocity, k.acceleration)]
    about = [np.abs(np.cross(r, v, axis=0)).max(axis=1) for r, v in vectors]
    each = [" : ".join(f"{share:.2f}" for share in peaks / peaks.max()) for peaks in about]
    yield "planes_of_the_swing", Finding(*(peaks[1] == peaks.min() for peaks in about), each=each)


def findings() -> dict[str, Finding]:
    """The rows of the table of claims."""
    return {
        **dict(of_the_abstract()),
        **dict(of_the_links()),
        **dict(of_the_modes()),
        **dict(of_the_conclusions()),
    }
