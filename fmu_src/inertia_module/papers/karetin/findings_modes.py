"""What was found of Karetin's claims on links, modes, periods and angles: sentences with figures."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from . import as_printed, exact
from .cases import DYNAMIC, GENERAL, STANDARD, STOP, over_period
from .complete import kinematics
from .differences import shown, worst
from .geometry import Geometry
from .motion import Motion, dynamic_mode, transmission_ratios
from .printed_chain import printed


def layout() -> str:
    """On the standard layout covering a broad range of modifications."""
    longest = Geometry(shaft_angle=1e-6).L
    across = float(np.ptp(over_period(STANDARD, STOP).k.position[:, 0]))
    return (
        "a, b, c, epsilon, gamma, teeth and Sigma vary freely, but OQ always meets Ox at a right angle: D "
        f"moves {across:.3g} m along Ox (scene R1), which no planar mechanism does, and as Sigma goes to "
        f"0 the cones grow without bound (L = {longest:.3g} m at 1e-6 rad)."
    )


def carrier() -> str:
    """On which link carries wheel 17 and the drive."""
    on_link1 = kinematics(GENERAL, DYNAMIC, over_period(GENERAL, DYNAMIC).t).speed
    on_link2 = kinematics(
        GENERAL,
        Motion(DYNAMIC.omega1, DYNAMIC.omega2, DYNAMIC.omega2),
        over_period(GENERAL, DYNAMIC).t,
    ).speed
    change = float(np.abs(on_link2 - on_link1).max() / on_link1.max())
    return (
        "It cannot be read in one way: link 1 is the input. Wheel 17 and the hinge of the drive must be on "
        "one link, or s = z17/z6 fails. That link is at rest in the stop mode (Q on Oz), as if it were the "
        "output, and turns with omega1 in the dynamic mode (19), as if it were the input. The module takes "
        f"link 1. On link 2 |V| would differ by up to {100 * change:.0f} % of its peak at i = 2."
    )


def absolute_in_stop_mode() -> str:
    """On (2) and (17) being absolute in the stop mode."""
    t = over_period(GENERAL, STOP).t
    relative, absolute = (kinematics(GENERAL, motion, t) for motion in (STOP, dynamic_mode(100.0, math.inf)))
    share = float(np.abs(absolute.speed - relative.speed).max() / absolute.speed.max())
    return (
        "Only if the link that carries OQ is at rest. Where that is link 1, as (19) has it, it turns with "
        "omega1 while link 2 is held, and (2), (17), (18) are motion against link 1: the absolute |V| "
        f"differs by up to {100 * share:.0f} % of its peak."
    )


def freewheel() -> str:
    """On the freewheel that blocks link 2 turning back with respect to link 1."""
    relative = DYNAMIC.omega2 - DYNAMIC.omega1
    return (
        "Taken as 'against the sense of link 1' it holds: a freewheel to the housing. With respect to link "
        f"1 link 2 does turn back, by omega2 - omega1 = {relative:.0f} rad/s at i = 2; blocked, the drive "
        "would stand still, omega16 = k (omega1 - omega2) = 0."
    )


def stop_condition() -> str:
    """On omega16 = omega2 and omega16 = omega2 = omega1."""
    k = GENERAL.k
    held = transmission_ratios(GENERAL, STOP)
    locked = transmission_ratios(GENERAL, dynamic_mode(100.0, 1.0))
    return (
        f"By (1) the stop mode (i = infinity) has omega2 = {held[0]:.0f} and omega16 = k omega1 = "
        f"{held[1]:.0f} rad/s; omega2 = omega1 = 100 gives omega16 = {locked[1]:.0f}, no pulses. omega16 = "
        f"omega2 needs i = 1 + 1/k = {1 + 1 / k:.0f}, and never equals omega1 too."
    )


def dynamic_range() -> str:
    """On omega16 >= 0 for 0 < i < infinity."""
    _, backwards, _ = transmission_ratios(GENERAL, dynamic_mode(100.0, 0.5))
    return (
        "Only for i >= 1 (and i < 0). Between 0 and 1 link 2 is ahead of link 1 and the drive turns back: "
        f"omega16 = {backwards:.0f} rad/s at i = 0.5, omega1 = 100."
    )


def period_of_a_turn() -> str:
    """On one turn of the satellite about the axis of the drive being one period."""

    def change(geometry: Geometry) -> float:
        turn = 2.0 * math.pi / 100.0
        t = over_period(geometry, STOP).t
        first, next_turn = (kinematics(geometry, STOP, t + shift).speed for shift in (0.0, turn))
        return float(np.abs(first - next_turn).max() / first.max())

    whole = change(replace(STANDARD, z17=40))
    return (
        f"Only where s = z17/z6 is whole (at s = 2 |V| changes by {shown(whole)} after a turn). At "
        f"s = 1.7 it changes by up to {100 * change(STANDARD):.0f} % of its peak: the period is "
        f"z6/gcd(z17, z6) = {STANDARD.turns_in_period} turns, in the fixed frame more, or none if "
        "omega1/omega16 is irrational."
    )


def height_of_A() -> str:  # noqa: N802
    """On the applicate of A being constant in the stop mode."""
    at = over_period(GENERAL, DYNAMIC).at
    A = exact.centre_of_satellite(at)
    rest, moving = float(np.ptp(A[:, 2])), float(np.ptp(exact.turned(at, A)[:, 2]))
    return f"z_A changes by {rest:.0f} m in the stop mode (and by {moving:.3g} m in the dynamic mode)."


def axes_of_the_angles() -> str:
    """On beta_H, beta_P, beta_F belonging to Ox, Oy, Oz in this order."""
    case = over_period(replace(GENERAL, a=0.0), STOP)
    about = case.k.angular_velocities
    steady = float(np.ptp(about[:, 0]) / case.at.omega16)
    return (
        "They turn about Oz, Ox and Oy. With a = 0 D only turns about Oz, with omega16 = "
        f"{case.at.omega16:.0f} rad/s: omega_H is {about[:, 0].mean():.0f} rad/s (it varies by "
        f"{shown(steady)}), omega_P and omega_F vary by {np.ptp(about[:, 1]):.0f} and "
        f"{np.ptp(about[:, 2]):.0f} rad/s. The later 'swing omega_P about Ox' has it right."
    )


def differentiable_angles() -> str:
    """On the angles being continuous, so that their rates follow by differentiation."""
    case = over_period(GENERAL, STOP)
    page = printed(GENERAL, STOP, case.t)
    jumps = int(np.count_nonzero(np.abs(np.diff(page.angles[:, 0])) > 3.0))
    below = float(np.mean(case.k.position[:, 2] < 0.0))
    worst_rate = worst(
        as_printed.angles(case.at.x, case.at.y, case.k.projections[:, 1], case.k.projections[:, 2]),
        case.k.angles.T,
    )
    return (
        f"beta_H by arctan jumps by pi {jumps} times in {GENERAL.turns_in_period} turns; beta_P and beta_F "
        f"are folded (error up to {worst_rate:.2f} of the largest angle) and omega_P, omega_F have the "
        f"wrong sign while z < 0, {100 * below:.0f} % of the time on the case of the table. The exact "
        "angles are continuous except where D passes through an axis."
    )
