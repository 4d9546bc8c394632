"""Runs of the module itself over a case, in communication steps of any length, looked at in between."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from inertia_module.fidelity.timing import kernel_time
from inertia_module.harness.simulate import whole_steps
from inertia_module.kernel.codes import AVERAGED, ELASTIC, EVENT, RIGID
from inertia_module.memory.instances import Module
from inertia_module.scene.mechanism import at_fidelity

from .trajectory import Array, Case, Trajectory

_SAMPLED = ("omega2", "omega_out", "imbalance_acceleration", "contact_mode", "contact_switches")
# the least distance that a switch may have from where it is expected, s
_NEAREST = 1e-13
# what a switch may be off, of its distance from a sampling time or from where it is expected
_ROUNDING, _SHARE = 1e-12, 1e-3


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

    def _switch(self, number: int, hint: float, share: float) -> float:
        """Time of a switch, s, by bisection of the logarithm of its distance from a time.

        Args:
            number: which, from 1. hint: the time, s. share: of the distance that it may be off.
        """

        def switched(time: float) -> bool:
            if not 0.0 < time < self.case.stop_time:
                return time > 0.0
            self.reach(time)
            return self.module["contact_switches"] >= number

        after, low, high = switched(hint), _NEAREST, self.case.stop_time
        side = -1.0 if after else 1.0
        while high > (1.0 + share) * low:
            middle = math.sqrt(low * high)
            if switched(hint + side * middle) == after:
                low = middle
            else:
                high = middle
        return hint + side * high

    def _switches(self, times: Array, counts: Array, hints: Array | None) -> Array:
        """Times at which the counter of switches goes up, s: to rounding, or near hints (see trajectory)."""
        if hints is None or hints.size != counts[-1]:
            numbers = np.arange(1, counts[-1] + 1)
            hints, share = times[np.searchsorted(counts, numbers)], _ROUNDING
        else:
            share = _SHARE
        return np.array([self._switch(n, float(hint), share) for n, hint in enumerate(hints, 1)])

    def trajectory(self, timed: bool = True, hints: Array | None = None) -> tuple[Trajectory, Array]:
        """What the run gives at the case's sampling times, and the contact modes there.

        Args:
            timed: whether to repeat it for its time.
            hints: where switches are expected, s: they are then found to a thousandth of the distance.
        """
        times = self.case.times
        rows, impulse, angle = [], [], []
        for time in times:
            impulse.append(self.reach(float(time)))
            rows.append([self.module[name] for name in _SAMPLED])
            angle.append(self.module["drive_angle"] + 2.0 * math.pi * self.module["drive_turns"])
        omega2, omega_out, acceleration, modes, counts = np.array(rows).T
        switches = self._switches(times, counts, hints) if self.located else None
        given = [(self.case.omega1, self.case.load_torque, 0.0)] * self.steps
        cost = kernel_time(self.module, self._saved[0], given, self.step) if timed else math.nan
        self.module.restore(self._saved[-1])
        nothing = np.full_like(times, math.nan)
        trajectory = Trajectory(
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
        )
        return trajectory, modes
