"""The reference: engine and module in one piece, Lagrange's equations in (theta1, theta2), by SciPy.

Nothing of the kernel or of the FMU takes part. The kinetic energy is 1/2 w' M(q) w with w = (omega1, omega2),

    M11 = J_E + J1 + I + 2kB + k^2 G    M12 = -k (B + k G)    M22 = J2 + k^2 G (+ J3 while the shaft is
    driven)

q' = k (omega1 - omega2), so d/dt(M w) = Q + k (1, -1) dT/dq. I, B and G come from positions by rotation
matrices (fourier_inertia.py). The engine's torque is that of its governor, sample by sample.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fourier_inertia import Inertia
from ..trajectory import Case as OpenCase
from ..trajectory import Unavailable
from .case import Array, CoupledCase

HELD, FREE, DRIVING, REST = range(4)
_TOLERANCE = 1e-10
# longest step, rad of the highest harmonic: no pulse is stepped over
_PHASE = 0.5
# and for a while after a sample of the governor, where the new torque may close a contact for a moment
_FINE_PHASE = 0.05
_FINE_SHARE = 0.2
_EVENTS_ALLOWED = 100_000


@dataclass
class Course:
    """Speeds of a run.

    Attributes:
        omega1: mean over each window, rad/s. omega_out: at the end of each, rad/s. work: of the engine, J.
    """

    omega1: Array
    omega_out: Array
    work: float


class Monolith:
    """Engine and module in one piece, both freewheels, rigid output.

    Raises:
        Unavailable: SciPy is not installed, or a parameter the reference does not know.
    """

    def __init__(self, case: CoupledCase, tolerance: float = _TOLERANCE) -> None:
        try:
            from scipy.integrate import solve_ivp
        except ImportError as error:
            raise Unavailable(f"the one-piece reference needs SciPy ({error}): extra peers") from error
        self._solve: Any = solve_ivp
        self.tolerance = tolerance
        self.case = case
        open_case = OpenCase(dict(case.parameters), case.speed, case.load_torque, case.stop_time)
        p = open_case.parameter
        if not (p("housing_freewheel") and p("output_freewheel")):
            raise Unavailable("the one-piece reference is refused: allowed are modules with both freewheels")
        series = Inertia(open_case)
        self._orders, self._terms = series.series
        ratio = ("sun_radius", "satellite_radius") if series.planar else ("z2", "z16")
        self.k = p(ratio[0]) / p(ratio[1])
        self.j1 = case.engine_inertia + p("input_inertia")
        self.j2, self.j3, self.load = p("link2_inertia"), p("output_inertia"), case.load_torque
        self.highest = float(series.highest)
        self.torque = 0.0

    # --- equations ---

    def _inertia(self, q: float) -> tuple[Array, Array]:
        """(I, B, G) and their derivatives at an angle, shape (3,) each."""
        waves = np.exp(1j * self._orders * q)
        return (self._terms @ waves).real, (self._terms @ (1j * self._orders * waves)).real

    def _matrix(self, ibg: Array, own: float, shaft: float) -> tuple[float, float, float]:
        """(M11, M12, M22) of inertias I, B, G, or of their derivatives with own = shaft = 0."""
        i, b, g = ibg
        k = self.k
        return own + i + 2.0 * k * b + k * k * g, -k * (b + k * g), shaft + k * k * g

    def _accelerations(self, mode: int, y: Array) -> tuple[float, float, float]:
        """(alpha1, alpha2, torque of the contact that the mode keeps closed)."""
        q, w1, w2 = y[0], y[1], y[2]
        ibg, slopes = self._inertia(q)
        driven = mode in (DRIVING, REST)
        m11, m12, m22 = self._matrix(ibg, self.j1, self.j2 + (self.j3 if driven else 0.0))
        d11, d12, d22 = self._matrix(slopes, 0.0, 0.0)
        rate = self.k * (w1 - w2)
        push = 0.5 * self.k * (d11 * w1 * w1 + 2.0 * d12 * w1 * w2 + d22 * w2 * w2)
        f1 = self.torque + push - rate * (d11 * w1 + d12 * w2)
        f2 = -push - rate * (d12 * w1 + d22 * w2) - (self.load if driven else 0.0)
        if mode in (HELD, REST):
            alpha1 = f1 / m11
            return alpha1, 0.0, m12 * alpha1 - f2  # of the housing
        determinant = m11 * m22 - m12 * m12
        alpha1, alpha2 = (m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant
        return alpha1, alpha2, self.load + self.j3 * alpha2  # of the output

    def _rates(self, mode: int) -> Callable[[float, Array], list[float]]:
        """Rates of (q, omega1, omega2, omega3, theta1)."""

        def rates(_: float, y: Array) -> list[float]:
            alpha1, alpha2, _contact = self._accelerations(mode, y)
            alpha3 = alpha2 if mode == DRIVING else 0.0 if mode == REST else -self.load / self.j3
            return [self.k * (y[1] - y[2]), alpha1, alpha2, alpha3, y[1]]

        return rates

    def _guards(self, mode: int) -> Sequence[tuple[Callable[[float, Array], float], int]]:
        """Functions that end a mode where they fall through zero, and the mode behind each."""

        def contact(_: float, y: Array) -> float:
            return self._accelerations(mode, y)[2]

        def link2(_: float, y: Array) -> float:
            return float(y[2])

        def slip(_: float, y: Array) -> float:
            return float(y[3] - y[2])

        def shaft(_: float, y: Array) -> float:
            return float(y[3])

        found: dict[int, list[tuple[Callable[[float, Array], float], int]]] = {
            HELD: [(contact, FREE), (shaft, REST)],
            FREE: [(link2, HELD), (slip, DRIVING)],
            DRIVING: [(contact, FREE), (link2, REST)],
            REST: [(contact, DRIVING)],
        }
        return found[mode]

    # --- from event to event ---

    def _entered(self, mode: int, y: Array) -> Array:
        """The equalities of a mode, exactly."""
        y = y.copy()
        if mode in (HELD, REST):
            y[2] = 0.0
        if mode == REST:
            y[3] = 0.0
        if mode == DRIVING:
            y[2] = y[3]
        return y

    def _advance(self, mode: int, y: Array, time: float, end: float, phase: float) -> tuple[int, Array]:
        """Integrate to a time, the engine's torque being constant; phase: longest step, see _PHASE."""
        for _ in range(_EVENTS_ALLOWED):
            # a torque that has jumped may have opened a contact
            for guard, behind in self._guards(mode):
                scale = 1e-9 * (abs(self.torque) + self.load + 1.0)
                if guard(time, y) < -scale:
                    mode, y = behind, self._entered(behind, y)
                    break
            events = []
            for guard, _behind in self._guards(mode):

                def falls(t: float, z: Array, guard: Callable[[float, Array], float] = guard) -> float:
                    return guard(t, z)

                falls.terminal, falls.direction = True, -1.0  # type: ignore[attr-defined]
                events.append(falls)
            longest = phase / (self.highest * self.k * max(abs(y[1]), 1.0))
            found = self._solve(
                self._rates(mode),
                (time, end),
                y,
                "DOP853",
                rtol=self.tolerance,
                atol=self.tolerance,
                max_step=longest,
                events=events,
            )
            time, y = float(found.t[-1]), found.y[:, -1]
            if found.status == 0:
                return mode, y
            which = next(n for n, times in enumerate(found.t_events) if times.size)
            mode = self._guards(mode)[which][1]
            y = self._entered(mode, y)
        raise RuntimeError(f"the one-piece reference met over {_EVENTS_ALLOWED} events in one sample")

    def run(self) -> Course:
        """The case from its start."""
        case = self.case
        engine = case.engine()
        governor = engine.governor
        samples = round(case.window / governor.sample_time)
        y = np.array([0.0, case.speed, 0.0, 0.0, 0.0])
        mode, integral, work, time = REST, 0.0, 0.0, 0.0
        omega1, omega_out = [], []
        for _ in range(case.windows):
            began = y[4]
            for _ in range(samples):
                limits = engine.limits.limits(y[1])
                self.torque, integral = governor.sample(integral, case.speed, y[1], limits)
                angle = y[4]
                begun, time = time, time + governor.sample_time
                middle = begun + _FINE_SHARE * governor.sample_time
                mode, y = self._advance(mode, y, begun, middle, _FINE_PHASE)
                mode, y = self._advance(mode, y, middle, time, _PHASE)
                work += self.torque * (y[4] - angle)
            omega1.append((y[4] - began) / case.window)
            omega_out.append(y[3])
        return Course(np.array(omega1), np.array(omega_out), work)
