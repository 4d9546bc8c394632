"""Lengths and positions by rotation matrices alone: nothing of the kernel is used."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# all parameters of the module by name
Parameters = Mapping[str, Any]

EX, _, EZ = np.eye(3)


class UnavailableError(RuntimeError):
    """A method cannot take the case: why, in one line."""


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
    """About the most at which link 2 swings on freewheels that wind up and on weights, rad/s, or 0."""
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
