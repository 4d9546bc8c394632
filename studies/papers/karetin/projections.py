"""What Karetin reads off r and V by projecting them on xOy, yOz and xOz: (4)-(6) and (26)-(31).

r: points, m, and v: their velocities, m/s, shape (3, n). Results, shape (3, n) where not told, are in the
order of the paper: H or L in xOy, P or M in yOz, F or N in xOz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# D closer to an axis than this, over |r|, is on it to rounding: its direction across is noise
ON_AXIS = 16.0 * float(np.finfo(np.float64).eps)
# squares below this are those of lengths that are 0
_TINY = float(np.finfo(np.float64).tiny)


def lengths(pairs: Array) -> Array:
    """Lengths of three vectors of a plane, their components after one another: shape (6, n)."""
    result: Array = np.sqrt(pairs[0::2] ** 2 + pairs[1::2] ** 2)
    return result


def projections(r: Array) -> Array:
    """OH, OP, OF: lengths of the projections of r, or of any vectors, on xOy, yOz and xOz: (4)."""
    return lengths(r[[0, 1, 1, 2, 0, 2]])


def angles(r: Array) -> Array:
    """beta_H = xOH, beta_P = zOP, beta_F = xOF, rad, in the whole circle (-pi, pi]: (5) put right.

    The sense is the paper's: beta_H from Ox to Oy, beta_P from Oz to Oy, beta_F from Ox to Oz; the last
    two are against the right-hand turn about Ox and Oy. 0 where D is on Oz, Ox or Oy to rounding, for
    there OH, OP or OF has no direction.
    """
    return np.where(_on_axis(r), 0.0, np.arctan2(r[[1, 1, 2]], r[[0, 2, 0]]))


def _on_axis(r: Array) -> NDArray[np.bool_]:
    """Whether D is on Oz, Ox, Oy to rounding: OH, OP or OF vanishes against r."""
    on_axis: NDArray[np.bool_] = projections(r) <= ON_AXIS * np.sqrt((r * r).sum(axis=0))
    return on_axis


def angular_velocities(r: Array, v: Array) -> Array:
    """omega_H, omega_P, omega_F, the rates of the angles (5), rad/s: (6) in closed form.

    Where D is on Oz, Ox or Oy to rounding, the angle does not exist (it jumps by pi where D passes
    straight through the axis): there the rate is set to 0. Near an axis the relative error grows as that
    of the distance from it.
    """
    turned = r[[0, 2, 0]] * v[[1, 1, 2]] - r[[1, 1, 2]] * v[[0, 2, 0]]
    return np.where(_on_axis(r), 0.0, turned / np.maximum(projections(r) ** 2, _TINY))


def feet(r: Array, v: Array) -> Array:
    """Feet L, M, N of the perpendiculars from O on the lines of the projected velocity, m: (26)-(31).

    In the plane the foot is n (n r) with n across V. Nothing is divided by one component of V.

    Returns:
        x_L, y_L, y_M, z_M, x_N, z_N, m, shape (6, n). Where the projected velocity is 0 there is no
        line and the foot is the projection of D itself.
    """
    planes = [[0, 1, 1, 2, 0, 2], [1, 0, 2, 1, 2, 0]]
    (one, other), (along, across) = r[planes], v[planes]
    square = along * along + across * across
    foot = across * (one * across - other * along) / np.maximum(square, _TINY)
    result: Array = np.where(square < _TINY, one, foot)
    return result
