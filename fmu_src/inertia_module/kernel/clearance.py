"""Tell whether a mechanism has room for its parts: what is computed all the same, but cannot be built.

Room is said of the pitch circles (planar) and the pitch cones (bevel) of one module. No body has an inertia
above the sum of the other two.
"""

import math

from .codes import BEVEL_OUTSIDE, BEVEL_OVERLAP, GEAR_TOO_FLAT, PLANAR_OUTSIDE, PLANAR_OVERLAP

# parts that touch do not overlap
ROUNDING = 1e-12


def satellites_overlap(p, reach):
    """Tell whether neighbouring satellites overlap.

    Planar: circles of radius r, their centres R0 + r from the axis and 2 (R0 + r) sin(pi/n) apart.
    Bevel: cones of half angle phi with one apex, their axes inclined by Sigma and delta apart:
    sin(delta/2) = sin(Sigma) sin(pi/n) against sin(phi) = sin(Sigma) / sqrt(1 + 2 s cos(Sigma) + s^2).
    An internal satellite (phi > pi/2) leaves no room for a second one; its root is below 1.

    Args:
        p: parameters. reach: (R0 + r) / r, or that root.
    """
    return p.satellites > 1.0 and reach * math.sin(math.pi / p.satellites) < 1.0 - ROUNDING


def warnings(p):
    """Sum of the warnings that hold for parameters that are each within their range."""
    found = 0
    if p.layout != 0.0:
        if satellites_overlap(p, 1.0 + p.sun_radius / p.satellite_radius):
            found += PLANAR_OVERLAP
        if p.eccentricity > p.satellite_radius * (1.0 + ROUNDING):
            found += PLANAR_OUTSIDE
        return found
    s = p.z17 / p.z6
    cosine = math.cos(p.shaft_angle)
    # never negative but by rounding
    if satellites_overlap(p, math.sqrt(max(0.0, 1.0 + 2.0 * s * cosine + s * s))):
        found += BEVEL_OVERLAP
    # the rim of an internal satellite is outside its pitch cone
    if s + cosine > 0.0 and p.a > min(1.0, p.b) * (1.0 + ROUNDING):
        found += BEVEL_OUTSIDE
    if p.satellite_inertia > 2.0 * p.satellite_transverse_inertia * (1.0 + ROUNDING):
        found += GEAR_TOO_FLAT
    return found
