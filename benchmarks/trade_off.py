"""The trade of speed for accuracy of an open-loop case: levels and peers against the converged kernel.

How far that can be trusted the independent reference says (tests/studies/test_trade.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from inertia_module.fidelity.trials import PEER, Level, Row, all_levels, attempt, kernel_time
from inertia_module.fmi.simulate import Progress, whole_steps
from inertia_module.interface.variables import default_parameters
from inertia_module.kernel.codes import AVERAGED, ELASTIC, KINEMATIC, RIGID
from inertia_module.model import Module
from inertia_module.scene.schema import at_fidelity, is_elastic
from verification.reference.geometry import Array

TOLERANCE = 1e-12
# communication steps of the converged kernel
_STEPS = 100


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


R1 = Case()
# an output shaft for R1: hub, spring, damper and driven mass
R1_ELASTIC = Case(
    {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
)


@dataclass(frozen=True)
class Trajectory:
    """Motion by an integrator at the sampling times of a case.

    Attributes:
        motion: drive angle q, unwrapped, rad; speeds of link 2 and of the output shaft, rad/s:
            shape (points + 1, 3).
        evaluations: of the right-hand side.
        wall_time: of the integration alone, s: median of repeats (see median_time).
        switches: of the freewheels, NaN where they are not counted.
    """

    motion: Array
    evaluations: int
    wall_time: float
    switches: float = math.nan

    @property
    def omega_out(self) -> Array:
        """Speed of the output shaft, rad/s, shape (points + 1,)."""
        return self.motion[:, 2]


# another way to integrate a case: one curve of the plots, such as "LSODA, clutch 1e4"; its setting, such as
# "rtol 1e-8"; and what does it, or raises one of trials.FAILURES and is listed as a failure
Peer = tuple[str, str, Callable[[Case], Trajectory]]


def by_kernel(case: Case, settings: Mapping[str, float], step: float, timed: bool = True) -> Trajectory:
    """Run the module over a case in steps, s; between them it is looked at from the last communication point.

    Args:
        settings: parameters over those of the case, such as fidelity and tolerance.
        timed: whether it is repeated for its time.

    Raises:
        ParameterError: the module refuses the settings or a step.
        ValueError: the stop time is no whole number of steps.
    """
    number = whole_steps(case.stop_time, step)
    if not number:
        raise ValueError(
            f"the communication step must be an integer fraction of {case.stop_time:g} s (got {step:g} s)"
        )
    step, fidelity = case.stop_time / number, int(settings.get("fidelity", RIGID))
    values = {**at_fidelity(case.parameters, fidelity), **settings}
    module = Module("auto").start(**values, omega1=case.omega1, load_torque=case.load_torque)
    saved = [module.save()]
    for _ in range(number):
        module.advance(step)
        saved.append(module.save())
    motion = []
    for time in case.times.tolist():
        n = min(math.floor(time / step * (1.0 + 1e-14)), number)
        module.restore(saved[n])
        if time - n * step > 1e-15 * case.stop_time:
            module.advance(time - n * step)
        angle = module["drive_angle"] + 2.0 * math.pi * module["drive_turns"]
        motion.append([angle, module["omega2"], module["omega_out"]])
    inputs = [(case.omega1, case.load_torque, 0.0)] * number
    cost = kernel_time(module, saved[0], inputs, step) if timed else math.nan
    module.restore(saved[-1])
    switches = math.nan if fidelity == AVERAGED else module["contact_switches"]
    return Trajectory(np.array(motion), int(module["rhs_evaluations"]), cost, switches)


def errors(trajectory: Trajectory, exact: Trajectory) -> dict[str, float]:
    """Errors of the output speed: at the end, relative; the worst, relative to the largest speed."""
    ours, theirs = trajectory.omega_out, exact.omega_out
    return {
        "omega_out_final": abs(float(ours[-1] / theirs[-1] - 1.0)),
        "omega_out_worst": float(np.abs(ours - theirs).max() / np.abs(theirs).max()),
    }


def converged(case: Case) -> Trajectory:
    """Run the kernel from event to event at tolerance 1e-13; elastic where the case is."""
    settings = {"fidelity": ELASTIC if is_elastic(case.parameters) else RIGID, "tolerance": TOLERANCE}
    return by_kernel(case, settings, case.stop_time / min(case.points, _STEPS), timed=False)


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

    def compared(run: Callable[..., Trajectory], *arguments: Any) -> dict[str, Any]:
        found = run(case, *arguments)
        return {
            "errors": errors(found, exact),
            "wall_time": found.wall_time / case.stop_time,
            "evaluations": found.evaluations,
            "switches": found.switches,
        }

    prescribed = Level(KINEMATIC, "prescribed ratio")
    chosen = [prescribed, *all_levels(is_elastic(case.parameters))] if levels is None else levels
    lengths = [case.stop_time / number for number in (1, 100, 1000)] if steps is None else steps
    runs: list[tuple[Any, ...]]
    runs = [(level.row(step), by_kernel, level.values, step) for step in lengths for level in chosen]
    runs += [(Row(PEER, name, label, case.stop_time), integrate) for name, label, integrate in peers]
    rows = []
    for head, *run in runs:
        rows.append(attempt(head, partial(compared, *run)))
        if progress is not None:
            progress(len(rows) / len(runs))
    return rows
