"""Others' integrators over the module's equations: from event to event, or with clutches.

SciPy's solve_ivp and odeint, and CVODE of SUNDIALS (scikit-sundae; Hindmarsh et al., ACM TOMS 31 (2005)). The
equations are those of the independent reference without losses, compiled from C.
The state is y = (q, omega2, omega3), rad and rad/s. Beside it go two arrays: numbers (see its places below)
and the Fourier series of the virtual work on q, a row for each harmonic.
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
from inertia_module.compiling.targets import here
from inertia_module.fidelity.trials import median_time
from inertia_module.kernel.codes import RIGID
from inertia_module.model import Module
from verification.reference.cases import HOUSING, OUTPUT, Machine
from verification.reference.geometry import Array, UnavailableError

from ..trade_off import Case, Trajectory

# places of the numbers: which freewheels are closed and which are there; rad/s, N.m; k, kg m^2; N.m.s/rad of
# a viscous clutch in place of each freewheel, Tc = c max(0, omega2 - omega3), Th = c max(0, -omega2), or 0
CLOSED, THERE = (0, 1), (2, 3)
SPEED, LOAD, RATIO, INERTIA2, INERTIA3, STIFFNESS = range(4, 10)
STEPS_ALLOWED = 10_000_000
# events a run may have: bounds a run that goes nowhere
EVENTS_ALLOWED = 100_000
# phase of the fastest harmonic in a step, rad: solvers compare a guard's sign at the ends of a step only, and
# while link 2 is held the motion is so smooth that their steps would jump over whole pulses
CVODE_PHASE = 1.0
SCIPY_PHASE = 0.5  # at 1 two short pulses of R1 are missed
ROOT_FOUND = 2  # CV_ROOT_RETURN
LOSSES = (
    *("input_friction", "drive_friction", "link2_friction", "output_friction", "gravity"),
    *("housing_drag", "housing_drag_viscous", "output_drag", "output_drag_viscous"),
)


@functools.cache
def equations() -> tuple[Any, Any]:
    """Compile the equations (equations.c), once a process.

    Returns:
        rates: (t, y, numbers, series), of the state, in a new array.
        guard: (t, y, numbers, series, which), positive while the freewheel stays as it is.

    Raises:
        CompilationError: no C compiler is installed.
    """
    source = Path(__file__).with_name("equations.c").read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"equations{here().suffix}"
        path.write_bytes(link(here(), path.name, {"equations.c": source}))
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
        y = np.ascontiguousarray(y)  # Radau differentiates by columns of a matrix
        result = np.empty(3)
        library.rates(address(y), address(numbers), address(series), len(series), address(result))
        return result

    def guard(t: float, y: Array, numbers: Array, series: Array, which: int) -> float:
        return float(library.guard(address(y), address(numbers), address(series), len(series), which))

    return rates, guard


class Problem:
    """A case as the compiled equations take it.

    Args:
        case: what is run. stiffness: of a clutch for each freewheel, N.m.s/rad, or None: by events.

    Attributes:
        data: numbers and series. start: state at time 0. machine: the reference's equations.
        events: whether it goes from event to event.

    Raises:
        UnavailableError: the module refuses the parameters, or the case is not of the rigid module without losses;
            or clutches are to stand for freewheels and one is left out.
    """

    def __init__(self, case: Case, stiffness: float | None = None) -> None:
        p = case.all_parameters
        if p["fidelity"] != RIGID:
            raise UnavailableError("the peers know the rigid module only: fidelity = 2")
        try:
            Module("plain").check(**case.parameters)
        except InertiaModuleError as error:
            raise UnavailableError(str(error)) from None
        there = [bool(p["housing_freewheel"]), bool(p["output_freewheel"])]
        if not (stiffness is None or all(there)):
            raise UnavailableError("viscous clutches stand for both freewheels: the case leaves one out")
        self.machine, self.case, self.events = Machine(p), case, stiffness is None
        if self.machine.rubs or any(p[name] for name in LOSSES):
            raise UnavailableError(f"the peers know no losses: {', '.join(LOSSES)} and friction must be 0")
        inertias = p["link2_inertia"], p["output_inertia"]
        given = case.omega1, case.load_torque, self.machine.k, *inertias, stiffness or 0.0
        # of the torque on q: by alpha2, omega1^2, omega1 q', q'^2
        by_q = self.machine.work.terms[6:10].T
        series = np.column_stack([self.machine.work.orders, by_q.real, by_q.imag])
        self.data = np.array([0.0, 0.0, *there, *given]), series
        self.start = np.array([p[f"{name}_start"] for name in ("drive_angle", "omega2", "omega_out")])

    def largest_step(self, phase: float) -> float:
        """Time in which the fastest harmonic turns by a phase (rad), s; infinite without events."""
        rate = self.machine.work.highest * self.machine.k * abs(self.case.omega1)
        return float(phase / rate) if self.events and rate > 0.0 else math.inf

    def choose(self, y: Array) -> None:
        """Close the freewheels that neither pull nor turn; an open one that does not turn begins to."""
        if not self.events:
            return
        numbers, (rates, guard) = self.data[0], equations()
        there, turning = numbers[list(THERE)] != 0.0, np.array([y[1] != 0.0, y[2] != y[1]])
        for closed in itertools.product((1.0, 0.0), repeat=2):
            # what is left out: open to the housing, closed to the output
            if any(closed[n] != (n == OUTPUT) for n in (HOUSING, OUTPUT) if not there[n]):
                continue
            numbers[list(CLOSED)] = closed
            _, alpha2, alpha3 = rates(0.0, y, *self.data)
            gained = alpha2, alpha3 - alpha2
            if not any(
                turning[n] or guard(0.0, y, *self.data, n) < 0.0
                if closed[n]
                else not turning[n] and gained[n] < 0.0
                for n in np.flatnonzero(there)
            ):
                return
        raise RuntimeError(f"no freewheels fit the state {y}")

    def leave(self, y: Array, which: int) -> None:
        """Put the state exactly on the guard that fell and set the freewheels as they follow."""
        numbers = self.data[0]
        if numbers[which]:
            numbers[which] = 0.0
            return
        if which == HOUSING:
            y[1] = 0.0
        if which == OUTPUT or numbers[OUTPUT]:
            y[2] = y[1]
        self.choose(y)


class Segment(NamedTuple):
    """Motion while no freewheel switches.

    Attributes:
        time, state: at its end. guard: which fell there, or None. samples: states at the output times.
        evaluations: right-hand sides.
    """

    time: float
    state: Array
    guard: int | None
    samples: Array
    evaluations: int


# integrates (time, state, output times not before time, the last of them the end)
Integrator = Callable[[float, Array, Array], Segment]


def _by_solve_ivp(problem: Problem, method: str, tolerance: float) -> Integrator:
    rates, guard = equations()

    def falling(which: int) -> Any:
        def event(t: float, y: Array, *data: Array) -> float:
            return float(guard(t, y, *data, which))

        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
        return event

    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance, "args": problem.data}
    options["max_step"] = problem.largest_step(SCIPY_PHASE)
    if problem.events:
        options["events"] = [falling(HOUSING), falling(OUTPUT)]

    def integrate(time: float, state: Array, times: Array) -> Segment:
        sampled = times if len(times) > 1 else None
        found = solve_ivp(rates, (time, times[-1]), state, method, sampled, **options)
        if found.status < 0:
            raise RuntimeError(f"{method} gave up: {found.message}")
        states = np.transpose(found.y).reshape(-1, 3)  # an empty list where no sampling time was reached
        if found.status == 0:
            taken = states if sampled is not None else states[-1:]
            return Segment(times[-1], states[-1], None, taken, found.nfev)
        which = HOUSING if len(found.t_events[HOUSING]) else OUTPUT
        taken = states if sampled is not None else states[:0]
        return Segment(found.t_events[which][0], found.y_events[which][0], which, taken, found.nfev)

    return integrate


def _by_odeint(problem: Problem, tolerance: float) -> Integrator:
    """LSODA with its loop in compiled code, which knows no events."""
    rates, _ = equations()
    options = {"rtol": tolerance, "atol": tolerance, "mxstep": STEPS_ALLOWED}

    def integrate(time: float, state: Array, times: Array) -> Segment:
        states, found = odeint(
            rates, state, [time, *times], problem.data, tfirst=True, full_output=True, **options
        )
        if found["message"] != "Integration successful.":
            raise RuntimeError(f"LSODA gave up: {found['message']}")
        return Segment(times[-1], states[-1], None, states[1:], int(found["nfe"][-1]))

    return integrate


def _by_cvode(problem: Problem, method: str, tolerance: float) -> Integrator:
    """CVODE with its own root finding, started anew where a root function falls through zero."""
    (rates, guard), data = equations(), problem.data
    step = problem.largest_step(CVODE_PHASE)

    def write_rates(t: float, y: Array, values: Array) -> None:
        values[:] = rates(t, y, *data)

    def write_guards(t: float, y: Array, values: Array) -> None:
        for which in (HOUSING, OUTPUT):
            values[which] = guard(t, y, *data, which)

    write_guards.terminal, write_guards.direction = [True, True], [-1, -1]  # type: ignore[attr-defined]
    solver = library("sksundae.cvode", "peers", "scikit-sundae").CVODE(
        write_rates,
        method=method,
        eventsfn=write_guards,
        num_events=2,
        rtol=tolerance,
        atol=tolerance,
        max_step=step if math.isfinite(step) else 0.0,
        max_num_steps=STEPS_ALLOWED,
    )

    def integrate(time: float, state: Array, times: Array) -> Segment:
        solver.init_step(time, state)
        # the wrapper keeps and copies all events it has ever met
        for kept in (write_guards._i, write_guards._t, write_guards._y):  # type: ignore[attr-defined]
            kept.clear()
        samples: list[Array] = []
        for until in times:
            found = solver.step(until)
            if found.status == ROOT_FOUND:
                which = int(np.flatnonzero(found.i_events[-1])[0])
                taken = np.array(samples).reshape(-1, 3)
                return Segment(float(found.t), found.y, which, taken, found.nfev)
            if found.status < 0:
                raise RuntimeError(f"CVODE gave up at {found.t} s: {found.message}")
            samples.append(found.y)
        return Segment(float(times[-1]), samples[-1], None, np.array(samples), found.nfev)

    return integrate


def _run(problem: Problem, times: Array, integrate: Integrator) -> list[Segment]:
    """One run through the output times; the first of them is the beginning."""
    time, state, found = float(times[0]), problem.start.copy(), list[Segment]()
    problem.choose(state)
    times = times[1:]
    while len(found) < EVENTS_ALLOWED:
        segment = integrate(time, state, times)
        found.append(segment)
        times = times[len(segment.samples) :]
        time, state = segment.time, segment.state.copy()
        if segment.guard is None:
            return found
        problem.leave(state, segment.guard)
    raise RuntimeError(f"more than {EVENTS_ALLOWED} events")


def simulate(case: Case, tolerance: float, method: str, stiffness: float | None = None) -> Trajectory:
    """Run a case with all samples, then, timed, to the end alone: what an integrator costs is its own steps.

    Args:
        tolerance: relative and absolute. stiffness: see Problem.
        method: "Adams" or "BDF" of CVODE, as solve_ivp names it, or, with clutches, "odeint".

    Raises:
        UnavailableError: the case is not for it. MissingDependencyError: a library is not.
        RuntimeError: the integrator gives up.
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
