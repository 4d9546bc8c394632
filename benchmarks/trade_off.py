"""Accuracy and run time of an open-loop case: levels and other integrators against the converged kernel.

The independent reference confirms the converged kernel (tests/verification/test_trade.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from inertia_module.fidelity.levels import Level, all_levels
from inertia_module.fidelity.rows import PEER, Row, attempt
from inertia_module.fidelity.timing import kernel_time
from inertia_module.fmi.simulate import Progress, whole_steps
from inertia_module.interface.variables import default_parameters
from inertia_module.kernel.codes import AVERAGED, ELASTIC, KINEMATIC, RIGID
from inertia_module.model import Module
from inertia_module.scene.schema import at_fidelity, is_elastic
from verification.reference.geometry import Array

TOLERANCE = 1e-12
# communication steps of the converged kernel
_STEPS = 100
# tolerances of the levels in the tables
TOLERANCES = tuple(10.0**-n for n in range(3, 12))


@dataclass(frozen=True)
class Case:
    """Open-loop case: constant input speed and load, from the start values of the parameters.

    Attributes:
        parameters: Parameters that differ from the defaults (scene R1), SI, by name.
        omega1: Input speed, rad/s.
        load_torque: Load torque, N·m.
        stop_time: Duration, s.
        points: Number of equal sampling intervals.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    omega1: float = 100.0
    load_torque: float = 10.0
    stop_time: float = 1.0
    points: int = 1000

    @property
    def times(self) -> Array:
        """Return the sampling times from 0 to stop_time, s, shape (points + 1,)."""
        return np.linspace(0.0, self.stop_time, self.points + 1)

    @property
    def all_parameters(self) -> dict[str, Any]:
        """Return the values of all parameters of the module, SI, by name."""
        return {**default_parameters(), **self.parameters}


R1 = Case()
# R1 with an elastic output shaft: hub, spring, damper and driven mass
R1_ELASTIC = Case(
    {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
)


@dataclass(frozen=True)
class Trajectory:
    """Motion by an integrator at the sampling times of a case.

    Attributes:
        motion: Angle of the pinion shaft q, unwrapped, rad; speed of link 2, rad/s; speed of the output
            shaft, rad/s. Shape (points + 1, 3).
        evaluations: Number of right-hand-side evaluations.
        wall_time: Run time of the integration, s: median of repeated runs (see median_time).
        switches: Number of contact switches; NaN if not counted.
    """

    motion: Array
    evaluations: int
    wall_time: float
    switches: float = math.nan

    @property
    def omega_out(self) -> Array:
        """Return the speed of the output shaft, rad/s, shape (points + 1,)."""
        return self.motion[:, 2]


# another integrator: name of the curve in the diagram, such as "LSODA, clutch 1e4"; setting, such as
# "rtol 1e-8"; function that integrates a case, or raises one of rows.FAILURES
Peer = tuple[str, str, Callable[[Case], Trajectory]]


def by_kernel(case: Case, settings: Mapping[str, float], step: float, timed: bool = True) -> Trajectory:
    """Run the module over a case; sampling times between communication points start at the point before.

    Args:
        case: The case.
        settings: Parameters that override the parameters of the case, such as fidelity and tolerance.
        step: Communication step, s.
        timed: True to measure the run time by repeated runs.

    Raises:
        ParameterError: The module rejects the settings or a step.
        ValueError: The stop time is not a whole number of steps.
    """
    number = whole_steps(case.stop_time, step)
    if not number:
        raise ValueError(
            f"the communication step must be an integer fraction of {case.stop_time:g} s (got {step:g} s)"
        )
    step, fidelity = case.stop_time / number, int(settings.get("fidelity", RIGID))
    values = {**at_fidelity(case.parameters, fidelity), **settings}
    module = Module("auto").start(**values, omega1=case.omega1, load_torque=case.load_torque)
    states = [module.save()]
    for _ in range(number):
        module.advance(step)
        states.append(module.save())
    motion = []
    for time in case.times.tolist():
        n = min(math.floor(time / step * (1.0 + 1e-14)), number)
        module.restore(states[n])
        if time - n * step > 1e-15 * case.stop_time:
            module.advance(time - n * step)
        angle = module["drive_angle"] + 2.0 * math.pi * module["drive_turns"]
        motion.append([angle, module["omega2"], module["omega_out"]])
    inputs = [(case.omega1, case.load_torque, 0.0)] * number
    cost = kernel_time(module, states[0], inputs, step) if timed else math.nan
    module.restore(states[-1])
    switches = math.nan if fidelity == AVERAGED else module["contact_switches"]
    return Trajectory(np.array(motion), int(module["rhs_evaluations"]), cost, switches)


def errors(trajectory: Trajectory, exact: Trajectory) -> dict[str, float]:
    """Return the relative final and maximum error of the output speed, by name.

    The maximum error is relative to the maximum output speed of the converged trajectory.

    Args:
        trajectory: Trajectory of an integrator.
        exact: Converged trajectory.
    """
    actual, expected = trajectory.omega_out, exact.omega_out
    return {
        "omega_out_final": abs(float(actual[-1] / expected[-1] - 1.0)),
        "omega_out_worst": float(np.abs(actual - expected).max() / np.abs(expected).max()),
    }


def converged(case: Case) -> Trajectory:
    """Run the event-driven kernel at tolerance TOLERANCE; elastic if the case has an elastic shaft.

    Args:
        case: The case.
    """
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
    """Measure all levels with all communication steps, and all peers without communication steps.

    Args:
        case: The case.
        exact: Converged trajectory of the case.
        levels: Levels to measure; None for all.
        peers: Other integrators.
        steps: Communication steps, s; None for the stop time, a hundredth and a thousandth of it.
        progress: Function called with the completed fraction, 0 to 1.
    """

    def compared(run: Callable[..., Trajectory], *arguments: Any) -> dict[str, Any]:
        trajectory = run(case, *arguments)
        return {
            "errors": errors(trajectory, exact),
            "wall_time": trajectory.wall_time / case.stop_time,
            "evaluations": trajectory.evaluations,
            "switches": trajectory.switches,
        }

    prescribed = Level(KINEMATIC, "prescribed ratio")
    if levels is None:
        levels = [prescribed, *all_levels(is_elastic(case.parameters), TOLERANCES)]
    lengths = [case.stop_time / number for number in (1, 100, 1000)] if steps is None else steps
    runs: list[tuple[Any, ...]]
    runs = [
        (Row.of_level(level, step), by_kernel, level.values, step) for step in lengths for level in levels
    ]
    runs += [(Row(PEER, name, label, case.stop_time), integrate) for name, label, integrate in peers]
    rows = []
    for head, *run in runs:
        rows.append(attempt(head, partial(compared, *run)))
        if progress is not None:
            progress(len(rows) / len(runs))
    return rows
