"""Links 1, 2 and the output shaft by SciPy with the input torque given: Lagrange, contacts as constraints.

The masses come from positions by rotation matrices, the contact torques as multipliers; nothing of the
kernel takes part.
"""

import math

import numpy as np
from geometry import direct_sums, ratio
from scenes import parameters
from scipy.integrate import solve_ivp

POINTS = 256
# relative velocity of each freewheel, of (omega1, omega2, omega3): it is never negative
GAPS = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
HOUSING, OUTPUT = 0, 1


class TorqueDriven:
    """A module with constant torques at both ends.

    Attributes:
        y: q, omega1, omega2, omega3 and the angle of link 1, none of them wrapped.
        closed: freewheels that hold now.
    """

    def __init__(self, values, tolerance=1e-12):
        self.p = p = parameters(**values)
        self.torque, self.load = p.pop("drive_torque"), p.pop("load_torque")
        self.tolerance = tolerance
        self.k = ratio(p)
        self.rigid = np.diag([p["input_inertia"], p["link2_inertia"], p["output_inertia"]])
        turns = 1 if p["layout"] else p["z6"] // math.gcd(p["z17"], p["z6"])
        samples = np.array(
            [direct_sums(p, 2.0 * np.pi * turns * n / POINTS)[[0, 3, 5]] for n in range(POINTS)]
        )
        terms = np.fft.fft(samples, axis=0) / POINTS
        orders = np.fft.fftfreq(POINTS, 1.0 / POINTS) / turns
        large = np.abs(terms).max(axis=1) > 1e-15 * np.abs(terms).max()
        self.orders, self.terms = orders[large], terms[large].T
        self.y = np.array(
            [p["drive_angle_start"], p.pop("omega1"), p["omega2_start"], p["omega_out_start"], 0.0]
        )
        self.there = [p["housing_freewheel"], p["output_freewheel"]]
        self.closed = self.first_contacts()

    def masses(self, q):
        """Mass matrix of (omega1, omega2, omega3) without the inertias of the links, and its slope in q."""
        k = self.k
        waves = np.exp(1j * self.orders * q)
        found = []
        for i, b, g in ((self.terms @ waves).real, (self.terms @ (1j * self.orders * waves)).real):
            coupling = -k * (b + k * g)
            found.append(
                np.array([[i + 2.0 * k * b + k * k * g, coupling, 0], [coupling, k * k * g, 0], [0] * 3])
            )
        return found

    def solve(self, y, closed):
        """(accelerations of links 1, 2 and the shaft, torques of the closed contacts)."""
        w = y[1:4]
        mass, slope = self.masses(y[0])
        rate = self.k * (w[0] - w[1])
        force = 0.5 * self.k * (w @ slope @ w) * np.array([1.0, -1.0, 0.0]) - rate * slope @ w
        force += [self.torque, 0.0, -self.load]
        held = GAPS[list(closed)]
        count = len(held)
        matrix = np.block([[self.rigid + mass, -held.T], [held, np.zeros((count, count))]])
        found = np.linalg.solve(matrix, [*force, *[0.0] * count])
        return found[:3], dict(zip(closed, found[3:], strict=True))

    def first_contacts(self):
        """What touches at the start and is pushed together."""
        closed = [n for n in (HOUSING, OUTPUT) if not self.is_open(n)]
        for _ in range(2):
            pulled = [
                n for n, torque in self.solve(self.y, closed)[1].items() if torque < 0.0 and self.there[n]
            ]
            closed = [n for n in closed if n not in pulled[-1:]]
        return closed

    def is_open(self, n):
        if n == OUTPUT and not self.there[n]:
            return False
        return not self.there[n] or GAPS[n] @ self.y[1:4] != 0.0

    def rates(self, _, y):
        return [self.k * (y[1] - y[2]), *self.solve(y, self.closed)[0], y[1]]

    def guards(self):
        """For each freewheel what falls through zero when it opens or closes."""
        found = []
        for n in (HOUSING, OUTPUT):

            def falls(_, y, n=n):
                if not self.there[n]:
                    return 1.0
                return self.solve(y, self.closed)[1][n] if n in self.closed else GAPS[n] @ y[1:4]

            falls.terminal, falls.direction = True, -1
            found.append(falls)
        return found

    def run(self, duration):
        """This after a while, and the number of events met."""
        time, events = 0.0, 0
        while True:
            found = solve_ivp(
                self.rates,
                (time, duration),
                self.y,
                "DOP853",
                rtol=self.tolerance,
                atol=self.tolerance,
                max_step=1e-3,
                events=self.guards(),
            )
            time, self.y = found.t[-1], found.y[:, -1]
            if found.status == 0:
                return events
            events += 1
            which = next(n for n, times in enumerate(found.t_events) if times.size)
            if which in self.closed:
                self.closed.remove(which)
                continue
            self.closed = sorted([*self.closed, which])
            if HOUSING in self.closed:
                self.y[2] = 0.0
            if OUTPUT in self.closed:
                self.y[3] = self.y[2] if HOUSING in self.closed else self.y[3]
                self.y[2] = self.y[3]
