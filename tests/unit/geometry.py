"""The mechanism by positions and virtual work, without the closed forms of the kernel."""

import numpy as np

from verification.reference.geometry import positions, ratio, satellite_ratio, turn
from verification.reference.virtual_work import VirtualWork

__all__ = ["ratio", "satellite_ratio", "turn"]


def position(p, q, satellite=0):
    """Return the imbalance position of one satellite in the frame of link 1; q may be complex."""
    return positions(p, np.array([q]), satellite)[0]


def taylor(function, at, terms=4, radius=0.5, points=32):
    """Return Taylor coefficients of an analytic function by Cauchy's integral, exact to rounding."""
    circle = np.exp(2j * np.pi * np.arange(points) / points)
    samples = np.array([function(at + radius * point) for point in circle])
    return np.array([np.tensordot(circle**-n, samples, 1).real / points / radius**n for n in range(terms)])


def derivatives(series):
    """Return (f, f', f'') from the first coefficients."""
    return series[0], series[1], 2.0 * series[2]


def direct_sums(p, q):
    """Return (I, I', B, B', G, G') of imbalances, gears and drives at a drive angle."""
    link1, drive = VirtualWork(p)(q)[0][:2]
    k = ratio(p)
    # Columns: alpha1, alpha2, omega1^2, omega1 q', q'^2, with q'' = k (alpha1 - alpha2).
    return [link1[0] + link1[1], link1[3], -link1[1] / k, link1[4], -drive[1] / k, 2.0 * drive[4]]
