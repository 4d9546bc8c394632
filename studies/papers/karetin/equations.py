"""Karetin's equations (1)-(33), as the page prints them, errors included, and put right.

Two scans of the page were compared equation by equation: a transcription (scan 000) and a text layer
(scan 003), whose operators stand in the symbol font and can be read. They agree on every sign, factor and
bracket; where they differ or leave something open, it is said here what was taken.

Two frames: that of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They differ by the
turn theta = omega1 t about Ox; in the paper's stop mode they are one. Vectors are of shape (3, n), lengths
of shape (n,), in SI units. Angles are products of speed and time: right to rounding within some turns.
Projections are in the order of the paper: H or L in xOy, P or M in yOz, F or N in xOz.
"""

from __future__ import annotations

from dataclasses import asdict
from functools import cache
from typing import Any

import numpy as np

from ..forms import Forms, Row, in_time, rate, tables, vector
from ..report import Equation, compared
from .mechanism import DYNAMIC, GENERAL, STOP, Geometry, Motion, period

# axes of xOy, yOz and xOz
PLANES = ((0, 1), (1, 2), (0, 2))
SAMPLES = 20_000


def modulus(v: Any) -> Any:
    """Length of a vector: (12), (18), (25) and (33)."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def lengths(v: Any) -> Any:
    """Lengths of the projections of a vector on xOy, yOz and xOz: OH, OP, OF of (4)."""
    return np.stack([np.sqrt(v[one] * v[one] + v[other] * v[other]) for one, other in PLANES])


def cross(one: Any, other: Any) -> Any:
    """Vector product."""
    return np.cross(one, other, axis=0)


def turned_x(v: Any, angle: Any) -> Any:
    """Vectors turned about Ox."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0], v[1] * cosine - v[2] * sine, v[1] * sine + v[2] * cosine)


def turned_z(v: Any, angle: Any) -> Any:
    """Vectors turned about Oz."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0] * cosine - v[1] * sine, v[0] * sine + v[1] * cosine, v[2])


def angles_of(r: Any) -> Any:
    """beta_H = xOH, beta_P = zOP, beta_F = xOF, rad, in the whole circle (-pi, pi]: (5) put right.

    The sense is the paper's: beta_H from Ox to Oy, beta_P from Oz to Oy, beta_F from Ox to Oz; the last
    two are against the right-hand turn about Ox and Oy.
    """
    return np.arctan2(r[[1, 1, 2]], r[[0, 2, 0]])


def angular_velocities_of(r: Any, v: Any) -> Any:
    """omega_H, omega_P, omega_F, the rates of these angles, rad/s: (6) in closed form."""
    return (r[[0, 2, 0]] * v[[1, 1, 2]] - r[[1, 1, 2]] * v[[0, 2, 0]]) / lengths(r) ** 2


def feet_of(r: Any, v: Any) -> Any:
    """Feet L, M, N of the perpendiculars from O on the lines of the projected velocity, m: (26)-(31).

    Nothing is divided by one component of V.

    Returns:
        L, M, N in the fixed frame, m, shape (3, 3, n): by foot, then axis.
    """
    found = np.zeros((3, *r.shape))
    for foot, (one, other) in zip(found, PLANES, strict=True):
        # n (n r) with n across V
        across = (v[other] * r[one] - v[one] * r[other]) / (v[one] ** 2 + v[other] ** 2)
        foot[one], foot[other] = v[other] * across, -v[one] * across
    return found


# (9) and (10) put right point from A to Q; (11), (15) and (22) put right are omega x r about QA, OQ and Ox
ROWS = (
    Row(
        "(1)",
        "speeds",
        "omega1 / i, omega1 * z2 / z16 * (1 - 1 / i), omega1 * z2 / z16 * z17 / z6 * (1 - 1 / i)",
        "omega2, k * (omega1 - omega2), s * k * (omega1 - omega2)",
    ),
    Row("", "speed_of_link2, omega16, omega6", "speeds"),
    Row("", "A", "omega16 * t + gamma"),
    Row("", "B", "omega6 * t + epsilon"),
    # Both scans print O_r Pi in U1. The text lists "the radii Q_r Pi and KPi and the heights O_r Q and QK":
    # O_r is the centre of the base of wheel 17, so O_r Pi is its radius and "Q_r Pi" a misprint of it.
    Row("", "U1", "wheel_radius / sin(psi)"),
    Row("", "U2", "b * cos(phi) * cos(phi + psi - pi / 2)"),
    Row("", "U3", "a * sin(phi)"),
    Row("", "U4", "cos(psi)"),
    Row("", "U5", "U1 * (c * cos(psi) + b * cos(phi) * sin(phi + psi - pi / 2))"),
    Row("", "U6", "U1 * U3 * sin(pi - chi)"),
    # of mixed units: U1 U5 U4 is an area
    Row("", "bracket", "U2 + U5 * U4 * cos(pi - B)"),
    # in the frame that carries OQ, and in the fixed frame
    Row(
        "(2)",
        "position_in_link1",
        "vector(U1 * (bracket * cos(A) + U3 * sin(pi - B) * sin(A)),"
        " U1 * (bracket * sin(A) - U3 * sin(pi - B) * cos(A)), U5 + U6 * cos(pi - B))",
        "centre_of_satellite + arm_of_imbalance",
    ),
    Row("", "D", "position_in_link1"),
    Row("", "x_D, y_D, z_D", "D"),
    Row("", "theta", "carrier * t"),
    Row("", "position", "position_in_link1", "turned_x(position_in_link1, theta)"),
    Row("", "x, y, z", "position"),
    Row("(3)", "radius", "sqrt(x * x + y * y + z * z)"),
    Row("(4)", "projections", "lengths(position)"),
    Row("", "OH, OP, OF", "projections"),
    # printed without the quadrant, fails at x = 0; the index of beta_P is in scan 003 only
    Row(
        "(5)",
        "angles",
        "vector(arctan(y / x), pi / 2 - arccos(y / OP), arccos(x / OF))",
        "angles_of(position)",
    ),
    Row("(6)", "angular_velocities", "rate(angles)", "angular_velocities_of(position, velocity)"),
    Row("(7), (17)", "velocity_in_link1", "about_satellite + about_drive"),
    # A is not printed: by the text it turns with the drive about Oz at the height of U5
    Row(
        "",
        "centre_of_satellite",
        "vector(across * cos(A), across * sin(A), U5)",
        "turned_z(vector(across, 0.0, height), A)",
    ),
    Row("", "x_A, y_A, z_A", "centre_of_satellite"),
    # not as a difference exact however short it is against QA
    Row(
        "(8)",
        "arm_of_imbalance",
        "position_in_link1 - centre_of_satellite",
        "turned_z(-AD * vector(cos(B) * cos(chi), sin(B), cos(B) * sin(chi)), A)",
    ),
    Row("", "x_AD, y_AD, z_AD", "arm_of_imbalance"),
    Row(
        "(9)",
        "spin_of_satellite",
        "mu * centre_of_satellite",
        "turned_z(omega6 * vector(-sin(chi), 0, cos(chi)), A)",
    ),
    Row("", "OA", "modulus(centre_of_satellite)"),
    Row("(10)", "mu", "omega6 / sqrt(OA**2 - 2 * z_A * OQ + OQ**2)", "omega6 / QA"),
    # of mixed units; the second row opens one bracket more than it closes, in both scans: the missing one is
    # taken at its end; the third row has no bracket after mu, which so multiplies the first product only
    Row(
        "(11)",
        "about_satellite",
        "vector(mu * (y_AD * (z_A - OQ) - z_AD * y_A), -mu * (x_AD * (z_A - z_AD * x_A)),"
        " mu * x_AD * y_A - y_AD * x_A)",
        "cross(spin_of_satellite, arm_of_imbalance)",
    ),
    Row("(12)", "speed_about_satellite", "modulus(about_satellite)"),
    Row("(13)", "spin_of_drive", "vector(0.0, 0.0, lambda_ * OQ)", "vector(0.0, 0.0, omega16 + 0.0 * t)"),
    Row("", "omega_H, omega_P, omega_F", "angular_velocities"),
    Row("(14)", "lambda_", "omega_H / OQ", "omega16 / OQ + 0.0 * t"),
    Row(
        "(15)",
        "about_drive",
        "vector(lambda_ * (y_D * OQ), -lambda_ * (x_D * OQ), 0.0)",
        "cross(spin_of_drive, D)",
    ),
    Row("(16)", "speed_about_drive", "sqrt(about_drive[0] ** 2 + about_drive[1] ** 2)"),
    Row("(18)", "speed_in_link1", "modulus(velocity_in_link1)"),
    # omega_P of D in link 1, which exactly is not to be counted
    Row("", "swing_rate", "omega_P", "angular_velocities_of(position_in_link1, velocity_in_link1)[1]"),
    Row("(19)", "alpha", "(omega1 + swing_rate) * t", "omega1 * t"),
    Row("(20)", "spin_of_link1", "vector(v * x_D, 0.0, 0.0)", "vector(carrier + 0.0 * t, 0.0, 0.0)"),
    # the page does not define omega_alpha: by (19) it is taken as omega1 + omega_P, to which (21) adds
    # omega_P again; scan 000 writes v, scan 003 nu and upsilon
    Row("(21)", "v", "(omega1 + swing_rate + swing_rate) / x_D", "carrier / x_D"),
    Row("(22)", "about_centre", "vector(0.0, v * (x_D * z_D), v * (x_D * y_D))", "cross(spin_of_link1, D)"),
    Row("(23)", "sum_of_three", "velocity_in_link1 + about_centre"),
    Row("", "W_x, W_y, W_z", "sum_of_three"),
    Row(
        "(24)", "velocity", "vector(W_x, W_y * sin(alpha), W_z * cos(alpha))", "turned_x(sum_of_three, theta)"
    ),
    Row("", "V_x, V_y, V_z", "velocity"),
    Row("(25)", "speed", "modulus(velocity)"),
    # feet, arms OL, OM, ON, and V on xOy, yOz, xOz; printed slopes are infinite where the divisor is 0
    Row("", "feet", "feet_of(position, velocity)"),
    Row("", "arms", "sqrt((feet**2).sum(axis=1))"),
    Row("", "plane_speeds", "lengths(velocity)"),
    Row("", "x_L", "(x + k1 * y) / (k1**2 + 1)"),
    Row("(26)", "foot_L", "vector(x_L, k1 * x_L)", "feet[0, :2]"),
    Row("(27)", "k1", "-V_x / V_y"),
    Row("(28)", "arm_L", "sqrt(foot_L[0] ** 2 + foot_L[1] ** 2)", "arms[0]"),
    Row("(29)", "speed_L", "sqrt(V_x**2 + V_y**2)", "plane_speeds[0]"),
    Row("", "k2", "-V_z / V_y"),
    Row("", "z_M", "(z + k2 * y) / (k2**2 + 1)"),
    Row("(30)", "foot_M", "vector(z_M, k2 * z_M)", "feet[1, [2, 1]]"),
    Row("", "k3", "-V_z / V_x"),
    Row("", "z_N", "(z + k3 * x) / (k3**2 + 1)"),
    # to the letter N is at (0, k3 z_N, z_N); the arm V_ON takes an x_N that is never given
    Row("(31)", "foot_N", "vector(0.0, k3 * z_N, z_N)", "feet[2]"),
    # exact: centripetal parts of satellite, drive and link 1, between them those of Coriolis
    Row(
        "(32)",
        "acceleration",
        "rate(velocity)",
        "turned_x(cross(spin_of_satellite + 2 * (spin_of_drive + spin_of_link1), about_satellite) + "
        "cross(spin_of_drive + 2 * spin_of_link1, about_drive) + cross(spin_of_link1, about_centre), theta)",
    ),
    Row("(33)", "acceleration_modulus", "modulus(acceleration)"),
)
PRINTED, EXACT = tables(
    ROWS, vector, rate, modulus, lengths, cross, turned_x, turned_z, angles_of, angular_velocities_of, feet_of
)


def inputs(g: Geometry, motion: Motion, t: Any) -> dict[str, Any]:
    """Mechanism and motion by the symbols of the paper, i = omega1/omega2 of (1), times."""
    lengths = {
        name: getattr(g, name) for name in ("s", "k", "phi", "psi", "AD", "QA", "OQ", "across", "height")
    }
    i = motion.omega1 / motion.omega2 if motion.omega2 else np.inf
    return {
        **asdict(g),
        **lengths,
        **motion._asdict(),
        "chi": g.shaft_angle,
        "i": i,
        "t": t,
        "g": g,
        "motion": motion,
    }


def exact(g: Geometry, motion: Motion, t: Any) -> Forms:
    """The exact forms at times, s, shape (n,)."""
    return Forms(EXACT, **inputs(g, motion, np.asarray(t)))


def printed(g: Geometry, motion: Motion, times: Any, name: str) -> Any:
    """A quantity of the page, all equations in a row, each fed with the printed results before it.

    Args:
        times: s, shape (n,). name: one of PRINTED, but not the accelerations: velocities hold rates already.

    Returns:
        Shape (n,) or (3, n); where the page divides by zero it is not finite.
    """
    with np.errstate(all="ignore"):
        return np.real(getattr(Forms(PRINTED, **inputs(g, motion, in_time(times))), name))


@cache
def over_period(geometry: Geometry = GENERAL, motion: Motion = STOP) -> Forms:
    """The exact forms at SAMPLES times over a period, between the instants at which something may vanish."""
    return exact(geometry, motion, (np.arange(SAMPLES) + 0.5) / SAMPLES * period(geometry, motion))


# (2) to (18) are judged in the stop mode, the others in the dynamic mode; and worked out with their rates
STOPPED, MOVING = over_period(GENERAL, STOP), over_period(GENERAL, DYNAMIC)
STOPPED_IN_TIME, MOVING_IN_TIME = (exact(e.g, e.motion, in_time(e.t)) for e in (STOPPED, MOVING))


def _angular_velocities() -> tuple[Any, ...]:
    """Rates of the exact angles, whose quadrant does not count."""
    x, y, z = STOPPED_IN_TIME.position
    return rate(np.arctan(vector(y / x, y / z, z / x))), STOPPED.angular_velocities


def _summed(name: str, e: Forms, as_of: Forms) -> Equation:
    """A sum of velocities in the frame that carries OQ against the rate of the exact place."""
    return Equation(name, lambda: (PRINTED[name](e), turned_x(rate(as_of.position), -e.theta)))


def _coefficient_v() -> tuple[Any, ...]:
    """Product v x_D, which (20) and (22) use: v itself has no largest value."""
    x = MOVING.position_in_link1[0]
    return PRINTED["v"](MOVING) * x, MOVING.v * x


def _slope() -> tuple[Any, ...]:
    """Angle of the slope: the slope has no largest value. The foot is as steep as OL."""
    return np.arctan(MOVING.k1), np.arctan(MOVING.foot_L[1] / MOVING.foot_L[0])


SUM_IN_LINK1 = _summed("velocity_in_link1", STOPPED, STOPPED_IN_TIME)
SPECIAL = {
    "(6)": Equation("angular_velocities", _angular_velocities),
    "(7)": SUM_IN_LINK1,
    "(17)": SUM_IN_LINK1,
    "(21)": Equation("v", _coefficient_v),
    "(23)": _summed("sum_of_three", MOVING, MOVING_IN_TIME),
    "(27)": Equation("k1", _slope),
    "(32)": Equation("acceleration", lambda: (rate(MOVING_IN_TIME.velocity), MOVING.acceleration)),
}
NAMES = {number: row.name for row in ROWS for number in row.number.split(", ")}
EQUATIONS = {
    number: SPECIAL.get(number) or compared(NAMES[number], PRINTED, STOPPED if 1 < n < 19 else MOVING)
    for n, number in ((n, f"({n})") for n in range(1, 34))
}
