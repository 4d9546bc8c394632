"""Forces, accelerations and powers of the machine with losses in one case of contacts, slip and signs.

A and R are the torques of virtual_work.py on theta1 and q, V the torques of the windage.
With slip = omega1 - omega2, q' = k slip, q'' = k (alpha1 - alpha2)
and sigma = sign(q'):

    tau_q = A_q (alpha1, q'') + R_q + V_q + bq q' + sigma (C + S)    M2 = f k tau_q
    M1 = J1 alpha1 + A_1 (alpha1, q'') + R_1 + V_1 + b1 omega1 + M2
    J2 alpha2 = M2 - b2 omega2 - Tc + Th
    J3 alpha3 = Tc - b3 omega3 - Ts    J4 (alpha4 - beta alpha3) = Ts - f4 omega4 - load
    Ts = c twist + d (omega3 - omega4)

- f is 1/eta for sigma M2 > 0, else 1/(2 - eta).
- C is the friction of the satellite bearings, S the friction of the meshes 17-6. S is linear while no
  torque of a satellite changes its sign.
- An overrunning freewheel drags: -Th = drag + viscous omega2, and Tc in the same way.
- A locked freewheel is rigid or a spring (c phi + d phi') and transmits at least -drag.
- A freewheel that rotates backward within its engagement angle transmits no torque.
  Its drag can hold it there; then it transmits at most 0.
- At q' = 0 links 1 and 2 stick together while |M2/k - tau_q(sigma = 0)| <= C + S + (1 - eta) |M2|/k.
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

# indices of a case: freewheels, signs of slip (0: sticking) and sigma M2, first sign of the satellites
HOUSING, OUTPUT, SLIP, MESH, TEETH = range(5)
# states of a freewheel; within its engagement angle it rotates backward, or its drag holds it
OPEN, CLOSED, BACKWARD, HELD_BY_DRAG = range(4)
# indices of the state: angles, twist, speeds; wind-up and remaining engagement angles; integrals
Q, THETA1, TWIST, OMEGA1, OMEGA2, OMEGA3, OMEGA4, WIND_UP, _, REMAINING, _, FIRST_INTEGRAL = range(12)
CAUSES = ("viscous", "mesh", "journal", "freewheel", "shaft", "windage")
INTEGRALS = ("energy_in", "energy_out", *CAUSES, "M1", "M2", "Tc", "Th")
# indices of the unknowns of a case
A1, A2, A3, A4, M1, M2, TC, TH, TS = range(9)

Mode = tuple[int, ...]


class Forces(NamedTuple):
    """Unknowns and friction of a case; a last axis contains several states.

    Attributes:
        x: unknowns, (9,).
        teeth: friction torque of the mesh 17-6 of each satellite, N.m; 0 without friction, as all below.
        journal: friction C of the satellite bearings, N.m.
        satellites: friction S of the meshes 17-6, N.m.
        free: tau_q without C and S, N.m.
    """

    x: Array
    teeth: Array
    journal: Array
    satellites: Array
    free: Array


@dataclass(frozen=True)
class Freewheel:
    """Parameters of a freewheel.

    Attributes:
        is_present: False for no freewheel.
        drag: constant drag, N.m.
        viscous: viscous drag, N.m.s/rad.
        angle: engagement angle, rad.
        stiffness: stiffness when locked, N.m/rad; 0 for a rigid freewheel.
        damping: damping when locked, N.m.s/rad.
    """

    is_present: bool
    drag: float
    viscous: float
    angle: float
    stiffness: float
    damping: float


def relative_speed(y: Array, place: int) -> Array:
    """Return the relative speed at a freewheel or between links 1 and 2, rad/s.

    Args:
        y: state.
        place: HOUSING, OUTPUT or SLIP.
    """
    speed: Array = y[(OMEGA2, OMEGA3, OMEGA1)[place]]
    return speed if place == HOUSING else speed - y[OMEGA2]


class Machine:
    """Equations of motion of a mechanism.

    Args:
        parameters: parameters that differ from the defaults, by name; any fidelity except elastic is rigid.

    Attributes:
        p: all parameters.
        work: virtual work of the mechanism.
        k: revolutions of the pinion shaft per revolution of link 1 relative to link 2.
        load: load torque, N.m.
        torque: torque on link 1 if the machine is torque-driven, N.m.
        slope: acceleration of link 1 if the machine is speed-driven, rad/s^2.
        has_dry_friction: True if a torque depends on the sign of the slip.
        wheels: freewheels to housing and output.
        frequency: sum of the natural frequencies of elastic shaft and freewheels, rad/s.
        max_order: maximum order of the harmonics of the torques.

    Raises:
        UnavailableError: a missing freewheel has a stiffness.
    """

    def __init__(self, parameters: Mapping[str, float]) -> None:
        self.p = p = {**default_parameters(), **parameters}
        self.work, self.k = VirtualWork(p), ratio(p)
        self.elastic, self._is_torque_driven = p["fidelity"] == ELASTIC, p["drive"] == DRIVE_TORQUE
        self.mesh = 1.0 - p["mesh_efficiency"]
        self.teeth = not p["layout"] and p["satellite_mesh_efficiency"] < 1.0
        self._journals = p["journal_friction"] > 0.0
        self.has_dry_friction = bool(self.mesh or self.teeth or self._journals)
        self.wheels = self._freewheel("housing", "housing"), self._freewheel("output", "freewheel")
        self.max_order, self.frequency = max(self.work.max_order, 1.0), 0.0
        if self.elastic:
            self.frequency = shaft_frequency(p.__getitem__)
            if stiffest := max(wheel.stiffness for wheel in self.wheels):
                self.frequency += math.sqrt(stiffest / min(p["link2_inertia"], p["output_inertia"]))
        self.torque = self.slope = self.load = 0.0
        self._matrices = dict[Mode, Array]()

    def _freewheel(self, name: str, spring: str) -> Freewheel:
        """Return a freewheel.

        Args:
            name: prefix of its parameters.
            spring: prefix of its stiffness and damping.
        """
        p = self.p
        is_present = bool(p[f"{name}_freewheel"])
        has_spring = self.elastic and p[f"{spring}_stiffness"] > 0.0
        if has_spring and not is_present:
            raise UnavailableError(f"reference: {spring}_stiffness needs the freewheel")
        values = (p[f"{name}_{value}"] * is_present for value in ("drag", "drag_viscous", "engagement_angle"))
        drag, viscous, angle = values
        stiffness = p[f"{spring}_stiffness"] if has_spring else 0.0
        return Freewheel(is_present, drag, viscous, angle, stiffness, p[f"{spring}_damping"])

    def is_joined(self, mode: Mode, place: int) -> bool:
        """Return True if a freewheel is locked and rigid, or held by its drag, so that its speeds are equal.

        Args:
            mode: case.
            place: HOUSING or OUTPUT.
        """
        return mode[place] == HELD_BY_DRAG or (mode[place] == CLOSED and not self.wheels[place].stiffness)

    def _transmitted(self, y: Array, mode: Mode, place: int) -> tuple[Array, Array]:
        """Return torque, N.m, and power loss, W, of a freewheel whose speeds differ.

        Args:
            y: state.
            mode: case.
            place: HOUSING or OUTPUT.
        """
        wheel, speed = self.wheels[place], relative_speed(y, place)
        if mode[place] == OPEN:
            # at rest the drag also acts against the next motion
            drag = wheel.drag + wheel.viscous * speed
            return -drag, drag * speed
        if mode[place] == BACKWARD:
            return 0.0 * speed, 0.0 * speed
        return wheel.stiffness * y[WIND_UP + place] - wheel.damping * speed, wheel.damping * speed**2

    def _matrix(self, mode: Mode, link1: Array, drive: Array) -> Array:
        """Return the matrix of the unknowns of a case, (9, 9), or of several states, (n, 9, 9).

        Args:
            mode: case.
            link1: torque on theta1 per alpha1 and alpha2, kg m^2, (2,) or (2, n).
            drive: M2 per alpha1 and alpha2, kg m^2, (2,) or (2, n).
        """
        if mode not in self._matrices:
            p, a = self.p, np.zeros((9, 9))
            a[0, M1 if self._is_torque_driven else A1] = 1.0
            a[1, [A1, M1, M2]] = p["input_inertia"], -1.0, 1.0
            a[2, M2] = 1.0
            a[3, [A2, M2, TC, TH]] = p["link2_inertia"], -1.0, 1.0, -1.0
            a[4, [A3, TC, TS]] = p["output_inertia"], -1.0, 1.0
            a[5, TS], a[6, A4], a[6, A3] = 1.0, 1.0, -1.0
            if self.elastic:
                a[6, [A4, A3, TS]] = p["driven_inertia"], -p["balancer"] * p["driven_inertia"], -1.0
            a[7, A2 if self.is_joined(mode, HOUSING) else TH] = 1.0
            a[8, A3 if self.is_joined(mode, OUTPUT) else TC] = 1.0
            if self.is_joined(mode, OUTPUT):
                a[8, A2] = -1.0
            self._matrices[mode] = a
        fixed = self._matrices[mode]
        matrix = np.empty((*link1.shape[1:], *fixed.shape))
        matrix[:] = fixed
        matrix[..., 1, :2] += link1.T
        matrix[..., 2, :2] = -drive.T
        return matrix

    def forces(self, y: Array, mode: Mode) -> Forces:
        """Solve a case at a state, or at several states, (length of the state, n).

        Args:
            y: state or states.
            mode: case, which need not be consistent with the state.

        Raises:
            LinAlgError: the case does not determine a torque or an acceleration.
        """
        p, k, sigma = self.p, self.k, mode[SLIP]
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        rate = k * (omega1 - omega2)
        squares = np.array([omega1 * omega1, omega1 * rate, rate * rate])
        work, bearings, weights = self.work(y[Q])
        # torques per alpha1, alpha2 and 1
        torques = work[:, :3].copy()
        torques[:, 2] = (work[:, 2:] * squares).sum(axis=1)
        torques[1, 2] += p["drive_friction"] * rate
        if p["windage"]:
            torques[:2, 2] += self.windage_torques(y)[:2]
        if p["gravity"]:
            weight, sine, cosine = weights.sum(axis=0), np.sin(y[THETA1]), np.cos(y[THETA1])
            torques[0, 2] += weight[0, 0] * cosine - weight[0, 1] * sine
            torques[1, 2] += weight[1, 0] * sine + weight[1, 1] * cosine
        link1, drive, teeth = torques[0], torques[1], torques[2:]
        journal = 0.0 * rate
        if self._journals:
            force = (bearings * squares).sum(axis=2)
            journal = np.sqrt((force * force).sum(axis=1)).sum(axis=0)
        if sigma and self.has_dry_friction:
            drive = drive + sigma * np.tensordot(mode[TEETH:], teeth, 1)
            drive[2] += sigma * journal
        factor = k / (1.0 - self.mesh * mode[MESH] * abs(sigma))
        b = np.zeros((9, *rate.shape))
        b[0] = self.torque if self._is_torque_driven else self.slope
        b[1] = -link1[2] - p["input_friction"] * omega1
        matrix = self._matrix(mode, link1[:2], factor * drive[:2])
        b[2] = factor * drive[2]
        if sigma == 0 and (self._is_torque_driven or not self.is_joined(mode, HOUSING)):
            # with link 1 and link 2 at rest friction allows any M2, so the equation without friction remains
            matrix[..., 2, [A1, A2, M2]], b[2] = (1.0, -1.0, 0.0), 0.0
        b[3] = -p["link2_friction"] * omega2
        b[4] = -p["output_friction"] * omega3
        b[5] = self.load
        if self.elastic:
            b[5] = p["shaft_stiffness"] * y[TWIST] + p["shaft_damping"] * (omega3 - omega4)
            b[6] = -p["driven_friction"] * omega4 - self.load
        for row, place in ((7, HOUSING), (8, OUTPUT)):
            if not self.is_joined(mode, place):
                b[row], _ = self._transmitted(y, mode, place)
        x = np.asarray(np.linalg.solve(matrix, b.T[..., None])[..., 0].T)
        if not self.has_dry_friction:
            return Forces(x, *np.zeros(4))
        unknowns = np.array([x[A1], x[A2], np.ones_like(rate)])
        sums = (torques * unknowns).sum(axis=1)
        return Forces(x, sums[2:], journal, np.abs(sums[2:]).sum(axis=0), sums[1])

    def windage_torques(self, y: Array) -> Array:
        """Return the torques of the windage on theta1 and q, N.m, and their power, W.

        The torque on each satellite is c |t| t with the angular velocity t = omega1 x + q' w.

        Args:
            y: state.
        """
        p, rate = self.p, self.k * (y[OMEGA1] - y[OMEGA2])
        total = np.zeros((3, *np.shape(rate)))
        for n in range(int(p["satellites"])):
            e = attitudes(p, np.asarray(y[Q]), n)[..., 0 if p["layout"] else 2]
            w = e if p["layout"] else EZ + satellite_ratio(p) * e
            t = np.multiply.outer(y[OMEGA1], EX) + np.asarray(rate)[..., None] * w
            torque = p["windage"] * p["modules"] * np.linalg.norm(t, axis=-1)[..., None] * t
            total += [(torque * direction).sum(axis=-1) for direction in (EX, w, t)]
        return total

    def rates(self, y: Array, mode: Mode) -> Array:
        """Return the derivatives of the state; the last ones are powers, W, and torques, N.m.

        Args:
            y: state.
            mode: case.
        """
        p, forces = self.p, self.forces(y, mode)
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1].tolist()
        x, slip = forces.x.tolist(), omega1 - omega2
        rate = self.k * slip
        viscous = p["input_friction"] * omega1**2 + p["drive_friction"] * rate**2
        viscous += p["link2_friction"] * omega2**2 + p["output_friction"] * omega3**2
        shaft = 0.0
        if self.elastic:
            shaft = p["shaft_damping"] * (omega3 - omega4) ** 2 + p["driven_friction"] * omega4**2
            shaft -= p["balancer"] * p["driven_inertia"] * x[A3] * omega4
        wheels = sum(
            self._transmitted(y, mode, n)[1] for n in (HOUSING, OUTPUT) if not self.is_joined(mode, n)
        )
        wind_up = [-relative_speed(y, n) * (mode[n] == CLOSED) for n in (HOUSING, OUTPUT)]
        remaining = [
            relative_speed(y, n) * (wheel.angle > 0.0 and mode[n] in (OPEN, BACKWARD))
            for n, wheel in enumerate(self.wheels)
        ]
        mesh = self.mesh * abs(x[M2] * slip) + forces.satellites * abs(rate)
        powers = x[M1] * omega1, self.load * omega4, viscous, mesh, forces.journal * abs(rate), wheels, shaft
        windage_power = float(self.windage_torques(y)[2]) if p["windage"] else 0.0
        derivatives = rate, omega1, omega3 - omega4, *x[: A4 + 1], *wind_up, *remaining
        return np.array([*derivatives, *powers, windage_power, *x[M1 : TH + 1]])

    def impact(self, y: Array, mode: Mode, change: float) -> Array:
        """Return the changes of the speeds, rad/s, and the impulses, N.m.s, of an impact as unknowns, (9,).

        Friction has no influence, and the speeds at a locked freewheel are equal afterwards (Moreau).

        Args:
            y: state.
            mode: case of the impact.
            change: jump of omega1, rad/s; 0 for an engagement.
        """
        torques, _, _ = self.work(y[Q])
        b = np.zeros(9)
        b[0] = change
        for row, place in ((7, HOUSING), (8, OUTPUT)):
            if mode[place] == CLOSED:
                b[row] = -relative_speed(y, place)
        return np.asarray(np.linalg.solve(self._matrix(mode, torques[0, :2], self.k * torques[1, :2]), b))

    def energy(self, y: Array) -> float:
        """Return the kinetic energy plus the energies of weights, shaft and wind-up springs, J.

        Args:
            y: state.
        """
        p = self.p
        omega1, omega2, omega3, omega4 = y[OMEGA1 : OMEGA4 + 1]
        torques, _, weights = self.work(y[Q])
        momenta = torques[:2, :2] @ [omega1, omega2]
        height = weights[:, 0].sum(axis=0) @ [math.sin(y[THETA1]), math.cos(y[THETA1])]
        doubled_energy = p["input_inertia"] * omega1**2 + p["link2_inertia"] * omega2**2
        doubled_energy += p["output_inertia"] * omega3**2
        if self.elastic:
            doubled_energy += p["driven_inertia"] * omega4**2 + p["shaft_stiffness"] * y[TWIST] ** 2
        doubled_energy += sum(wheel.stiffness * y[WIND_UP + n] ** 2 for n, wheel in enumerate(self.wheels))
        return float(0.5 * (momenta @ [omega1, self.k * (omega1 - omega2)] + doubled_energy) + height)
