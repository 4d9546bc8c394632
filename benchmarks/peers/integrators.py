"""Equations of the module in integrators of SciPy and SUNDIALS, with event location or viscous clutches.

The integrators are solve_ivp and odeint of SciPy, and CVODE of SUNDIALS (scikit-sundae; Hindmarsh et al., ACM
TOMS 31 (2005)). The equations are the equations of the independent reference without losses, compiled from C.
The state is y = (q, omega2, omega3), rad and rad/s. The data of a problem are two arrays: numbers (indices
below) and the Fourier series of the virtual work on q, one row per harmonic.
"""

from __future__ import annotations

import ctypes
import functools
import itertools
import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import odeint, solve_ivp

from inertia_module.common.errors import InertiaModuleError
from inertia_module.common.extras import library
from inertia_module.compiling.c_compiler import link
from inertia_module.compiling.targets import host_target
from inertia_module.fidelity.timing import median_time
from inertia_module.kernel.codes import RIGID
from inertia_module.model import Module
from verification.reference.cases import HOUSING, OUTPUT, Machine
from verification.reference.geometry import Array, UnavailableError

from ..trade_off import Case, Trajectory

# indices of the numbers, two per freewheel: is it closed, is it present
CLOSED, PRESENT = (0, 1), (2, 3)
# input speed, rad/s; load torque, N·m; ratio k; inertias, kg·m²; stiffness c of the viscous clutches that
# replace the freewheels, N·m·s/rad: Tc = c max(0, omega2 - omega3), Th = c max(0, -omega2); 0 with event
# location
SPEED, LOAD, RATIO, INERTIA2, INERTIA3, STIFFNESS = range(4, 10)
# maximum numbers of steps and of events of a run
MAX_STEPS = 10_000_000
MAX_EVENTS = 100_000
# maximum phase of the fastest harmonic per step, rad. Solvers compare the sign of an event indicator only at
# the ends of a step. While link 2 is locked, the motion is so smooth that their steps would skip whole
# pulses.
CVODE_PHASE = 1.0
SCIPY_PHASE = 0.5  # 1 misses two short pulses of R1
ROOT_FOUND = 2  # CV_ROOT_RETURN
LOSSES = (
    *("input_friction", "drive_friction", "link2_friction", "output_friction", "gravity"),
    *("housing_drag", "housing_drag_viscous", "output_drag", "output_drag_viscous"),
)


@functools.cache
def equations() -> tuple[Any, Any]:
    """Compile the equations (equations.c), once per process.

    Returns:
        Function rates(t, y, numbers, series), which returns the derivative of the state in a new array, and
        function guard(t, y, numbers, series, freewheel), which is positive while the freewheel does not
        switch.

    Raises:
        CompilationError: No C compiler is installed.
    """
    source = Path(__file__).with_name("equations.c").read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"equations{host_target().suffix}"
        path.write_bytes(link(host_target(), path.name, {"equations.c": source}))
        library = ctypes.CDLL(str(path))
    pointers = [ctypes.c_void_p] * 3
    library.rates.argtypes, library.rates.restype = [*pointers, ctypes.c_size_t, ctypes.c_void_p], None
    library.guard.argtypes, library.guard.restype = (
        [*pointers, ctypes.c_size_t, ctypes.c_int],
        ctypes.c_double,
    )

    def address(array: Array) -> int:
        return int(array.__array_interface__["data"][0])

    def rates(t: float, y: Array, numbers: Array, series: Array) -> Array:
        y = np.ascontiguousarray(y)  # Radau passes columns of a matrix
        result = np.empty(3)
        library.rates(address(y), address(numbers), address(series), len(series), address(result))
        return result

    def guard(t: float, y: Array, numbers: Array, series: Array, freewheel: int) -> float:
        return float(library.guard(address(y), address(numbers), address(series), len(series), freewheel))

    return rates, guard


class Problem:
    """A case as data of the compiled equations.

    Args:
        case: The case.
        stiffness: Stiffness of the viscous clutch that replaces each freewheel, N·m·s/rad; None for event
            location.

    Attributes:
        data: Arrays numbers and series.
        start: State at time 0.
        machine: Equations of the reference.
        events: True for event location.

    Raises:
        UnavailableError: The module rejects the parameters, the fidelity is not rigid, the case has losses,
            or a clutch would replace a missing freewheel.
    """

    def __init__(self, case: Case, stiffness: float | None = None) -> None:
        p = case.all_parameters
        if p["fidelity"] != RIGID:
            raise UnavailableError("peers support only fidelity rigid")
        try:
            Module("plain").check(**case.parameters)
        except InertiaModuleError as error:
            raise UnavailableError(str(error)) from None
        present = [bool(p["housing_freewheel"]), bool(p["output_freewheel"])]
        if not (stiffness is None or all(present)):
            raise UnavailableError("viscous clutches require both freewheels (got a case without one)")
        self.machine, self.case, self.events = Machine(p), case, stiffness is None
        if self.machine.has_dry_friction or any(p[name] for name in LOSSES):
            raise UnavailableError(f"peers do not support losses: {', '.join(LOSSES)} and friction must be 0")
        inertias = p["link2_inertia"], p["output_inertia"]
        constants = case.omega1, case.load_torque, self.machine.k, *inertias, stiffness or 0.0
        # terms of the torque on q: alpha2, omega1², omega1 q', q'²
        by_q = self.machine.work.terms[6:10].T
        series = np.column_stack([self.machine.work.orders, by_q.real, by_q.imag])
        self.data = np.array([0.0, 0.0, *present, *constants]), series
        self.start = np.array([p[f"{name}_start"] for name in ("drive_angle", "omega2", "omega_out")])

    def max_step(self, phase: float) -> float:
        """Return the time in which the fastest harmonic turns by a phase, s; infinite without event location.

        Args:
            phase: Phase, rad.
        """
        rate = self.machine.work.max_order * self.machine.k * abs(self.case.omega1)
        return float(phase / rate) if self.events and rate > 0.0 else math.inf

    def choose(self, y: Array) -> None:
        """Select the contact mode: no closed freewheel transmits a wrong sign, no open one closes at once.

        Args:
            y: State.
        """
        if not self.events:
            return
        numbers, (rates, guard) = self.data[0], equations()
        present, is_moving = numbers[list(PRESENT)] != 0.0, np.array([y[1] != 0.0, y[2] != y[1]])
        for closed in itertools.product((1.0, 0.0), repeat=2):
            # a missing housing freewheel is open, a missing output freewheel is closed
            if any(closed[n] != (n == OUTPUT) for n in (HOUSING, OUTPUT) if not present[n]):
                continue
            numbers[list(CLOSED)] = closed
            _, alpha2, alpha3 = rates(0.0, y, *self.data)
            relative_accelerations = alpha2, alpha3 - alpha2
            if not any(
                is_moving[n] or guard(0.0, y, *self.data, n) < 0.0
                if closed[n]
                else not is_moving[n] and relative_accelerations[n] < 0.0
                for n in np.flatnonzero(present)
            ):
                return
        raise RuntimeError(f"no contact mode is consistent with the state {y}")

    def handle_event(self, y: Array, freewheel: int) -> None:
        """Handle an event: set the state exactly to the guard, and select the contact mode.

        Args:
            y: State at the event, which is changed.
            freewheel: Freewheel whose guard reached zero.
        """
        numbers = self.data[0]
        if numbers[freewheel]:
            numbers[freewheel] = 0.0
            return
        if freewheel == HOUSING:
            y[1] = 0.0
        if freewheel == OUTPUT or numbers[OUTPUT]:
            y[2] = y[1]
        self.choose(y)


class Segment(NamedTuple):
    """Motion without a switch of a freewheel.

    Attributes:
        time: Time at the end, s.
        state: State at the end.
        guard: Freewheel whose guard reached zero at the end, or None.
        samples: States at the output times, shape (times, 3).
        evaluations: Number of right-hand-side evaluations.
    """

    time: float
    state: Array
    guard: int | None
    samples: Array
    evaluations: int


# function of (start time, state, output times); the last output time is the end
Integrator = Callable[[float, Array, Array], Segment]


def _by_solve_ivp(problem: Problem, method: str, tolerance: float) -> Integrator:
    rates, guard = equations()

    def falling(freewheel: int) -> Any:
        def event(t: float, y: Array, *data: Array) -> float:
            return float(guard(t, y, *data, freewheel))

        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
        return event

    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance, "args": problem.data}
    options["max_step"] = problem.max_step(SCIPY_PHASE)
    if problem.events:
        options["events"] = [falling(HOUSING), falling(OUTPUT)]

    def integrate(time: float, state: Array, times: Array) -> Segment:
        sampled = times if len(times) > 1 else None
        solution = solve_ivp(rates, (time, times[-1]), state, method, sampled, **options)
        if solution.status < 0:
            raise RuntimeError(f"{method} failed: {solution.message}")
        states = np.transpose(solution.y).reshape(-1, 3)  # an empty list if no sampling time was reached
        if solution.status == 0:
            samples = states if sampled is not None else states[-1:]
            return Segment(times[-1], states[-1], None, samples, solution.nfev)
        freewheel = HOUSING if len(solution.t_events[HOUSING]) else OUTPUT
        samples = states if sampled is not None else states[:0]
        return Segment(
            solution.t_events[freewheel][0],
            solution.y_events[freewheel][0],
            freewheel,
            samples,
            solution.nfev,
        )

    return integrate


def _by_odeint(problem: Problem, tolerance: float) -> Integrator:
    """Return LSODA by odeint, whose loop is compiled and has no event location."""
    rates, _ = equations()
    options = {"rtol": tolerance, "atol": tolerance, "mxstep": MAX_STEPS}

    def integrate(time: float, state: Array, times: Array) -> Segment:
        states, info = odeint(
            rates, state, [time, *times], problem.data, tfirst=True, full_output=True, **options
        )
        if info["message"] != "Integration successful.":
            raise RuntimeError(f"LSODA failed: {info['message']}")
        return Segment(times[-1], states[-1], None, states[1:], int(info["nfe"][-1]))

    return integrate


def _by_cvode(problem: Problem, method: str, tolerance: float) -> Integrator:
    """Return CVODE with its own root finding, restarted after each root."""
    (rates, guard), data = equations(), problem.data
    step = problem.max_step(CVODE_PHASE)

    def write_rates(t: float, y: Array, values: Array) -> None:
        values[:] = rates(t, y, *data)

    def write_guards(t: float, y: Array, values: Array) -> None:
        for freewheel in (HOUSING, OUTPUT):
            values[freewheel] = guard(t, y, *data, freewheel)

    write_guards.terminal, write_guards.direction = [True, True], [-1, -1]  # type: ignore[attr-defined]
    solver = library("sksundae.cvode", "peers", "scikit-sundae").CVODE(
        write_rates,
        method=method,
        eventsfn=write_guards,
        num_events=2,
        rtol=tolerance,
        atol=tolerance,
        max_step=step if math.isfinite(step) else 0.0,
        max_num_steps=MAX_STEPS,
    )

    def integrate(time: float, state: Array, times: Array) -> Segment:
        solver.init_step(time, state)
        # the wrapper stores all events since its creation, and copies them
        for events in (write_guards._i, write_guards._t, write_guards._y):  # type: ignore[attr-defined]
            events.clear()
        samples: list[Array] = []
        for until in times:
            result = solver.step(until)
            if result.status == ROOT_FOUND:
                freewheel = int(np.flatnonzero(result.i_events[-1])[0])
                reached = np.array(samples).reshape(-1, 3)
                return Segment(float(result.t), result.y, freewheel, reached, result.nfev)
            if result.status < 0:
                raise RuntimeError(f"CVODE failed at {result.t} s: {result.message}")
            samples.append(result.y)
        return Segment(float(times[-1]), samples[-1], None, np.array(samples), result.nfev)

    return integrate


def _run(problem: Problem, times: Array, integrate: Integrator) -> list[Segment]:
    """Run through the output times, of which the first is the start."""
    time, state, segments = float(times[0]), problem.start.copy(), list[Segment]()
    problem.choose(state)
    times = times[1:]
    while len(segments) < MAX_EVENTS:
        segment = integrate(time, state, times)
        segments.append(segment)
        times = times[len(segment.samples) :]
        time, state = segment.time, segment.state.copy()
        if segment.guard is None:
            return segments
        problem.handle_event(state, segment.guard)
    raise RuntimeError(f"more than {MAX_EVENTS} events")


def simulate(case: Case, tolerance: float, method: str, stiffness: float | None = None) -> Trajectory:
    """Run a case with all samples; then measure the run time without samples.

    Args:
        case: The case.
        tolerance: Relative and absolute tolerance.
        method: "Adams" or "BDF" of CVODE, a method of solve_ivp, or "odeint" with clutches.
        stiffness: Stiffness of the clutches, N·m·s/rad; None for event location (see Problem).

    Raises:
        UnavailableError: The equations do not support the case.
        MissingDependencyError: A library is not installed.
        RuntimeError: The integrator fails.
    """
    problem = Problem(case, stiffness)
    if method in ("Adams", "BDF"):
        integrate = _by_cvode(problem, method, tolerance)
    elif method == "odeint":
        integrate = _by_odeint(problem, tolerance)
    else:
        integrate = _by_solve_ivp(problem, method, tolerance)
    segments = _run(problem, case.times, integrate)
    samples = [problem.start[None, :], *(segment.samples for segment in segments)]
    return Trajectory(
        motion=np.concatenate(samples),
        evaluations=sum(segment.evaluations for segment in segments),
        wall_time=median_time(lambda: _run(problem, case.times[[0, -1]], integrate)),
        switches=len(segments) - 1 if problem.events else math.nan,
    )
