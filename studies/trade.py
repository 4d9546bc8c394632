"""The trade of speed for accuracy of an open-loop case: levels and peers against the converged kernel.

How far that can be trusted the independent reference says (see agreement).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from inertia_module.contract.variables import default_parameters
from inertia_module.fidelity.trials import PEER, Attempt, Level, Row, all_levels, attempt_all, kernel_time
from inertia_module.harness.simulate import Progress, whole_steps
from inertia_module.kernel.codes import AVERAGED, DRIVING, ELASTIC, EVENT, FREE, KINEMATIC, RIGID
from inertia_module.kernel.layout import imbalance_in_fixed_frame
from inertia_module.memory import Module
from inertia_module.scene.schema import at_fidelity, is_elastic

from .reference.geometry import Array
from .reference.motion import Reference
from .stability.motion import solve_at

# measure: what it is, unit ("" where it is relative)
MEASURES: dict[str, tuple[str, str]] = {
    "omega_out_final": ("output speed at the end, relative", ""),
    "omega_out_worst": ("output speed, worst, relative to the largest", ""),
    "torque_mean": ("mean output torque over the run, relative", ""),
    "impulse": ("impulse of the output torque in a pulse, worst, relative to the largest", ""),
    "acceleration": ("acceleration of the imbalance, worst, relative to the largest", ""),
    "event_time": ("time of a switch of the freewheels, worst", "s"),
    "energy": ("residual of the energy audit, relative to the energy in", ""),
}
# an interval belongs to a pulse where its impulse is more than this of the largest
_PULSE = 1e-9
_SAMPLED = ("omega2", "omega_out", "imbalance_acceleration", "contact_mode", "contact_switches")
# what the time of a switch may be off, s
_CLOSE = 2e-14


@dataclass(frozen=True)
class Case:
    """An open-loop case: constant input speed and load, from the start values of the parameters.

    Attributes:
        parameters: of the module by name, those that differ from the defaults (scene R1).
        omega1: rad/s. load_torque: N.m. stop_time: s. points: number of equal sampling intervals.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    omega1: float = 100.0
    load_torque: float = 10.0
    stop_time: float = 1.0
    points: int = 1000

    @property
    def times(self) -> Array:
        """Sampling times from 0 to stop_time, s, shape (points + 1,)."""
        return np.linspace(0.0, self.stop_time, self.points + 1)

    @property
    def all_parameters(self) -> dict[str, Any]:
        """Values of all parameters of the module in this case."""
        return {**default_parameters(), **self.parameters}


@dataclass(frozen=True)
class Trajectory:
    """Motion by an integrator at the sampling times of a case; arrays of shape (points + 1,).

    Attributes:
        time: s. drive_angle: q, unwrapped, rad (NaN where there is no phase).
        omega2, omega_out: speeds of link 2 and of the output shaft, rad/s.
        switches: times of the switches of the freewheels, s, shape (n,), or None if they are not located.
        evaluations: of the right-hand side. energy_residual: of its own energy audit, J, or None.
        wall_time: of the integration alone, s: median of repeats (see median_time).
        impulse: of the output torque Tc from the start, N.m.s, or None if it follows from omega_out
            as output_inertia (omega_out - start) + load_torque time.
        energy_in: work of the input torque, J, or None.
        number_of_switches: where they are counted, else NaN.
        acceleration: of the imbalance, m/s^2, or None if it follows from drive_angle and the speeds.
        modes: contact modes, or None where nobody asks for them.
    """

    time: Array
    drive_angle: Array
    omega2: Array
    omega_out: Array
    evaluations: int
    energy_residual: float | None
    wall_time: float
    switches: Array | None = None
    impulse: Array | None = None
    energy_in: float | None = None
    number_of_switches: float = math.nan
    acceleration: Array | None = None
    modes: Array | None = None


@dataclass(frozen=True)
class Peer:
    """Another way to integrate a case, with the settings it is to be tried at.

    Attributes:
        name: one curve of the plots, such as "LSODA, clutch 1e4".
        settings: what integrate takes, by its label, such as "rtol 1e-8"; from coarse to fine.
        integrate: of (case, setting) the trajectory. May raise ValueError, RuntimeError (Unavailable,
            NotInstalled) or ArithmeticError: it is then listed as a failure.
    """

    name: str
    settings: Mapping[str, Any]
    integrate: Callable[[Case, Any], Trajectory]


class KernelRun:
    """The module over a case at one setting, saved at each communication point.

    Args:
        case: what is run. settings: parameters over those of the case, such as fidelity and tolerance.
        communication_step: s; the case's stop time has to be a whole number of them.

    Raises:
        Refused: the module refuses the settings or a step.
        ValueError: the stop time is no whole number of steps.
    """

    def __init__(self, case: Case, settings: Mapping[str, float], communication_step: float) -> None:
        number = whole_steps(case.stop_time, communication_step)
        if not number:
            raise ValueError(
                f"the communication step must be a whole part of {case.stop_time:g} s,"
                f" is {communication_step:g} s"
            )
        self.case, self.steps, self.step = case, number, case.stop_time / number
        inputs = {"omega1": case.omega1, "load_torque": case.load_torque}
        self.fidelity = int(settings.get("fidelity", RIGID))
        values = at_fidelity(case.parameters, self.fidelity) | dict(settings) | inputs
        self.module = Module("auto").start(**values)
        self.phased = self.fidelity != AVERAGED
        self.located = settings.get("method", EVENT) == EVENT and self.fidelity in (RIGID, ELASTIC)
        self._saved = [self.module.save()]
        self._impulse = [0.0]
        for _ in range(self.steps):
            self.module.advance(self.step)
            self._saved.append(self.module.save())
            self._impulse.append(self._impulse[-1] + self.step * self.module["output_torque_mean"])

    def reach(self, time: float) -> float:
        """Bring the module to a time by the run's own steps and a part of one. Returns the impulse."""
        n = min(math.floor(time / self.step * (1.0 + 1e-14)), self.steps)
        self.module.restore(self._saved[n])
        rest = time - n * self.step
        if rest <= 1e-15 * self.case.stop_time:
            return self._impulse[n]
        self.module.advance(rest)
        return self._impulse[n] + rest * self.module["output_torque_mean"]

    def _switch(self, number: int, low: float, high: float) -> float:
        """Time of a switch, numbered from 1, between two times, s, by bisection."""
        while high - low > _CLOSE:
            middle = 0.5 * (low + high)
            self.reach(middle)
            if self.module["contact_switches"] >= number:
                high = middle
            else:
                low = middle
        return high

    def trajectory(self, timed: bool = True) -> Trajectory:
        """Look at the run at the case's sampling times; timed: repeat it for its time."""
        times = self.case.times
        rows, impulse, angle = [], [], []
        for time in times:
            impulse.append(self.reach(float(time)))
            rows.append([self.module[name] for name in _SAMPLED])
            angle.append(self.module["drive_angle"] + 2.0 * math.pi * self.module["drive_turns"])
        omega2, omega_out, acceleration, modes, counts = np.array(rows).T
        switches = None
        if self.located:
            numbers = range(1, int(counts[-1]) + 1)
            after = np.searchsorted(counts, numbers)
            switches = np.array(
                [self._switch(n, *times[i - 1 : i + 1]) for n, i in zip(numbers, after, strict=True)]
            )
        given = [(self.case.omega1, self.case.load_torque, 0.0)] * self.steps
        cost = kernel_time(self.module, self._saved[0], given, self.step) if timed else math.nan
        self.module.restore(self._saved[-1])
        nothing = np.full_like(times, math.nan)
        return Trajectory(
            time=times,
            drive_angle=np.array(angle) if self.phased else nothing,
            omega2=omega2 if self.phased else nothing,
            omega_out=omega_out,
            switches=switches,
            evaluations=int(self.module["rhs_evaluations"]),
            energy_residual=self.module["energy_residual"],
            wall_time=cost,
            impulse=np.array(impulse),
            energy_in=self.module["energy_in"],
            number_of_switches=counts[-1] if self.phased else math.nan,
            acceleration=None if self.fidelity == RIGID else acceleration if self.phased else nothing,
            modes=modes,
        )


def impulse(case: Case, trajectory: Trajectory) -> Array:
    """Impulse of the output torque from the start up to each sample, N.m.s, shape (points + 1,)."""
    if trajectory.impulse is not None:
        return trajectory.impulse
    gained = trajectory.omega_out - trajectory.omega_out[0]
    total: Array = case.all_parameters["output_inertia"] * gained + case.load_torque * trajectory.time
    return total


def pulses(impulses: Array) -> list[tuple[int, int]]:
    """First and last sample of each pulse in impulses up to each sample, shape (points + 1,)."""
    driving = np.diff(impulses) > _PULSE * np.abs(np.diff(impulses)).max(initial=0.0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], driving, [False]]).astype(int)))
    return [(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def acceleration(case: Case, trajectory: Trajectory, modes: Array) -> Array:
    """Acceleration of the imbalance at the sampled states, m/s^2, shape (points + 1,).

    Args:
        modes: contact modes of the reference, so that a switch a little early or late counts in
            event_time alone, and not by which sample it falls on.
    """
    if trajectory.acceleration is not None:
        return trajectory.acceleration
    module = Module("plain").start(**at_fidelity(case.parameters, RIGID))
    d, omega1, found = module.derived, case.omega1, []
    for q, omega2, mode in zip(trajectory.drive_angle, trajectory.omega2, modes, strict=True):
        held = mode not in (DRIVING, FREE)
        speeds = {"omega1": omega1, "omega2": omega2, "omega3": omega2}
        alpha2 = solve_at(module, held, mode == DRIVING, case.load_torque, q=q, **speeds).alpha2
        place = (d, q, 0.0, omega1, 0.0, d.k * (omega1 - omega2), -d.k * alpha2, 0.0)
        found.append(np.linalg.norm(imbalance_in_fixed_frame(*place)[6:]))  # type: ignore[no-untyped-call]
    return np.array(found)


def _worst(values: Array, exact: Array) -> float:
    """Largest difference relative to the largest exact value, NaN where there is nothing to compare."""
    scale = float(np.abs(exact).max(initial=0.0))
    return float(np.abs(values - exact).max()) / scale if scale > 0.0 else math.nan


def _relative(value: float, exact: float | None) -> float:
    """Difference of a value from the exact one, relative to it; NaN where that is zero or not known."""
    return abs(value / exact - 1.0) if exact else math.nan


def errors(case: Case, trajectory: Trajectory, exact: Trajectory) -> dict[str, float]:
    """Errors of a trajectory by the names of MEASURES; NaN where nothing is known.

    Raises:
        ValueError: it has other sampling times than the reference.
    """
    if trajectory.omega_out.shape != exact.omega_out.shape:
        raise ValueError(
            f"a trajectory must have the samples of the reference, {exact.omega_out.size},"
            f" has {trajectory.omega_out.size}"
        )
    ours, theirs = impulse(case, trajectory), impulse(case, exact)
    found = dict.fromkeys(MEASURES, math.nan)
    found["omega_out_final"] = _relative(trajectory.omega_out[-1], exact.omega_out[-1])
    found["omega_out_worst"] = _worst(trajectory.omega_out, exact.omega_out)
    found["torque_mean"] = _relative(ours[-1], theirs[-1])
    if (modes := exact.modes) is not None and not np.isnan(trajectory.drive_angle).any():
        edges = np.array(pulses(theirs), dtype=int).reshape(-1, 2)
        found["impulse"] = _worst(*(values[edges[:, 1]] - values[edges[:, 0]] for values in (ours, theirs)))
        found["acceleration"] = _worst(*(acceleration(case, one, modes) for one in (trajectory, exact)))
    switches, expected = trajectory.switches, exact.switches
    if switches is not None and expected is not None and switches.size == expected.size > 0:
        found["event_time"] = np.abs(switches - expected).max()
    if trajectory.energy_residual is not None and exact.energy_in:
        found["energy"] = abs(trajectory.energy_residual / exact.energy_in)
    return {name: float(value) for name, value in found.items()}


R1 = Case()
# an output shaft for R1: hub, spring, damper and driven mass
R1_ELASTIC = Case(
    {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
)
TOLERANCE = 1e-13
# communication steps of the converged kernel: short ones make the switches quick to find
_STEPS = 100
# sampling intervals of its comparison with the reference
_COMPARED = 20


@dataclass(frozen=True)
class Agreement:
    """Largest difference between the converged kernel and the independent reference.

    Attributes:
        omega_out: relative to the largest omega_out. events: of the times of the switches, s.
        switches: number of them in the kernel and in the reference.
    """

    omega_out: float
    events: float
    switches: tuple[int, int]


def _fidelity(case: Case) -> int:
    return ELASTIC if is_elastic(case.parameters) else RIGID


def converged(case: Case) -> Trajectory:
    """Run the kernel from event to event at tolerance 1e-13; elastic where the case is.

    Raises:
        Refused: the module refuses the case.
    """
    settings = {"fidelity": _fidelity(case), "tolerance": TOLERANCE}
    return KernelRun(case, settings, case.stop_time / min(case.points, _STEPS)).trajectory(timed=False)


def agreement(case: Case) -> Agreement:
    """Compare the converged kernel with the reference: other equations, other integrator, other events.

    Raises:
        Unavailable: the reference does not take the case (see motion.py).
    """
    coarse = dataclasses.replace(case, points=_COMPARED)
    parameters = {**case.parameters, "fidelity": _fidelity(case)}
    second, speeds = Reference(parameters, case.omega1, case.load_torque), []
    for time in coarse.times:
        second.advance(time)
        speeds.append(second.omega_out)
    first = converged(coarse)
    assert first.switches is not None
    counts = first.switches.size, len(second.switches)
    events = (
        float(np.abs(first.switches - second.switches).max(initial=0.0)) if counts[0] == counts[1] else np.nan
    )
    largest = float(np.abs(speeds).max()) or 1.0
    return Agreement(float(np.abs(first.omega_out - speeds).max()) / largest, events, counts)


def measure(
    case: Case,
    exact: Trajectory,
    levels: Sequence[Level] | None = None,
    peers: Sequence[Peer] = (),
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Rows of all levels in all communication steps, and of all peers, which run the case in one go.

    Args:
        case: what is run. exact: its converged trajectory. levels: by default all. peers: beside them.
        steps: communication steps, s; by default the whole run, a hundredth and a thousandth of it.
        progress: told how much is done (0 to 1).
    """

    def compared(run: Callable[..., Trajectory], *arguments: Any) -> Callable[[Progress], dict[str, Any]]:
        def measured(_: Progress) -> dict[str, Any]:
            found = run(*arguments)
            return {
                "errors": errors(case, found, exact),
                "wall_time": found.wall_time / case.stop_time,
                "evaluations": found.evaluations,
                "switches": found.number_of_switches,
            }

        return measured

    def run_level(level: Level, step: float) -> Trajectory:
        return KernelRun(case, level.values, step).trajectory()

    prescribed = Level(KINEMATIC, EVENT, "prescribed ratio")
    chosen = [prescribed, *all_levels(is_elastic(case.parameters))] if levels is None else levels
    lengths = [case.stop_time / number for number in (1, 100, 1000)] if steps is None else steps
    attempts: list[Attempt] = [
        (level.row(step), compared(run_level, level, step)) for step in lengths for level in chosen
    ]
    attempts += [
        (Row(PEER, peer.name, label, case.stop_time), compared(peer.integrate, case, setting))
        for peer in peers
        for label, setting in peer.settings.items()
    ]
    return attempt_all(attempts, progress)
