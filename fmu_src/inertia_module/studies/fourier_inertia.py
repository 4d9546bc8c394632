"""Reduced inertia as a Fourier series in the drive angle, from positions by rotation matrices alone.

Nothing of the kernel is used; all in extended precision, where the machine has it.
"""

from __future__ import annotations

import math

import numpy as np

from .collocation import Extended
from .trajectory import Case

REAL = np.longdouble


def _turn(axis: int, angle: Extended) -> Extended:
    """Rotation matrices about a coordinate axis, shape (points, 3, 3)."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((angle.size, 3, 3), dtype=REAL)
    matrix[:, axis, axis] = 1
    matrix[:, u, u] = matrix[:, v, v] = np.cos(angle)
    matrix[:, v, u] = np.sin(angle)
    matrix[:, u, v] = -np.sin(angle)
    return matrix


class Inertia:
    """I, B, G (and their derivatives) of the case's mechanism as Fourier series in q."""

    def __init__(self, case: Case) -> None:
        self.planar = case.parameter("layout") == 1.0
        self._case = case
        s, turns = self._satellite()
        points = 2 * math.ceil(4 * (1 + s) * turns) + 16
        full = 8 * np.arctan(REAL(1))  # 2 pi beyond double
        angles = full * turns * np.arange(points, dtype=REAL) / points
        orders = np.fft.fftfreq(points, 1 / points).astype(REAL) / turns
        waves = np.exp(-1j * np.outer(orders, angles)) / points
        back = np.exp(1j * np.outer(angles, orders))
        sums = np.zeros((3, points), dtype=REAL)
        for satellite in range(int(case.parameter("satellites"))):
            r = self._positions(angles, satellite)
            rate = (back @ (1j * orders[:, None] * (waves @ r))).real
            sums[0] += r[:, 1] ** 2 + r[:, 2] ** 2
            sums[1] += r[:, 1] * rate[:, 2] - r[:, 2] * rate[:, 1]
            sums[2] += (rate**2).sum(axis=1)
        sums *= REAL(case.parameter("imbalance_mass")) * int(case.parameter("modules"))
        own = REAL(case.parameter("drive_inertia"))
        sums += own * np.array([[self.planar], [self.planar], [1]], dtype=REAL)
        coefficients = sums @ waves.T
        size = np.abs(coefficients).max(axis=0)
        kept = (size > 1e-16 * size.max()) & (orders >= 0)
        self._orders = orders[kept]
        self.highest = self._orders.max()
        # a real series: twice the half with positive orders
        self._terms = coefficients[:, kept] * np.where(self._orders > 0, 2, 1)

    def _satellite(self) -> tuple[float, int]:
        """Turns of the satellite per turn of the drive, and turns of the drive in one period."""
        if self.planar:
            return 1.0, 1
        z17, z6 = int(self._case.parameter("z17")), int(self._case.parameter("z6"))
        return z17 / z6, z6 // math.gcd(z17, z6)

    def _positions(self, q: Extended, satellite: int) -> Extended:
        """Imbalance of a satellite in the frame of link 1, m, shape (points, 3)."""
        p = self._case.parameter
        full = 8 * np.arctan(REAL(1))
        place = np.full(q.size, full * satellite / int(p("satellites")))
        if self.planar:
            arm = np.array([0, 0, -p("eccentricity")], dtype=REAL)
            centre = np.array([0, 0, REAL(p("sun_radius")) + REAL(p("satellite_radius"))])
            return np.einsum("nij,nj->ni", _turn(0, place), centre + _turn(0, q) @ arm)
        s = REAL(p("z17")) / REAL(p("z6"))
        tilt = _turn(1, np.array([-REAL(p("shaft_angle"))]))[0]
        # the satellite rolls about the line of the sum of both spins; its length from the pitch radius
        line = np.array([0, 0, 1], dtype=REAL) + s * tilt[:, 2]
        line /= np.sqrt(line @ line)
        cone = REAL(p("wheel_radius")) / np.sqrt(line[0] ** 2 + line[1] ** 2)
        along = line @ tilt[:, 2]
        across = np.sqrt(1 - along * along)
        place_on_satellite = np.array([-p("a") * cone * across, 0, -p("b") * cone * along], dtype=REAL)
        spun = _turn(2, s * q + REAL(p("epsilon"))) @ place_on_satellite
        turned = np.einsum("nij,nj->ni", _turn(2, q + REAL(p("gamma")) + place), spun @ tilt.T)
        return turned + np.array([0, 0, p("c") * cone * line[2]], dtype=REAL)

    def __call__(self, q: Extended) -> tuple[Extended, Extended]:
        """(I, B, G) and their derivatives at the angles q, shape (3, points) each."""
        waves = np.exp(1j * self._orders[:, None] * q[None, :])
        return (self._terms @ waves).real, (self._terms @ (1j * self._orders[:, None] * waves)).real
