"""All links by SciPy under a given input torque: Lagrange, contacts as constraints, shaft rigid or elastic.

The masses come from positions by rotation matrices, the contact torques as multipliers; nothing of the
kernel takes part.
"""

import math

import numpy as np
from geometry import direct_sums, ratio
from scenes import parameters
from scipy.integrate import solve_ivp

POINTS = 256
ELASTIC = 3
# relative velocity of each freewheel, of (omega1, omega2, omega3, omega4): it is never negative
GAPS = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, -1.0, 1.0, 0.0]])
# where the speeds begin
SPEEDS = 3
LINK2, SHAFT = SPEEDS + 1, SPEEDS + 2
HOUSING, OUTPUT = 0, 1


class TorqueDriven:
    """A module with constant torques at both ends.

    Attributes:
        y: q, the angle of link 1, the twist of the shaft, omega1 to omega3 and, elastic, omega4.
        closed: freewheels that hold now.
    """

    def __init__(self, values, tolerance=1e-12):
        self.p = p = parameters(**values)
        self.torque, self.load = p.pop("drive_torque"), p.pop("load_torque")
        self.tolerance = tolerance
        self.k = ratio(p)
        self.elastic = p["fidelity"] == ELASTIC
        links = ["input_inertia", "link2_inertia", "output_inertia", "driven_inertia"]
        self.links = len(links) if self.elastic else len(links) - 1
        self.rigid = np.diag([p[name] for name in links[: self.links]])
        self.gaps = GAPS[:, : self.links]
        if self.elastic:
            self.rigid[3, 2] = -p["balancer"] * p["driven_inertia"]
        turns = 1 if p["layout"] else p["z6"] // math.gcd(p["z17"], p["z6"])
        samples = np.array(
            [direct_sums(p, 2.0 * np.pi * turns * n / POINTS)[[0, 3, 5]] for n in range(POINTS)]
        )
        terms = np.fft.fft(samples, axis=0) / POINTS
        orders = np.fft.fftfreq(POINTS, 1.0 / POINTS) / turns
        large = np.abs(terms).max(axis=1) > 1e-15 * np.abs(terms).max()
        self.orders, self.terms = orders[large], terms[large].T
        speeds = [p.pop("omega1"), p["omega2_start"], p["omega_out_start"], p["omega_out_start"]]
        self.y = np.array([p["drive_angle_start"], 0.0, 0.0, *speeds[: self.links]])
        self.there = [p["housing_freewheel"], p["output_freewheel"]]
        self.closed = self.first_contacts()

    def masses(self, q):
        """Mass matrix of links 1 and 2 without their own inertias, and its slope in q."""
        k = self.k
        waves = np.exp(1j * self.orders * q)
        found = []
        for i, b, g in ((self.terms @ waves).real, (self.terms @ (1j * self.orders * waves)).real):
            coupling = -k * (b + k * g)
            found.append(np.array([[i + 2.0 * k * b + k * k * g, coupling], [coupling, k * k * g]]))
        return found

    def outer_torques(self, y):
        """Torques on all links that the freewheels do not give."""
        if not self.elastic:
            return np.array([self.torque, 0.0, -self.load])
        p, (hub, driven) = self.p, y[-2:]
        shaft = p["shaft_stiffness"] * y[2] + p["shaft_damping"] * (hub - driven)
        return np.array([self.torque, 0.0, -shaft, shaft - p["driven_friction"] * driven - self.load])

    def solve(self, y, closed):
        """(accelerations of all links, torques of the closed contacts)."""
        w = y[SPEEDS : SPEEDS + 2]
        own, slope = self.masses(y[0])
        mass, force = self.rigid.copy(), self.outer_torques(y)
        mass[:2, :2] += own
        force[:2] += (
            0.5 * self.k * (w @ slope @ w) * np.array([1.0, -1.0]) - self.k * (w[0] - w[1]) * slope @ w
        )
        held = self.gaps[list(closed)]
        count = len(held)
        matrix = np.block([[mass, -held.T], [held, np.zeros((count, count))]])
        found = np.linalg.solve(matrix, [*force, *[0.0] * count])
        return found[: self.links], dict(zip(closed, found[self.links :], strict=True))

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
        return not self.there[n] or self.gaps[n] @ self.y[SPEEDS:] != 0.0

    def rates(self, _, y):
        w = y[SPEEDS:]
        twisting = w[2] - w[3] if self.elastic else 0.0
        return [self.k * (w[0] - w[1]), w[0], twisting, *self.solve(y, self.closed)[0]]

    def guards(self):
        """For each freewheel what falls through zero when it opens or closes."""
        found = []
        for n in (HOUSING, OUTPUT):

            def falls(_, y, n=n):
                if not self.there[n]:
                    return 1.0
                return self.solve(y, self.closed)[1][n] if n in self.closed else self.gaps[n] @ y[SPEEDS:]

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
                self.y[LINK2] = 0.0
            if OUTPUT in self.closed:
                slower = LINK2 if HOUSING in self.closed else SHAFT
                self.y[[LINK2, SHAFT]] = self.y[slower]
