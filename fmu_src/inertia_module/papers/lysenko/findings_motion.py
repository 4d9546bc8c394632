"""What exact mechanics says about angular momentum, speeds and energy; figures of the example mechanism."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import as_printed, exact, motion
from .equations import cycle, speed_ratio_difference
from .findings_forces import MODULI
from .mechanism import EXAMPLE, EXAMPLE_SPEED, with_modulus

Array = NDArray[np.float64]


# sums of some thousand terms are not better than this
ROUNDING = 1e-15


def mean_over_peak(values: Array) -> float:
    """Mean over alpha of a periodic function given over cycle(), shape (n,), over its peak, or rounding."""
    return max(float(abs(values[:-1].mean()) / np.abs(values).max()), ROUNDING)


def angular_momentum() -> str:
    """Angular momentum in free motion."""
    angle = cycle()
    omega = motion.free_omega(EXAMPLE, angle, 1.0)
    momentum = motion.angular_momentum(EXAMPLE, angle, omega)
    return (
        f"in free motion the angular momentum about O runs from {momentum.min() / momentum.max():.2f} to 1 of"
        " its largest value every cycle: the held wheel exerts torque. The speed does change, by conservation"
        " of energy"
    )


def limits() -> str:
    """Limits of rho, J and of the reduced inertia."""
    distance = exact.rho(EXAMPLE, cycle())
    D, arm = EXAMPLE.centre_distance, EXAMPLE.arm
    error = max(abs(distance.min() / (D - arm) - 1.0), abs(distance.max() / (D + arm) - 1.0))
    largest, smallest = as_printed.inertia_limits(EXAMPLE)
    true = motion.reduced_inertia_limits(EXAMPLE)
    return (
        f"ρ reaches R0 + r ± l to {error:.0e}, so (20) is right about O: {largest / smallest:.2f} between the"
        f" ends; the inertia that governs the motion changes {true[0] / true[1]:.2f} times"
    )


def places() -> str:
    """Where free motion is fastest and slowest."""
    angle = cycle()
    omega = motion.free_omega(EXAMPLE, angle, 1.0)
    places = np.degrees(angle[[omega.argmax(), omega.argmin()]])
    return f"fastest at α = {places[0]:.0f}° (ρ smallest), slowest at α = {places[1]:.0f}° (ρ largest)"


def ratio() -> str:
    """Ratio of the speeds in free motion, printed and exact."""
    others = [speed_ratio_difference(with_modulus(b)) for b in MODULI]
    return (
        f"printed {as_printed.omega_max(EXAMPLE, 1.0):.3f}, exact {motion.speed_ratio(EXAMPLE):.3f}; off by"
        f" {100 * min(others):.0f} to {100 * max(others):.0f} % for b = {MODULI[0]} to {MODULI[-1]}; without"
        f" inertia of the links and l = r it has no bound, where (21) gives"
        f" (1 + 2b)² = {(1 + 2 * EXAMPLE.b) ** 2:.2f}"
    )


def impulse() -> str:
    """How the speed changes within a cycle."""
    angle = cycle(36001)
    omega = motion.free_omega(EXAMPLE, angle, 1.0)
    time = 1.0 / omega[:-1]
    fast = omega[:-1] > 0.5 * (omega.max() + omega.min())
    return (
        f"up and down once a cycle, above the middle speed for"
        f" {100 * time[fast].sum() / time.sum():.0f} % of the time, but smoothly: no impulse acts"
    )


def energy() -> str:
    """Ratio of the kinetic energies."""
    printed = as_printed.energy_nearest_of_farthest(EXAMPLE, 1.0)
    angle = cycle()
    free = motion.kinetic_energy(EXAMPLE, angle, motion.free_omega(EXAMPLE, angle, 1.0))
    largest, smallest = motion.reduced_inertia_limits(EXAMPLE)
    return (
        f"(24) gives T2/T1 = {printed:.3f}; in free motion the ratio is 1 (to"
        f" {np.ptp(free) / free.max():.0e}), at constant speed {smallest / largest:.3f}:"
        " the energy is lowest nearest to O"
    )


def impulsive_drive() -> str:
    """What a drive that enforced (21) would do."""
    largest, smallest = motion.reduced_inertia_limits(EXAMPLE)
    ratio = as_printed.omega_max(EXAMPLE, 1.0)
    return (
        f"on the way in the free mechanism speeds up {motion.speed_ratio(EXAMPLE):.2f} times without any"
        f" drive; a drive that made it follow (21), {ratio:.2f} times, would take energy out, down to"
        f" {smallest / largest * ratio**2:.2f} of T1, and have to put it back on the way out"
    )


def cyclic_energy() -> str:
    """Kinetic energy at constant speed and the work of the drive."""
    angle = cycle()
    energy = motion.kinetic_energy(EXAMPLE, angle, EXAMPLE_SPEED)
    power = motion.drive_power(EXAMPLE, angle, EXAMPLE_SPEED)
    work = float(np.sum(0.5 * (power[1:1801] + power[:1800])) * (angle[1] - angle[0]) / EXAMPLE_SPEED)
    return (
        f"of a driven mechanism: at constant speed {energy.min():.1f} to {energy.max():.1f} J, the difference"
        f" of {np.ptp(energy):.2f} J being the work of the drive over half a cycle, {work:.2f} J; free, it is"
        " constant"
    )


def no_gain() -> str:
    """Mean power over a cycle."""
    power = motion.drive_power(EXAMPLE, cycle(), EXAMPLE_SPEED)
    printed = as_printed.wheel_power(EXAMPLE, cycle(), EXAMPLE_SPEED) + as_printed.carrier_power(
        EXAMPLE, cycle(), EXAMPLE_SPEED
    )
    return (
        f"the mean power over a cycle is at most {mean_over_peak(power):.0e} of its peak at constant speed,"
        f" and even by the printed (17), (18) {mean_over_peak(printed):.0e}; in free motion the energy is"
        " constant. Nothing is gained: the inertia forces return what they took"
    )
