"""The claims in the text of Karetin: the figures found of each and whether what it says is so."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..jets import rate
from ..report import ROUNDING, Finding, shown, worst
from . import conclusions
from .as_printed import PRINTED, printed
from .cases import DYNAMIC, PAPER, STANDARD, STOP, over_period
from .cases import GENERAL as G
from .equations import EQUATIONS, angles_in_time
from .equations import MOVING as M
from .equations import STOPPED as S
from .exact import exact, modulus, turned
from .geometry import Geometry
from .motion import Motion, dynamic_mode, transmission_ratios
from .projections import feet, lengths, projections

OFFSET = 0.5


def layout() -> Finding:
    """What a, b and c change, and what the layout cannot be."""
    others = (replace(G, a=0.5), replace(G, b=0.5), replace(G, c=0.5))
    moved = [np.abs(exact(other, STOP, S.t).position - S.position).max() for other in others]
    across = np.ptp(over_period(STANDARD, STOP).position[0])
    longest = Geometry(shaft_angle=1e-6).L
    return Finding(*(move > 0.01 for move in moved), across < ROUNDING, across=across, longest=longest)


def superposition() -> Finding:
    """The sum of the three velocities against the rate of the position."""
    agreed = EQUATIONS["(23)"].difference
    return Finding(agreed < ROUNDING, agreed=shown(agreed))


def base_plane() -> Finding:
    """V_QA against the axis of the satellite, and out of the base plane of wheel 17."""
    v, largest = S.about_satellite, S.speed_about_satellite.max()
    along = np.abs((v * S.spin_of_satellite / S.omega6).sum(axis=0)).max() / largest
    off, through = abs(1.0 - 1.0 / G.b) * G.QA, np.abs(v[2]).max() / largest
    figures = {"along": shown(along), "b": G.b, "off": 1e3 * off, "through": 100 * through}
    return Finding(along < ROUNDING, off < ROUNDING, **figures)


def drive_velocity_in_plane() -> Finding:
    """The z component of V_Oz in both modes."""
    rest = np.abs(S.about_drive[2]).max()
    share = np.abs(turned(M, M.about_drive)[2]).max() / M.speed_about_drive.max()
    return Finding(rest < ROUNDING, share < ROUNDING, share=100 * share)


def central_velocity_in_plane() -> Finding:
    """The x component of V_Ox."""
    return Finding(np.abs(turned(M, M.about_centre)[0]).max() < ROUNDING)


def stop_condition() -> Finding:
    """omega16 = omega2 with link 2 held, and omega16 = omega2 = omega1."""
    held, locked = (transmission_ratios(G, motion) for motion in (STOP, dynamic_mode(100.0, 1.0)))
    says = held[0] == held[1], locked[0] == locked[1]
    return Finding(*says, held=held, locked=locked, needed=1 + 1 / G.k)


def _moment(v: Any) -> Any:
    """The vectors r x v of the dynamic mode about the normals of xOy, yOz and xOz."""
    return np.cross(M.position, v, axis=0)[[2, 0, 1]]


def moments_from_arms() -> Finding:
    """Arm times projection of V against r x V."""
    moment = _moment(M.velocity)
    agreed, negative = worst(M.arms * M.plane_speeds, np.abs(moment)), (moment < 0.0).mean()
    return Finding(agreed < ROUNDING, negative == 0.0, agreed=shown(agreed), negative=100 * negative)


def arms_of_acceleration() -> Finding:
    """The arms given, those of V, with a; and those of a by the same formulas."""
    moment, planes = np.abs(_moment(M.acceleration)), projections(M.acceleration)
    off = worst(M.arms * planes, moment)
    agreed = worst(lengths(feet(M.position, M.acceleration)) * planes, moment)
    return Finding(off < ROUNDING, off=100 * off, agreed=shown(agreed))


def angular_accelerations() -> Finding:
    """Which of the four the page has, and how large the fourth is in the stop mode, 1e3 rad/s^2."""
    names = ("velocity", "angular_velocities", "acceleration", "angular_accelerations")
    about_drive = 1e-3 * np.abs(rate(rate(angles_in_time(S)[0])).value).max()
    body = 1e-3 * S.omega16 * S.omega6 * math.sin(G.shaft_angle)
    return Finding(*(name in PRINTED for name in names), about_drive=about_drive, body=body)


def carrier() -> Finding:
    """Which link carries wheel 17 and the drive: |V| of (23) with it on link 1 and on link 2."""
    page = modulus(PRINTED["sum_of_three"](M))
    on_link2 = exact(G, Motion(DYNAMIC.omega1, DYNAMIC.omega2, DYNAMIC.omega2), M.t).speed
    change = np.abs(on_link2 - M.speed).max() / M.speed.max()
    return Finding(*(worst(page, speed) < ROUNDING for speed in (M.speed, on_link2)), change=100 * change)


def freewheel() -> Finding:
    """Link 2 against the housing and against link 1."""
    relative = DYNAMIC.omega2 - DYNAMIC.omega1
    return Finding(DYNAMIC.omega2 >= 0.0, relative >= 0.0, relative=relative)


def dynamic_range() -> Finding:
    """The sense of the drive over i."""
    drives = [transmission_ratios(G, dynamic_mode(100.0, i))[1] for i in (0.5, 1.0, 2.0, math.inf)]
    return Finding(*(drive >= 0.0 for drive in drives), backwards=drives[0])


def differentiable_angles() -> Finding:
    """Jumps of beta_H, folds of beta_P and beta_F, and the rates of the right angles."""
    beta = PRINTED["angles"](S)
    jumps = np.count_nonzero(np.abs(np.diff(beta[0])) > 3.0)
    says = jumps == 0, EQUATIONS["(6)"].difference < ROUNDING
    figures = {"fold": worst(beta, S.angles), "below": 100 * np.mean(S.position[2] < 0.0)}
    return Finding(*says, jumps=jumps, turns=G.turns_in_period, **figures)


def axes_of_the_angles() -> Finding:
    """omega_H, omega_P, omega_F where D only turns about Oz: with a = 0 in the stop mode."""
    case = over_period(replace(G, a=0.0), STOP)
    about, turns = case.angular_velocities, (0.0, 0.0, case.omega16)
    says = [np.abs(omega - turn).max() < 1e-9 for omega, turn in zip(about, turns, strict=True)]
    figures = {"mean": about[0].mean(), "steady": shown(np.ptp(about[0]) / case.omega16)}
    return Finding(*says, drive=case.omega16, varies=np.ptp(about[1:], axis=1), **figures)


def height_of_A() -> Finding:  # noqa: N802
    """How z_A changes in the stop and in the dynamic mode."""
    A = M.centre_of_satellite
    return Finding(np.ptp(A[2]) < ROUNDING, moving=np.ptp(turned(M, A)[2]))


def absolute_in_stop_mode() -> Finding:
    """|V| with OQ at rest, and with OQ on link 1 while link 2 is held, against (18)."""
    turning = exact(G, dynamic_mode(100.0, math.inf), S.t).speed
    off = np.abs(turning - S.speed_in_link1).max() / turning.max()
    return Finding(worst(S.speed_in_link1, S.speed) < ROUNDING, off < ROUNDING, off=100 * off)


def only_modulus() -> Finding:
    """The angle between the velocities of both modes, apart from the turn by alpha."""
    cosine = (turned(M, M.velocity_in_link1) * M.velocity).sum(axis=0) / (M.speed_in_link1 * M.speed)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return Finding(angle.max() < 1e-3, mean=angle.mean(), most=angle.max())


def angle_of_turn() -> Finding:
    """The swing in the turn of D and in that of V; alpha of (19) with the exact and the printed omega_P."""
    total = np.arctan2(*M.position_in_link1[1:]) - M.alpha
    place = M.projections[1] * np.array([np.sin(total), np.cos(total)])
    of_place = worst(place, M.position[1:])
    page = PRINTED["alpha"](M), printed(G, DYNAMIC, M.t, "alpha")
    off = [np.abs(alpha - M.alpha).max() for alpha in page]
    return Finding(of_place < ROUNDING, off[0] < ROUNDING, off=off, span=M.t[-1], of_place=shown(of_place))


def abscissa() -> Finding:
    """Where D is along Ox before and after the turn about Ox."""
    return Finding(np.abs(M.position[0] - M.position_in_link1[0]).max() < ROUNDING)


def period_of_a_turn() -> Finding:
    """Change of |V| after a turn of the drive, with s whole and with s = 1.7."""
    changes = []
    for g in (PAPER, STANDARD):
        first = over_period(g, STOP)
        following = exact(g, STOP, first.t + 2.0 * math.pi / STOP.omega1)
        changes.append(np.abs(first.speed - following.speed).max() / first.speed.max())
    whole, broken = changes
    figures = {"whole": shown(whole), "broken": 100 * broken, "turns": STANDARD.turns_in_period}
    return Finding(whole < ROUNDING, broken < ROUNDING, **figures)


def continuous_functions() -> Finding:
    """The largest step of exact quantities between neighbouring times, and the poles of the printed ones."""
    divisors = (M.position[0], M.velocity[1], M.velocity[0])
    poles = [np.count_nonzero(np.diff(np.sign(u))) for u in divisors]
    steps = [np.abs(np.diff(v)).max() / np.abs(v).max() for v in (M.position, M.velocity, M.acceleration)]
    return Finding(max(steps) < 0.05, sum(poles) == 0, poles=poles)


def asymmetry_from_offsets() -> Finding:
    """Asymmetry of |V| in both modes by either offset and by both, % of its range."""
    found = {}
    for name, offsets in (
        ("epsilon", (OFFSET, 0.0)),
        ("gamma", (0.0, OFFSET)),
        ("both", (OFFSET, OFFSET / PAPER.s)),
    ):
        geometry = replace(PAPER, epsilon=offsets[0], gamma=offsets[1])
        found[name] = [100 * conclusions.asymmetry("speed", geometry, motion) for motion in (STOP, DYNAMIC)]
    components = 100 * conclusions.asymmetry_of_components(replace(PAPER, gamma=OFFSET), STOP)
    says = (value > 1.0 for value in found["epsilon"] + found["gamma"])
    return Finding(*says, components=components, **found)


def swing_about_axes() -> Finding:
    """Whole turns of D about each axis in a period, in both modes, in the standard and the general case."""
    found = [conclusions.swings(g, motion) for motion in (STOP, DYNAMIC) for g in (PAPER, G)]
    turns = [", ".join(f"{axis} {swing[axis].turns:+d}" for axis in ("Ox", "Oy", "Oz")) for swing in found]
    says = (swing[axis].turns == 0 for swing in found for axis in ("Ox", "Oy"))
    return Finding(*says, turns=turns, amplitude=math.degrees(found[0]["Ox"].amplitude))


def planes_of_the_swing() -> Finding:
    """Peaks of |r x V| and |r x a| about Ox, Oy, Oz in both modes: are those in yOz and xOy the largest?"""
    about = [
        np.abs(np.cross(k.position, v, axis=0)).max(axis=1)
        for k in (S, M)
        for v in (k.velocity, k.acceleration)
    ]
    each = [" : ".join(f"{share:.2f}" for share in peaks / peaks.max()) for peaks in about]
    return Finding(*(peaks[1] == peaks.min() for peaks in about), each=each)
