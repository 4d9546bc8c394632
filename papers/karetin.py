"""Karetin (2020): kinematics of the imbalance of the bevel inertia module, equations (1) to (33).

V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111, doi 10.33249/2663-2144-2020-92-7-104-111.

The equations stand as the page prints them, errors included, and put right. Two scans of the page were
compared equation by equation: a transcription (scan 000) and a text layer (scan 003), whose operators stand
in the symbol font and can be read. They agree on every sign, factor and bracket; where they differ or leave
something open, it is said here what was taken.

Two frames: that of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They differ by the
turn theta = omega1 t about Ox; in the paper's stop mode they are one. Vectors are of shape (3, n), lengths
of shape (n,), in SI units. Angles are products of speed and time: right to rounding within some turns.
Projections are in the order of the paper: H or L in xOy, P or M in yOz, F or N in xOz.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from .engine import ROUNDING, Equation, Forms, compared, in_time, rate, tables, vector

# axes of xOy, yOz and xOz
PLANES = ((0, 1), (1, 2), (0, 2))
SAMPLES = 20_000
# offset of the imbalance where its effect is looked at, rad
OFFSET = 0.5
# grid of the search for an instant of symmetry, and times on either side of it that are compared
INSTANTS, COMPARED = 400, 250


@dataclass(frozen=True)
class Geometry:
    """One inertia module in the standard layout.

    Names, ranges and defaults (scene R1) are those of the parameters of the FMU.

    Attributes:
        z2, z16, z17, z6: teeth. shaft_angle: angle Sigma = phi + psi between the axes QA and OQ, rad, the
            paper's chi as well. wheel_radius: pitch radius O_r Pi of wheel 17, m.
        a, b, c: AD, QA and OQ over their lengths in the pitch cones (KPi, QK, O_r Q).
        epsilon, gamma: offsets of the imbalance about QA and OQ at the time 0, rad.
        s: turns of the satellite 6 on the drive per turn of the drive 16, z17/z6.
        k: turns of the drive in link 1 per turn of link 1 against link 2, z2/z16.
        phi, psi: half angles of the pitch cones of the satellite and of wheel 17, rad.
        L: length of the generatrix Q Pi, U1 of equation (2), m.
        AD, QA, OQ: arm of the imbalance, offset of its plane on the satellite's axis, place of Q, m.
            QA is negative where phi > pi/2 (internal satellite), OQ where psi > pi/2.
        across, height: of A from OQ and above the plane z = 0, m: QA sin(Sigma), OQ - QA cos(Sigma).
        turns_in_period: turns of the drive after which drive and satellite are as they were.
    """

    z2: int = 20
    z16: int = 20
    z17: int = 34
    z6: int = 20
    shaft_angle: float = math.pi / 2
    wheel_radius: float = 0.08
    a: float = 1.0
    b: float = 1.0
    c: float = 1.0
    epsilon: float = 0.0
    gamma: float = 0.0

    s = cached_property(lambda g: g.z17 / g.z6)
    k = cached_property(lambda g: g.z2 / g.z16)
    _sine = cached_property(lambda g: math.sin(g.shaft_angle))
    # s + cos and 1 + s cos without the cancellation near Sigma = pi, where both can vanish
    _half = cached_property(lambda g: 2.0 * math.cos(0.5 * g.shaft_angle) ** 2)
    _along_satellite = cached_property(lambda g: (g.z17 - g.z6) / g.z6 + g._half)
    _along_drive = cached_property(lambda g: (g.z6 - g.z17) / g.z6 + g.s * g._half)
    # rolling without slip: s = sin psi / sin phi, so the cones follow from s and Sigma
    _scale = cached_property(lambda g: g.wheel_radius / (g.s * g._sine))
    phi = cached_property(lambda g: math.atan2(g._sine, g._along_satellite))
    psi = cached_property(lambda g: math.atan2(g.s * g._sine, g._along_drive))
    L = cached_property(lambda g: g._scale * math.hypot(g.s * g._sine, g._along_drive))
    AD = cached_property(lambda g: g.a * g.wheel_radius / g.s)
    QA = cached_property(lambda g: g.b * g._scale * g._along_satellite)
    OQ = cached_property(lambda g: g.c * g._scale * g._along_drive)
    across = cached_property(lambda g: g.b * g.wheel_radius * g._along_satellite / g.s)
    # with b = c the huge OQ and QA cos(Sigma) of a small Sigma cancel: written out
    height = cached_property(
        lambda g: (g.c - g.b) * g._scale * g._along_drive + g.b * g.wheel_radius * g._sine / g.s
    )
    turns_in_period = cached_property(lambda g: g.z6 // math.gcd(int(g.z17), int(g.z6)))


class Motion(NamedTuple):
    """Steady speeds of the links.

    Attributes:
        omega1: of link 1, rad/s. omega2: of link 2, rad/s.
        carrier: speed about Ox of the frame that carries the axis OQ, rad/s. In the mechanism that is
            link 1. The paper's stop mode has OQ at rest on Oz: its motion is the one seen from link 1.
    """

    omega1: float
    omega2: float
    carrier: float


def stop_mode(omega1: float) -> Motion:
    """The paper's stop mode: i = infinity, omega2 = 0, OQ at rest on Oz; omega1 against link 2, rad/s."""
    return Motion(omega1, 0.0, 0.0)


def dynamic_mode(omega1: float, transmission: float) -> Motion:
    """The dynamic mode, in which link 1 turns with omega1, rad/s, and carries OQ.

    Args:
        omega1: speed of link 1, rad/s.
        transmission: i = omega1/omega2, not 0; math.inf with link 2 held.
    """
    return Motion(omega1, omega1 / transmission, omega1)


def period(geometry: Geometry, motion: Motion) -> float:
    """Time after which drive and satellite stand in link 1 as before, s; the drive must turn."""
    drive = geometry.k * (motion.omega1 - motion.omega2)
    return float(2.0 * math.pi * geometry.turns_in_period / abs(drive))


# the paper gives no numbers; the scene R1: pole of the cones, no offsets
STANDARD = Geometry()
# s is whole, as the paper has it, for whom one turn of the drive is one period: its figures are drawn so
PAPER = Geometry(z17=40, z6=20)
# nothing vanishes or cancels, and D changes sides of every plane: the equations are judged on this one
GENERAL = Geometry(shaft_angle=math.radians(80.0), a=0.9, b=1.1, c=0.7, epsilon=0.4, gamma=0.3)
STOP = stop_mode(100.0)
# the link 1 closes with drive and satellite after ten turns of the drive, twenty of its own
DYNAMIC = dynamic_mode(100.0, 2.0)
MODES = STOP, DYNAMIC


def modulus(v: Any) -> Any:
    """Length of a vector: (12), (18), (25) and (33)."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def lengths(v: Any) -> Any:
    """Lengths of the projections of a vector on xOy, yOz and xOz: OH, OP, OF of (4)."""
    return np.stack([np.sqrt(v[one] * v[one] + v[other] * v[other]) for one, other in PLANES])


def turned_x(v: Any, angle: Any) -> Any:
    """Vectors turned about Ox."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0], v[1] * cosine - v[2] * sine, v[1] * sine + v[2] * cosine)


def turned_z(v: Any, angle: Any) -> Any:
    """Vectors turned about Oz."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0] * cosine - v[1] * sine, v[0] * sine + v[1] * cosine, v[2])


def angular_velocities_of(r: Any, v: Any) -> Any:
    """omega_H, omega_P, omega_F, the rates of the angles (5), rad/s: (6) in closed form."""
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


ROWS, PRINTED, EXACT = tables("karetin", globals())


def inputs(g: Geometry, motion: Motion, t: Any) -> dict[str, Any]:
    """Mechanism and motion by the symbols of the paper, i = omega1/omega2 of (1), times."""
    names = ("s", "k", "phi", "psi", "AD", "QA", "OQ", "across", "height")
    known: dict[str, Any] = {**asdict(g), **motion._asdict(), "chi": g.shaft_angle, "t": t}
    known |= {name: getattr(g, name) for name in names}
    i = motion.omega1 / motion.omega2 if motion.omega2 else np.inf
    return known | {"i": i, "g": g, "motion": motion}


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


def _summed(name: str, e: Forms, as_of: Forms) -> Equation:
    """A sum of velocities in the frame that carries OQ against the rate of the exact place."""
    return Equation(name, lambda: (PRINTED[name](e), turned_x(rate(as_of.position), -e.theta)))


NAMES = {number: row.name for row in ROWS for number in row.number.split(", ")}
EQUATIONS = {
    number: compared(NAMES[number], PRINTED, STOPPED if 1 < n < 19 else MOVING)
    for n, number in ((n, f"({n})") for n in range(1, 34))
}
EQUATIONS |= {
    # of tangents, for which the quadrant does not count
    "(6)": Equation(
        "angular_velocities", lambda: (rate(np.arctan(STOPPED_IN_TIME.tangents)), STOPPED.angular_velocities)
    ),
    "(7)": _summed("velocity_in_link1", STOPPED, STOPPED_IN_TIME),
    # v has no largest value, v x_D, which (20) and (22) use, has one; so has the angle of the slope k1, as
    # which the foot is as steep
    "(21)": Equation("v", lambda: (PRINTED["v"](MOVING) * MOVING.x_D, MOVING.v * MOVING.x_D)),
    "(23)": _summed("sum_of_three", MOVING, MOVING_IN_TIME),
    "(27)": Equation("k1", lambda: (np.arctan(MOVING.k1), np.arctan(MOVING.foot_L[1] / MOVING.foot_L[0]))),
    "(32)": Equation("acceleration", lambda: (rate(MOVING_IN_TIME.velocity), MOVING.acceleration)),
}
EQUATIONS["(17)"] = EQUATIONS["(7)"]


# --- claims ---

# Conclusion 2 is about instants of symmetry. With q = omega16 t the angles are A = q + gamma and
# B = s q + epsilon. About q = (n pi - epsilon)/s, where B is a multiple of pi, the radial place of D is even
# and the tangential one odd. So only A there, gamma - epsilon/s + n pi/s, decides: epsilon and gamma count
# through gamma - epsilon/s alone, and not at all in the moduli of the stop mode, for which no direction
# across OQ is special.


def best_mirror(f: Callable[[Any], Any], span: float, sign: float = 1.0) -> tuple[float, float]:
    """Find the instant about which a periodic function is mirrored best.

    Args:
        f: of times, s, shape (n,), to values, shape (n,). span: period of the function, s.
        sign: 1 for mirrored, -1 for mirrored with the opposite sign (a function of mean 0).

    Returns:
        The largest |f(instant + u) - sign f(instant - u)| over the range of f, the least that any instant
        gives, 0 for a constant; and that instant, s.
    """
    dt, index = span / INSTANTS, np.arange(INSTANTS)
    samples, u = f(dt * index), np.linspace(0.0, 0.5 * span, COMPARED)
    if np.ptp(samples) <= ROUNDING * np.abs(samples).max():
        return 0.0, 0.0

    def difference(instant: float) -> float:
        return float(np.abs(f(instant + u) - sign * f(instant - u)).max())

    mirrored = samples[(index[:, None] - index) % INSTANTS]
    coarse = np.abs(samples - sign * mirrored).max(axis=1)
    found = [
        minimize_scalar(
            difference, bounds=(0.5 * dt * (m - 2), 0.5 * dt * (m + 2)), options={"xatol": 1e-9 * span}
        )
        for m in np.argsort(coarse)[:4]
    ]
    best = min(found, key=lambda one: one.fun)
    return float(best.fun / np.ptp(samples)), float(best.x)


def asymmetry(name: str, g: Geometry, motion: Motion) -> float:
    """Asymmetry of one of the exact moduli over the period of the motion in link 1."""
    return best_mirror(lambda t: getattr(exact(g, motion, t), name), period(g, motion))[0]


def asymmetry_of_components(g: Geometry, motion: Motion) -> float:
    """Largest asymmetry of V_x, V_y, V_z over that period, mirrored with either sign."""
    span = period(g, motion)
    components = [lambda t, axis=axis: exact(g, motion, t).velocity[axis] for axis in range(3)]
    return max(min(best_mirror(v, span, sign)[0] for sign in (1.0, -1.0)) for v in components)
