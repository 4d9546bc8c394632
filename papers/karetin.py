"""Karetin (2020): kinematics of the imbalance of the bevel inertia module, equations (1) to (33).

V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111, doi 10.33249/2663-2144-2020-92-7-104-111.

The tables contain the equations as printed, with their errors, and corrected. Two scans were compared
equation by equation: a transcription (scan 000) and a text layer (scan 003), whose operators in the symbol
font are readable. They agree on every sign, factor and bracket. Comments state the choice at each ambiguous
place.

There are two frames: the frame of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They
differ by the rotation theta = omega1 t about Ox and are identical in the paper's stop mode. Vectors have
shape (3, n), lengths shape (n,), in SI units. Projections are in the order of the paper: H or L in xOy, P or
M in yOz, F or N in xOz.
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
# offset of the imbalance whose effect is computed, rad
OFFSET = 0.5
# search for an instant of symmetry: grid points, and compared times on either side
N_INSTANTS, N_COMPARED = 400, 250


@dataclass(frozen=True)
class Geometry:
    """Inertia module in the standard layout.

    Names, ranges and defaults (scene R1) are the same as for the parameters of the FMU.

    Attributes:
        z2: Number of teeth of wheel 2.
        z16: Number of teeth of the pinion 16.
        z17: Number of teeth of wheel 17.
        z6: Number of teeth of the satellite 6.
        shaft_angle: Angle Sigma = phi + psi between the axes QA and OQ, rad (chi in the paper).
        wheel_radius: Pitch radius O_r Pi of wheel 17, m.
        a: AD over its length KPi in the pitch cones.
        b: QA over its length QK in the pitch cones.
        c: OQ over its length O_r Q in the pitch cones.
        epsilon: Offset of the imbalance about QA at time 0, rad.
        gamma: Offset of the imbalance about OQ at time 0, rad.
        s: Turns of the satellite 6 on the pinion shaft per turn of the pinion 16, z17/z6.
        k: Turns of the pinion shaft in link 1 per turn of link 1 relative to link 2, z2/z16.
        phi: Half angle of the pitch cone of the satellite, rad.
        psi: Half angle of the pitch cone of wheel 17, rad.
        L: Length of the generatrix Q Pi, U1 of equation (2), m.
        AD: Arm of the imbalance, m.
        QA: Offset of the plane of the imbalance on the satellite axis, m; negative if phi > pi/2 (internal
            satellite).
        OQ: Position of Q, m; negative if psi > pi/2.
        across: Distance of A from OQ, m: QA sin(Sigma).
        height: Height of A above the plane z = 0, m: OQ - QA cos(Sigma).
        turns_in_period: Turns of the pinion shaft in a period of pinion shaft and satellite.
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
    # s + cos(Sigma) and 1 + s cos(Sigma), without cancellation near Sigma = pi
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
    # expanded, because OQ and QA cos(Sigma) are large and cancel if Sigma is small and b = c
    height = cached_property(
        lambda g: (g.c - g.b) * g._scale * g._along_drive + g.b * g.wheel_radius * g._sine / g.s
    )
    turns_in_period = cached_property(lambda g: g.z6 // math.gcd(int(g.z17), int(g.z6)))


class Motion(NamedTuple):
    """Steady speeds of the links.

    Attributes:
        omega1: Speed of link 1, rad/s.
        omega2: Speed of link 2, rad/s.
        carrier: Speed about Ox of the frame that carries the axis OQ, rad/s. In the mechanism this frame is
            link 1. In the paper's stop mode OQ is at rest on Oz, so the motion is relative to link 1.
    """

    omega1: float
    omega2: float
    carrier: float


def stop_mode(omega1: float) -> Motion:
    """Return the paper's stop mode: i = infinity, omega2 = 0, OQ at rest on Oz.

    Args:
        omega1: Speed of link 1 relative to link 2, rad/s.
    """
    return Motion(omega1, 0.0, 0.0)


def dynamic_mode(omega1: float, transmission: float) -> Motion:
    """Return the dynamic mode, in which link 1 carries OQ.

    Args:
        omega1: Speed of link 1, rad/s.
        transmission: Ratio i = omega1/omega2, not 0; math.inf if link 2 is at rest.
    """
    return Motion(omega1, omega1 / transmission, omega1)


def period(geometry: Geometry, motion: Motion) -> float:
    """Return the period of pinion shaft and satellite in link 1, s.

    Args:
        geometry: The mechanism.
        motion: Speeds, with a turning pinion shaft.
    """
    pinion = geometry.k * (motion.omega1 - motion.omega2)
    return float(2.0 * math.pi * geometry.turns_in_period / abs(pinion))


# scene R1, because the paper contains no dimensions
STANDARD = Geometry()
# s is an integer, so that one turn of the pinion shaft is a period, as in the figures of the paper
PAPER = Geometry(z17=40, z6=20)
# test case of the equations: no term vanishes or cancels, and D crosses every plane
GENERAL = Geometry(shaft_angle=math.radians(80.0), a=0.9, b=1.1, c=0.7, epsilon=0.4, gamma=0.3)
STOP = stop_mode(100.0)
# period: ten turns of the pinion shaft, twenty turns of link 1
DYNAMIC = dynamic_mode(100.0, 2.0)
MODES = STOP, DYNAMIC


def modulus(v: Any) -> Any:
    """Return the length of vectors, shape (n,): (12), (18), (25) and (33).

    Args:
        v: Vectors, shape (3, n).
    """
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def lengths(v: Any) -> Any:
    """Return the lengths of the projections on xOy, yOz and xOz, shape (3, n): OH, OP, OF of (4).

    Args:
        v: Vectors, shape (3, n).
    """
    return np.stack([np.sqrt(v[i] * v[i] + v[j] * v[j]) for i, j in PLANES])


def turned_x(v: Any, angle: Any) -> Any:
    """Rotate vectors about Ox.

    Args:
        v: Vectors, shape (3, n).
        angle: Angle, rad.
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0], v[1] * cosine - v[2] * sine, v[1] * sine + v[2] * cosine)


def turned_z(v: Any, angle: Any) -> Any:
    """Rotate vectors about Oz.

    Args:
        v: Vectors, shape (3, n).
        angle: Angle, rad.
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector(v[0] * cosine - v[1] * sine, v[0] * sine + v[1] * cosine, v[2])


def angular_velocities_of(r: Any, v: Any) -> Any:
    """Return the rates omega_H, omega_P, omega_F of the angles (5), rad/s: (6) in closed form.

    Args:
        r: Positions, m, shape (3, n).
        v: Velocities, m/s, shape (3, n).
    """
    return (r[[0, 2, 0]] * v[[1, 1, 2]] - r[[1, 1, 2]] * v[[0, 2, 0]]) / lengths(r) ** 2


def feet_of(r: Any, v: Any) -> Any:
    """Return the feet L, M, N of the perpendiculars from O to the lines of the projected velocity: (26)-(31).

    No term is divided by a single component of V.

    Args:
        r: Positions, m, shape (3, n).
        v: Velocities, m/s, shape (3, n).

    Returns:
        L, M, N in the fixed frame, m, shape (3, 3, n): foot, axis, time.
    """
    feet = np.zeros((3, *r.shape))
    for foot, (i, j) in zip(feet, PLANES, strict=True):
        # n (n·r), with n perpendicular to V
        factor = (v[j] * r[i] - v[i] * r[j]) / (v[i] ** 2 + v[j] ** 2)
        foot[i], foot[j] = v[j] * factor, -v[i] * factor
    return feet


ROWS, PRINTED, EXACT = tables("karetin", globals())


def inputs(g: Geometry, motion: Motion, t: Any) -> dict[str, Any]:
    """Return mechanism, motion and times by the symbols of the paper, with i = omega1/omega2 of (1).

    Args:
        g: Mechanism.
        motion: Speeds.
        t: Times, s, shape (n,).
    """
    names = ("s", "k", "phi", "psi", "AD", "QA", "OQ", "across", "height")
    values: dict[str, Any] = {**asdict(g), **motion._asdict(), "chi": g.shaft_angle, "t": t}
    values |= {name: getattr(g, name) for name in names}
    i = motion.omega1 / motion.omega2 if motion.omega2 else np.inf
    return values | {"i": i, "g": g, "motion": motion}


def exact(g: Geometry, motion: Motion, t: Any) -> Forms:
    """Return the exact forms.

    Args:
        g: Mechanism.
        motion: Speeds.
        t: Times, s, shape (n,).
    """
    return Forms(EXACT, **inputs(g, motion, np.asarray(t)))


def printed(g: Geometry, motion: Motion, times: Any, name: str) -> Any:
    """Return a quantity by the printed equations, with printed results as inputs.

    Args:
        g: Mechanism.
        motion: Speeds.
        times: Times, s, shape (n,).
        name: Name in PRINTED, except accelerations, because velocities already contain rates.

    Returns:
        Values, shape (n,) or (3, n); not finite where the page divides by zero.
    """
    with np.errstate(all="ignore"):
        return np.real(getattr(Forms(PRINTED, **inputs(g, motion, in_time(times))), name))


@cache
def over_period(geometry: Geometry = GENERAL, motion: Motion = STOP) -> Forms:
    """Return the exact forms at SAMPLES times over a period, between instants at which a term can vanish.

    Args:
        geometry: Mechanism.
        motion: Speeds.
    """
    return exact(geometry, motion, (np.arange(SAMPLES) + 0.5) / SAMPLES * period(geometry, motion))


# (2) to (18) are tested in the stop mode, the others in the dynamic mode; with rates at complex times
STOPPED, MOVING = over_period(GENERAL, STOP), over_period(GENERAL, DYNAMIC)
STOPPED_IN_TIME, MOVING_IN_TIME = (exact(e.g, e.motion, in_time(e.t)) for e in (STOPPED, MOVING))


def _summed(name: str, e: Forms, as_of: Forms) -> Equation:
    """Compare a sum of velocities in the frame that carries OQ with the rate of the exact position."""
    return Equation(name, lambda: (PRINTED[name](e), turned_x(rate(as_of.position), -e.theta)))


NAMES = {number: row.name for row in ROWS for number in row.number.split(", ")}
EQUATIONS = {
    number: compared(NAMES[number], PRINTED, STOPPED if 1 < n < 19 else MOVING)
    for n, number in ((n, f"({n})") for n in range(1, 34))
}
EQUATIONS |= {
    # rates of arctangents, which do not depend on the quadrant
    "(6)": Equation(
        "angular_velocities", lambda: (rate(np.arctan(STOPPED_IN_TIME.tangents)), STOPPED.angular_velocities)
    ),
    "(7)": _summed("velocity_in_link1", STOPPED, STOPPED_IN_TIME),
    # v is unbounded, so v x_D of (20) and (22) is compared; k1 is unbounded, so its angle is compared
    "(21)": Equation("v", lambda: (PRINTED["v"](MOVING) * MOVING.x_D, MOVING.v * MOVING.x_D)),
    "(23)": _summed("sum_of_three", MOVING, MOVING_IN_TIME),
    "(27)": Equation("k1", lambda: (np.arctan(MOVING.k1), np.arctan(MOVING.foot_L[1] / MOVING.foot_L[0]))),
    "(32)": Equation("acceleration", lambda: (rate(MOVING_IN_TIME.velocity), MOVING.acceleration)),
}
EQUATIONS["(17)"] = EQUATIONS["(7)"]


# --- claims ---

# Conclusion 2 is about instants of symmetry. With q = omega16 t the angles are A = q + gamma and
# B = s q + epsilon. About q = (n pi - epsilon)/s, where B is a multiple of pi, the radial coordinate of D is
# even and the tangential one is odd. Therefore only A at this instant, gamma - epsilon/s + n pi/s, matters:
# epsilon and gamma have an effect only through gamma - epsilon/s. They have no effect on the moduli of the
# stop mode, because all directions across OQ are equivalent.


def best_mirror(f: Callable[[Any], Any], span: float, sign: float = 1.0) -> tuple[float, float]:
    """Find the instant about which a periodic function is closest to symmetric.

    Args:
        f: Function of times, s, shape (n,), that returns values, shape (n,).
        span: Period of the function, s.
        sign: 1 for even symmetry, -1 for odd symmetry (function with mean 0).

    Returns:
        Minimum over all instants of the maximum |f(instant + u) - sign f(instant - u)|, relative to the range
        of f (0 for a constant), and the instant, s.
    """
    dt, index = span / N_INSTANTS, np.arange(N_INSTANTS)
    samples, u = f(dt * index), np.linspace(0.0, 0.5 * span, N_COMPARED)
    if np.ptp(samples) <= ROUNDING * np.abs(samples).max():
        return 0.0, 0.0

    def difference(instant: float) -> float:
        return float(np.abs(f(instant + u) - sign * f(instant - u)).max())

    mirrored = samples[(index[:, None] - index) % N_INSTANTS]
    coarse = np.abs(samples - sign * mirrored).max(axis=1)
    minima = [
        minimize_scalar(
            difference, bounds=(0.5 * dt * (m - 2), 0.5 * dt * (m + 2)), options={"xatol": 1e-9 * span}
        )
        for m in np.argsort(coarse)[:4]
    ]
    best = min(minima, key=lambda minimum: minimum.fun)
    return float(best.fun / np.ptp(samples)), float(best.x)


def asymmetry(name: str, g: Geometry, motion: Motion) -> float:
    """Return the asymmetry of an exact modulus over the period of the motion in link 1 (see best_mirror).

    Args:
        name: Name of the modulus.
        g: Mechanism.
        motion: Speeds.
    """
    return best_mirror(lambda t: getattr(exact(g, motion, t), name), period(g, motion))[0]


def asymmetry_of_components(g: Geometry, motion: Motion) -> float:
    """Return the maximum asymmetry of V_x, V_y, V_z, each for the better of even and odd symmetry.

    Args:
        g: Mechanism.
        motion: Speeds.
    """
    span = period(g, motion)
    components = [lambda t, axis=axis: exact(g, motion, t).velocity[axis] for axis in range(3)]
    return max(min(best_mirror(v, span, sign)[0] for sign in (1.0, -1.0)) for v in components)
