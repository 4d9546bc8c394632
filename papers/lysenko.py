"""Lysenko: equations (1) to (24) of the inertial gear, as the page has them, errors kept, and exact; claims.

V. S. Lysenko, S. Zh. Praliev, B. T. Suleimenov, S. D. Baubekov, Analysis of the inertial gear.

The paper writes R for R0 and uses phi and alpha for one angle, that of wheel 1 on the carrier: (1) and (2)
with phi, the rest with alpha. omega is its rate, steady but where told; for (21) to (24) the lowest one.
Results in SI units, in the shape of alpha.

Exact places and forces are complex numbers in the frame that turns with the carrier, O to O1 its real axis.
The imbalance S is at O1 - l exp(i alpha), so nearest to O at alpha = 0. Inertia forces, with e from O1 to S:

    F1 = m l omega^2 e,  F2 = m b^2 omega^2 OS,  Fk = 2 m b omega (l omega) e,  sum = -m a

Fk takes the speed l omega relative to the carrier, and as the carrier turns in the same sense it lies
along e, in line with F1. Moments are positive in the sense of omega.

With wheel 2 held one angle describes the mechanism: its energy is J_red(alpha) theta'^2 / 2, theta = b alpha
the angle of the carrier. The held wheel takes torque, so angular momentum about O is not conserved; left
alone, the mechanism keeps its energy.

Claims on friction, weight, vibration and drive power are judged by the module with its losses. Wheel 2 is
link 2, too heavy to be moved, as in examples/papers/lysenko_wheel.toml. Nothing is lost and nothing has
weight unless it is told.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from inertia_module.model import Module

from .engine import Equation, Forms, Formulas, compared, largest, tables, worst

# losses of examples/real_machine.toml
LOSSES = {
    "mesh_efficiency": 0.99,
    "journal_friction": 2.5e-5,
    "input_friction": 2e-3,
    "drive_friction": 2.5e-4,
}
# of a run of the module
STEPS = 900


@dataclass(frozen=True)
class Mechanism:
    """Wheel 1 with the imbalance, rolled around the held wheel 2 by carrier 3, in the horizontal plane.

    Attributes:
        R0: radius of the held wheel 2 (R in the paper), m. r: radius of wheel 1, m.
        arm: distance l of the imbalance from the axis O1 of wheel 1, m; l = r in the paper's example.
        m: mass of the imbalance, kg.
        J_carrier: moment of inertia of the carrier about O, the mass of wheel 1 on it included, kg m^2.
        J_wheel: moment of inertia of wheel 1 about its own axis O1, the imbalance not included, kg m^2.
    """

    R0: float
    r: float
    arm: float
    m: float
    J_carrier: float = 0.0
    J_wheel: float = 0.0

    @property
    def b(self) -> float:
        """Modulus of the epicycloid b = r/R0; the carrier turns b times as fast as wheel 1 turns on it."""
        return self.r / self.R0

    @property
    def centre_distance(self) -> float:
        """Distance D = O O1 = R0 (1 + b), m."""
        return self.R0 + self.r


def moment(place: Any, force: Any) -> Any:
    """Moment of a force at a place, about where the place is counted from."""
    return (np.conj(place) * force).imag


ROWS, PRINTED, EXACT = tables("lysenko", globals())


def forms(formulas: Formulas, m: Mechanism, alpha: Any, omega: Any = 1.0, **known: Any) -> Forms:
    """Results for dimensions, angles of wheel 1 on the carrier, rad, and its speed, rad/s.

    Args:
        formulas: PRINTED, each fed with the printed results before it, or EXACT. m: dimensions.
        alpha, omega: numbers or of shape (n,). known: quantities in place of formulas, or omega_rate,
            rad/s^2, if the speed is not steady.
    """
    lengths = {**asdict(m), "D": m.centre_distance, "l": m.arm, "b": m.b, "links": m.J_carrier + m.J_wheel}
    motion = {"alpha": np.asarray(alpha), "omega": omega, "omega_rate": 0.0}
    return Forms(formulas, **lengths | motion | {"at": lambda angle: exact(m, angle)} | known)


printed, exact = partial(forms, PRINTED), partial(forms, EXACT)

# l = r as in the paper, b = 1/3 (three cycles a turn); speed of wheel 1 relative to the carrier, rad/s
EXAMPLE = Mechanism(R0=0.06, r=0.02, arm=0.02, m=1.0, J_carrier=2e-3, J_wheel=5e-5)
EXAMPLE_SPEED = 100.0
# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between the cusps, where the speed is 0 and the page divides by it
INSIDE = ALPHA[1:-1]
CYCLE = exact(EXAMPLE, INSIDE, EXAMPLE_SPEED)


EQUATIONS = {row.number: compared(row.name, PRINTED, CYCLE) for row in ROWS if row.number}
# over l, with the printed delta: the exact arm is 0
WITH_PRINTED_DELTA = CYCLE.replaced(delta=PRINTED["delta"](CYCLE))
EQUATIONS["(13)"] = Equation("k1", lambda: (PRINTED["k1"](WITH_PRINTED_DELTA), CYCLE.k1, EXAMPLE.arm))


# --- claims ---

# speed of the carrier of the example, rad/s, and its time for a turn, s
CARRIER_SPEED = EXAMPLE.b * EXAMPLE_SPEED
TURN = 2.0 * np.pi / CARRIER_SPEED


def module_of(m: Mechanism, **values: Any) -> Module:
    """The mechanism as a module with link 2 held, the carrier at its speed; values over these."""
    held = {"link2_inertia": 1e5, "housing_freewheel": False, "output_freewheel": False}
    lengths = {"sun_radius": m.R0, "satellite_radius": m.r, "eccentricity": m.arm, "imbalance_mass": m.m}
    inertias = {"input_inertia": m.J_carrier, "drive_inertia": m.J_wheel}
    others = {"layout": "planar", "omega1": m.b * EXAMPLE_SPEED, "load_torque": 0.0, "tolerance": 1e-9}
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
    speed = m.b * EXAMPLE_SPEED
    return speed * outputs(module_of(m, **values), 2.0 * np.pi / speed, "input_torque_mean")[:, 0]


def shaking(**values: float) -> tuple[float, float]:
    """Largest force, N, and moment about the axis, N m, on the mount over a turn of the carrier."""
    names = "shaking_force_y", "shaking_force_z", "shaking_moment_x"
    y, z, moment = outputs(module_of(EXAMPLE, **values), TURN, *names).T
    return np.hypot(y, z).max(), largest(moment)


def missing(coriolis: Any, turned: Any) -> float:
    """Worst difference of F1 + F2 + Fk from -m a, over the largest m a; Fk at the angle turned from F1."""
    along = (CYCLE.F1 + coriolis * np.exp(1j * turned)) * CYCLE.spoke / EXAMPLE.arm
    return worst(along + CYCLE.F2 * CYCLE.place / CYCLE.rho, CYCLE.force)


def ripple(power: Any) -> float:
    """Mean over a cycle, the first angle being met again at its end, relative to the peak."""
    return float(abs(power[:-1].mean()) / largest(power))
