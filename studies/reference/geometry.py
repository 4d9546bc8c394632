"""Lengths, positions and reduced inertia by rotation matrices alone: nothing of the kernel is used."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .trajectory import Array

EX, _, EZ = np.eye(3)

# all parameters of the module by name
Parameters = Mapping[str, Any]


def turn(axis: int, angle: float | Array) -> Array:
    """Matrices of turns about axis 0, 1 or 2 (x, y, z) by angles, rad: shape of the angles, then (3, 3).

    As positions, it may be continued to complex angles.
    """
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((*np.shape(angle), 3, 3), dtype=np.result_type(angle, 1.0))
    matrix[..., axis, axis] = 1.0
    matrix[..., i, i] = matrix[..., j, j] = np.cos(angle)
    matrix[..., j, i] = np.sin(angle)
    matrix[..., i, j] = -matrix[..., j, i]
    return matrix


def ratio(p: Parameters) -> float:
    """k: turns of the drive on link 1 per turn of link 1 against link 2."""
    return float(p["sun_radius"] / p["satellite_radius"] if p["layout"] else p["z2"] / p["z16"])


def satellite_ratio(p: Parameters) -> float:
    """s: turns of the satellite on the drive per turn of the drive."""
    return float(1.0 if p["layout"] else p["z17"] / p["z6"])


def shaft_frequency(value: Callable[[str], float]) -> float:
    """Frequency of the elastic shaft between its two inertias, rad/s, from the values of parameters."""
    inertias = 1.0 / value("output_inertia") + 1.0 / value("driven_inertia")
    return math.sqrt(value("shaft_stiffness") * inertias)


def swing_frequency(value: Callable[[str], float]) -> float:
    """About the most at which link 2 swings on freewheels that wind up and on weights, rad/s; 0 without them.

    Args:
        value: of a parameter by name.
    """
    size = value("sun_radius") + value("satellite_radius") if value("layout") else value("wheel_radius")
    stiffness = value("housing_stiffness") + value("freewheel_stiffness")
    stiffness += value("imbalance_mass") * value("gravity") * size
    return math.sqrt(stiffness / value("link2_inertia")) if stiffness > 0.0 else 0.0


def bevel_lengths(p: Parameters) -> tuple[float, float, float]:
    """(AD, QA, OQ), m: the pitch cones touch on the line about which the satellite turns in link 1."""
    satellite_axis = turn(1, -p["shaft_angle"]) @ EZ
    line = EZ + satellite_ratio(p) * satellite_axis
    line /= np.linalg.norm(line)
    cone = p["wheel_radius"] / np.linalg.norm(np.cross(line, EZ))
    radius = cone * np.linalg.norm(np.cross(line, satellite_axis))
    return (
        float(p["a"] * radius),
        float(p["b"] * cone * (line @ satellite_axis)),
        float(p["c"] * cone * (line @ EZ)),
    )


def attitudes(p: Parameters, q: Array, satellite: int) -> Array:
    """Matrices that turn a satellite to where it is in link 1 at drive angles q (points,): (points, 3, 3).

    Its own axis is x (planar) or z (bevel).
    """
    place = 2.0 * np.pi * satellite / p["satellites"]
    if p["layout"]:
        planar: Array = turn(0, q + place)
        return planar
    spun = turn(1, -p["shaft_angle"]) @ turn(2, satellite_ratio(p) * q + p["epsilon"])
    bevel: Array = turn(2, q + p["gamma"] + place) @ spun
    return bevel


def positions(p: Parameters, q: Array, satellite: int) -> Array:
    """Imbalance of a satellite in the frame of link 1 at drive angles q (points,), m, shape (points, 3)."""
    turned = attitudes(p, q, satellite)
    if p["layout"]:
        place = turn(0, 2.0 * np.pi * satellite / p["satellites"])
        centre = (p["sun_radius"] + p["satellite_radius"]) * EZ
        planar: Array = place @ centre - p["eccentricity"] * turned @ EZ
        return planar
    ad, qa, oq = bevel_lengths(p)
    bevel: Array = oq * EZ + turned @ np.array([-ad, 0.0, -qa])
    return bevel


def masses(p: Parameters, q: Array, satellite: int) -> list[tuple[float, Array]]:
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


def satellite_axes(p: Parameters, q: Array, satellite: int) -> tuple[Array, Array]:
    """How a satellite turns in link 1: about its axis e, and with its drive by w dq; both (points, 3)."""
    if p["layout"]:
        axis = np.broadcast_to(EX, (np.size(q), 3))
        return axis, axis
    place = 2.0 * np.pi * satellite / p["satellites"]
    axis = turn(2, q + p["gamma"] + place) @ turn(1, -p["shaft_angle"]) @ EZ
    return axis, EZ + satellite_ratio(p) * axis


def period(p: Parameters) -> tuple[Array, Array]:
    """Drive angles evenly over a period of the motion, rad, and orders of harmonics per turn, (points,)."""
    turns = 1 if p["layout"] else int(p["z6"]) // math.gcd(int(p["z17"]), int(p["z6"]))
    points = 2 * math.ceil(4.0 * (1.0 + satellite_ratio(p)) * turns) + 16
    angles = np.linspace(0.0, 2.0 * np.pi * turns, points, endpoint=False)
    return angles, np.asarray(np.fft.fftfreq(points, turns / points))


class Series:
    """Fourier series in the drive angle of what is sampled over a period.

    Args:
        samples: any shape, the last axis along the angles of period(). orders: of the harmonics there.

    Attributes:
        highest: order of the highest harmonic, per turn of the drive.
    """

    def __init__(self, samples: Array, orders: Array) -> None:
        terms = np.fft.fft(samples) / samples.shape[-1]
        size = np.abs(terms).max(axis=tuple(range(terms.ndim - 1)))
        kept = (size > 1e-15 * size.max()) & (orders >= 0.0)
        self._waves = 1j * orders[kept]
        self.highest = float(orders[kept].max(initial=0.0))
        # a real series is twice its half of positive orders
        self._terms = terms[..., kept] * np.where(orders[kept] > 0.0, 2.0, 1.0)

    def __call__(self, q: float) -> list[Array]:
        """At a drive angle, and its first and second derivatives in it, in the shape of what was sampled."""
        waves = np.exp(self._waves * q)
        return [(self._terms @ (self._waves**n * waves)).real for n in range(3)]


class Inertia:
    """I, B, G of imbalances, gears and drives (docs/mechanics.md) as Fourier series in the drive angle.

    Attributes:
        highest: order of the highest harmonic, per turn of the drive.
    """

    def __init__(self, p: Parameters) -> None:
        angles, orders = period(p)
        sums = np.zeros((3, angles.size))
        moving = (masses(p, angles, satellite) for satellite in range(int(p["satellites"])))
        for mass, r in itertools.chain.from_iterable(moving):
            rate = np.fft.ifft(1j * orders[:, None] * np.fft.fft(r, axis=0), axis=0).real
            (_, y, z), (_, y1, z1) = r.T, rate.T
            sums += mass * np.array([y * y + z * z, y * z1 - z * y1, (rate**2).sum(axis=1)])
        sums *= p["modules"]
        # the drive's own: of the planar layout it turns with link 1 too
        sums += p["drive_inertia"] * np.array([[p["layout"]], [p["layout"]], [1.0]])
        self._series = Series(sums, orders)
        self.highest = self._series.highest

    def __call__(self, q: float) -> tuple[Array, Array]:
        """(I, B, G) at a drive angle and their derivatives, kg m^2, shape (3,) each."""
        value, slope, _ = self._series(q)
        return value, slope
