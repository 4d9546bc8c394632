"""What Karetin reads off r and V by projecting them on xOy, yOz and xOz: (4)-(6) and (26)-(31).

r: points, m, and v: their velocities, m/s, of shape (n, 3). Columns of the results, of shape (n, 3) where
not told, are in the order of the paper: H or L in xOy, P or M in yOz, F or N in xOz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# D closer to an axis than this, over |r|, is on it to rounding: its direction across is noise
ON_AXIS = 16.0 * float(np.finfo(np.float64).eps)
# squares below this are those of lengths that are 0
_TINY = float(np.finfo(np.float64).tiny)


def vectors(*components: ArrayLike) -> Array:
    """Vectors, shape (n, 3), of components of shape (n,) or numbers, each in one piece of memory."""
    return np.stack(np.broadcast_arrays(*components)).T


def _length(u: Array, v: Array) -> Array:
    # np.hypot takes four times as long
    result: Array = np.sqrt(u * u + v * v)
    return result


def projections(r: Array) -> Array:
    """OH, OP, OF: lengths of the projections of r, or of any vectors, on xOy, yOz and xOz: (4)."""
    x, y, z = r.T
    return vectors(_length(x, y), _length(y, z), _length(x, z))


def angles(r: Array) -> Array:
    """beta_H = xOH, beta_P = zOP, beta_F = xOF, rad, in the whole circle (-pi, pi]: (5) put right.

    The sense is the paper's: beta_H from Ox to Oy, beta_P from Oz to Oy, beta_F from Ox to Oz; the last
    two are against the right-hand turn about Ox and Oy. 0 where D is on Oz, Ox or Oy to rounding, for
    there OH, OP or OF has no direction. See continuous.
    """
    x, y, z = r.T
    beta = vectors(np.arctan2(y, x), np.arctan2(y, z), np.arctan2(z, x))
    beta[_on_axis(r)] = 0.0
    return beta


def _on_axis(r: Array) -> NDArray[np.bool_]:
    """Whether D is on Oz, Ox, Oy to rounding: OH, OP or OF vanishes against r; shape (n, 3)."""
    xx, yy, zz = (r * r).T
    least = (ON_AXIS * ON_AXIS) * (xx + yy + zz)
    return np.stack([xx + yy <= least, yy + zz <= least, xx + zz <= least], axis=1)


def continuous(beta: Array) -> Array:
    """Angles of successive times, so close that none changes by half a turn, without jumps of a turn."""
    return np.unwrap(beta, axis=0)


def angular_velocities(r: Array, v: Array) -> Array:
    """omega_H, omega_P, omega_F, the rates of the angles (5), rad/s: (6) in closed form.

    Where D is on Oz, Ox or Oy to rounding, the angle does not exist (it jumps by pi where D passes
    straight through the axis): there the rate is set to 0. Near an axis the relative error grows as that
    of the distance from it.
    """
    x, y, z = r.T
    vx, vy, vz = v.T
    omega = vectors(_rate(x, y, vx, vy), _rate(z, y, vz, vy), _rate(x, z, vx, vz))
    omega[_on_axis(r)] = 0.0
    return omega


def _rate(u: Array, v: Array, u_rate: Array, v_rate: Array) -> Array:
    """Rate of atan2(v, u), finite also at the origin."""
    result: Array = (u * v_rate - v * u_rate) / np.maximum(u * u + v * v, _TINY)
    return result


def feet(r: Array, v: Array) -> Array:
    """Feet L, M, N of the perpendiculars from O on the lines of the projected velocity, m: (26)-(31).

    In the plane the foot is n (n r) with n across V. Nothing is divided by one component of V.

    Returns:
        x_L, y_L, y_M, z_M, x_N, z_N, m, shape (n, 6). Where the projected velocity is 0 there is no
        line and the foot is the projection of D itself.
    """
    x, y, z = r.T
    vx, vy, vz = v.T
    return vectors(*_foot(x, y, vx, vy), *_foot(y, z, vy, vz), *_foot(x, z, vx, vz))


def _foot(x: Array, y: Array, vx: Array, vy: Array) -> tuple[Array, Array]:
    square = vx * vx + vy * vy
    factor = (x * vy - y * vx) / np.maximum(square, _TINY)
    rest = square < _TINY
    return np.where(rest, x, factor * vy), np.where(rest, y, -factor * vx)


def arms(foot: Array) -> Array:
    """OL, OM, ON of feet of shape (n, 6), m: (28) and within (30), (31); |r x V| / |V| in each plane."""
    xl, yl, ym, zm, xn, zn = foot.T
    return vectors(_length(xl, yl), _length(ym, zm), _length(xn, zn))
