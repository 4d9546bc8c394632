"""The claims in the text of Lysenko: the figures found of each and whether what it says is so."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..report import ROUNDING, Finding, shown, worst
from .as_printed import printed
from .equations import ALPHA, CYCLE, INSIDE
from .exact import exact, reduced_inertia_limits, speed_ratio
from .mechanism import EXAMPLE as M
from .mechanism import EXAMPLE_SPEED as W
from .mechanism import with_modulus

# moduli of wheels that can be built, and arms of the imbalance over r
MODULI = (0.1, 0.2, 1.0 / 3.0, 0.5, 1.0)
ARMS = (0.5, 1.0, 2.0)
# the cycle with its cusps; the page between them, and at the lowest speed; free motion from that speed
WHOLE, PAGE, LOWEST, FREE = exact(M, ALPHA, W), printed(M, INSIDE, W), printed(M, 0.0, 1.0), exact(M, ALPHA)
FREE = FREE.given(omega=FREE.free_speed)
# largest inertia that governs the motion, smallest, their ratio and that of the speeds
LARGEST, SMALLEST = reduced_inertia_limits(M)
STEADY, RATIO = SMALLEST / LARGEST, speed_ratio(M)


def cusp() -> Finding:
    """With l = r the imbalance stops at each cusp."""
    at_cusp = WHOLE.V[0] / WHOLE.V.max()
    return Finding(at_cusp < ROUNDING, at_cusp=shown(at_cusp))


def modulus() -> Finding:
    """Speeds by (1), differentiated with a complex step, and by rolling."""
    rates = [u.imag / 1e-30 * W for u in printed(M, ALPHA + 1e-30j, W).epicycloid]
    agreed = worst(np.hypot(*rates), WHOLE.V)
    return Finding(agreed < ROUNDING, agreed=shown(agreed))


def cycles() -> Finding:
    """The path closes after 1/b cycles."""
    path = exact(M, np.array([0.3, 0.3 + 2.0 * np.pi / M.b])).epicycloid
    gap = float(np.hypot(*np.diff(path)[:, 0]) / M.R0)
    return Finding(gap < ROUNDING, count=1.0 / M.b, gap=shown(gap))


def note() -> Finding:
    """What (8) and (2) make of phi = b alpha."""
    rho = printed(M, ALPHA, W).rho_of_note
    sine = np.abs(M.centre_distance * np.sin(ALPHA) / rho).max()
    off = worst(rho, WHOLE.rho)
    return Finding(off < ROUNDING, sine=sine, off=100 * off)


def _defect(coriolis: Any, turned: Any) -> float:
    """Worst difference of F1 + F2 + Fk from -m a, over the largest m a; Fk at the angle turned from F1."""
    outward = CYCLE.spoke / M.arm
    forces = (
        CYCLE.F1 * outward + coriolis * outward * np.exp(1j * turned) + CYCLE.F2 * CYCLE.place / CYCLE.rho
    )
    return float(np.abs(forces - CYCLE.force).max() / np.abs(CYCLE.force).max())


def forces() -> Finding:
    """The sum of the inertia forces against -m a."""
    right, off = _defect(CYCLE.Fk, 0.0), _defect(PAGE.Fk, PAGE.beta1 - PAGE.delta)
    return Finding(right < ROUNDING, off < ROUNDING, right=shown(right), off=100 * off)


def speed() -> Finding:
    """Where V with the printed beta1 is right."""
    page = printed(M, ALPHA, W).V
    wrong = np.abs(page - WHOLE.V) > 1e-9 * WHOLE.V.max()
    acute = np.abs(WHOLE.beta1) < np.pi / 2
    return Finding(
        not wrong[acute].any(),
        not wrong.any(),
        share=100 * wrong[:-1].mean(),
        off=100 * worst(page, WHOLE.V),
        at_cusp=page[0] / WHOLE.V.max(),
    )


def moments() -> Finding:
    """(15) and (16) against the exact moments, over the modulus."""
    triple = worst(PAGE.M1, 3.0 * CYCLE.M1)
    off = [worst(printed(m, INSIDE, W).M, exact(m, INSIDE, W).M) for m in map(with_modulus, MODULI)]
    each = ", ".join(f"{100 * error:.0f} % (b = {b:.2g})" for error, b in zip(off, MODULI, strict=True))
    return Finding(triple > 1.0, max(off) < ROUNDING, triple=shown(triple), off=each)


def vibration() -> Finding:
    """The force on the frame, which vibration comes from."""
    force, off = np.abs(CYCLE.force), _defect(PAGE.Fk, PAGE.beta1 - PAGE.delta)
    parts = [M.m * M.centre_distance * (M.b * W) ** 2, M.m * M.arm * ((1.0 + M.b) * W) ** 2]
    speeds = {"b": M.b * W, "wheel": W + M.b * W}
    return Finding(off < ROUNDING, off=100 * off, least=force.min(), most=force.max(), parts=parts, **speeds)


def optimisation() -> Finding:
    """The mean power for every modulus and arm: what there is to optimise."""
    powers = [exact(with_modulus(b, arm), ALPHA, W).drive_power for b in MODULI for arm in ARMS]
    gains = [abs(power[:-1].mean()) / np.abs(power).max() for power in powers]
    return Finding(max(gains) > ROUNDING, count=len(gains), gain=shown(max(gains)))


def equations_of_motion() -> Finding:
    """The torque of Lagrange's equation from M1 and M."""
    right, off = (worst(-e.M - e.M1 / M.b, CYCLE.drive_torque) for e in (CYCLE, PAGE))
    return Finding(off < ROUNDING, right=shown(right), off=100 * off)


def zones() -> Finding:
    """Where the inertia forces resist the drive and where they unload it."""
    power = CYCLE.drive_power
    half = power.size // 2
    out, back = np.mean(power[:half] > 0.0), np.mean(power[half + 1 :] < 0.0)
    same = np.mean(-(PAGE.N1 + PAGE.N) * power >= 0.0)
    return Finding(out > 0.0, back > 0.0, out=100 * out, back=100 * back, peak=power.max(), same=100 * same)


def angular_momentum() -> Finding:
    """Angular momentum in free motion."""
    least = FREE.angular_momentum.min() / FREE.angular_momentum.max()
    return Finding(1.0 - least < ROUNDING, least=least)


def limits() -> Finding:
    """The limits of rho and of J, and of the inertia that governs the motion."""
    distance, D = WHOLE.rho, M.centre_distance
    error = max(abs(distance.min() / (D - M.arm) - 1.0), abs(distance.max() / (D + M.arm) - 1.0))
    largest, smallest = LOWEST.J_limits
    return Finding(
        error < ROUNDING, error=shown(error), printed=largest / smallest, reduced=LARGEST / SMALLEST
    )


def places() -> Finding:
    """Where free motion is fastest and slowest."""
    fast, slow = FREE.omega.argmax(), FREE.omega.argmin()
    says = fast == WHOLE.rho.argmin(), slow == WHOLE.rho.argmax()
    return Finding(*says, fast=np.degrees(ALPHA[fast]), slow=np.degrees(ALPHA[slow]))


def ratio() -> Finding:
    """The ratio of the speeds in free motion."""
    others = [worst(printed(m, 0.0, 1.0).omega_max, speed_ratio(m)) for m in map(with_modulus, MODULI)]
    found = {"least": 100 * min(others), "most": 100 * max(others), "bare": (1 + 2 * M.b) ** 2}
    return Finding(min(others) < ROUNDING, printed=LOWEST.omega_max, exact=RATIO, **found)


def impulse() -> Finding:
    """How the speed changes within a cycle: once up and down, but without a jump."""
    omega = exact(M, np.linspace(0.0, 2.0 * np.pi, 36001)).free_speed[:-1]
    fast = omega > 0.5 * (omega.max() + omega.min())
    turns = np.count_nonzero(np.diff(np.sign(np.diff(omega))))
    jump = np.abs(np.diff(omega)).max() / np.ptp(omega)
    return Finding(turns == 1, jump > 0.5, share=100 * (1.0 / omega[fast]).sum() / (1.0 / omega).sum())


def energy() -> Finding:
    """The ratio of the kinetic energies."""
    page = LOWEST.T2_of_T1 / LOWEST.T1
    changed = shown(np.ptp(FREE.kinetic_energy) / FREE.kinetic_energy.max())
    says = abs(page - 1.0) < ROUNDING, abs(page - STEADY) < ROUNDING
    return Finding(*says, printed=page, changed=changed, steady=STEADY)


def impulsive_drive() -> Finding:
    """What a drive that enforced (21) would do."""
    left = STEADY * LOWEST.omega_max**2
    return Finding(left > 1.0, free=RATIO, page=LOWEST.omega_max, left=left)


def cyclic_energy() -> Finding:
    """Kinetic energy at constant speed with the work of the drive, and in free motion."""
    steady, free, power = WHOLE.kinetic_energy, FREE.kinetic_energy, WHOLE.drive_power[:1801]
    work = np.sum(0.5 * (power[1:] + power[:-1])) * ALPHA[1] / W
    says = (np.ptp(energy) > ROUNDING * energy.max() for energy in (steady, free))
    return Finding(*says, least=steady.min(), most=steady.max(), change=np.ptp(steady), work=work)


def no_gain() -> Finding:
    """The mean power over a cycle, exact and as printed."""
    page = printed(M, ALPHA, W)
    gains = [abs(p[:-1].mean()) / np.abs(p).max() for p in (WHOLE.drive_power, page.N1 + page.N)]
    return Finding(gains[0] > ROUNDING, gain=shown(gains[0]), printed=shown(gains[1]))
