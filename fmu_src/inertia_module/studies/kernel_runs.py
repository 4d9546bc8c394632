"""Runs of the module itself over a case, in communication steps of any length, looked at in between."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..kernel.codes import AVERAGED, ELASTIC, EVENT, RIGID
from ..memory.instances import Module
from ..scene.mechanism import at_fidelity
from .timing import kernel_time
from .trajectory import Array, Case, Trajectory

_SAMPLED = ("omega2", "omega_out", "imbalance_acceleration", "contact_mode", "contact_switches")
# the first distance at which a switch is looked for from where it is expected, s
_NEAREST = 1e-13


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
        number = round(case.stop_time / communication_step)
        if number < 1 or abs(number * communication_step - case.stop_time) > 1e-9 * case.stop_time:
            raise ValueError(
                f"communication step = {communication_step:g} s is refused: allowed is a whole part of"
                f" {case.stop_time:g} s"
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

    def _switched(self, time: float, number: int) -> bool:
        """Whether this switch has happened by a time, s."""
        self.reach(time)
        return self.module["contact_switches"] >= number

    def _bracket(self, number: int, low: float, high: float, hint: float) -> tuple[float, float]:
        """Narrow a bracket of a switch around where it is expected, looking further and further away."""
        if not low < hint < high:
            return low, high
        after, away = self._switched(hint, number), _NEAREST
        edge = hint
        while True:
            probe = hint - away if after else hint + away
            if not low < probe < high:
                return (low, edge) if after else (edge, high)
            if self._switched(probe, number) != after:
                return (probe, edge) if after else (edge, probe)
            edge, away = probe, away * 8.0

    def _switches(self, times: Array, counts: Array, hints: Array | None) -> Array:
        """Times at which the counter of switches goes up, s."""
        expected = hints if hints is not None and hints.size == counts[-1] else None
        found = []
        for number in range(1, int(counts[-1]) + 1):
            place = int(np.searchsorted(counts, number))
            low, high = float(times[max(place - 1, 0)]), float(times[place])
            near = math.nan if expected is None else float(expected[number - 1])
            if expected is not None:
                low, high = self._bracket(number, low, high, near)
            # to rounding, or to a thousandth of how far it is from where it is expected
            while high - low > 1e-3 * abs(high - near) if expected is not None else True:
                middle = 0.5 * (low + high)
                if not low < middle < high:
                    break
                low, high = (low, middle) if self._switched(middle, number) else (middle, high)
            found.append(high)
        return np.array(found)

    def _cost(self) -> float:
        """Time of the kernel for the whole run, s, median of repeats."""
        inputs = [(self.case.omega1, self.case.load_torque, 0.0)] * self.steps
        return kernel_time(self.module, self._saved[0], inputs, self.step)

    def trajectory(
        self, locate: bool = True, timed: bool = True, hints: Array | None = None
    ) -> tuple[Trajectory, Array]:
        """What the run gives at the case's sampling times, and the contact modes there.

        Args:
            locate: whether to find the times of the switches. timed: whether to repeat it for its time.
            hints: where switches are expected, s: they are then found to a thousandth of the distance.
        """
        times = self.case.times
        rows, impulse, angle = [], [], []
        for time in times:
            impulse.append(self.reach(float(time)))
            rows.append([self.module[name] for name in _SAMPLED])
            angle.append(self.module["drive_angle"] + 2.0 * math.pi * self.module["drive_turns"])
        omega2, omega_out, acceleration, modes, counts = np.array(rows).T
        self.module.restore(self._saved[-1])
        nothing = np.full_like(times, math.nan)
        trajectory = Trajectory(
            time=times,
            drive_angle=np.array(angle) if self.phased else nothing,
            omega2=omega2 if self.phased else nothing,
            omega_out=omega_out,
            switches=self._switches(times, counts, hints) if locate and self.located else None,
            evaluations=int(self._final("rhs_evaluations")),
            energy_residual=self._final("energy_residual"),
            wall_time=self._cost() if timed else math.nan,
            impulse=np.array(impulse),
            energy_in=self._final("energy_in"),
            number_of_switches=int(counts[-1]) if self.phased else None,
            acceleration=None if self.fidelity == RIGID else acceleration if self.phased else nothing,
        )
        return trajectory, modes

    def _final(self, name: str) -> float:
        self.module.restore(self._saved[-1])
        return self.module[name]
