"""What exact mechanics says about the geometry, forces and moments; figures of the example mechanism."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import as_printed, exact, motion
from .equations import cycle, relative
from .mechanism import EXAMPLE, EXAMPLE_SPEED, with_modulus

Array = NDArray[np.float64]

# moduli of wheels that can be built
MODULI = (0.1, 0.2, 1.0 / 3.0, 0.5, 1.0)


# --- geometry ---


def cusp() -> str:
    """Speed at the cusp."""
    speed = exact.speed(EXAMPLE, cycle(), EXAMPLE_SPEED)
    return (
        f"with l = r the imbalance stops at each cusp: {speed[0] / speed.max():.0e} of its highest speed; any"
        " other l gives a shortened or lengthened epicycloid by the same (1)"
    )


def modulus() -> str:
    """Speeds by (1), differentiated, and by rolling."""
    step = 1e-6
    angle = cycle()
    ahead, behind = (exact.epicycloid(EXAMPLE, angle + sign * step) for sign in (1.0, -1.0))
    velocity = np.hypot(*(EXAMPLE_SPEED * (a - z) / (2.0 * step) for a, z in zip(ahead, behind, strict=True)))
    found = relative(velocity, exact.speed(EXAMPLE, angle, EXAMPLE_SPEED))
    return (
        "the carrier turns b times as fast as wheel 1 turns on it; wheel 1 turns 1 + b times as fast in the"
        f" frame: speeds by (1) and by rolling agree to {found:.0e}"
    )


def cycles() -> str:
    """Cycles a turn of the carrier."""
    x, y = exact.epicycloid(EXAMPLE, np.array([0.3, 0.3 + 2.0 * np.pi / EXAMPLE.b]))
    return (
        f"1/b cycles a turn of the carrier, {1.0 / EXAMPLE.b:.0f} here, closed to"
        f" {np.hypot(x[1] - x[0], y[1] - y[0]) / EXAMPLE.R0:.0e} of R0; with an irrational b it never closes"
    )


def note() -> str:
    """What (8) makes of phi = b alpha."""
    angle = cycle()
    printed = as_printed.rho(EXAMPLE, as_printed.phi_of_note(EXAMPLE, angle))
    sine = np.abs(EXAMPLE.centre_distance * np.sin(angle) / printed).max()
    return (
        f"with φ = bα the sine in (8) reaches {sine:.2f}, which no angle has, and ρ is off by"
        f" {100 * relative(printed, exact.rho(EXAMPLE, angle)):.0f} %; φ = α throughout"
    )


# --- forces and moments ---


def inertia_force_defect(coriolis: Array, turned: Array) -> float:
    """Worst difference of F1 + F2 + Fk from -m a, over the largest m a.

    Args:
        coriolis: magnitude of Fk over cycle(), N. turned: its direction, rad from e, shapes (n,).
    """
    angle, omega, b = cycle(), EXAMPLE_SPEED, EXAMPLE.b
    along, across = exact.position(EXAMPLE, angle)
    outward = -np.exp(1j * angle)
    forces = exact.relative_force(EXAMPLE, omega) * outward + coriolis * outward * np.exp(1j * turned)
    forces = forces + EXAMPLE.m * (b * omega) ** 2 * (along + 1j * across)
    # (1) differentiated twice, seen from the carrier
    acceleration = omega**2 * (
        EXAMPLE.arm * (1.0 + b) ** 2 * np.exp(1j * angle) - EXAMPLE.centre_distance * b**2
    )
    defect = np.abs(forces + EXAMPLE.m * acceleration).max()
    return float(defect / np.abs(EXAMPLE.m * acceleration).max())


def forces() -> str:
    """Sum of the inertia forces against -m a."""
    angle = cycle()
    right = np.full_like(angle, exact.coriolis_force(EXAMPLE, EXAMPLE_SPEED))
    printed = as_printed.coriolis_force(EXAMPLE, angle, EXAMPLE_SPEED)
    turned = as_printed.beta1(EXAMPLE, angle) - as_printed.delta(EXAMPLE, angle)
    return (
        "F1 and F2 are right; with Fk as printed the sum differs from −ma by up to"
        f" {100 * inertia_force_defect(printed, turned):.0f} % of the largest ma, with the relative speed"
        f" by {inertia_force_defect(right, 0.0 * angle):.0e}"
    )


def speed() -> str:
    """Where the printed V is right."""
    angle = cycle()
    printed, right = (form.speed(EXAMPLE, angle, EXAMPLE_SPEED) for form in (as_printed, exact))
    wrong = np.abs(printed - right) > 1e-9 * right.max()
    return (
        f"right while β1 is below a right angle; with arcsin wrong over {100 * wrong[:-1].mean():.0f} % of"
        f" the cycle, by up to {100 * relative(printed, right):.0f} % of the highest speed; at the cusp it"
        f" gives {printed[0] / right.max():.2f} of it where the imbalance stands still"
    )


def moments() -> str:
    """Errors of (15) and (16) over the modulus."""
    angle = cycle()
    first = as_printed.wheel_moment(EXAMPLE, angle, 1.0)
    triple = relative(first, 3.0 * exact.wheel_moment(EXAMPLE, angle, 1.0))
    parts = []
    for b in MODULI:
        mechanism = with_modulus(b)
        forms = (form.carrier_moment(mechanism, angle, 1.0) for form in (as_printed, exact))
        parts.append(f"{100 * relative(*forms):.0f} % (b = {b:.2g})")
    return (
        f"M1 as printed is three times the exact one at every angle (to {triple:.0e}), M off by up to "
        + ", ".join(parts)
        + " of its largest value, and 1 + 3b²/(1 + 2b) times the exact one where β1 is below a right angle:"
        " 2mbωV contains 2 F2; the dependence on m and ω² is right"
    )


def equations_of_motion() -> str:
    """Torque of the drive from M1 and M against Lagrange."""
    angle, b = cycle(), EXAMPLE.b
    drive = motion.drive_torque(EXAMPLE, angle, EXAMPLE_SPEED)
    printed, right = (
        -form.carrier_moment(EXAMPLE, angle, EXAMPLE_SPEED)
        - form.wheel_moment(EXAMPLE, angle, EXAMPLE_SPEED) / b
        for form in (as_printed, exact)
    )
    return (
        f"the torque of Lagrange's equation is −(M + M1/b): exact to {relative(right, drive):.0e}, as printed"
        f" off by up to {100 * relative(printed, drive):.0f} %"
    )


def zones() -> str:
    """Where the inertia forces resist and unload."""
    power = motion.drive_power(EXAMPLE, cycle(), EXAMPLE_SPEED)
    half = power.size // 2
    printed = -as_printed.wheel_power(EXAMPLE, cycle(), EXAMPLE_SPEED)
    printed = printed - as_printed.carrier_power(EXAMPLE, cycle(), EXAMPLE_SPEED)
    resisted = np.mean(power[1:half] > 0.0), np.mean(power[half + 1 : -1] < 0.0)
    return (
        f"they resist over {100 * resisted[0]:.0f} % of the half cycle in which the imbalance moves out and"
        f" unload over {100 * resisted[1]:.0f} % of that in which it moves in, peak {power.max():.0f} W; the"
        f" printed powers have the same signs over {100 * np.mean(printed * power >= 0.0):.0f} % of the cycle"
    )
