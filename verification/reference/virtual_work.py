"""Torques of inertia and weight on links 1 and 2: virtual work of imbalances, drives and satellites.

From positions and their Fourier series alone (d'Alembert): neither I, B, G nor Lagrange's equations are used.
All in the frame of link 1, x along the central axis.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from .geometry import EX, EZ, Array, Parameters, attitudes, bevel_lengths, positions, ratio, satellite_ratio

# harmonics below this part of the largest are rounding
ROUNDING = 3e-15


def period(p: Parameters) -> tuple[Array, Array]:
    """Drive angles evenly over a period of the motion, rad, and orders of harmonics per turn, (points,)."""
    turns = 1 if p["layout"] else int(p["z6"]) // math.gcd(int(p["z17"]), int(p["z6"]))
    points = 2 * math.ceil(4.0 * (1.0 + satellite_ratio(p)) * turns) + 16
    angles = np.linspace(0.0, 2.0 * np.pi * turns, points, endpoint=False)
    return angles, np.asarray(np.fft.fftfreq(points, turns / points))


class VirtualWork:
    """Virtual work of one mechanism, all its modules, as Fourier series in the drive angle.

    Args:
        p: all parameters of the module by name.

    Attributes:
        orders: of the harmonics per turn of the drive. terms: of all series, a column for each of them.
        highest: of the orders. largest: of the inertias, kg m^2.
    """

    def __init__(self, p: Parameters) -> None:
        angles, orders = period(p)
        satellites, modules, mass = int(p["satellites"]), p["modules"], p["imbalance_mass"]
        k, s = ratio(p), satellite_ratio(p)
        teeth = 0.0 if p["layout"] else (1.0 - p["satellite_mesh_efficiency"]) * s
        # a point on the axes of the satellites (in the planar layout the drives' own are not asked for)
        pivot = np.zeros(3) if p["layout"] else bevel_lengths(p)[2] * EZ
        torques = np.zeros((2 + satellites, 5, angles.size))
        bearings = np.zeros((satellites, 3, 3, angles.size))
        centres = np.zeros((satellites, 2, 2, angles.size))

        def rate(samples: Array) -> Array:
            """Slope in q of what is sampled, (points, 3)."""
            terms = np.fft.fft(samples, axis=0)
            terms[np.abs(terms) < ROUNDING * np.abs(terms).max()] = 0.0
            slopes: Array = np.fft.ifft(1j * orders[:, None] * terms, axis=0).real
            return slopes

        x = np.broadcast_to(EX, (angles.size, 3))
        for n in range(satellites):
            r = positions(p, angles, n)
            slope = rate(r)
            # the acceleration by (alpha1, q'', omega1^2, omega1 q', q'^2)
            moved = np.cross(x, r), slope
            parts = *moved, np.cross(x, moved[0]), 2.0 * np.cross(x, slope), rate(slope)
            # how it turns in link 1: about its axis e, and with its drive by w dq
            e = attitudes(p, angles, n)[..., 0 if p["layout"] else 2]
            w = e if p["layout"] else EZ + s * e
            directions = *moved, teeth * np.cross(e, r - pivot)
            torques[[0, 1, 2 + n]] += mass * np.einsum("jpx,ipx->jip", directions, parts)
            bearings[n] = p["journal_friction"] * s * mass * np.transpose(parts[2:], (2, 0, 1))
            centres[n] = np.transpose([r, slope], (0, 2, 1))[:, 1:]
            torques[:2] += np.einsum("jpx,ipx->jip", [x, w], _gear(p, e, rate(e), w, rate(w)))
        torques *= modules
        own = p["drive_inertia"] * np.array([[p["layout"], p["layout"]], [p["layout"], 1.0]])
        torques[:2, :2] += own[..., None]
        self.largest = float(np.abs(torques[:2, :2]).max())
        # q'' = k (alpha1 - alpha2)
        torques[:, 0] += k * torques[:, 1]
        torques[:, 1] *= -k
        samples = torques, modules * bearings, mass * p["gravity"] * (modules == 1) * centres
        terms = [np.fft.fft(one).reshape(-1, orders.size) / orders.size for one in samples]
        sizes = [np.abs(one).max(axis=0) for one in terms]
        there = np.any([size > ROUNDING * size.max() for size in sizes], axis=0)
        kept = np.flatnonzero(there & (orders >= 0.0))
        self.highest = float(orders[kept].max(initial=0.0))
        self.orders = orders[kept]
        # a real series is twice its half of positive orders
        self.terms = np.concatenate(terms)[:, kept] * np.where(orders[kept] > 0.0, 2.0, 1.0)
        ends = np.cumsum([0, *map(len, terms)])
        self._parts = [
            (slice(*pair), one.shape[:-1])
            for pair, one in zip(itertools.pairwise(ends), samples, strict=True)
        ]

    def __call__(self, q: float | Array) -> list[Array]:
        """Evaluate all series at drive angles, rad; their shape, () or (n,), comes last in all.

        Returns:
            torques: on theta1 and q, and what friction of the meshes 17-6 makes of that of each satellite,
                by (alpha1, alpha2, omega1^2, omega1 q', q'^2), kg m^2, (2 + satellites, 5).
            bearings: what friction of the journals makes of the acceleration of each imbalance, by the last
                three, (satellites, 3, 3).
            weights: m g (y, z) of each and its slope in q, N.m, (satellites, 2, 2).
        """
        values = (self.terms @ np.exp(np.multiply.outer(1j * self.orders, q))).real
        return [values[part].reshape(shape + np.shape(q)) for part, shape in self._parts]


def _gear(p: Parameters, e: Array, e_slope: Array, w: Array, w_slope: Array) -> list[Array]:
    """Torques of a satellite's gear, N.m, by (alpha1, q'', omega1^2, omega1 q', q'^2), each (points, 3).

    Euler: d/dt L in the fixed frame, L = Jt t + (Ja - Jt) (e.t) e of the turn t = omega1 x + q' w.
    """
    across = p["satellite_transverse_inertia"]
    along = p["satellite_inertia"] - across
    x = np.broadcast_to(EX, e.shape)

    def projected(one: Array, other: Array, turning: Array) -> Array:
        product: Array = along * (one * turning).sum(axis=1, keepdims=True) * other
        return product

    def momentum(turning: Array) -> Array:
        total: Array = across * turning + projected(e, e, turning)
        return total

    def tilted(turning: Array) -> Array:
        return projected(e_slope, e, turning) + projected(e, e_slope, turning)

    steady = np.cross(x, momentum(x)), np.cross(x, momentum(w)) + tilted(x), momentum(w_slope) + tilted(w)
    return [momentum(x), momentum(w), *steady]
