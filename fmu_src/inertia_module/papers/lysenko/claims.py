"""The claims in the text of Lysenko: the figures found of each and whether what it says is so."""

from __future__ import annotations

import numpy as np

from ..report import ROUNDING, Finding, shown, worst
from . import exact, motion
from .as_printed import Printed
from .equations import ALPHA, INSIDE
from .exact import Value
from .mechanism import EXAMPLE as M
from .mechanism import EXAMPLE_SPEED as W
from .mechanism import with_modulus

# moduli of wheels that can be built, and arms of the imbalance over r
MODULI = (0.1, 0.2, 1.0 / 3.0, 0.5, 1.0)
ARMS = (0.5, 1.0, 2.0)


def cusp() -> Finding:
    """With l = r the imbalance stops at each cusp."""
    speed = exact.speed(M, ALPHA, W)
    at_cusp = speed[0] / speed.max()
    return Finding(at_cusp < ROUNDING, at_cusp=shown(at_cusp))


def modulus() -> Finding:
    """Speeds by (1), differentiated with a complex step, and by rolling."""
    rates = [u.imag / 1e-30 * W for u in Printed(M, ALPHA + 1e-30j, W).epicycloid]
    agreed = worst(np.hypot(*rates), exact.speed(M, ALPHA, W))
    return Finding(agreed < ROUNDING, agreed=shown(agreed))


def cycles() -> Finding:
    """The path closes after 1/b cycles."""
    x, y = exact.epicycloid(M, np.array([0.3, 0.3 + 2.0 * np.pi / M.b]))
    gap = float(np.hypot(*np.diff([x, y])[:, 0]) / M.R0)
    return Finding(gap < ROUNDING, count=1.0 / M.b, gap=shown(gap))


def note() -> Finding:
    """What (8) and (2) make of phi = b alpha."""
    printed = Printed(M, ALPHA, W).rho_of_note
    sine = np.abs(M.centre_distance * np.sin(ALPHA) / printed).max()
    off = worst(printed, exact.rho(M, ALPHA))
    return Finding(off < ROUNDING, sine=sine, off=100 * off)


def _defect(coriolis: Value, turned: Value) -> float:
    """Worst difference of F1 + F2 + Fk from -m a, over the largest m a; Fk at the angle turned from e."""
    along, across = exact.position(M, INSIDE)
    outward = -np.exp(1j * INSIDE)
    forces = exact.relative_force(M, W) * outward + coriolis * outward * np.exp(1j * turned)
    forces = forces + M.m * (M.b * W) ** 2 * (along + 1j * across)
    force = -M.m * _acceleration()
    return float(np.abs(forces - force).max() / np.abs(force).max())


def _acceleration() -> Value:
    """(1) differentiated twice, seen from the carrier, m/s^2."""
    wheel = M.arm * (1.0 + M.b) ** 2 * np.exp(1j * INSIDE)
    return W**2 * (wheel - M.centre_distance * M.b**2)


def forces() -> Finding:
    """The sum of the inertia forces against -m a."""
    page = Printed(M, INSIDE, W)
    right, off = _defect(exact.coriolis_force(M, W), 0.0), _defect(page.Fk, page.beta1 - page.delta)
    return Finding(right < ROUNDING, off < ROUNDING, right=shown(right), off=100 * off)


def speed() -> Finding:
    """Where V with the printed beta1 is right."""
    printed, right = Printed(M, ALPHA, W).V, exact.speed(M, ALPHA, W)
    wrong = np.abs(printed - right) > 1e-9 * right.max()
    acute = np.abs(exact.beta1(M, ALPHA)) < np.pi / 2
    return Finding(
        not wrong[acute].any(),
        not wrong.any(),
        share=100 * wrong[:-1].mean(),
        off=100 * worst(printed, right),
        at_cusp=printed[0] / right.max(),
    )


def moments() -> Finding:
    """(15) and (16) against the exact moments, over the modulus."""
    page = Printed(M, INSIDE, W)
    triple = worst(page.M1, 3.0 * exact.wheel_moment(M, INSIDE, W))
    off = [
        worst(Printed(m, INSIDE, W).M, exact.carrier_moment(m, INSIDE, W)) for m in map(with_modulus, MODULI)
    ]
    each = ", ".join(f"{100 * error:.0f} % (b = {b:.2g})" for error, b in zip(off, MODULI, strict=True))
    return Finding(triple > 1.0, max(off) < ROUNDING, triple=shown(triple), off=each)


def vibration() -> Finding:
    """The force on the frame, which vibration comes from."""
    force = np.abs(M.m * _acceleration())
    page = Printed(M, INSIDE, W)
    off = _defect(page.Fk, page.beta1 - page.delta)
    parts = [M.m * M.centre_distance * (M.b * W) ** 2, M.m * M.arm * ((1.0 + M.b) * W) ** 2]
    return Finding(
        off < ROUNDING,
        off=100 * off,
        least=force.min(),
        most=force.max(),
        parts=parts,
        b=M.b * W,
        wheel=W + M.b * W,
    )


def optimisation() -> Finding:
    """The mean power for every modulus and arm: what there is to optimise."""
    gains = [
        abs(power[:-1].mean()) / np.abs(power).max()
        for power in (motion.drive_power(with_modulus(b, arm), ALPHA, W) for b in MODULI for arm in ARMS)
    ]
    return Finding(max(gains) > ROUNDING, count=len(gains), gain=shown(max(gains)))


def equations_of_motion() -> Finding:
    """The torque of Lagrange's equation from M1 and M."""
    page, drive = Printed(M, INSIDE, W), motion.drive_torque(M, INSIDE, W)
    right = -exact.carrier_moment(M, INSIDE, W) - exact.wheel_moment(M, INSIDE, W) / M.b
    off = worst(-page.M - page.M1 / M.b, drive)
    return Finding(off < ROUNDING, right=shown(worst(right, drive)), off=100 * off)


def zones() -> Finding:
    """Where the inertia forces resist the drive and where they unload it."""
    power = motion.drive_power(M, INSIDE, W)
    page = Printed(M, INSIDE, W)
    half = power.size // 2
    out, back = np.mean(power[:half] > 0.0), np.mean(power[half + 1 :] < 0.0)
    same = np.mean(-(page.N1 + page.N) * power >= 0.0)
    return Finding(out > 0.0, back > 0.0, out=100 * out, back=100 * back, peak=power.max(), same=100 * same)


def angular_momentum() -> Finding:
    """Angular momentum in free motion."""
    momentum = motion.angular_momentum(M, ALPHA, motion.free_omega(M, ALPHA, 1.0))
    least = momentum.min() / momentum.max()
    return Finding(1.0 - least < ROUNDING, least=least)


def limits() -> Finding:
    """The limits of rho and of J, and of the inertia that governs the motion."""
    distance, D = exact.rho(M, ALPHA), M.centre_distance
    error = max(abs(distance.min() / (D - M.arm) - 1.0), abs(distance.max() / (D + M.arm) - 1.0))
    (largest, smallest), reduced = Printed(M, 0.0, 1.0).J_limits, motion.reduced_inertia_limits(M)
    return Finding(
        error < ROUNDING, error=shown(error), printed=largest / smallest, reduced=reduced[0] / reduced[1]
    )


def places() -> Finding:
    """Where free motion is fastest and slowest."""
    omega, distance = motion.free_omega(M, ALPHA, 1.0), exact.rho(M, ALPHA)
    fast, slow = omega.argmax(), omega.argmin()
    return Finding(
        fast == distance.argmin(),
        slow == distance.argmax(),
        fast=np.degrees(ALPHA[fast]),
        slow=np.degrees(ALPHA[slow]),
    )


def ratio() -> Finding:
    """The ratio of the speeds in free motion."""
    others = [worst(Printed(m, 0.0, 1.0).omega_max, motion.speed_ratio(m)) for m in map(with_modulus, MODULI)]
    return Finding(
        min(others) < ROUNDING,
        printed=Printed(M, 0.0, 1.0).omega_max,
        exact=motion.speed_ratio(M),
        least=100 * min(others),
        most=100 * max(others),
        bare=(1 + 2 * M.b) ** 2,
    )


def impulse() -> Finding:
    """How the speed changes within a cycle: once up and down, but without a jump."""
    omega = motion.free_omega(M, np.linspace(0.0, 2.0 * np.pi, 36001), 1.0)[:-1]
    fast = omega > 0.5 * (omega.max() + omega.min())
    turns = np.count_nonzero(np.diff(np.sign(np.diff(omega))))
    jump = np.abs(np.diff(omega)).max() / np.ptp(omega)
    return Finding(turns == 1, jump > 0.5, share=100 * (1.0 / omega[fast]).sum() / (1.0 / omega).sum())


def energy() -> Finding:
    """The ratio of the kinetic energies."""
    printed = Printed(M, 0.0, 1.0, T1=1.0).T2_of_T1
    free = motion.kinetic_energy(M, ALPHA, motion.free_omega(M, ALPHA, 1.0))
    largest, smallest = motion.reduced_inertia_limits(M)
    steady, changed = smallest / largest, np.ptp(free) / free.max()
    return Finding(
        abs(printed - 1.0) < ROUNDING,
        abs(printed - steady) < ROUNDING,
        printed=printed,
        changed=shown(changed),
        steady=steady,
    )


def impulsive_drive() -> Finding:
    """What a drive that enforced (21) would do."""
    free, page = motion.speed_ratio(M), Printed(M, 0.0, 1.0).omega_max
    largest, smallest = motion.reduced_inertia_limits(M)
    left = smallest / largest * page**2
    return Finding(left > 1.0, free=free, page=page, left=left)


def cyclic_energy() -> Finding:
    """Kinetic energy at constant speed with the work of the drive, and in free motion."""
    steady = motion.kinetic_energy(M, ALPHA, W)
    free = motion.kinetic_energy(M, ALPHA, motion.free_omega(M, ALPHA, 1.0))
    power = motion.drive_power(M, ALPHA[:1801], W)
    work = np.sum(0.5 * (power[1:] + power[:-1])) * ALPHA[1] / W
    return Finding(
        np.ptp(steady) > ROUNDING * steady.max(),
        np.ptp(free) > ROUNDING * free.max(),
        least=steady.min(),
        most=steady.max(),
        change=np.ptp(steady),
        work=work,
    )


def no_gain() -> Finding:
    """The mean power over a cycle, exact and as printed."""
    exact_power, page = motion.drive_power(M, ALPHA, W), Printed(M, ALPHA, W)
    gains = [abs(p[:-1].mean()) / np.abs(p).max() for p in (exact_power, page.N1 + page.N)]
    return Finding(gains[0] > ROUNDING, gain=shown(gains[0]), printed=shown(gains[1]))
