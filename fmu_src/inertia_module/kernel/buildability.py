"""Warnings of mechanisms that can be computed but not built (mechanics.md, Motion).

Clearance is checked between the pitch circles (planar layout) and pitch cones (bevel layout) of one module.
A gear is too flat if its axial inertia exceeds the sum of its two transverse inertias: no body has this.
The deprecated value of `method` has a warning, too.
"""

import math

from . import codes
from .records import Parameters

OVERLAP_RTOL = 1e-12  # Relative overlap below which parts touch


def satellites_overlap(p: Parameters, reach: float) -> bool:
    """Return True if neighbouring satellites overlap.

    Args:
        p: Parameters.
        reach: Planar layout (R0 + r) / r, bevel layout sqrt(1 + 2 s cos Sigma + s^2).
    """
    return p.satellites > 1.0 and reach * math.sin(math.pi / p.satellites) < 1.0 - OVERLAP_RTOL


def planar_warnings(p: Parameters) -> int:
    """Return the sum of the warnings of a planar mechanism.

    Args:
        p: Parameters.
    """
    total = 0
    if satellites_overlap(p, 1.0 + p.sun_radius / p.satellite_radius):
        total += codes.PLANAR_OVERLAP
    if p.eccentricity > p.satellite_radius * (1.0 + OVERLAP_RTOL):
        total += codes.PLANAR_OUTSIDE
    return total


def bevel_warnings(p: Parameters) -> int:
    """Return the sum of the warnings of a bevel mechanism.

    Args:
        p: Parameters.
    """
    total = 0
    s = p.z17 / p.z6
    cosine = math.cos(p.shaft_angle)
    # The square is non-negative except for round-off
    if satellites_overlap(p, math.sqrt(max(0.0, 1.0 + 2.0 * s * cosine + s * s))):
        total += codes.BEVEL_OVERLAP
    # The rim of an internal satellite is outside its pitch cone
    if s + cosine > 0.0 and p.a > min(1.0, p.b) * (1.0 + OVERLAP_RTOL):
        total += codes.BEVEL_OUTSIDE
    if p.satellite_inertia > 2.0 * p.satellite_transverse_inertia * (1.0 + OVERLAP_RTOL):
        total += codes.GEAR_TOO_FLAT
    return total


def buildability_warnings(p: Parameters) -> int:
    """Return the sum of all warnings (codes.PLANAR_OVERLAP and so on); 0 means none.

    Args:
        p: Parameters, each within its range of the table of variables.
    """
    method = codes.METHOD_DEPRECATED if p.method == codes.TIMESTEPPING else 0
    return method + (planar_warnings(p) if p.layout != 0.0 else bevel_warnings(p))
