"""The bounds a trial is held to, as functions of the tolerance. docs/stability.md prints these."""

from __future__ import annotations

import math

from ...variables import BY_NAME
from .case import AVERAGED, ELASTIC, TIMESTEPPING, Case

# relative rounding that adds up over a run
ROUNDING = 1e-12
# tolerances that the energy residual may come to, of the largest energy
ENERGY_TOLERANCES = 100.0
# accuracies, and effects of a change of the problem by a tolerance, that a result may be off
RESULT_ACCURACIES = 3.0
# no relative error is allowed to be larger, whatever accuracy is asked for: a looser bound would say nothing
LARGEST_ERROR = 0.1
# what the fixed steps of timestepping are trusted to, relative
TIMESTEPPING_ACCURACY = 0.02
# what the torque map of the averaged module is trusted to, relative
AVERAGED_ACCURACY = 0.005
# breach of a freewheel, of the largest torque or speed
BREACH = 1e-9
# right-hand sides for each communication step, and for each radian of the highest harmonic
STEP_WORK = 100.0
PHASE_WORK = 20.0
WORK_ORDER = 8.0
# what makes the frequency of the elastic shaft
SHAFT = ("shaft_stiffness", "output_inertia", "driven_inertia")
# and for each internal step of method timestepping
FIXED_STEP_WORK = 10.0


def tolerance_of(case: Case) -> float:
    """Tolerance of a case."""
    return float(case.extreme.parameters.get("tolerance", BY_NAME["tolerance"].start or 0.0))


def accuracy_of(case: Case) -> float:
    """Relative accuracy a case is asked for: its tolerance, or what its method and fidelity can give."""
    accuracy = tolerance_of(case)
    if case.rung.method == TIMESTEPPING:
        accuracy = max(accuracy, TIMESTEPPING_ACCURACY)
    if case.rung.fidelity == AVERAGED:
        accuracy = max(accuracy, AVERAGED_ACCURACY)
    return accuracy


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
    """Right-hand sides allowed.

    With method event the eighth order makes them grow slowly with the digits asked for; with method
    timestepping each internal step costs the same.
    """
    if case.rung.method == TIMESTEPPING:
        return STEP_WORK * steps + FIXED_STEP_WORK * fixed_steps
    digits = float(tolerance_of(case) ** (-1.0 / WORK_ORDER))
    if case.rung.fidelity == ELASTIC:
        phase += shaft_phase(case)
    return STEP_WORK * steps + PHASE_WORK * digits * (1.0 + phase)


def shaft_phase(case: Case) -> float:
    """Phase, rad, the elastic shaft can swing through in a case: what its oscillation may cost."""
    values = {name: BY_NAME[name].start or 0.0 for name in SHAFT} | dict(case.extreme.parameters)
    c, j3, j4 = (float(values[name]) for name in SHAFT)
    return math.sqrt(c * (1.0 / j3 + 1.0 / j4)) * sum(part.duration for part in case.extreme.segments)
