"""The converged reference of a case, and how well a second method agrees with it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from inertia_module.kernel.codes import ELASTIC, RIGID
from inertia_module.memory.instances import Module
from inertia_module.scene.mechanism import is_elastic

from .kernel_runs import KernelRun
from .lagrange import Lagrange
from .lossy import Lossy
from .trajectory import Array, Case, Trajectory

TOLERANCE = 1e-13
# communication steps: short ones make the switches quick to find
_STEPS = 100
# sampling intervals of the comparison with the second method
_COMPARED = 20


def second_method(parameters: Mapping[str, float]) -> type[Lagrange | Lossy]:
    """The equations that the module is held to with these parameters: with losses those of virtual work.

    Raises:
        Refused: the module refuses them.
    """
    return Lossy if Module().start(**parameters).derived.general else Lagrange


@dataclass(frozen=True)
class Reference:
    """The tightest run of a case.

    Attributes:
        case: what was run. trajectory: at its sampling times. modes: contact modes there, (points + 1,).
    """

    case: Case
    trajectory: Trajectory
    modes: Array


@dataclass(frozen=True)
class Agreement:
    """Largest difference between the reference and the second method.

    Attributes:
        omega_out: relative to the largest omega_out. events: of the times of the switches, s.
        switches: number of them in the reference and in the second method.
    """

    omega_out: float
    events: float
    switches: tuple[int, int]


def _fidelity(case: Case) -> int:
    return ELASTIC if is_elastic(case.parameters) else RIGID


def converged(case: Case) -> Reference:
    """The reference: the kernel from event to event at tolerance 1e-13; elastic where the case is.

    Raises:
        Refused: the module refuses the case.
    """
    settings = {"fidelity": _fidelity(case), "tolerance": TOLERANCE}
    run = KernelRun(case, settings, case.stop_time / min(case.points, _STEPS))
    return Reference(case, *run.trajectory(timed=False))


def agreement(case: Case) -> Agreement:
    """Compare the reference with the second method: other equations, other integrator, other events.

    Raises:
        Unavailable: the second method does not take the case (see lagrange.py, lossy.py).
    """
    coarse = dataclasses.replace(case, points=_COMPARED)
    parameters = {**case.parameters, "fidelity": _fidelity(case)}
    second = second_method(parameters)(parameters, case.omega1, case.load_torque)
    speeds = []
    for time in coarse.times:
        second.advance(time)
        speeds.append(second.omega_out)
    first = converged(coarse).trajectory
    assert first.switches is not None
    counts = first.switches.size, len(second.switches)
    events = (
        float(np.abs(first.switches - second.switches).max(initial=0.0)) if counts[0] == counts[1] else np.nan
    )
    largest = float(np.abs(speeds).max()) or 1.0
    return Agreement(float(np.abs(first.omega_out - speeds).max()) / largest, events, counts)
