"""Torques of inertia and weight on links 1 and 2 by the principle of virtual work (d'Alembert).

The torques are Fourier series of the positions of unbalanced masses, pinion shafts and satellites. They
contain neither Lagrange's equations nor the functions I, B and G of the kernel.
All vectors refer to the frame of link 1, with x along the central axis.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from .geometry import EX, EZ, Array, Parameters, attitudes, bevel_lengths, positions, ratio, satellite_ratio

# round-off of harmonics, relative to the largest harmonic
ROUNDING = 3e-15


def period(p: Parameters) -> tuple[Array, Array]:
    """Return pinion-shaft angles over one period, rad, and the orders of the harmonics, both (points,).

    Args:
        p: parameters by name.
    """
    turns = 1 if p["layout"] else int(p["z6"]) // math.gcd(int(p["z17"]), int(p["z6"]))
    points = 2 * math.ceil(4.0 * (1.0 + satellite_ratio(p)) * turns) + 16
    angles = np.linspace(0.0, 2.0 * np.pi * turns, points, endpoint=False)
    return angles, np.asarray(np.fft.fftfreq(points, turns / points))


class VirtualWork:
    """Virtual work of all modules of a mechanism, as Fourier series in the pinion-shaft angle.

    Args:
        p: all parameters of the module by name.

    Attributes:
        orders: orders of the harmonics per revolution of the pinion shaft.
        terms: coefficients of all series, a column for each order.
        max_order: maximum order.
        max_inertia: maximum inertia, kg m^2.
    """

    def __init__(self, p: Parameters) -> None:
        angles, orders = period(p)
        satellites, modules, mass = int(p["satellites"]), p["modules"], p["imbalance_mass"]
        k, s = ratio(p), satellite_ratio(p)
        teeth = 0.0 if p["layout"] else (1.0 - p["satellite_mesh_efficiency"]) * s
        # a point on the axes of the satellites (bevel)
        pivot = np.zeros(3) if p["layout"] else bevel_lengths(p)[2] * EZ
        torques = np.zeros((2 + satellites, 5, angles.size))
        bearings = np.zeros((satellites, 3, 3, angles.size))
        centres = np.zeros((satellites, 2, 2, angles.size))

        def rate(samples: Array) -> Array:
            """Return the derivative with respect to q, (points, 3).

            Args:
                samples: values at the angles, (points, 3).
            """
            terms = np.fft.fft(samples, axis=0)
            terms[np.abs(terms) < ROUNDING * np.abs(terms).max()] = 0.0
            slopes: Array = np.fft.ifft(1j * orders[:, None] * terms, axis=0).real
            return slopes

        x = np.broadcast_to(EX, (angles.size, 3))
        for n in range(satellites):
            r = positions(p, angles, n)
            slope = rate(r)
            # acceleration per alpha1, q'', omega1^2, omega1 q' and q'^2
            displacements = np.cross(x, r), slope
            parts = *displacements, np.cross(x, displacements[0]), 2.0 * np.cross(x, slope), rate(slope)
            # the satellite has the axis e and rotates in link 1 by w dq
            e = attitudes(p, angles, n)[..., 0 if p["layout"] else 2]
            w = e if p["layout"] else EZ + s * e
            directions = *displacements, teeth * np.cross(e, r - pivot)
            torques[[0, 1, 2 + n]] += mass * np.einsum("jpx,ipx->jip", directions, parts)
            bearings[n] = p["journal_friction"] * s * mass * np.transpose(parts[2:], (2, 0, 1))
            centres[n] = np.transpose([r, slope], (0, 2, 1))[:, 1:]
            torques[:2] += np.einsum("jpx,ipx->jip", [x, w], _gear(p, e, rate(e), w, rate(w)))
        torques *= modules
        own = p["drive_inertia"] * np.array([[p["layout"], p["layout"]], [p["layout"], 1.0]])
        torques[:2, :2] += own[..., None]
        self.max_inertia = float(np.abs(torques[:2, :2]).max())
        # q'' = k (alpha1 - alpha2)
        torques[:, 0] += k * torques[:, 1]
        torques[:, 1] *= -k
        samples = torques, modules * bearings, mass * p["gravity"] * (modules == 1) * centres
        terms = [np.fft.fft(series).reshape(-1, orders.size) / orders.size for series in samples]
        sizes = [np.abs(series).max(axis=0) for series in terms]
        is_significant = np.any([size > ROUNDING * size.max() for size in sizes], axis=0)
        selected = np.flatnonzero(is_significant & (orders >= 0.0))
        self.max_order = float(orders[selected].max(initial=0.0))
        self.orders = orders[selected]
        # a real series is twice the sum of its positive orders
        self.terms = np.concatenate(terms)[:, selected] * np.where(orders[selected] > 0.0, 2.0, 1.0)
        ends = np.cumsum([0, *map(len, terms)])
        self._parts = [
            (slice(*pair), series.shape[:-1])
            for pair, series in zip(itertools.pairwise(ends), samples, strict=True)
        ]

    def __call__(self, q: float | Array) -> list[Array]:
        """Return all series at pinion-shaft angles; the last axes of the results are the axes of the angles.

        Args:
            q: angles, rad, () or (n,).

        Returns:
            torques: torques on theta1, on q, and of each satellite by the friction of mesh 17-6, per alpha1,
                alpha2, omega1^2, omega1 q' and q'^2, kg m^2, (2 + satellites, 5).
            bearings: friction of each satellite bearing by direction, per omega1^2, omega1 q' and q'^2,
                kg m^2, (satellites, 3, 3).
            weights: m g (y, z) of each unbalanced mass and its derivative with respect to q, N.m,
                (satellites, 2, 2).
        """
        values = (self.terms @ np.exp(np.multiply.outer(1j * self.orders, q))).real
        return [values[part].reshape(shape + np.shape(q)) for part, shape in self._parts]


def _gear(p: Parameters, e: Array, e_slope: Array, w: Array, w_slope: Array) -> list[Array]:
    """Return the torques of a satellite gear per alpha1, q'', omega1^2, omega1 q' and q'^2, each (points, 3).

    They are the derivative of the angular momentum L = Jt t + (Ja - Jt) (e.t) e in the fixed frame, with the
    angular velocity t = omega1 x + q' w.

    Args:
        p: parameters by name.
        e: axis of the satellite, (points, 3).
        e_slope: derivative of e with respect to q, (points, 3).
        w: angular velocity of the satellite in link 1 per q', (points, 3).
        w_slope: derivative of w with respect to q, (points, 3).
    """
    across = p["satellite_transverse_inertia"]
    along = p["satellite_inertia"] - across
    x = np.broadcast_to(EX, e.shape)

    def projected(first: Array, second: Array, velocity: Array) -> Array:
        product: Array = along * (first * velocity).sum(axis=1, keepdims=True) * second
        return product

    def momentum(velocity: Array) -> Array:
        total: Array = across * velocity + projected(e, e, velocity)
        return total

    def tilted(velocity: Array) -> Array:
        return projected(e_slope, e, velocity) + projected(e, e_slope, velocity)

    steady = np.cross(x, momentum(x)), np.cross(x, momentum(w)) + tilted(x), momentum(w_slope) + tilted(w)
    return [momentum(x), momentum(w), *steady]
