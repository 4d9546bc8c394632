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
from .cases import DYNAMIC, GENERAL, PAPER, STANDARD, STOP, over_period
from .equations import EQUATIONS, MOVING, STOPPED, angles_in_time
from .exact import exact, modulus, turned
from .geometry import Geometry
from .motion import Motion, dynamic_mode, transmission_ratios
from .projections import feet, lengths, projections

OFFSET = 0.5


def layout() -> Finding:
    """What a, b and c change, and what the layout cannot be."""
    place = STOPPED.position
    others = (replace(GENERAL, a=0.5), replace(GENERAL, b=0.5), replace(GENERAL, c=0.5))
    moved = [np.abs(exact(other, STOP, STOPPED.t).position - place).max() for other in others]
    across = float(np.ptp(over_period(STANDARD, STOP).position[0]))
    longest = Geometry(shaft_angle=1e-6).L
    return Finding(*(move > 0.01 for move in moved), across < ROUNDING, across=across, longest=longest)


def superposition() -> Finding:
    """The sum of the three velocities against the rate of the position."""
    agreed = worst(*EQUATIONS["(23)"].forms())  # type: ignore[misc, operator]
    return Finding(agreed < ROUNDING, agreed=shown(agreed))


def base_plane() -> Finding:
    """V_QA against the axis of the satellite, and out of the base plane of wheel 17."""
    v, largest = STOPPED.about_satellite, STOPPED.speed_about_satellite.max()
    axis = STOPPED.spin_of_satellite / STOPPED.omega6
    along = float(np.abs((v * axis).sum(axis=0)).max() / largest)
    off = abs(1.0 - 1.0 / GENERAL.b) * GENERAL.QA
    through = 100 * float(np.abs(v[2]).max() / largest)
    return Finding(
        along < ROUNDING, off < ROUNDING, along=shown(along), b=GENERAL.b, off=1e3 * off, through=through
    )


def drive_velocity_in_plane() -> Finding:
    """The z component of V_Oz in both modes."""
    rest = np.abs(STOPPED.about_drive[2]).max()
    share = np.abs(turned(MOVING, MOVING.about_drive)[2]).max() / MOVING.speed_about_drive.max()
    return Finding(rest < ROUNDING, share < ROUNDING, share=100 * share)


def central_velocity_in_plane() -> Finding:
    """The x component of V_Ox."""
    along = np.abs(turned(MOVING, MOVING.about_centre)[0]).max()
    return Finding(along < ROUNDING)


def stop_condition() -> Finding:
    """omega16 = omega2 with link 2 held, and omega16 = omega2 = omega1."""
    held = transmission_ratios(GENERAL, STOP)
    locked = transmission_ratios(GENERAL, dynamic_mode(100.0, 1.0))
    return Finding(
        held[0] == held[1], locked[0] == locked[1], held=held, locked=locked, needed=1 + 1 / GENERAL.k
    )


def _moment(k: Any, v: Any) -> Any:
    """The vectors r x v about the normals of xOy, yOz and xOz."""
    return np.cross(k.position, v, axis=0)[[2, 0, 1]]


def moments_from_arms() -> Finding:
    """Arm times projection of V against r x V."""
    k = MOVING
    moment = _moment(k, k.velocity)
    agreed = worst(k.arms * k.plane_speeds, np.abs(moment))
    negative = float((moment < 0.0).mean())
    return Finding(agreed < ROUNDING, negative == 0.0, agreed=shown(agreed), negative=100 * negative)


def arms_of_acceleration() -> Finding:
    """The arms given, those of V, with a; and those of a by the same formulas."""
    k = MOVING
    moment, planes = np.abs(_moment(k, k.acceleration)), projections(k.acceleration)
    off = worst(k.arms * planes, moment)
    agreed = worst(lengths(feet(k.position, k.acceleration)) * planes, moment)
    return Finding(off < ROUNDING, off=100 * off, agreed=shown(agreed))


def angular_accelerations() -> Finding:
    """Which of the four the page has, and how large the fourth is in the stop mode, 1e3 rad/s^2."""
    names = ("velocity", "angular_velocities", "acceleration", "angular_accelerations")
    about_drive = 1e-3 * np.abs(rate(rate(angles_in_time(STOPPED)[0])).value).max()
    body = 1e-3 * STOPPED.omega16 * STOPPED.omega6 * math.sin(GENERAL.shaft_angle)
    return Finding(*(name in PRINTED for name in names), about_drive=about_drive, body=body)


def carrier() -> Finding:
    """Which link carries wheel 17 and the drive: |V| of (23) with it on link 1 and on link 2."""
    k, page = MOVING, modulus(PRINTED["sum_of_three"](MOVING))
    on_link2 = exact(GENERAL, Motion(DYNAMIC.omega1, DYNAMIC.omega2, DYNAMIC.omega2), MOVING.t)
    change = np.abs(on_link2.speed - k.speed).max() / k.speed.max()
    return Finding(
        worst(page, k.speed) < ROUNDING, worst(page, on_link2.speed) < ROUNDING, change=100 * change
    )


def freewheel() -> Finding:
    """Link 2 against the housing and against link 1."""
    relative = DYNAMIC.omega2 - DYNAMIC.omega1
    return Finding(DYNAMIC.omega2 >= 0.0, relative >= 0.0, relative=relative)


def dynamic_range() -> Finding:
    """The sense of the drive over i."""
    drives = {i: transmission_ratios(GENERAL, dynamic_mode(100.0, i))[1] for i in (0.5, 1.0, 2.0, math.inf)}
    return Finding(*(drive >= 0.0 for drive in drives.values()), backwards=drives[0.5])


def differentiable_angles() -> Finding:
    """Jumps of beta_H, folds of beta_P and beta_F, and the rates of the right angles."""
    k, beta = STOPPED, PRINTED["angles"](STOPPED)
    jumps = int(np.count_nonzero(np.abs(np.diff(beta[0])) > 3.0))
    return Finding(
        jumps == 0,
        worst(*EQUATIONS["(6)"].forms()) < ROUNDING,  # type: ignore[misc, operator]
        jumps=jumps,
        turns=GENERAL.turns_in_period,
        fold=worst(beta, k.angles),
        below=100 * float(np.mean(k.position[2] < 0.0)),
    )


def axes_of_the_angles() -> Finding:
    """omega_H, omega_P, omega_F where D only turns about Oz: with a = 0 in the stop mode."""
    case = over_period(replace(GENERAL, a=0.0), STOP)
    about, turns = case.angular_velocities, (0.0, 0.0, case.omega16)
    says = [np.abs(omega - turn).max() < 1e-9 for omega, turn in zip(about, turns, strict=True)]
    steady = shown(float(np.ptp(about[0]) / case.omega16))
    return Finding(
        *says, drive=case.omega16, mean=about[0].mean(), steady=steady, varies=np.ptp(about[1:], axis=1)
    )


def height_of_A() -> Finding:  # noqa: N802
    """How z_A changes in the stop and in the dynamic mode."""
    A = MOVING.centre_of_satellite
    rest, moving = np.ptp(A[2]), np.ptp(turned(MOVING, A)[2])
    return Finding(rest < ROUNDING, moving=moving)


def absolute_in_stop_mode() -> Finding:
    """|V| with OQ at rest, and with OQ on link 1 while link 2 is held, against (18)."""
    page = STOPPED.speed_in_link1
    turning = exact(GENERAL, dynamic_mode(100.0, math.inf), STOPPED.t).speed
    off = np.abs(turning - page).max() / turning.max()
    return Finding(worst(page, STOPPED.speed) < ROUNDING, off < ROUNDING, off=100 * off)


def only_modulus() -> Finding:
    """The angle between the velocities of both modes, apart from the turn by alpha."""
    k = MOVING
    before = turned(k, k.velocity_in_link1)
    cosine = (before * k.velocity).sum(axis=0) / (k.speed_in_link1 * k.speed)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return Finding(angle.max() < 1e-3, mean=angle.mean(), most=angle.max())


def angle_of_turn() -> Finding:
    """The swing in the turn of D and in that of V; alpha of (19) with the exact and the printed omega_P."""
    k, t = MOVING, MOVING.t
    total = np.arctan2(*k.position_in_link1[1:]) - DYNAMIC.omega1 * t
    OP = k.projections[1]
    of_place = worst((OP * np.sin(total), OP * np.cos(total)), k.position[1:])
    page = PRINTED["alpha"](MOVING), printed(GENERAL, DYNAMIC, t, "alpha")
    off = [np.abs(alpha - DYNAMIC.omega1 * t).max() for alpha in page]
    return Finding(of_place < ROUNDING, off[0] < ROUNDING, off=off, span=t[-1], of_place=shown(of_place))


def abscissa() -> Finding:
    """Where D is along Ox before and after the turn about Ox."""
    return Finding(np.abs(MOVING.position[0] - MOVING.position_in_link1[0]).max() < ROUNDING)


def period_of_a_turn() -> Finding:
    """Change of |V| after a turn of the drive, with s whole and with s = 1.7."""

    def change(geometry: Geometry) -> float:
        t = over_period(geometry, STOP).t
        first, following = (
            exact(geometry, STOP, t + shift).speed for shift in (0.0, 2.0 * math.pi / STOP.omega1)
        )
        return float(np.abs(first - following).max() / first.max())

    whole, broken = change(PAPER), change(STANDARD)
    return Finding(
        whole < ROUNDING,
        broken < ROUNDING,
        whole=shown(whole),
        broken=100 * broken,
        turns=STANDARD.turns_in_period,
    )


def continuous_functions() -> Finding:
    """The largest step of exact quantities between neighbouring times, and the poles of the printed ones."""
    k = MOVING
    x, vx, vy = k.position[0], k.velocity[0], k.velocity[1]
    poles = [int(np.count_nonzero(np.diff(np.sign(u)))) for u in (x, vy, vx)]
    steps = [np.abs(np.diff(v)).max() / np.abs(v).max() for v in (k.position, k.velocity, k.acceleration)]
    return Finding(max(steps) < 0.05, sum(poles) == 0, poles=poles)


def asymmetry_from_offsets() -> Finding:
    """Asymmetry of |V| in both modes by either offset and by both, % of its range."""

    def of_speed(epsilon: float, gamma: float) -> list[float]:
        geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
        return [100 * conclusions.asymmetry("speed", geometry, motion) for motion in (STOP, DYNAMIC)]

    epsilon, gamma = of_speed(OFFSET, 0.0), of_speed(0.0, OFFSET)
    components = conclusions.asymmetry_of_components(replace(PAPER, gamma=OFFSET), STOP)
    return Finding(
        *(value > 1.0 for value in (*epsilon, *gamma)),
        epsilon=epsilon,
        gamma=gamma,
        both=of_speed(OFFSET, OFFSET / PAPER.s),
        components=100 * components,
    )


def swing_about_axes() -> Finding:
    """Whole turns of D about each axis in a period, in both modes, in the standard and the general case."""
    cases = [(g, motion) for motion in (STOP, DYNAMIC) for g in (PAPER, GENERAL)]
    found = [conclusions.swings(g, motion) for g, motion in cases]
    turns = [", ".join(f"{axis} {swing[axis].turns:+d}" for axis in ("Ox", "Oy", "Oz")) for swing in found]
    return Finding(
        *(swing[axis].turns == 0 for swing in found for axis in ("Ox", "Oy")),
        turns=turns,
        amplitude=math.degrees(found[0]["Ox"].amplitude),
    )


def planes_of_the_swing() -> Finding:
    """Peaks of |r x V| and |r x a| about Ox, Oy, Oz in both modes: are those in yOz and xOy the largest?"""
    peaks = []
    for k in (STOPPED, MOVING):
        for v in (k.velocity, k.acceleration):
            about = np.abs(np.cross(k.position, v, axis=0)).max(axis=1)
            peaks.append(about / about.max())
    each = [" : ".join(f"{share:.2f}" for share in about) for about in peaks]
    return Finding(*(about[1] == about.min() for about in peaks), each=each)
