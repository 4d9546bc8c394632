"""Times of experiments of FMUs: start, stop and communication step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FmuError, must_be

# number of steps of an experiment without a step size
STEPS = 100
# share of a step that is treated as round-off
ROUNDING = 1e-6


class Span(NamedTuple):
    """Times of an experiment.

    Attributes:
        start: start time, s.
        stop: stop time, s.
        step: communication step, s.
        is_variable: True if the last step may be shorter; otherwise a remainder is omitted.
    """

    start: float
    stop: float
    step: float
    is_variable: bool

    @property
    def steps(self) -> float:
        """Number of steps, with a fraction; NaN if the times are not finite."""
        return (self.stop - self.start) / self.step if self.step > 0.0 else math.nan

    def times(self, maximum: int) -> NDArray[np.float64]:
        """Return the communication points, s, shape (steps + 1,).

        Args:
            maximum: maximum number of steps.

        Raises:
            FmuError: the times are invalid, or there are too many steps.
        """
        text = f"{self.start:g} s to {self.stop:g} s by {self.step:g} s"
        if not (0.0 < self.steps < math.inf):
            allowed = "finite, the stop time after the start time and the step positive"
            raise FmuError(must_be("times of an experiment", allowed, text))
        if self.steps > maximum + ROUNDING:
            number = f"{self.steps:.4g}: {text}"
            raise FmuError(must_be("number of steps of an experiment", f"at most {maximum}", number))
        whole = max(math.floor(self.steps + ROUNDING), 1)
        is_shorter = self.is_variable and self.steps > whole + ROUNDING
        times = self.start + np.arange(whole + 1, dtype=np.float64) * self.step
        if is_shorter:
            times = np.append(times, self.stop)
        elif abs(self.steps - whole) <= ROUNDING or self.is_variable:
            times[-1] = self.stop
        if not (np.diff(times) > 0.0).all():
            raise FmuError(must_be("step", "large enough to change the time", text))
        return times


def span_of(description: Any, settings: Mapping[str, str | float]) -> Span:
    """Return the times of an experiment.

    The step is the first of these that exists: step of the experiment, step of the default experiment,
    internal step of the FMU, a hundredth of the duration.

    Args:
        description: model description of fmpy; its default experiment completes the settings.
        settings: startTime, stopTime and stepSize, s, if the experiment defines them.

    Raises:
        ValueError: a time is no number.
    """
    default, interface = description.defaultExperiment, description.coSimulation
    numbers: dict[str, float | None] = {}
    for name in ("startTime", "stopTime", "stepSize"):
        value = settings.get(name, getattr(default, name, None))
        numbers[name] = None if value is None else float(value)
    start = numbers["startTime"] or 0.0
    stop = start + 1.0 if numbers["stopTime"] is None else numbers["stopTime"]
    internal = getattr(interface, "fixedInternalStepSize", None)
    step = numbers["stepSize"]
    if step is None:
        step = float(internal) if internal else (stop - start) / STEPS
    is_variable = bool(getattr(interface, "canHandleVariableCommunicationStepSize", True))
    return Span(start, stop, step, is_variable)
