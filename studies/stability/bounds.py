"""The bounds a trial is held to, as functions of the tolerance. docs/stability.md prints these."""

from __future__ import annotations

from inertia_module.kernel.codes import ELASTIC, TIMESTEPPING

from ..reference.geometry import shaft_frequency, swing_frequency
from .case import Case

# relative rounding that adds up over a run
ROUNDING = 1e-12
# tolerances that the energy residual may come to, of the largest energy
ENERGY_TOLERANCES = 100.0
# accuracies, and effects of a change of the problem by a tolerance, that a result may be off
RESULT_ACCURACIES = 3.0
# no relative error is allowed to be larger, whatever accuracy is asked for: a looser bound would say nothing
LARGEST_ERROR = 0.1
# breach of a freewheel, of the largest torque or speed
BREACH = 1e-9
# right-hand sides for each communication step, for each radian of the highest harmonic (by events: they grow
# slowly with the digits asked for, at eighth order) and for each internal step of timestepping
STEP_WORK = 100.0
PHASE_WORK = 20.0
WORK_ORDER = 8.0
FIXED_STEP_WORK = 10.0


def energy_bound(accuracy: float) -> float:
    """Energy residual allowed, of the largest energy."""
    return min(LARGEST_ERROR, ENERGY_TOLERANCES * accuracy + ROUNDING)


def result_bound(accuracy: float, sensitivity: float) -> float:
    """Distance allowed between two runs of one motion, relative.

    Args:
        accuracy: asked for, relative.
        sensitivity: distance that a change of the problem by the tolerance makes.
    """
    return min(LARGEST_ERROR, RESULT_ACCURACIES * (accuracy + sensitivity) + ROUNDING)


def work_bound(case: Case, phase: float, steps: int, fixed_steps: int) -> float:
    """Right-hand sides allowed for a phase (rad), communication steps and internal steps of timestepping."""
    if case.level.method == TIMESTEPPING:
        return STEP_WORK * steps + FIXED_STEP_WORK * fixed_steps
    # what the shaft, freewheels that wind up and weights can swing through costs too
    swinging = swing_frequency(case.parameter)
    if case.level.fidelity == ELASTIC:
        swinging += shaft_frequency(case.parameter)
    phase += swinging * sum(part.duration for part in case.extreme.segments)
    digits = float(case.parameter("tolerance") ** (-1.0 / WORK_ORDER))
    return STEP_WORK * steps + PHASE_WORK * digits * (1.0 + phase)
