"""Lengths and positions by rotation matrices, without any code of the kernel."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# parameters of the module by name
Parameters = Mapping[str, Any]

EX, _, EZ = np.eye(3)


class UnavailableError(RuntimeError):
    """A method does not support a case; the message is the reason."""


def turn(axis: int, angle: float | Array) -> Array:
    """Return rotation matrices about an axis, with the shape of the angles and (3, 3).

    Args:
        axis: 0, 1 or 2 for x, y or z.
        angle: angles, rad; complex angles are allowed.
    """
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((*np.shape(angle), 3, 3), dtype=np.result_type(angle, 1.0))
    matrix[..., axis, axis] = 1.0
    matrix[..., i, i] = matrix[..., j, j] = np.cos(angle)
    matrix[..., j, i] = np.sin(angle)
    matrix[..., i, j] = -matrix[..., j, i]
    return matrix


def ratio(p: Parameters) -> float:
    """Return k: revolutions of the pinion shaft per revolution of link 1 relative to link 2.

    Args:
        p: parameters by name.
    """
    return float(p["sun_radius"] / p["satellite_radius"] if p["layout"] else p["z2"] / p["z16"])


def satellite_ratio(p: Parameters) -> float:
    """Return s: revolutions of the satellite relative to the pinion shaft per revolution of the pinion shaft.

    Args:
        p: parameters by name.
    """
    return float(1.0 if p["layout"] else p["z17"] / p["z6"])


def shaft_frequency(value: Callable[[str], float]) -> float:
    """Return the natural frequency of the elastic shaft between its two inertias, rad/s.

    Args:
        value: function that returns a parameter by name.
    """
    inertias = 1.0 / value("output_inertia") + 1.0 / value("driven_inertia")
    return math.sqrt(value("shaft_stiffness") * inertias)


def swing_frequency(value: Callable[[str], float]) -> float:
    """Estimate the maximum natural frequency of link 2 on wind-up springs and weights, rad/s; 0 without them.

    Args:
        value: function that returns a parameter by name.
    """
    size = value("sun_radius") + value("satellite_radius") if value("layout") else value("wheel_radius")
    stiffness = value("housing_stiffness") + value("freewheel_stiffness")
    stiffness += value("imbalance_mass") * value("gravity") * size
    return math.sqrt(stiffness / value("link2_inertia")) if stiffness > 0.0 else 0.0


def bevel_lengths(p: Parameters) -> tuple[float, float, float]:
    """Return the lengths AD, QA and OQ in m.

    The pitch cones touch on the instantaneous axis of the satellite in link 1.

    Args:
        p: parameters by name.
    """
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
    """Return the orientations of a satellite in the frame of link 1, (points, 3, 3).

    The axis of the satellite is x (planar) or z (bevel).

    Args:
        p: parameters by name.
        q: pinion-shaft angles, rad, (points,).
        satellite: number of the satellite.
    """
    place = 2.0 * np.pi * satellite / p["satellites"]
    if p["layout"]:
        planar: Array = turn(0, q + place)
        return planar
    satellite_frame = turn(1, -p["shaft_angle"]) @ turn(2, satellite_ratio(p) * q + p["epsilon"])
    bevel: Array = turn(2, q + p["gamma"] + place) @ satellite_frame
    return bevel


def positions(p: Parameters, q: Array, satellite: int) -> Array:
    """Return the positions of an unbalanced mass in the frame of link 1, m, (points, 3).

    Args:
        p: parameters by name.
        q: pinion-shaft angles, rad, (points,).
        satellite: number of the satellite.
    """
    orientation = attitudes(p, q, satellite)
    if p["layout"]:
        place = turn(0, 2.0 * np.pi * satellite / p["satellites"])
        centre = (p["sun_radius"] + p["satellite_radius"]) * EZ
        planar: Array = place @ centre - p["eccentricity"] * orientation @ EZ
        return planar
    ad, qa, oq = bevel_lengths(p)
    bevel: Array = oq * EZ + orientation @ np.array([-ad, 0.0, -qa])
    return bevel
