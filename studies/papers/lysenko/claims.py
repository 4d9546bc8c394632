"""The claims in the text of Lysenko: figures found, and whether what is said is so.

Those on friction, weight, vibration and drive power are judged by the module with its losses. Wheel 2 is
link 2, too heavy to be moved, as in examples/papers/lysenko_wheel.toml. Nothing is lost and nothing has
weight unless it is told.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia_module.memory import Module

from ..report import ROUNDING, Finding, shown, worst
from .equations import ALPHA, CYCLE, INSIDE, Mechanism, exact, printed, reduced_inertia, speed_ratio
from .equations import EXAMPLE as M
from .equations import EXAMPLE_SPEED as W

Rows = Iterator[tuple[str, Finding]]
# moduli of wheels that can be built, and arms of the imbalance over r
MODULI = (0.1, 0.2, 1.0 / 3.0, 0.5, 1.0)
ARMS = (0.5, 1.0, 2.0)
# the cycle with its cusps; the page between them, there as well, and at the lowest speed; free motion from it
WHOLE, PAGE, PAGE_WHOLE, LOWEST = (
    exact(M, ALPHA, W),
    printed(M, INSIDE, W),
    printed(M, ALPHA, W),
    printed(M, 0.0, 1.0),
)
FREE = exact(M, ALPHA).replaced(omega=exact(M, ALPHA).free_speed)
# losses of examples/real_machine.toml
LOSSES = {
    "mesh_efficiency": 0.99,
    "journal_friction": 2.5e-5,
    "input_friction": 2e-3,
    "drive_friction": 2.5e-4,
}
# speed of the carrier of the example, rad/s, its time for a turn, s, and steps over a run
CARRIER_SPEED = M.b * W
TURN = 2.0 * np.pi / CARRIER_SPEED
STEPS = 900


def with_modulus(b: float, arm: float = 1.0) -> Mechanism:
    """The example with another wheel 1, r = b R0, and the imbalance at arm times r."""
    r = b * M.R0
    return Mechanism(M.R0, r, arm * r, M.m, M.J_carrier, M.J_wheel)


def module_of(m: Mechanism, **values: Any) -> Module:
    """The mechanism as a module with link 2 held, the carrier at its speed; values over these."""
    held = {"link2_inertia": 1e9, "housing_freewheel": False, "output_freewheel": False}
    lengths = {"sun_radius": m.R0, "satellite_radius": m.r, "eccentricity": m.arm, "imbalance_mass": m.m}
    inertias = {"input_inertia": m.J_carrier, "drive_inertia": m.J_wheel}
    others = {"layout": "planar", "omega1": m.b * W, "load_torque": 0.0, "tolerance": 1e-9}
    return Module().start(**{**held, **lengths, **inertias, **others, **values})


def outputs(module: Module, time: float, *names: str) -> Any:
    """Outputs after each of STEPS steps over a time, s: shape (STEPS, number of names)."""
    found = []
    for _ in range(STEPS):
        module.advance(time / STEPS)
        found.append(module.read(names))
    return np.array(found)


def drive_power(m: Mechanism, **values: float) -> Any:
    """Power of the drive over a turn of the carrier at constant speed, W, shape (STEPS,)."""
    speed = m.b * W
    return speed * outputs(module_of(m, **values), 2.0 * np.pi / speed, "input_torque_mean")[:, 0]


def shaking(**values: float) -> tuple[float, float]:
    """Largest force, N, and moment about the axis, N m, on the mount over a turn of the carrier."""
    names = "shaking_force_y", "shaking_force_z", "shaking_moment_x"
    y, z, moment = outputs(module_of(M, **values), TURN, *names).T
    return np.hypot(y, z).max(), np.abs(moment).max()


def missing(coriolis: Any, turned: Any) -> float:
    """Worst difference of F1 + F2 + Fk from -m a, over the largest m a; Fk at the angle turned from F1."""
    outward = CYCLE.spoke / M.arm
    along = (CYCLE.F1 + coriolis * np.exp(1j * turned)) * outward
    return worst(
        np.abs(along + CYCLE.F2 * CYCLE.place / CYCLE.rho - CYCLE.force), 0.0, np.abs(CYCLE.force).max()
    )


def ripple(power: Any) -> float:
    """Mean over a cycle, the first angle being met again at its end, relative to the peak."""
    return float(abs(power[:-1].mean()) / np.abs(power).max())


def of_the_path() -> Rows:
    """The epicycloid, its modulus and its cycles."""
    at_cusp = WHOLE.V[0] / WHOLE.V.max()
    yield "cusp", Finding(at_cusp < ROUNDING, at_cusp=shown(at_cusp))

    # speeds by (1), differentiated with a complex step, and by rolling
    rates = [u.imag / 1e-30 * W for u in printed(M, ALPHA + 1e-30j, W).epicycloid]
    agreed = worst(np.hypot(*rates), WHOLE.V)
    yield "modulus", Finding(agreed < ROUNDING, agreed=shown(agreed))

    path = exact(M, np.array([0.3, 0.3 + 2.0 * np.pi / M.b])).epicycloid
    gap = float(np.hypot(*np.diff(path)[:, 0]) / M.R0)
    yield "cycles", Finding(gap < ROUNDING, count=1.0 / M.b, gap=shown(gap))

    sine = np.abs(M.centre_distance * np.sin(ALPHA) / PAGE_WHOLE.rho_of_note).max()
    off = worst(PAGE_WHOLE.rho_of_note, WHOLE.rho)
    yield "note", Finding(off < ROUNDING, sine=sine, off=100 * off)


def of_the_forces() -> Rows:
    """Inertia forces, speed, moments and power at constant speed."""
    right, off = missing(CYCLE.Fk, 0.0), missing(PAGE.Fk, PAGE.beta1 - PAGE.delta)
    yield "forces", Finding(right < ROUNDING, off < ROUNDING, right=shown(right), off=100 * off)

    parts = [M.m * M.centre_distance * CARRIER_SPEED**2, M.m * M.arm * ((1.0 + M.b) * W) ** 2]
    figures = {"least": np.abs(CYCLE.force).min(), "most": np.abs(CYCLE.force).max(), "parts": parts}
    figures |= {"b": CARRIER_SPEED, "wheel": W + CARRIER_SPEED}
    yield "vibration", Finding(off < ROUNDING, off=100 * off, **figures)

    wrong = np.abs(PAGE_WHOLE.V - WHOLE.V) > 1e-9 * WHOLE.V.max()
    says = not wrong[np.abs(WHOLE.beta1) < np.pi / 2].any(), not wrong.any()
    figures = {"off": 100 * worst(PAGE_WHOLE.V, WHOLE.V), "at_cusp": PAGE_WHOLE.V[0] / WHOLE.V.max()}
    yield "speed", Finding(*says, share=100 * wrong[:-1].mean(), **figures)

    triple = worst(PAGE.M1, 3.0 * CYCLE.M1)
    errors = [worst(printed(m, INSIDE, W).M, exact(m, INSIDE, W).M) for m in map(with_modulus, MODULI)]
    each = ", ".join(f"{100 * error:.0f} % (b = {b:.2g})" for error, b in zip(errors, MODULI, strict=True))
    yield "moments", Finding(triple > 1.0, max(errors) < ROUNDING, triple=shown(triple), off=each)

    powers = [exact(with_modulus(b, arm), ALPHA, W).drive_power for b in MODULI for arm in ARMS]
    gain = max(map(ripple, powers))
    yield "optimisation", Finding(gain > ROUNDING, count=len(powers), gain=shown(gain))

    right, off = (worst(-e.M - e.M1 / M.b, CYCLE.drive_torque) for e in (CYCLE, PAGE))
    yield "equations_of_motion", Finding(off < ROUNDING, right=shown(right), off=100 * off)

    power, page = CYCLE.drive_power, PAGE.N1 + PAGE.N
    half = power.size // 2
    out, back = np.mean(power[:half] > 0.0), np.mean(power[half + 1 :] < 0.0)
    figures = {"peak": power.max(), "same": 100 * np.mean(-page * power >= 0.0)}
    yield "zones", Finding(out > 0.0, back > 0.0, out=100 * out, back=100 * back, **figures)

    gain, page_gain = ripple(WHOLE.drive_power), ripple(PAGE_WHOLE.N1 + PAGE_WHOLE.N)
    yield "no_gain", Finding(gain > ROUNDING, gain=shown(gain), printed=shown(page_gain))


def of_the_energy() -> Rows:
    """Inertia, speed and energy in free motion."""
    least = FREE.angular_momentum.min() / FREE.angular_momentum.max()
    yield "angular_momentum", Finding(1.0 - least < ROUNDING, least=least)

    limits = np.array([WHOLE.rho.min(), WHOLE.rho.max()])
    error = np.abs(limits / (M.centre_distance + M.arm * np.array([-1.0, 1.0])) - 1.0).max()
    # ratio of largest and smallest inertia, and of the speeds, exact and by (21)
    reduced, ratio, page_ratio = (
        reduced_inertia(M, np.pi) / reduced_inertia(M, 0.0),
        speed_ratio(M),
        LOWEST.omega_max,
    )
    yield "limits", Finding(error < ROUNDING, error=shown(error), printed=page_ratio, reduced=reduced)

    fast, slow = FREE.omega.argmax(), FREE.omega.argmin()
    says: Any = fast == WHOLE.rho.argmin(), slow == WHOLE.rho.argmax()
    yield "places", Finding(*says, fast=np.degrees(ALPHA[fast]), slow=np.degrees(ALPHA[slow]))

    others = [worst(printed(m, 0.0, 1.0).omega_max, speed_ratio(m)) for m in map(with_modulus, MODULI)]
    figures: dict[str, Any] = {
        "least": 100 * min(others),
        "most": 100 * max(others),
        "bare": (1 + 2 * M.b) ** 2,
    }
    yield "ratio", Finding(min(others) < ROUNDING, printed=page_ratio, exact=ratio, **figures)

    omega = exact(M, np.linspace(0.0, 2.0 * np.pi, 36001)).free_speed[:-1]
    fast = omega > 0.5 * (omega.max() + omega.min())
    turns = np.count_nonzero(np.diff(np.sign(np.diff(omega))))
    says = turns == 1, np.abs(np.diff(omega)).max() / np.ptp(omega) > 0.5
    yield "impulse", Finding(*says, share=100 * (1.0 / omega[fast]).sum() / (1.0 / omega).sum())

    page, steady, free = LOWEST.T2_of_T1 / LOWEST.T1, WHOLE.kinetic_energy, FREE.kinetic_energy
    says = abs(page - 1.0) < ROUNDING, abs(page - 1.0 / reduced) < ROUNDING
    figures = {"changed": shown(np.ptp(free) / free.max()), "steady": 1.0 / reduced}
    yield "energy", Finding(*says, printed=page, **figures)

    # a drive that enforced (21)
    left = page_ratio**2 / reduced
    yield "impulsive_drive", Finding(left > 1.0, free=ratio, page=page_ratio, left=left)

    half = WHOLE.drive_power[:1801]
    work = np.sum(0.5 * (half[1:] + half[:-1])) * ALPHA[1] / W
    says = (np.ptp(energy) > ROUNDING * energy.max() for energy in (steady, free))
    figures = {"least": steady.min(), "most": steady.max(), "change": np.ptp(steady)}
    yield "cyclic_energy", Finding(*says, work=work, **figures)


def of_the_machine() -> Rows:
    """Friction, weight and vibration, by the module."""
    mechanisms = [M, *map(with_modulus, MODULI)]
    # in the middle of the steps
    pages = [printed(m, 2.0 * np.pi * (np.arange(STEPS) + 0.5) / STEPS, W) for m in mechanisms]
    asked = [-page.N1 - page.N for page in pages]
    powers = [drive_power(m, **LOSSES) for m in mechanisms]
    off = [abs(page.max() / power.max() - 1.0) for page, power in zip(asked, powers, strict=True)]
    mean, page_mean = powers[0].mean(), asked[0].mean() / powers[0].mean()
    free = module_of(M, drive="torque", drive_torque=0.0, **LOSSES)
    start = free["energy_stored"]
    half = 20.0 * TURN * np.mean(outputs(free, 20.0 * TURN, "energy_stored") > 0.5 * start)
    figures = {"page": asked[0].max(), "peak": powers[0].max(), "half": half, "most": 100.0 * max(off)}
    says = abs(page_mean - 1.0) < 0.1, max(off) < 0.1
    yield "drive", Finding(*says, losses=LOSSES, mean=mean, page_mean=shown(page_mean), **figures)

    level, upright = drive_power(M, gravity=9.81), drive_power(M)
    share = np.abs(level - upright).max() / upright.max()
    # the weight stays, the inertia forces grow with the square of the speed
    figures = {"small": CARRIER_SPEED * np.sqrt(share / 0.01), "mean": shown(abs(level.mean()) / level.max())}
    yield "weight", Finding(share > 0.01, share=100.0 * share, **figures)

    one, three = shaking(), shaking(satellites=3, drive_inertia=3.0 * M.J_wheel)
    centred = shaking(eccentricity=0.0)
    left = three[0] / one[0], three[1] / one[1]
    figures = {
        "balance": shown(left[0]),
        "moment": three[1],
        "centred": centred[0],
        "still": shown(centred[1] / one[1]),
    }
    yield "cause_of_vibration", Finding(*(part < ROUNDING for part in left), one=one, **figures)

    # link 2 free between freewheels, a shaft at half the speed of the carrier
    freewheels: Any = {"housing_freewheel": True, "output_freewheel": True, "link2_inertia": 2e-3}
    shaft = {"output_inertia": 1e8, "omega_out_start": 0.5 * CARRIER_SPEED, "tolerance": 1e-6}
    modules = [module_of(M, **freewheels, **shaft, **losses) for losses in ({}, LOSSES)]
    means = [
        outputs(m, 3000.0 * TURN, "output_torque_mean", "input_torque_mean").mean(axis=0) for m in modules
    ]
    torque, gain = [out for out, _ in means], [0.5 * out / into for out, into in means]
    yield "rectified", Finding(min(torque) > 0.0, max(gain) > 1.01, torque=torque, gain=gain)

    # share of the mean energy that the mesh takes in a turn, at constant speed and left to itself
    lost: Any = {"mesh_efficiency": LOSSES["mesh_efficiency"]}
    steady = outputs(module_of(M, **lost), TURN, "energy_stored", "energy_lost")
    free = module_of(M, drive="torque", drive_torque=0.0, **lost)
    swinging = outputs(free, 3.0 * TURN, "energy_stored", "energy_lost", "drive_turns")
    turn = swinging[swinging[:, 2] < 1.0 / M.b]
    shares = [100.0 * part[-1, 1] / part[:, 0].mean() for part in (steady, turn)]
    ratio = shares[1] / shares[0]
    yield "circulation", Finding(abs(ratio - 1.0) > 0.1, share=shares, ratio=ratio)


def findings() -> dict[str, Finding]:
    """The rows of the table of claims."""
    parts = of_the_path, of_the_forces, of_the_energy, of_the_machine
    return {name: found for part in parts for name, found in part()}
