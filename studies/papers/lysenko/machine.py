"""The claims of Lysenko on friction, weight, vibration and drive power, judged by the module with its losses.

Wheel 2 is link 2, too heavy to be moved, as in examples/papers/lysenko_wheel.toml. Nothing is lost and
nothing has weight unless it is given.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia_module.memory.instances import Module

from ..report import ROUNDING, Finding, shown
from .as_printed import printed
from .claims import MODULI
from .mechanism import EXAMPLE, EXAMPLE_SPEED, Mechanism, with_modulus

# those of examples/real_machine.toml
LOSSES = {
    "mesh_efficiency": 0.99,
    "journal_friction": 2.5e-5,
    "input_friction": 2e-3,
    "drive_friction": 2.5e-4,
}
# speed of the carrier of the example, rad/s, and its time for a turn, s
CARRIER_SPEED = EXAMPLE.b * EXAMPLE_SPEED
TURN = 2.0 * np.pi / CARRIER_SPEED
HEAVY = 1e9
STEPS = 900


def _module(m: Mechanism, **values: Any) -> Module:
    """The mechanism as a module with link 2 held, the carrier at its speed; values over these."""
    held = {"link2_inertia": HEAVY, "housing_freewheel": False, "output_freewheel": False}
    lengths = {"sun_radius": m.R0, "satellite_radius": m.r, "eccentricity": m.arm, "imbalance_mass": m.m}
    inertias = {"input_inertia": m.J_carrier, "drive_inertia": m.J_wheel}
    others = {"layout": "planar", "omega1": m.b * EXAMPLE_SPEED, "load_torque": 0.0, "tolerance": 1e-9}
    return Module().start(**{**held, **lengths, **inertias, **others, **values})


def _over(module: Module, time: float, *names: str) -> Any:
    """Outputs after each of STEPS steps over a time, s: shape (STEPS, number of names)."""
    found = []
    for _ in range(STEPS):
        module.advance(time / STEPS)
        found.append(module.read(names))
    return np.array(found)


def _power(m: Mechanism, **values: float) -> Any:
    """Power of the drive over a turn of the carrier at constant speed, W, shape (STEPS,)."""
    speed = m.b * EXAMPLE_SPEED
    return speed * _over(_module(m, **values), 2.0 * np.pi / speed, "input_torque_mean")[:, 0]


def drive() -> Finding:
    """The power of a drive with friction against the one printed: mean, and peak over the modulus."""
    alpha = 2.0 * np.pi * (np.arange(STEPS) + 0.5) / STEPS
    mechanisms = [EXAMPLE, *map(with_modulus, MODULI)]
    pages = [-page.N1 - page.N for page in (printed(m, alpha, EXAMPLE_SPEED) for m in mechanisms)]
    powers = [_power(m, **LOSSES) for m in mechanisms]
    off = [abs(page.max() / power.max() - 1.0) for page, power in zip(pages, powers, strict=True)]
    power, mean = powers[0], powers[0].mean()
    free = _module(EXAMPLE, drive="torque", drive_torque=0.0, **LOSSES)
    start = free["energy_stored"]
    half = 20.0 * TURN / STEPS * np.count_nonzero(_over(free, 20.0 * TURN, "energy_stored") > 0.5 * start)
    says = abs(pages[0].mean() / mean - 1.0) < 0.1, max(off) < 0.1
    figures = {"page": pages[0].max(), "peak": power.max(), "half": half, "most": 100.0 * max(off)}
    return Finding(*says, losses=LOSSES, mean=mean, page_mean=shown(pages[0].mean() / mean), **figures)


def weight() -> Finding:
    """What the weight changes of the power of the drive with the axis level in place of upright."""
    level, upright = _power(EXAMPLE, gravity=9.81), _power(EXAMPLE)
    share = np.abs(level - upright).max() / upright.max()
    # the weight stays, the inertia forces grow with the square of the speed
    small = CARRIER_SPEED * np.sqrt(share / 0.01)
    return Finding(
        share > 0.01, share=100.0 * share, small=small, mean=shown(abs(level.mean()) / level.max())
    )


def cause_of_vibration() -> Finding:
    """Largest force and moment about the axis on the mount: of one imbalance, of three, of one at O1."""

    def largest(**values: float) -> tuple[float, float]:
        names = "shaking_force_y", "shaking_force_z", "shaking_moment_x"
        y, z, moment = _over(_module(EXAMPLE, **values), TURN, *names).T
        return np.hypot(y, z).max(), np.abs(moment).max()

    one, three = largest(), largest(satellites=3, drive_inertia=3.0 * EXAMPLE.J_wheel)
    centred = largest(eccentricity=0.0)
    left = three[0] / one[0], three[1] / one[1]
    figures = {"balance": shown(left[0]), "moment": three[1], "centred": centred[0]}
    return Finding(
        left[0] < ROUNDING, left[1] < ROUNDING, one=one, still=shown(centred[1] / one[1]), **figures
    )


def rectified() -> Finding:
    """The carrier driven, link 2 free between freewheels: torque and power on a shaft at half its speed."""
    freewheels = {"housing_freewheel": True, "output_freewheel": True, "link2_inertia": 2e-3}
    shaft = {"output_inertia": 1e8, "omega_out_start": 0.5 * CARRIER_SPEED, "tolerance": 1e-6}
    torque, gain = [], []
    for losses in ({}, LOSSES):
        module = _module(EXAMPLE, **freewheels, **shaft, **losses)
        given, taken = _over(module, 3000.0 * TURN, "output_torque_mean", "input_torque_mean").mean(axis=0)
        torque.append(given)
        gain.append(0.5 * given / taken)
    return Finding(min(torque) > 0.0, max(gain) > 1.01, torque=torque, gain=gain)


def circulation() -> Finding:
    """Share of the mean energy that the mesh takes in a turn, at constant speed and left to itself."""
    lost = {"mesh_efficiency": LOSSES["mesh_efficiency"]}
    steady = _over(_module(EXAMPLE, **lost), TURN, "energy_stored", "energy_lost")
    free = _module(EXAMPLE, drive="torque", drive_torque=0.0, **lost)
    swinging = _over(free, 3.0 * TURN, "energy_stored", "energy_lost", "drive_turns")
    turn = swinging[swinging[:, 2] < 1.0 / EXAMPLE.b]
    share = [100.0 * part[-1, 1] / part[:, 0].mean() for part in (steady, turn)]
    return Finding(abs(share[1] / share[0] - 1.0) > 0.1, share=share, ratio=share[1] / share[0])
