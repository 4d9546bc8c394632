"""The machine with losses in one case of its contacts, slip and signs: forces, accelerations, powers.

With A, R of virtual_work.py on (theta1, q), slip = omega1 - omega2, q' = k slip, q'' = k (alpha1 - alpha2)
and sigma = sign(q'):

    tau_q = A_q (alpha1, q'') + R_q + V_q + bq q' + sigma (C + S)    M2 = f k tau_q    (air in V_q and V_1)
    M1 = J1 alpha1 + A_1 (alpha1, q'') + R_1 + V_1 + b1 omega1 + M2
    J2 alpha2 = M2 - b2 omega2 - Tc + Th
    J3 alpha3 = Tc - b3 omega3 - Ts    J4 (alpha4 - beta alpha3) = Ts - f4 omega4 - load
    Ts = c twist + d (omega3 - omega4)

f is 1/eta where sigma M2 > 0, else 1/(2 - eta); C the friction of the journals, S that of the meshes 17-6,
linear while no satellite's torque changes its sign. An overrunning freewheel drags, -Th = drag + viscous
omega2, and so does Tc; a locked one, rigid or a spring (c phi + d phi'), passes no less than -drag. One that
turns back through its play passes nothing; its drag may hold it there, and passes no more than 0. At q' = 0
links 1 and 2 turn together while |M2/k - tau_q(sigma = 0)| <= C + S + (1 - eta) |M2|/k.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from inertia_module.interface.variables import default_parameters
from inertia_module.kernel.codes import DRIVE_TORQUE, ELASTIC

from .geometry import EX, EZ, Array, UnavailableError, attitudes, ratio, satellite_ratio, shaft_frequency
from .virtual_work import VirtualWork

# places of a case: freewheels, signs of the slip (0: none) and of sigma M2; then those of the satellites
HOUSING, OUTPUT, SLIP, MESH, TEETH = range(5)
# of a freewheel; with play left it turns back, or its drag holds it
OPEN, CLOSED, BACK, DRAGGED = range(4)
# places of the state: angles and twist, speeds, wind-up and play of both freewheels, integrals
Q, THETA1, TWIST, OMEGA1, OMEGA2, OMEGA3, OMEGA4, WOUND, _, PLAY, _, SUMS = range(12)
CAUSES = ("viscous", "mesh", "journal", "freewheel", "shaft", "windage")
INTEGRALS = ("energy_in", "energy_out", *CAUSES, "M1", "M2", "Tc", "Th")
# the unknowns of a case
A1, A2, A3, A4, M1, M2, TC, TH, TS = range(9)

Mode = tuple[int, ...]


class Forces(NamedTuple):
    """Unknowns and friction of a case, of one state or, in a last axis, of several.

    Attributes:
        x: the unknowns, (9,). teeth: what friction 17-6 makes of the torque of each satellite, N.m.
        journal, satellites: C and S, N.m. free: tau_q without C and S, N.m. All of them 0 without friction.
    """

    x: Array
    teeth: Array
    journal: Array
    satellites: Array
    free: Array


@dataclass(frozen=True)
class Freewheel:
    """Freewheel: if it is there; drag, its viscous part; play; stiffness (0: rigid), damping when locked."""

    there: bool
    drag: float
    viscous: float
    angle: float
    stiffness: float
    damping: float


def speed_of(y: Array, place: int) -> Array:
    """Relative speed at a freewheel or between links 1 and 2, rad/s: exactly zero where nothing turns."""
    speed: Array = y[(OMEGA2, OMEGA3, OMEGA1)[place]]
    return speed if place == HOUSING else speed - y[OMEGA2]


class Machine:
    """The equations of a mechanism.

    Args:
        parameters: by name, those that differ from the defaults; fidelity elastic or, any other, rigid.

    Attributes:
        p: all parameters. load: N.m.
        torque, slope: on link 1, N.m, or its acceleration, rad/s^2: the one that is given counts.
        rubs: whether anything depends on the sign of the slip. wheels: freewheels to housing and output.
        frequency: of elastic shaft and freewheels together, rad/s. highest: harmonic of the torques.

    Raises:
        UnavailableError: a freewheel that is not there is a spring.
    """

    def __init__(self, parameters: Mapping[str, float]) -> None:
        self.p = p = {**default_parameters(), **parameters}
        self.work, self.k = VirtualWork(p), ratio(p)
        self.elastic, self._by_torque = p["fidelity"] == ELASTIC, p["drive"] == DRIVE_TORQUE
        self.mesh = 1.0 - p["mesh_efficiency"]
        self.teeth = not p["layout"] and p["satellite_mesh_efficiency"] < 1.0
        self._journals = p["journal_friction"] > 0.0
        self.rubs = bool(self.mesh or self.teeth or self._journals)
        self.wheels = self._freewheel("housing", "housing"), self._freewheel("output", "freewheel")
        self.highest, self.frequency = max(self.work.highest, 1.0), 0.0
        if self.elastic:
            self.frequency = shaft_frequency(p.__getitem__)
            if stiffest := max(wheel.stiffness for wheel in self.wheels):
                self.frequency += math.sqrt(stiffest / min(p["link2_inertia"], p["output_inertia"]))
        self.torque = self.slope = self.load = 0.0
        self._matrices = dict[Mode, Array]()

    def _freewheel(self, name: str, spring: str) -> Freewheel:
        p = self.p
        there, sprung = bool(p[f"{name}_freewheel"]), self.elastic and p[f"{spring}_stiffness"] > 0.0
        if sprung and not there:
            raise UnavailableError(f"reference: {spring}_stiffness needs the freewheel")
        own = (p[f"{name}_{value}"] * there for value in ("drag", "drag_viscous", "engagement_angle"))
        drag, viscous, angle = own
        stiffness = p[f"{spring}_stiffness"] if sprung else 0.0
        return Freewheel(there, drag, viscous, angle, stiffness, p[f"{spring}_damping"])

    def joined(self, mode: Mode, place: int) -> bool:
        """Tell whether a freewheel is closed and rigid, or held: the speeds at it are the same."""
        return mode[place] == DRAGGED or (mode[place] == CLOSED and not self.wheels[place].stiffness)

    def _passed(self, y: Array, mode: Mode, place: int) -> tuple[Array, Array]:
        """(torque of a freewheel that joins nothing, N.m; power lost in it, W)."""
        wheel, speed = self.wheels[place], speed_of(y, place)
        if mode[place] == OPEN:
            # at rest, too, its drag is that of the motion to come
            drag = wheel.drag + wheel.viscous * speed
            return -drag, drag * speed
        if mode[place] == BACK:
            return 0.0 * speed, 0.0 * speed
        return wheel.stiffness * y[WOUND + place] - wheel.damping * speed, wheel.damping * speed**2

    def _matrix(self, mode: Mode, link1: Array, drive: Array) -> Array:
        """Matrix of the unknowns of a case, (9, 9), or of several states, (n, 9, 9).

        Args:
            link1, drive: torques on theta1 and M2 by alpha1 and alpha2, kg m^2, (2,).
        """
        if mode not in self._matrices:
            p, a = self.p, np.zeros((9, 9))
            a[0, M1 if self._by_torque else A1] = 1.0
            a[1, [A1, M1, M2]] = p["input_inertia"], -1.0, 1.0
            a[2, M2] = 1.0
            a[3, [A2, M2, TC, TH]] = p["link2_inertia"], -1.0, 1.0, -1.0
            a[4, [A3, TC, TS]] = p["output_inertia"], -1.0, 1.0
            a[5, TS], a[6, A4], a[6, A3] = 1.0, 1.0, -1.0
            if self.elastic:
                a[6, [A4, A3, TS]] = p["driven_inertia"], -p["balancer"] * p["driven_inertia"], -1.0
            a[7, A2 if self.joined(mode, HOUSING) else TH] = 1.0
            a[8, A3 if self.joined(mode, OUTPUT) else TC] = 1.0
            if self.joined(mode, OUTPUT):
                a[8, A2] = -1.0
            self._matrices[mode] = a
        fixed = self._matrices[mode]
        matrix = np.empty((*link1.shape[1:], *fixed.shape))
        matrix[:] = fixed
        matrix[..., 1, :2] += link1.T
        matrix[..., 2, :2] = -drive.T
        return matrix

    def forces(self, y: Array, mode: Mode) -> Forces:
        """Solve a case at a state, whether it holds or not, or at several states, (places, n).

        Raises:
            LinAlgError: the case leaves a torque or an acceleration open.
        """
        p, k, sigma = self.p, self.k, mode[SLIP]
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        rate = k * (omega1 - omega2)
        squares = np.array([omega1 * omega1, omega1 * rate, rate * rate])
        work, bearings, weights = self.work(y[Q])
        # by (alpha1, alpha2, 1)
        torques = work[:, :3].copy()
        torques[:, 2] = (work[:, 2:] * squares).sum(axis=1)
        torques[1, 2] += p["drive_friction"] * rate
        if p["windage"]:
            torques[:2, 2] += self.air(y)[:2]
        if p["gravity"]:
            weight, sine, cosine = weights.sum(axis=0), np.sin(y[THETA1]), np.cos(y[THETA1])
            torques[0, 2] += weight[0, 0] * cosine - weight[0, 1] * sine
            torques[1, 2] += weight[1, 0] * sine + weight[1, 1] * cosine
        link1, drive, teeth = torques[0], torques[1], torques[2:]
        journal = 0.0 * rate
        if self._journals:
            felt = (bearings * squares).sum(axis=2)
            journal = np.sqrt((felt * felt).sum(axis=1)).sum(axis=0)
        if sigma and self.rubs:
            drive = drive + sigma * np.tensordot(mode[TEETH:], teeth, 1)
            drive[2] += sigma * journal
        factor = k / (1.0 - self.mesh * mode[MESH] * abs(sigma))
        b = np.zeros((9, *rate.shape))
        b[0] = self.torque if self._by_torque else self.slope
        b[1] = -link1[2] - p["input_friction"] * omega1
        matrix = self._matrix(mode, link1[:2], factor * drive[:2])
        b[2] = factor * drive[2]
        if sigma == 0 and (self._by_torque or not self.joined(mode, HOUSING)):
            # else link 1 is at rest as it is given and link 2 is held, friction allows any M2: as without it
            matrix[..., 2, [A1, A2, M2]], b[2] = (1.0, -1.0, 0.0), 0.0
        b[3] = -p["link2_friction"] * omega2
        b[4] = -p["output_friction"] * omega3
        b[5] = self.load
        if self.elastic:
            b[5] = p["shaft_stiffness"] * y[TWIST] + p["shaft_damping"] * (omega3 - omega4)
            b[6] = -p["driven_friction"] * omega4 - self.load
        for row, place in ((7, HOUSING), (8, OUTPUT)):
            if not self.joined(mode, place):
                b[row], _ = self._passed(y, mode, place)
        x = np.asarray(np.linalg.solve(matrix, b.T[..., None])[..., 0].T)
        if not self.rubs:
            return Forces(x, *np.zeros(4))
        unknowns = np.array([x[A1], x[A2], np.ones_like(rate)])
        moved = (torques * unknowns).sum(axis=1)
        return Forces(x, moved[2:], journal, np.abs(moved[2:]).sum(axis=0), moved[1])

    def air(self, y: Array) -> Array:
        """Torques by which the air resists theta1 and q, N.m, and their power, W: c |t| t on each satellite.

        t = omega1 x + q' w is how it turns, by the matrices of its attitude.
        """
        p, rate = self.p, self.k * (y[OMEGA1] - y[OMEGA2])
        found = np.zeros((3, *np.shape(rate)))
        for n in range(int(p["satellites"])):
            e = attitudes(p, np.asarray(y[Q]), n)[..., 0 if p["layout"] else 2]
            w = e if p["layout"] else EZ + satellite_ratio(p) * e
            t = np.multiply.outer(y[OMEGA1], EX) + np.asarray(rate)[..., None] * w
            torque = p["windage"] * p["modules"] * np.linalg.norm(t, axis=-1)[..., None] * t
            found += [(torque * one).sum(axis=-1) for one in (EX, w, t)]
        return found

    def rates(self, y: Array, mode: Mode) -> Array:
        """Rates of the state: those of the integrals are powers, W, and torques, N.m."""
        p, found = self.p, self.forces(y, mode)
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1].tolist()
        x, slip = found.x.tolist(), omega1 - omega2
        rate = self.k * slip
        viscous = p["input_friction"] * omega1**2 + p["drive_friction"] * rate**2
        viscous += p["link2_friction"] * omega2**2 + p["output_friction"] * omega3**2
        shaft = 0.0
        if self.elastic:
            shaft = p["shaft_damping"] * (omega3 - omega4) ** 2 + p["driven_friction"] * omega4**2
            shaft -= p["balancer"] * p["driven_inertia"] * x[A3] * omega4
        wheels = sum(self._passed(y, mode, n)[1] for n in (HOUSING, OUTPUT) if not self.joined(mode, n))
        wound = [-speed_of(y, n) * (mode[n] == CLOSED) for n in (HOUSING, OUTPUT)]
        played = [
            speed_of(y, n) * (wheel.angle > 0.0 and mode[n] in (OPEN, BACK))
            for n, wheel in enumerate(self.wheels)
        ]
        mesh = self.mesh * abs(x[M2] * slip) + found.satellites * abs(rate)
        powers = x[M1] * omega1, self.load * omega4, viscous, mesh, found.journal * abs(rate), wheels, shaft
        air = float(self.air(y)[2]) if p["windage"] else 0.0
        followed = rate, omega1, omega3 - omega4, *x[: A4 + 1], *wound, *played
        return np.array([*followed, *powers, air, *x[M1 : TH + 1]])

    def impact(self, y: Array, mode: Mode, change: float) -> Array:
        """Changes of speed, rad/s, and impulses, N.m.s, of a jump of omega1, rad/s, or of an engagement.

        They are the unknowns, (9,). No friction; of freewheels that are closed the speeds are equal
        afterwards (Moreau).
        """
        torques, _, _ = self.work(y[Q])
        b = np.zeros(9)
        b[0] = change
        for row, place in ((7, HOUSING), (8, OUTPUT)):
            if mode[place] == CLOSED:
                b[row] = -speed_of(y, place)
        return np.asarray(np.linalg.solve(self._matrix(mode, torques[0, :2], self.k * torques[1, :2]), b))

    def energy(self, y: Array) -> float:
        """Kinetic energy, that of the weights and of shaft and freewheels that are wound up, J."""
        p = self.p
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        torques, _, weights = self.work(y[Q])
        momenta = torques[:2, :2] @ [omega1, omega2]
        height = weights[:, 0].sum(axis=0) @ [math.sin(y[THETA1]), math.cos(y[THETA1])]
        twice = p["input_inertia"] * omega1**2 + p["link2_inertia"] * omega2**2
        twice += p["output_inertia"] * omega3**2
        if self.elastic:
            twice += p["driven_inertia"] * omega4**2 + p["shaft_stiffness"] * y[TWIST] ** 2
        twice += sum(wheel.stiffness * y[WOUND + n] ** 2 for n, wheel in enumerate(self.wheels))
        return float(0.5 * (momenta @ [omega1, self.k * (omega1 - omega2)] + twice) + height)
