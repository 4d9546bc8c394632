"""The mechanism as a chain of turned rigid bodies, written out without the closed forms of the kernel."""

import numpy as np

from studies.reference.geometry import attitudes, positions, ratio, satellite_ratio, turn

__all__ = ["ratio", "satellite_ratio", "turn"]


def masses(p, q, satellite):
    """Point masses that move as a satellite does: kg, and positions in link 1, shape (points, 3), m.

    The imbalance, and three at 1 m on the axes of the gear that have its inertias about its centre (that on
    its own axis may be negative).
    """
    axes = attitudes(p, q, satellite)
    across = 0.5 * p["satellite_inertia"]
    own = p["satellite_transverse_inertia"] - across
    shares = (own, across, across) if p["layout"] else (across, across, own)
    gear = [(share, axes[..., n]) for n, share in enumerate(shares)]
    return [(p["imbalance_mass"], positions(p, q, satellite)), *gear]


def position(p, q, satellite=0):
    """Imbalance of one satellite in the frame of link 1; q may be complex."""
    return positions(p, np.array([q]), satellite)[0]


def circle(radius=0.5, points=32):
    return radius * np.exp(2j * np.pi * np.arange(points) / points)


def coefficients(samples, around, terms):
    """Taylor coefficients from values on a circle by Cauchy's integral: exact to rounding."""
    return np.array([np.tensordot(around**-n, samples, 1).real / len(around) for n in range(terms)])


def taylor(function, at, terms=4, radius=0.5, points=32):
    """Taylor coefficients of an analytic function."""
    around = circle(radius, points)
    return coefficients(np.array([function(at + point) for point in around]), around, terms)


def series_rate(series):
    """Series of the derivative."""
    return np.arange(1, len(series)).reshape(-1, *[1] * (series.ndim - 1)) * series[1:]


def series_product(one, two):
    """First three coefficients of the product of two series."""
    return np.array([sum(one[i] * two[n - i] for i in range(n + 1)) for n in range(3)])


def derivatives(series):
    """(f, f', f'') from the first coefficients."""
    return series[0], series[1], 2.0 * series[2]


def direct_derivatives(p, q):
    """I, B and G (rows) and their first two derivatives, summed over the imbalances, gears and drives."""
    sums = np.zeros((3, 3))
    for satellite in range(p["satellites"]):
        for mass, places in masses(p, q + circle(), satellite):
            path = coefficients(places, circle(), 5)
            (_, y, z), (x1, y1, z1) = path.T, series_rate(path).T
            sums += (
                mass
                * p["modules"]
                * np.array(
                    [
                        derivatives(series_product(y, y) + series_product(z, z)),
                        derivatives(series_product(y, z1) - series_product(z, y1)),
                        derivatives(series_product(x1, x1) + series_product(y1, y1) + series_product(z1, z1)),
                    ]
                )
            )
    own = p["drive_inertia"]
    sums[2, 0] += own
    if p["layout"]:  # the satellite's axis is parallel to the central one: J16 (omega1 + q')^2 / 2
        sums[0, 0] += own
        sums[1, 0] += own
    return sums


def direct_sums(p, q):
    """(I, I', B, B', G, G') summed over the imbalances, the drives with them."""
    sums = direct_derivatives(p, q)
    return sums[:, :2].ravel()
