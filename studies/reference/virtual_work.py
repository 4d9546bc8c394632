"""What imbalances, drives and satellites ask of links 1 and 2: virtual work of their inertia and weight.

From positions and their Fourier series alone (d'Alembert): neither I, B, G nor Lagrange's equations are used.
All in the frame of link 1, x along the central axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .geometry import EX, EZ, Parameters, Series, bevel_lengths, period, positions, satellite_axes
from .trajectory import Array

# turns a vector by a right angle about Ox, and keeps what is across it
ABOUT_X = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
ACROSS_X = np.diag([0.0, 1.0, 1.0])


@dataclass(frozen=True)
class Work:
    """Torques of inertia and weight on theta1 and q at a position and speeds, of all modules.

    Attributes:
        inertia: by the accelerations (alpha1, q''), kg m^2, (2, 2). rest: of the speeds alone, N.m, (2,).
        weight: of gravity, N.m, (2,). height: m g z, J.
        teeth, teeth_rest: torque m a . dr/dB of each satellite of a module in the same way, (n, 2), (n,).
        bearings: sum of m |a| over all imbalances, of the speeds alone, N.
    """

    inertia: Array
    rest: Array
    weight: Array
    height: float
    teeth: Array
    teeth_rest: Array
    bearings: float


class VirtualWork:
    """Of one mechanism.

    Args:
        p: all parameters of the module by name.

    Attributes:
        highest: order of the highest harmonic of the torques, per turn of the drive.
        largest: inertia of all imbalances where they are farthest out, kg m^2.
    """

    def __init__(self, p: Parameters) -> None:
        angles, orders = period(p)
        # a point on the axes of the satellites (in the planar layout the drives' own are not asked for)
        pivot = np.zeros(3) if p["layout"] else bevel_lengths(p)[2] * EZ
        samples = []
        for satellite in range(int(p["satellites"])):
            r = positions(p, angles, satellite)
            axis, turning = satellite_axes(p, angles, satellite)
            samples.append([r.T, np.cross(axis, r - pivot).T, axis.T, turning.T])
        self._series = Series(np.array(samples), orders)
        self.highest = 2.0 * self._series.highest
        self._mass, self._modules = p["imbalance_mass"], p["modules"]
        self.largest = self._mass * self._modules * float(sum((r * r).sum(axis=0).max() for r, *_ in samples))
        self._weight = p["imbalance_mass"] * p["gravity"] * (p["modules"] == 1)
        self._across = p["satellite_transverse_inertia"]
        self._along = p["satellite_inertia"] - self._across
        own = p["drive_inertia"]
        self._drives = own * np.array([[p["layout"], p["layout"]], [p["layout"], 1.0]])

    def __call__(self, q: float, theta1: float, omega1: float, rate: float) -> Work:
        """At a drive angle q and link angle, rad, with the speeds omega1 and q', rad/s."""
        value, slope, second = self._series(q)
        (r, r_b), (r1, _), (r2, _) = (series[:, :2].swapaxes(0, 1) for series in (value, slope, second))
        # a = a_c + alpha1 (x cross r) + q'' r'
        moved = np.stack([r @ ABOUT_X.T, r1])
        central = rate * rate * r2 + 2.0 * omega1 * rate * (r1 @ ABOUT_X.T) - omega1 * omega1 * (r @ ACROSS_X)
        flat = moved.reshape(2, -1)
        masses = self._mass * self._modules
        inertia = masses * flat @ flat.T + self._drives
        rest = masses * flat @ central.ravel()
        if self._across or self._along:
            body, body_rest = self._bodies(value[:, 2:], slope[:, 2:], omega1, rate)
            inertia, rest = inertia + self._modules * body, rest + self._modules * body_rest
        up = np.array([0.0, math.sin(theta1), math.cos(theta1)])
        return Work(
            inertia=inertia,
            rest=rest,
            weight=self._weight * (moved.sum(axis=1) @ up),
            height=float(self._weight * (r.sum(axis=0) @ up)),
            teeth=self._mass * (moved * r_b).sum(axis=2).T,
            teeth_rest=self._mass * (central * r_b).sum(axis=1),
            bearings=float(masses * np.sqrt((central * central).sum(axis=1)).sum()),
        )

    def _bodies(self, value: Array, slope: Array, omega1: float, rate: float) -> tuple[Array, Array]:
        """Of the satellites' gears in a module: (inertia, rest) by Euler's equations.

        d/dt L in the fixed frame with L = Jt w + (Ja - Jt) (e.w) e of the turn w = omega1 x + q' w_q.
        """
        inertia, rest = np.zeros((2, 2)), np.zeros(2)
        for (e, turning), (e1, turning1) in zip(value, slope, strict=True):
            tensor = self._across * np.eye(3) + self._along * np.outer(e, e)
            w, e_rate = omega1 * EX + rate * turning, rate * e1
            gyroscopic = tensor @ (rate * rate * turning1) + omega1 * np.cross(EX, tensor @ w)
            gyroscopic += self._along * ((e_rate @ w) * e + (e @ w) * e_rate)
            moved = np.stack([EX, turning])
            inertia += moved @ tensor @ moved.T
            rest += moved @ gyroscopic
        return inertia, rest
