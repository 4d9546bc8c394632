"""Lysenko's equations (1) to (24), as the page has them, errors kept, and exact.

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
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..forms import Forms, Row, tables
from ..report import Equation, compared


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


def arcsin_of(sine: Any) -> Any:
    """Arcsine; rounding alone can carry a sine past one: |D sin alpha| <= rho always."""
    return np.arcsin(np.clip(sine, -1.0, 1.0))


def root_of(square: Any) -> Any:
    """Square root; rounding alone can make the square negative."""
    return np.sqrt(np.maximum(square, 0.0))


def moment(place: Any, force: Any) -> Any:
    """Moment of a force at a place, about where the place is counted from."""
    return (np.conj(place) * force).imag


def parts(place: Any) -> tuple[Any, Any]:
    """Both coordinates of a place."""
    return place.real, place.imag


def reduced_inertia(m: Mechanism, alpha: Any) -> Any:
    """J_carrier + J_wheel ((1 + b)/b)^2 + m |dS/dtheta|^2, reduced to the carrier, kg m^2: for (19)."""
    ratio, turns = m.arm / m.r, m.centre_distance / m.r
    swing = (1.0 - ratio) ** 2 + 4.0 * ratio * np.sin(0.5 * np.asarray(alpha)) ** 2
    return m.J_carrier + m.J_wheel * turns**2 + m.m * m.centre_distance**2 * swing


def speed_ratio(m: Mechanism) -> float:
    """omega_max / omega_min of the free mechanism, sqrt(J_red,max / J_red,min): corrects (21).

    It has no bound where l = r and the links have no inertia.
    """
    return float(np.sqrt(reduced_inertia(m, np.pi) / reduced_inertia(m, 0.0)))


ROWS = (
    # O1 to the imbalance, O to it, its velocity, and the inertia force -m a
    Row("", "spoke", "-l * exp(1j * alpha)"),
    Row("", "place", "D + spoke"),
    Row("", "velocity", "1j * omega * (b * D + (1 + b) * spoke)"),
    Row("", "force", "m * omega**2 * (b**2 * D + (1 + b) ** 2 * spoke)"),
    Row(
        "(1)",
        "epicycloid",
        "D * cos(b * alpha) - l * cos((1 + b) * alpha), D * sin(b * alpha) - l * sin((1 + b) * alpha)",
        "parts(place * exp(1j * b * alpha))",
    ),
    Row("(2)", "rho", "root_of(D**2 + l**2 - 2 * D * l * cos(alpha))", "abs(place)"),
    # used nowhere else
    Row("(2), note", "rho_of_note", "root_of(D**2 + l**2 - 2 * D * l * cos(b * alpha))", "rho"),
    Row("(3)", "F1", "m * l * omega**2", "m * omega**2 * abs(spoke)"),
    Row("(4)", "F2", "m * rho * b**2 * omega**2"),
    # put right the same at every angle
    Row("(5)", "Fk", "2 * m * V * b * omega", "2 * m * b * omega * (l * omega)"),
    Row("", "V1, V2", "l * omega, rho * b * omega"),
    Row("(6)", "resultant", "sqrt(V1**2 + V2**2 - 2 * V1 * V2 * cos(pi - beta1))", "V"),
    Row("", "root", "sqrt(l**2 + (rho * b) ** 2 + 2 * l * rho * b * cos(beta1))", "V / omega"),
    Row("(7)", "V", "omega * root", "abs(velocity)"),
    # printed never beyond pi/2; exact from O1 S to O S, -pi to pi
    Row("(8)", "beta1", "arcsin_of(D * sin(alpha) / rho)", "angle(place / spoke)"),
    # moments of the forces by their arms (11) to (14): the Coriolis force is in line with F1
    Row("(9)", "M1_of_forces", "F2 * n2 + Fk * k1", "M1"),
    Row("(10)", "M_of_forces", "-F1 * n1 - F2 * n2 - Fk * k2", "M"),
    Row("(11)", "n1", "D * sin(alpha)", "-moment(D, spoke) / l"),
    Row("(12)", "n2", "D * l * sin(alpha) / rho", "moment(spoke, place) / rho"),
    # the angle in (13), from V to b omega OS
    Row(
        "", "delta", "arcsin_of(l * D * sin(alpha) / (rho * root))", "angle(1j * place * conjugate(velocity))"
    ),
    Row("(13)", "k1", "l * sin(beta1 - delta)", "0.0 * alpha"),
    Row("(14)", "k2", "D * sin(alpha + beta1 - delta)", "n1"),
    # on wheel 1 about O1, m b^2 omega^2 l D sin alpha: F1 and Fk pass through O1
    Row(
        "(15)",
        "M1",
        "m * b * l * omega**2 * (b * D * sin(alpha) + 2 * root * sin(beta1 - delta))",
        "moment(spoke, force)",
    ),
    # about O, -m D (1 + 2 b) l omega^2 sin alpha: what drive and held wheel have to balance
    Row(
        "(16)",
        "M",
        "-m * D * omega**2 * (l * (1 + b**2) * sin(alpha) + 2 * b * root * sin(alpha + beta1 - delta))",
        "moment(place, force)",
    ),
    # powers: together all the inertia forces do, at constant speed minus the power of the drive
    Row("(17)", "N1", "M1 * omega"),
    Row("(18)", "N", "M * b * omega"),
    # farthest from O and nearest to it; exact energies with omega that of the carrier
    Row("(19)", "J", "links + m * rho**2"),
    Row("(20)", "J_limits", "links + m * (D + l) ** 2, links + m * (D - l) ** 2", "J_at(pi), J_at(0.0)"),
    Row("", "J_max, J_min", "J_limits"),
    Row("(21)", "omega_max", "omega * J_max / J_min", "omega * sqrt(J_red_max / J_red_min)"),
    Row("(22)", "T1", "J_max * omega**2 / 2", "J_red_max * omega**2 / 2"),
    Row("(23)", "T2", "J_min * omega_max**2 / 2", "J_red_min * omega_max**2 / 2"),
    Row("(24)", "T2_of_T1", "T1 * J_max / J_min", "T1"),
    # of all links
    Row("", "J_red, J_red_max, J_red_min", "J_red_at(alpha), J_red_at(pi), J_red_at(0.0)"),
    Row("", "kinetic_energy", "J_red * (b * omega) ** 2 / 2"),
    Row("", "links_momentum", "J_carrier * b * omega + J_wheel * (1 + b) * omega"),
    Row("", "angular_momentum", "links_momentum + m * moment(place, velocity)"),
    # at the carrier by Lagrange, J_red theta'' + J_red' theta'^2 / 2; steadily -(M + M1/b)
    Row("", "drive_torque", "J_red * b * omega_rate + m * D**2 * l / r * b * sin(alpha) * omega**2"),
    Row("", "drive_power", "drive_torque * b * omega"),
    # of wheel 1 on the carrier in free motion, omega being that at alpha = pi
    Row("", "free_speed", "omega * sqrt(J_red_max / J_red)"),
)
PRINTED, EXACT = tables(ROWS, arcsin_of, root_of, moment, parts)


def _inputs(m: Mechanism, alpha: Any, omega: Any, known: dict[str, Any]) -> dict[str, Any]:
    """By the symbols of the paper; links: their constant inertia."""
    lengths = {**asdict(m), "D": m.centre_distance, "l": m.arm, "b": m.b, "links": m.J_carrier + m.J_wheel}
    inertias = {
        "J_at": lambda angle: exact(m, angle).J,
        "J_red_at": lambda angle: reduced_inertia(m, angle),
    }
    return lengths | inertias | {"alpha": np.asarray(alpha), "omega": omega, "omega_rate": 0.0} | known


def printed(m: Mechanism, alpha: Any, omega: Any, **known: Any) -> Forms:
    """Results of the page for dimensions, angle (rad) and speed (rad/s), its equations in a row.

    Args:
        m: dimensions. alpha, omega: numbers or of shape (n,). known: quantities in place of the printed.
    """
    return Forms(PRINTED, **_inputs(m, alpha, omega, known))


def exact(m: Mechanism, alpha: Any, omega: Any = 1.0, **known: Any) -> Forms:
    """The exact forms at angles of wheel 1 on the carrier, rad, and its speed, rad/s.

    Args:
        m: dimensions. alpha, omega: numbers or of shape (n,). known: as omega_rate, rad/s^2, if not steady.
    """
    return Forms(EXACT, **_inputs(m, alpha, omega, known))


# l = r as in the paper, b = 1/3 (three cycles a turn); speed of wheel 1 relative to the carrier, rad/s
EXAMPLE = Mechanism(R0=0.06, r=0.02, arm=0.02, m=1.0, J_carrier=2e-3, J_wheel=5e-5)
EXAMPLE_SPEED = 100.0
# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between the cusps, where the speed is 0 and the page divides by it
INSIDE = ALPHA[1:-1]
CYCLE = exact(EXAMPLE, INSIDE, EXAMPLE_SPEED)


def _arm_of_coriolis_force() -> tuple[Any, ...]:
    """With the printed delta, over l: the exact arm is 0."""
    return PRINTED["k1"](CYCLE.replaced(delta=PRINTED["delta"](CYCLE))), CYCLE.k1, EXAMPLE.arm


EQUATIONS = {row.number: compared(row.name, PRINTED, CYCLE) for row in ROWS if row.number}
EQUATIONS["(13)"] = Equation("k1", _arm_of_coriolis_force)
