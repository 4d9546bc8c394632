"""Lysenko: printed and exact equations (1) to (24) of the inertial gear, and claims.

V. S. Lysenko, S. Zh. Praliev, B. T. Suleimenov, S. D. Baubekov, Analysis of the inertial gear.

The paper writes R for R0 and uses phi in (1) and (2) and alpha elsewhere for the angle of wheel 1 on the
carrier. omega is the rate of this angle. It is constant unless stated; in (21) to (24) it is the minimum
rate. Results are in SI units and have the shape of alpha.

Exact positions and forces are complex numbers in the frame of the carrier, whose real axis is O to O1. The
imbalance S is at O1 - l exp(i alpha), so it is nearest to O at alpha = 0. Inertia forces, with e from O1 to
S:

    F1 = m l omega^2 e,  F2 = m b^2 omega^2 OS,  Fk = 2 m b omega (l omega) e,  sum = -m a

Fk uses the speed l omega relative to the carrier. The carrier turns in the same direction, so Fk is parallel
to e and to F1. Moments are positive in the direction of omega.

While wheel 2 is fixed, one angle describes the mechanism. Its energy is J_red(alpha) theta'^2 / 2, with the
angle of the carrier theta = b alpha. The fixed wheel transmits a torque, so angular momentum about O is not
conserved. Without a drive torque the energy is constant.

Claims on friction, weight, vibration and drive power are tested with the module and its losses. Wheel 2 is
link 2 with a very large inertia, as in examples/papers/lysenko_wheel.toml. The default is no losses and no
gravity.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from inertia_module.model import Module

from .engine import Equation, Forms, Formulas, compared, max_abs, max_difference, tables

# losses of examples/real_machine.toml
LOSSES = {
    "mesh_efficiency": 0.99,
    "journal_friction": 2.5e-5,
    "input_friction": 2e-3,
    "drive_friction": 2.5e-4,
}
# communication steps of a run of the module
STEPS = 900


@dataclass(frozen=True)
class Mechanism:
    """Wheel 1 with the imbalance, rolling around the fixed wheel 2 on carrier 3, in the horizontal plane.

    Attributes:
        R0: Radius of the fixed wheel 2 (R in the paper), m.
        r: Radius of wheel 1, m.
        arm: Distance l of the imbalance from the axis O1 of wheel 1, m; l = r in the paper's example.
        m: Mass of the imbalance, kg.
        J_carrier: Moment of inertia of the carrier about O with the mass of wheel 1, kg·m².
        J_wheel: Moment of inertia of wheel 1 about its axis O1 without the imbalance, kg·m².
    """

    R0: float
    r: float
    arm: float
    m: float
    J_carrier: float = 0.0
    J_wheel: float = 0.0

    @property
    def b(self) -> float:
        """Return the modulus b = r/R0 of the epicycloid: speed of the carrier over speed of wheel 1."""
        return self.r / self.R0

    @property
    def centre_distance(self) -> float:
        """Return the distance D = O O1 = R0 (1 + b), m."""
        return self.R0 + self.r


def moment(place: Any, force: Any) -> Any:
    """Return the moment of a force about the origin, N·m.

    Args:
        place: Position, complex, m.
        force: Force, complex, N.
    """
    return (np.conj(place) * force).imag


ROWS, PRINTED, EXACT = tables("lysenko", globals())


def forms(formulas: Formulas, m: Mechanism, alpha: Any, omega: Any = 1.0, **values: Any) -> Forms:
    """Return the results of formulas for a mechanism and its motion.

    Args:
        formulas: PRINTED (with printed results as inputs) or EXACT.
        m: Dimensions.
        alpha: Angle of wheel 1 on the carrier, rad, number or shape (n,).
        omega: Rate of alpha, rad/s, number or shape (n,).
        values: Values that override formulas, or omega_rate, rad/s², if the rate is not constant.
    """
    lengths = {**asdict(m), "D": m.centre_distance, "l": m.arm, "b": m.b, "links": m.J_carrier + m.J_wheel}
    motion = {"alpha": np.asarray(alpha), "omega": omega, "omega_rate": 0.0}
    return Forms(formulas, **lengths | motion | {"at": lambda angle: exact(m, angle)} | values)


printed, exact = partial(forms, PRINTED), partial(forms, EXACT)

# l = r as in the paper, b = 1/3 (three cycles per turn), and the rate of alpha, rad/s
EXAMPLE = Mechanism(R0=0.06, r=0.02, arm=0.02, m=1.0, J_carrier=2e-3, J_wheel=5e-5)
EXAMPLE_SPEED = 100.0
# number of intervals is even, so that 0 and pi are included, where the quadrant of arcsin changes
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between the cusps, where the speed is 0 and the page divides by it
INSIDE = ALPHA[1:-1]
CYCLE = exact(EXAMPLE, INSIDE, EXAMPLE_SPEED)


EQUATIONS = {row.number: compared(row.name, PRINTED, CYCLE) for row in ROWS if row.number}
# relative to l, with the printed delta, because the exact arm is 0
WITH_PRINTED_DELTA = CYCLE.replaced(delta=PRINTED["delta"](CYCLE))
EQUATIONS["(13)"] = Equation("k1", lambda: (PRINTED["k1"](WITH_PRINTED_DELTA), CYCLE.k1, EXAMPLE.arm))


# --- claims ---

# speed of the carrier of the example, rad/s, and duration of its turn, s
CARRIER_SPEED = EXAMPLE.b * EXAMPLE_SPEED
TURN = 2.0 * np.pi / CARRIER_SPEED


def module_of(m: Mechanism, **values: Any) -> Module:
    """Return the mechanism as a started module with a fixed link 2.

    Args:
        m: Dimensions.
        values: Parameters and inputs that override the defaults.
    """
    fixed = {"link2_inertia": 1e5, "housing_freewheel": False, "output_freewheel": False}
    lengths = {"sun_radius": m.R0, "satellite_radius": m.r, "eccentricity": m.arm, "imbalance_mass": m.m}
    inertias = {"input_inertia": m.J_carrier, "drive_inertia": m.J_wheel}
    others = {"layout": "planar", "omega1": m.b * EXAMPLE_SPEED, "load_torque": 0.0, "tolerance": 1e-9}
    return Module().start(**{**fixed, **lengths, **inertias, **others, **values})


def outputs(module: Module, time: float, *names: str) -> Any:
    """Run a module and return outputs after each of STEPS steps, shape (STEPS, number of names).

    Args:
        module: The module.
        time: Duration, s.
        names: Names of the outputs.
    """
    rows = []
    for _ in range(STEPS):
        module.advance(time / STEPS)
        rows.append(module.read(names))
    return np.array(rows)


def drive_power(m: Mechanism, **values: float) -> Any:
    """Return the drive power over a turn of the carrier at constant speed, W, shape (STEPS,).

    Args:
        m: Dimensions.
        values: Parameters that override the defaults.
    """
    speed = m.b * EXAMPLE_SPEED
    return speed * outputs(module_of(m, **values), 2.0 * np.pi / speed, "input_torque_mean")[:, 0]


def shaking(**values: float) -> tuple[float, float]:
    """Return the maximum force, N, and moment about the axis, N·m, on the mount over a turn of the carrier.

    Args:
        values: Parameters that override the defaults.
    """
    names = "shaking_force_y", "shaking_force_z", "shaking_moment_x"
    y, z, moment = outputs(module_of(EXAMPLE, **values), TURN, *names).T
    return np.hypot(y, z).max(), max_abs(moment)


def missing(coriolis: Any, turned: Any) -> float:
    """Return the maximum difference of F1 + F2 + Fk and -m a relative to the maximum m a.

    Args:
        coriolis: Force Fk, N, shape (n,).
        turned: Angle from F1 to Fk, rad.
    """
    along = (CYCLE.F1 + coriolis * np.exp(1j * turned)) * CYCLE.spoke / EXAMPLE.arm
    return max_difference(along + CYCLE.F2 * CYCLE.place / CYCLE.rho, CYCLE.force)


def ripple(power: Any) -> float:
    """Return the magnitude of the mean over a cycle, relative to the maximum magnitude.

    Args:
        power: Values over a cycle, whose first and last angle are the same, shape (n,).
    """
    return float(abs(power[:-1].mean()) / max_abs(power))
