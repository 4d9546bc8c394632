"""The machine with losses in one case of its contacts, slip and signs: forces, accelerations, powers.

With A, R of virtual_work.py on (theta1, q), slip = omega1 - omega2, q' = k slip, q'' = k (alpha1 - alpha2)
and sigma = sign(q'):

    tau_q = A_q (alpha1, q'') + R_q + V_q + bq q' + sigma (C + S)    M2 = f k tau_q
    M1 = J1 alpha1 + A_1 (alpha1, q'') + R_1 + V_1 + b1 omega1 + M2
    J2 alpha2 = M2 - b2 omega2 - Tc + Th
    J3 alpha3 = Tc - b3 omega3 - Ts    J4 (alpha4 - beta alpha3) = Ts - f4 omega4 - load
    Ts = c twist + d (omega3 - omega4)

f is 1/eta where sigma M2 > 0, else 1/(2 - eta); C the friction of the journals, S that of the meshes 17-6,
linear while no satellite's torque changes its sign. An overrunning freewheel drags, -Th = drag + viscous
omega2, and so does Tc; a locked one, rigid or a spring (c phi + d phi'), passes no less than -drag. At q' = 0
links 1 and 2 turn together while |M2/k - tau_q(sigma = 0)| <= C + S + (1 - eta) |M2|/k.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from inertia_module.contract.variables import default_parameters
from inertia_module.kernel.codes import DRIVE_TORQUE, ELASTIC

from .geometry import ratio, satellite_ratio, shaft_frequency
from .trajectory import Array, Unavailable
from .virtual_work import VirtualWork

# places of a case: freewheels, signs of the slip (0: none) and of sigma M2; then those of the satellites
HOUSING, OUTPUT, SLIP, MESH, TEETH = range(5)
OPEN, CLOSED = 0, 1
# places of the state: angles and twist, speeds, wind-up of both freewheels, integrals
Q, THETA1, TWIST, OMEGA1, OMEGA2, OMEGA3, OMEGA4, WOUND = range(8)
CAUSES = ("viscous", "mesh", "journal", "freewheel", "shaft")
INTEGRALS = ("energy_in", "energy_out", *CAUSES, "M1", "M2", "Tc", "Th")
SUMS = WOUND + 2
# the unknowns of a case
A1, A2, A3, A4, M1, M2, TC, TH, TS = range(9)

Mode = tuple[int, ...]


class Forces(NamedTuple):
    """What a case makes: the unknowns, (9,), and what friction there is.

    Attributes:
        teeth: torque of each satellite, N.m, (satellites,). journal, satellites: C and S, N.m.
        free: tau_q without C and S, N.m. size: of the torques there are, N.m.
    """

    x: Array
    teeth: Array
    journal: float
    satellites: float
    free: float
    size: float


@dataclass(frozen=True)
class Freewheel:
    """Whether it is there; drag and its viscous part; stiffness (0: rigid) and damping when locked."""

    there: bool
    drag: float
    viscous: float
    stiffness: float
    damping: float


def speed_of(y: Array, place: int) -> float:
    """Relative speed at a freewheel or between links 1 and 2, rad/s: exactly zero where nothing turns."""
    return float((y[OMEGA2], y[OMEGA3] - y[OMEGA2], y[OMEGA1] - y[OMEGA2])[place])


class Machine:
    """The equations of a mechanism.

    Args:
        parameters: by name, those that differ from the defaults; fidelity elastic or, any other, rigid.

    Attributes:
        p: all parameters. load: N.m.
        torque, slope: on link 1, N.m, or its acceleration, rad/s^2: the one that is given counts.
        rubs: whether anything depends on the sign of the slip. wheels: freewheels to housing and output.
        frequency: of elastic shaft and freewheels together, rad/s. highest: harmonic of the torques.
        evaluations: so far.

    Raises:
        Unavailable: a freewheel that is not there is a spring.
    """

    def __init__(self, parameters: Mapping[str, float]) -> None:
        self.p = p = {**default_parameters(), **parameters}
        self._work, self.k = VirtualWork(p), ratio(p)
        self.elastic, self._by_torque = p["fidelity"] == ELASTIC, p["drive"] == DRIVE_TORQUE
        self.mesh = 1.0 - p["mesh_efficiency"]
        self.teeth = 0.0 if p["layout"] else (1.0 - p["satellite_mesh_efficiency"]) * satellite_ratio(p)
        self._journals = p["journal_friction"] * satellite_ratio(p)
        self.rubs = bool(self.mesh or self.teeth or self._journals)
        self.wheels = self._freewheel("housing", "housing"), self._freewheel("output", "freewheel")
        self.highest, self.frequency = max(self._work.highest, 1.0), 0.0
        if self.elastic:
            self.frequency = shaft_frequency(p.__getitem__)
            if stiffest := max(wheel.stiffness for wheel in self.wheels):
                self.frequency += math.sqrt(stiffest / min(p["link2_inertia"], p["output_inertia"]))
        self.torque = self.slope = self.load = 0.0
        self.evaluations = 0

    def _freewheel(self, name: str, spring: str) -> Freewheel:
        p = self.p
        there, sprung = bool(p[f"{name}_freewheel"]), self.elastic and p[f"{spring}_stiffness"] > 0.0
        if sprung and not there:
            raise Unavailable(f"losses: {spring}_stiffness needs the freewheel")
        drag = (p[f"{name}_drag"], p[f"{name}_drag_viscous"]) if there else (0.0, 0.0)
        return Freewheel(there, *drag, p[f"{spring}_stiffness"] if sprung else 0.0, p[f"{spring}_damping"])

    def _passed(self, y: Array, mode: Mode, place: int) -> tuple[float | None, float]:
        """(torque of a freewheel, N.m, or None where it is rigid and closed; power lost in it, W)."""
        wheel, speed = self.wheels[place], speed_of(y, place)
        if mode[place] == OPEN:
            # at rest, too, its drag is that of the motion to come
            drag = wheel.drag + wheel.viscous * speed
            return -drag, drag * speed
        if wheel.stiffness > 0.0:
            torque = wheel.stiffness * y[WOUND + place] - wheel.damping * speed
            return torque, wheel.damping * speed * speed
        return None, 0.0

    def forces(self, y: Array, mode: Mode) -> Forces:
        """Of a state in a case, whether it holds or not.

        Raises:
            LinAlgError: the case leaves a torque or an acceleration open.
        """
        self.evaluations += 1
        p, k = self.p, self.k
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        sigma, rate = mode[SLIP], k * (omega1 - omega2)
        work = self._work(y[Q], y[THETA1], omega1, rate)
        journal = self._journals * work.bearings
        # by (alpha1, alpha2) in place of (alpha1, q'')
        turned = np.array([[1.0, 0.0], [k, -k]])
        inertia, teeth = work.inertia @ turned, work.teeth @ turned
        rest = work.rest + work.weight + [0.0, p["drive_friction"] * rate]
        a, b = np.zeros((9, 9)), np.zeros(9)
        a[0, M1 if self._by_torque else A1] = 1.0
        b[0] = self.torque if self._by_torque else self.slope
        a[1, :2], a[1, M1], a[1, M2] = inertia[0], -1.0, 1.0
        a[1, A1] += p["input_inertia"]
        b[1] = -rest[0] - p["input_friction"] * omega1
        if sigma == 0 and (self._by_torque or mode[HOUSING] == OPEN or self.wheels[HOUSING].stiffness):
            a[2, A1], a[2, A2] = 1.0, -1.0
        else:
            # where link 1 is at rest as it is given and link 2 is held, friction allows any M2: as without it
            signs = self.teeth * p["modules"] * np.array(mode[TEETH:])
            factor = k / (1.0 - self.mesh * mode[MESH] * abs(sigma))
            a[2, :2], a[2, M2] = -factor * (inertia[1] + sigma * signs @ teeth), 1.0
            b[2] = factor * (rest[1] + sigma * (journal + signs @ work.teeth_rest))
        a[3, [A2, M2, TC, TH]] = p["link2_inertia"], -1.0, 1.0, -1.0
        b[3] = -p["link2_friction"] * omega2
        a[4, [A3, TC, TS]] = p["output_inertia"], -1.0, 1.0
        b[4] = -p["output_friction"] * omega3
        a[5, TS], a[6, A4], a[6, A3] = 1.0, 1.0, -1.0
        b[5] = self.load
        if self.elastic:
            b[5] = p["shaft_stiffness"] * y[TWIST] + p["shaft_damping"] * (omega3 - omega4)
            a[6, [A4, A3, TS]] = p["driven_inertia"], -p["balancer"] * p["driven_inertia"], -1.0
            b[6] = -p["driven_friction"] * omega4 - self.load
        for row, place, torque in ((7, HOUSING, TH), (8, OUTPUT, TC)):
            passed, _ = self._passed(y, mode, place)
            if passed is not None:
                a[row, torque], b[row] = 1.0, passed
            else:
                a[row, A2] = 1.0
                a[row, A3] = -1.0 if place == OUTPUT else 0.0
        x = np.linalg.solve(a, b)
        torques = teeth @ x[:2] + work.teeth_rest
        satellites = self.teeth * p["modules"] * float(np.abs(torques).sum())
        size = float(np.abs(x[M1:]).sum() + self._work.largest * (omega1 * omega1 + rate * rate))
        free = float(inertia[1] @ x[:2] + rest[1])
        return Forces(np.asarray(x), torques, journal, satellites, free, size)

    def rates(self, y: Array, mode: Mode) -> Array:
        """Of the state: those of the integrals are powers, W, and torques, N.m."""
        p, found = self.p, self.forces(y, mode)
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        x, slip = found.x, omega1 - omega2
        rate = self.k * slip
        viscous = p["input_friction"] * omega1**2 + p["drive_friction"] * rate**2
        viscous += p["link2_friction"] * omega2**2 + p["output_friction"] * omega3**2
        shaft = 0.0
        if self.elastic:
            shaft = p["shaft_damping"] * (omega3 - omega4) ** 2 + p["driven_friction"] * omega4**2
            shaft -= p["balancer"] * p["driven_inertia"] * x[A3] * omega4
        wheels = sum(self._passed(y, mode, place)[1] for place in (HOUSING, OUTPUT))
        wound = [-speed_of(y, n) * (mode[n] == CLOSED) for n in (HOUSING, OUTPUT)]
        mesh = self.mesh * abs(x[M2] * slip) + found.satellites * abs(rate)
        powers = x[M1] * omega1, self.load * omega4, viscous, mesh, found.journal * abs(rate), wheels, shaft
        return np.array([rate, omega1, omega3 - omega4, *x[: A4 + 1], *wound, *powers, *x[M1 : TH + 1]])

    def energy(self, y: Array) -> float:
        """Kinetic energy, that of the weights and of shaft and freewheels that are wound up, J."""
        p = self.p
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        work, moved = self._work(y[Q], y[THETA1], omega1, 0.0), np.array([omega1, self.k * (omega1 - omega2)])
        twice = p["input_inertia"] * omega1**2 + p["link2_inertia"] * omega2**2
        twice += p["output_inertia"] * omega3**2
        if self.elastic:
            twice += p["driven_inertia"] * omega4**2 + p["shaft_stiffness"] * y[TWIST] ** 2
        twice += sum(wheel.stiffness * y[WOUND + n] ** 2 for n, wheel in enumerate(self.wheels))
        return float(0.5 * (moved @ work.inertia @ moved + twice) + work.height)
