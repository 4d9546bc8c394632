"""What Karetin reads off r and V by projecting them on xOy, yOz and xOz: (4)-(6) and (26)-(31).

Columns of the results are in the order of the paper: H or L in xOy, P or M in yOz, F or N in xOz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .exact import vectors

Array = NDArray[np.float64]

# D closer to an axis than this, over |r|, is on it to rounding: its direction across is noise
ON_AXIS = 16.0 * float(np.finfo(np.float64).eps)
# squares below this are those of lengths that are 0
_TINY = float(np.finfo(np.float64).tiny)


def _length(u: Array, v: Array) -> Array:
    square = u * u
    square += v * v
    result: Array = np.sqrt(square, out=square)
    return result


def projections(r: Array) -> Array:
    """OH, OP, OF: lengths of the projections of r on xOy, yOz and xOz: equation (4).

    Args:
        r: points or vectors, shape (n, 3), any unit.

    Returns:
        shape (n, 3), same unit.
    """
    x, y, z = r.T
    return vectors(_length(x, y), _length(y, z), _length(x, z))


def angles(r: Array) -> Array:
    """beta_H = xOH, beta_P = zOP, beta_F = xOF, in the whole circle: equation (5) put right.

    The sense is the paper's: beta_H from Ox to Oy, beta_P from Oz to Oy, beta_F from Ox to Oz; the last
    two are against the right-hand turn about Ox and Oy.

    Args:
        r: points, m, shape (n, 3).

    Returns:
        rad, shape (n, 3), in (-pi, pi]; 0 where D is on Oz, Ox or Oy to rounding, for there OH, OP or OF
        has no direction. See continuous.
    """
    x, y, z = r.T
    beta = vectors(np.arctan2(y, x), np.arctan2(y, z), np.arctan2(z, x))
    on_axis = _on_axis(r)
    if on_axis.any():
        beta[on_axis] = 0.0
    return beta


def _on_axis(r: Array) -> NDArray[np.bool_]:
    """Whether D is on Oz, Ox, Oy to rounding: OH, OP or OF vanishes against r; shape (n, 3)."""
    xx, yy, zz = (r * r).T
    least = (ON_AXIS * ON_AXIS) * (xx + yy + zz)
    result = np.empty((3, len(r)), dtype=np.bool_)
    np.less_equal(xx + yy, least, out=result[0])
    np.less_equal(yy + zz, least, out=result[1])
    np.less_equal(xx + zz, least, out=result[2])
    return result.T


def continuous(beta: Array) -> Array:
    """Angles of successive times without the jumps of a whole turn.

    Args:
        beta: rad, shape (n, 3), of times so close that no angle changes by half a turn between them.

    Returns:
        rad, shape (n, 3).
    """
    return np.unwrap(beta, axis=0)


def angular_velocities(r: Array, v: Array) -> Array:
    """omega_H, omega_P, omega_F, the rates of the angles (5): equation (6) in closed form.

    Args:
        r: points, m, shape (n, 3).
        v: their velocities, m/s, shape (n, 3).

    Returns:
        rad/s, shape (n, 3). Where D is on Oz, Ox or Oy to rounding, the angle does not exist (it jumps by
        pi where D passes straight through the axis): there the rate is set to 0. Near an axis the
        relative error grows as that of the distance from it.
    """
    x, y, z = r.T
    vx, vy, vz = v.T
    omega = vectors(_rate(x, y, vx, vy), _rate(z, y, vz, vy), _rate(x, z, vx, vz))
    on_axis = _on_axis(r)
    if on_axis.any():
        omega[on_axis] = 0.0
    return omega


def _rate(u: Array, v: Array, u_rate: Array, v_rate: Array) -> Array:
    """Rate of atan2(v, u), finite also at the origin."""
    square = u * u
    square += v * v
    np.maximum(square, _TINY, out=square)
    moment = u * v_rate
    moment -= v * u_rate
    moment /= square
    return moment


def feet(r: Array, v: Array) -> Array:
    """Feet L, M, N of the perpendiculars from O on the lines of the projected velocity: (26)-(31).

    In the plane the foot is n (n r) with n across V. Nothing is divided by one component of V.

    Args:
        r: points, m, shape (n, 3).
        v: their velocities, m/s, shape (n, 3).

    Returns:
        x_L, y_L, y_M, z_M, x_N, z_N, m, shape (n, 6). Where the projected velocity is 0 there is no
        line and the foot is the projection of D itself.
    """
    x, y, z = r.T
    vx, vy, vz = v.T
    whole = np.empty((6, len(x)))
    _foot(x, y, vx, vy, whole[0], whole[1])
    _foot(y, z, vy, vz, whole[2], whole[3])
    _foot(x, z, vx, vz, whole[4], whole[5])
    return whole.T


def _foot(x: Array, y: Array, vx: Array, vy: Array, foot_x: Array, foot_y: Array) -> None:
    square = vx * vx
    square += vy * vy
    at_rest = square < _TINY
    np.maximum(square, _TINY, out=square)
    factor = x * vy
    factor -= y * vx
    factor /= square
    np.multiply(factor, vy, out=foot_x)
    np.multiply(factor, -vx, out=foot_y)
    if at_rest.any():
        foot_x[at_rest] = x[at_rest]
        foot_y[at_rest] = y[at_rest]


def arms(foot: Array) -> Array:
    """OL, OM, ON, the arms about O of the projected velocities: (28) and within (30), (31).

    Args:
        foot: of feet, m, shape (n, 6).

    Returns:
        m, shape (n, 3): |r x V| / |V| in each plane.
    """
    xl, yl, ym, zm, xn, zn = foot.T
    return vectors(_length(xl, yl), _length(ym, zm), _length(xn, zn))
