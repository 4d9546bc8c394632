"""Every equation of the paper with the verdict on it. Differences over a cycle of the example mechanism."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..report import Equation
from . import as_printed, exact, motion
from .mechanism import EXAMPLE, EXAMPLE_SPEED, Mechanism

Array = NDArray[np.float64]
Function = Callable[..., ArrayLike]

# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
POINTS = 3601


def cycle(points: int = POINTS) -> Array:
    """Angles alpha over a cycle of the epicycloid, rad, shape (points,)."""
    return np.linspace(0.0, 2.0 * np.pi, points)


def relative(printed: ArrayLike, right: ArrayLike) -> float:
    """Worst difference over the largest right value."""
    one, two = np.asarray(printed, dtype=np.float64), np.asarray(right, dtype=np.float64)
    return float(np.abs(one - two).max() / np.abs(two).max())


def _of(printed: Function, right: Function, *speed: float) -> Callable[[], float]:
    """The difference of two functions of mechanism, angle and, with one, speed."""
    return lambda: relative(printed(EXAMPLE, cycle(), *speed), right(EXAMPLE, cycle(), *speed))


def epicycloid_difference() -> float:
    """Equation (1) against the chain carrier, wheel."""
    x, y = as_printed.epicycloid(EXAMPLE, cycle())
    along, across = exact.position(EXAMPLE, cycle())
    turned = (along + 1j * across) * np.exp(1j * EXAMPLE.b * cycle())
    return float(np.abs(x + 1j * y - turned).max() / np.abs(turned).max())


def note_difference() -> float:
    """Distance rho with phi = b alpha as the note has it, against rho."""
    printed = as_printed.rho(EXAMPLE, as_printed.phi_of_note(EXAMPLE, cycle()))
    return relative(printed, exact.rho(EXAMPLE, cycle()))


def coriolis_difference() -> float:
    """Coriolis force from the absolute speed, against the one from the relative speed."""
    printed = as_printed.coriolis_force(EXAMPLE, cycle(), EXAMPLE_SPEED)
    return relative(printed, exact.coriolis_force(EXAMPLE, EXAMPLE_SPEED))


def resultant_difference() -> float:
    """Equation (6) with the right angle."""
    angle = cycle()
    one = EXAMPLE.arm * EXAMPLE_SPEED
    two = exact.rho(EXAMPLE, angle) * EXAMPLE.b * EXAMPLE_SPEED
    printed = as_printed.resultant_speed(one, two, np.pi - exact.beta1(EXAMPLE, angle))
    return relative(printed, exact.speed(EXAMPLE, angle, EXAMPLE_SPEED))


def coriolis_arm_difference() -> float:
    """Arm of the Coriolis force about O1, which is zero: over l."""
    return float(np.abs(as_printed.k1(EXAMPLE, cycle())).max() / EXAMPLE.arm)


def inertia_difference() -> float:
    """Moment of inertia about O from the place of the imbalance."""
    along, across = exact.position(EXAMPLE, cycle())
    right = EXAMPLE.constant_inertia + EXAMPLE.m * (along**2 + across**2)
    return relative(as_printed.moment_of_inertia(EXAMPLE, cycle()), right)


def limits_difference() -> float:
    """Its limits from its course over a cycle."""
    course = as_printed.moment_of_inertia(EXAMPLE, cycle())
    return relative(as_printed.inertia_limits(EXAMPLE), (course.max(), course.min()))


def speed_ratio_difference(mechanism: Mechanism = EXAMPLE) -> float:
    """Ratio of the speeds by (21) against the free mechanism."""
    return relative(as_printed.omega_max(mechanism, 1.0), motion.speed_ratio(mechanism))


def energy_differences() -> tuple[float, float, float]:
    """Equations (22), (23) and (24) against the free mechanism with the same lowest speed."""
    largest, smallest = motion.reduced_inertia_limits(EXAMPLE)
    energy = 0.5 * largest
    first = as_printed.energy_farthest(EXAMPLE, 1.0)
    second = as_printed.energy_nearest(EXAMPLE, motion.speed_ratio(EXAMPLE))
    third = as_printed.energy_nearest_of_farthest(EXAMPLE, energy)
    return (
        relative(first, energy),
        relative(second, 0.5 * smallest * motion.speed_ratio(EXAMPLE) ** 2),
        relative(third, energy),
    )


def _row(
    number: str,
    subject: str,
    name: str,
    difference: Callable[[], float] | None,
    correction: str = "",
    printed: str = "",
    right: bool | None = None,
) -> Equation:
    """A row; where not told, right if nothing is to be corrected."""
    verdict = not correction if right is None else right
    return Equation(
        number,
        subject,
        name,
        f"as_printed.{printed or name.rpartition('.')[2]}",
        verdict,
        correction,
        difference,
    )


_ATAN2 = "β1 by atan2(D sin α, l − D cos α), D = R0(1 + b): beyond a right angle arcsin is wrong"
_J_RED = "J_red = J_carrier + J_wheel((1 + b)/b)² + mD²(1 + (l/r)² − 2(l/r) cos α)"
_SPEED = EXAMPLE_SPEED

EQUATIONS = (
    _row("(1)", "epicycloid of the imbalance", "exact.epicycloid", epicycloid_difference),
    _row("(2)", "distance ρ from O, φ = α", "exact.rho", _of(as_printed.rho, exact.rho)),
    _row(
        "(2), note",
        "φ = bα",
        "exact.rho",
        note_difference,
        "φ = α, the angle of wheel 1 on the carrier; bα is that of the carrier",
        "phi_of_note",
    ),
    _row("(3)", "force of inertia from the turning about O1", "exact.relative_force", None),
    _row(
        "(4)",
        "force of inertia from the turning about O",
        "exact.carrier_force",
        _of(as_printed.carrier_force, exact.carrier_force, _SPEED),
    ),
    _row(
        "(5)",
        "Coriolis force",
        "exact.coriolis_force",
        coriolis_difference,
        "2m(lω)(bω), with the speed relative to the carrier; directed from O1 to the imbalance",
    ),
    _row("(6)", "resultant of two speeds", "exact.speed", resultant_difference, "", "resultant_speed"),
    _row(
        "(7)", "speed V of the imbalance", "exact.speed", _of(as_printed.speed, exact.speed, _SPEED), _ATAN2
    ),
    _row("(8)", "angle β1", "exact.beta1", _of(as_printed.beta1, exact.beta1), _ATAN2),
    _row(
        "(9)",
        "moment M1 about O1 from forces and arms",
        "exact.wheel_moment",
        _of(as_printed.wheel_moment_of_forces, exact.wheel_moment, _SPEED),
        "M1 = F2 n2: the Coriolis force passes through O1",
        "wheel_moment_of_forces",
    ),
    _row(
        "(10)",
        "moment M about O from forces and arms",
        "exact.carrier_moment",
        _of(as_printed.carrier_moment_of_forces, exact.carrier_moment, _SPEED),
        "M = −(F1 + Fk) n1: F2 passes through O (−F2 n2 is its moment once moved to O1)",
        "carrier_moment_of_forces",
    ),
    _row("(11)", "arm of F1 about O", "exact.n1", _of(as_printed.n1, exact.n1)),
    _row("(12)", "arm of F2 about O1", "exact.n2", _of(as_printed.n2, exact.n2)),
    _row(
        "(13)",
        "arm of the Coriolis force about O1, and δ",
        "exact.wheel_moment",
        coriolis_arm_difference,
        "0 (difference given over l); δ, too, needs atan2",
        "k1",
    ),
    _row(
        "(14)",
        "arm of the Coriolis force about O",
        "exact.n1",
        _of(as_printed.k2, exact.n1),
        "D sin α; for the printed direction − l sin(β1 − δ) is missing",
        "k2",
    ),
    _row(
        "(15)",
        "moment M1 about O1",
        "exact.wheel_moment",
        _of(as_printed.wheel_moment, exact.wheel_moment, _SPEED),
        "M1 = m b² ω² l R0(1 + b) sin α: the printed form is three times that at every angle",
    ),
    _row(
        "(16)",
        "moment M about O",
        "exact.carrier_moment",
        _of(as_printed.carrier_moment, exact.carrier_moment, _SPEED),
        "M = −m R0(1 + b)(1 + 2b) l ω² sin α; with the right angles the page has 1 + 2b + 3b²",
    ),
    _row(
        "(17)",
        "power N1 on wheel 1",
        "exact.wheel_power",
        _of(as_printed.wheel_power, exact.wheel_power, _SPEED),
        "M1 as in (15); ω relative to the carrier goes with M about O",
    ),
    _row(
        "(18)",
        "power N on the carrier",
        "exact.carrier_power",
        _of(as_printed.carrier_power, exact.carrier_power, _SPEED),
        "M as in (16)",
    ),
    _row(
        "(19)",
        "moment of inertia about O",
        "motion.reduced_inertia",
        inertia_difference,
        "right about O, but not what (21)–(24) need: wheel and imbalance turn on the carrier",
        "moment_of_inertia",
        right=True,
    ),
    _row(
        "(20)",
        "its limits",
        "motion.reduced_inertia_limits",
        limits_difference,
        "as (19)",
        "inertia_limits",
        right=True,
    ),
    _row(
        "(21)",
        "highest from lowest speed",
        "motion.speed_ratio",
        speed_ratio_difference,
        f"ω_max/ω_min = √(J_red,max/J_red,min), for energy is conserved, angular momentum is not; {_J_RED}",
        "omega_max",
    ),
    _row(
        "(22)",
        "kinetic energy farthest from O",
        "motion.kinetic_energy",
        lambda: energy_differences()[0],
        "J_red,max for J_max, the speed being that of the carrier",
        "energy_farthest",
    ),
    _row(
        "(23)",
        "kinetic energy nearest to O",
        "motion.kinetic_energy",
        lambda: energy_differences()[1],
        "J_red,min for J_min",
        "energy_nearest",
    ),
    _row(
        "(24)",
        "ratio of the kinetic energies",
        "motion.kinetic_energy",
        lambda: energy_differences()[2],
        "T2 = T1 in free motion; T2/T1 = J_red,min/J_red,max < 1 at constant speed",
        "energy_nearest_of_farthest",
    ),
)
