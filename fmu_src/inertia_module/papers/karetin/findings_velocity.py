"""What was found of Karetin's claims on velocities, accelerations and in his conclusions: sentences."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import asymmetry, exact
from .cases import DYNAMIC, GENERAL, PAPER, STOP, over_period, period
from .differences import shown, worst
from .differences_dynamic import position_series
from .printed_chain import printed
from .swing import swings

Array = NDArray[np.float64]

OFFSET = 0.5


def superposition() -> str:
    """On the motion of D being a sum of three rotations."""
    case = over_period(GENERAL, DYNAMIC)
    total = exact.turned(case.at, case.k.about_satellite + case.k.about_drive + case.k.about_centre)
    rates = [u.rate().value for u in position_series(case)]
    return f"The sum of the three is the rate of the position to {shown(worst(rates, total.T))}."


def base_plane() -> str:
    """On V_QA lying in the base plane of the cone of 'satellite z17'."""
    case = over_period(GENERAL, STOP)
    v = case.k.about_satellite
    axis = exact.spin_of_satellite(case.at) / case.at.omega6
    along = float(np.abs((v * axis).sum(axis=1)).max() / case.k.speed_about_satellite.max())
    through = float(np.abs(v[:, 2]).max() / case.k.speed_about_satellite.max())
    off = abs(1.0 - 1.0 / GENERAL.b) * GENERAL.QA
    return (
        "z17 is the wheel, the satellite is z6. V_QA is across the axis of the satellite "
        f"(along it: {shown(along)}), so parallel to its base; in it only for b = 1 (at b = {GENERAL.b} D is "
        f"{1e3 * off:.1f} mm off). Out of the base plane of wheel 17 it points by up to "
        f"{100 * through:.0f} % of its modulus."
    )


def drive_velocity_in_plane() -> str:
    """On V_Oz being parallel to xOy."""
    case = over_period(GENERAL, DYNAMIC)
    rest = float(np.abs(case.k.about_drive[:, 2]).max())
    turned = exact.turned(case.at, case.k.about_drive)
    share = float(np.abs(turned[:, 2]).max() / case.k.speed_about_drive.max())
    return (
        f"In the stop mode its z component is {rest:.0f}. In the dynamic mode, to which the abstract "
        f"applies it as well, it turns with link 1 and reaches {100 * share:.0f} % of the modulus along Oz."
    )


def central_velocity_in_plane() -> str:
    """On V_Ox being parallel to yOz."""
    case = over_period(GENERAL, DYNAMIC)
    along = np.abs(exact.turned(case.at, case.k.about_centre)[:, 0]).max()
    return f"Its x component is {along:.0f} in both modes."


def only_modulus() -> str:
    """On the velocities of both modes differing only in modulus."""
    case = over_period(GENERAL, DYNAMIC)
    before = exact.turned(case.at, case.k.velocity_in_link1)
    cosine = (before * case.k.velocity).sum(axis=1) / (case.k.speed_in_link1 * case.k.speed)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return (
        "V_Ox is a vector of its own direction. Even apart from the turn by alpha, the directions differ by "
        f"{angle.mean():.0f} degrees on average and up to {angle.max():.0f} degrees (i = 2)."
    )


def abscissa() -> str:
    """On the turn about Ox leaving the abscissa as it is."""
    case = over_period(GENERAL, DYNAMIC)
    change = np.abs(case.k.position[:, 0] - case.at.x).max()
    return f"x of D differs by {change:.0f} m before and after the turn."


def angle_of_turn() -> str:
    """On having to add the swing omega_P to omega1."""
    case = over_period(GENERAL, DYNAMIC)
    at, k = case.at, case.k
    OP, beta = k.projections[:, 1], np.arctan2(at.y, at.z)
    page = printed(GENERAL, DYNAMIC, case.t)
    error = np.abs(page.alpha - DYNAMIC.omega1 * case.t).max()
    total = beta - DYNAMIC.omega1 * case.t
    agreed = worst([OP * np.sin(total), OP * np.cos(total)], [k.position[:, 1], k.position[:, 2]])
    return (
        f"alpha of (19) is off by up to {error:.0f} rad within the first {case.t[-1]:.2f} s, and more with "
        "time: omega_P t is no angle. V turns by omega1 t alone. For y and z of D the swing itself counts: "
        f"OP sin(beta_P - omega1 t), OP cos(beta_P - omega1 t) are exact (to {shown(agreed)}), which must be "
        "what was meant."
    )


def moments_from_arms() -> str:
    """On projections and arms letting the dynamic quantities be predicted."""
    k = over_period(GENERAL, DYNAMIC).k
    moment = np.cross(k.position, k.velocity)[:, [2, 0, 1]]
    agreed = worst((k.arms * k.plane_speeds).T, np.abs(moment).T)
    negative = float((moment < 0.0).mean())
    force = np.abs(np.cross(k.position, k.acceleration)[:, [2, 0, 1]])
    wrong = worst((k.arms * _planes(k.acceleration)).T, force.T)
    return (
        f"Arm times projection is |r x V| about each axis (to {shown(agreed)}), but without its sense, which "
        f"is negative {100 * negative:.0f} % of the time (mean of the three). The arms given are those of V: "
        f"with them the moment of the inertia force is wrong by up to {100 * wrong:.0f} %."
    )


def _planes(v: Array) -> Array:
    squares = v * v
    result: Array = np.sqrt(squares[:, [0, 1, 0]] + squares[:, [1, 2, 2]])
    return result


def continuous_functions() -> str:
    """Conclusion 1."""
    case = over_period(GENERAL, DYNAMIC)
    x, _, _ = (u.value for u in position_series(case))
    vx, vy, _ = case.k.velocity.T
    poles = [int(np.count_nonzero(np.diff(np.sign(u)))) for u in (x, vy, vx)]
    return (
        "The exact r, V, a and their projections are analytic in t. The printed functions are not: in one "
        f"period v of (21) passes through infinity {poles[0]} times (x = 0), k1 and k2 {poles[1]} times "
        f"(V_y = 0), k3 {poles[2]} times (V_x = 0), and beta_H jumps."
    )


def asymmetry_from_offsets() -> str:
    """Conclusion 2."""
    s = PAPER.s

    def figures(epsilon: float, gamma: float) -> str:
        geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
        stop, dynamic = (asymmetry.of_speed(geometry, motion) for motion in (STOP, DYNAMIC))
        return f"{100 * stop:.1f} % / {100 * dynamic:.1f} %"

    components = asymmetry.of_components(replace(PAPER, gamma=OFFSET), STOP)
    return (
        "Asymmetry of |V| (stop / dynamic mode, of its range, s = 2, i = 2): "
        f"epsilon = {OFFSET}: {figures(OFFSET, 0.0)}; gamma = {OFFSET}: {figures(0.0, OFFSET)}; epsilon = "
        f"{OFFSET}, gamma = epsilon/s: {figures(OFFSET, OFFSET / s)}. So gamma alone does cause it in the "
        "dynamic mode, as does epsilon. In the stop mode neither does, in |V| or |a|: gamma turns the "
        "trajectory about Oz, epsilon shifts time. There gamma makes components asymmetric (up to "
        f"{100 * components:.0f} %). Only gamma - epsilon/s counts: gamma = epsilon/s causes none at all."
    )


def swing_about_axes() -> str:
    """Conclusion 3, the swing."""
    parts = []
    for name, motion in (("stop", STOP), ("dynamic", DYNAMIC)):
        for label, geometry in (("standard", PAPER), ("general", GENERAL)):
            found = swings(geometry, motion, period(geometry, motion))
            turns = ", ".join(f"{axis} {found[axis].turns:+d}" for axis in ("Ox", "Oy", "Oz"))
            parts.append(f"{name} mode, {label} case: {turns}")
    amplitude = math.degrees(swings(PAPER, STOP, period(PAPER, STOP))["Ox"].amplitude)
    return (
        "Whole turns of D in a period ("
        + "; ".join(parts)
        + f"). In the stop mode it does swing about Ox and Oy (by +-{amplitude:.0f} degrees about Ox in "
        "the standard case) while turning about Oz; in the dynamic mode it turns about Ox with omega1, the "
        "swing on top, and whether it swings or turns about Oy depends on the geometry."
    )


def planes_of_the_swing() -> str:
    """Conclusion 3, the planes."""
    about = over_period(GENERAL, STOP).k
    moment = np.cross(about.position, about.velocity)
    shares = np.abs(moment).max(axis=0) / np.abs(moment).max()
    return (
        "A swing about Ox shows in yOz, one about Oy in xOz, not in xOy, which shows the turn about Oz; "
        f"peak moments of V about Ox, Oy, Oz are as {shares[0]:.2f} : {shares[1]:.2f} : {shares[2]:.2f}."
    )
