"""An engine or motor: rotor with inertia, limits of torque over speed, and a sampled speed governor.

    J_E omega' = tau - T        -drag(omega) <= tau <= greatest(omega)

The governor is a control unit: it samples the speed, sets tau and holds it until the next sample. So between
samples omega is linear under a constant load T, and a step of any length is exact, works and impulses
included.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

__all__ = ["Engine", "EngineMap", "EngineState", "Governor"]

# of a sample time: the end of a step this close to a sample is at the sample
_ROUNDING = 1e-9


def _positive(name: str, value: float, unit: str) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be a positive number of {unit}, is {value}")


@dataclass(frozen=True)
class EngineMap:
    """Limits of the torque over the speed, linear between breakpoints, constant beyond them.

    Attributes:
        speed: breakpoints, rad/s, rising.
        greatest: torque at full load, N.m, at each of them, from 0.
        drag: torque against the motion without fuel, N.m, from 0.

    Raises:
        ValueError: breakpoints that do not rise, or torques that are negative or of another number.
    """

    speed: tuple[float, ...]
    greatest: tuple[float, ...]
    drag: tuple[float, ...]

    def __post_init__(self) -> None:
        rising = all(a < b for a, b in zip(self.speed, self.speed[1:], strict=False))
        if not self.speed or not rising or not all(math.isfinite(value) for value in self.speed):
            raise ValueError(f"speed must be finite breakpoints that rise, is {self.speed}")
        for name, torques in (("greatest", self.greatest), ("drag", self.drag)):
            if len(torques) != len(self.speed):
                raise ValueError(
                    f"{name} must be {len(self.speed)} torques, one for each speed, is {len(torques)}"
                )
            for torque in torques:
                if not (math.isfinite(torque) and torque >= 0.0):
                    raise ValueError(f"{name} must be finite torques from 0 N.m, has {torque}")

    def limits(self, speed: float) -> tuple[float, float]:
        """Least and greatest torque at a speed, N.m. The drag acts on a turning engine only."""
        greatest = float(np.interp(speed, self.speed, self.greatest))
        return (-float(np.interp(speed, self.speed, self.drag)) if speed > 0.0 else 0.0), greatest


@dataclass(frozen=True)
class Governor:
    """PI speed governor, sampled, with anti-windup by back-calculation against the limits of the moment.

    Where the torque is cut off, the integral is led back with the time constant of the governor,
    proportional_gain / integral_gain, but not faster than the sample time.
    Source: Åström and Murray, Feedback Systems (2nd edition 2021), section 11.4.

    Attributes:
        proportional_gain: N.m per rad/s. integral_gain: N.m per rad. sample_time: s.

    Raises:
        ValueError: a gain is negative or not finite, or the sample time is not positive.
    """

    proportional_gain: float
    integral_gain: float
    sample_time: float = 0.005

    def __post_init__(self) -> None:
        _positive("sample_time", self.sample_time, "seconds")
        for name in ("proportional_gain", "integral_gain"):
            gain = getattr(self, name)
            if not (math.isfinite(gain) and gain >= 0.0):
                raise ValueError(f"{name} must be a finite number from 0, is {gain}")

    def sample(
        self,
        integral: float,
        reference: float,
        speed: float,
        limits: tuple[float, float],
        feedforward: float = 0.0,
    ) -> tuple[float, float]:
        """One sample.

        Args:
            integral: N.m. reference, speed: rad/s. limits: least and greatest torque, N.m.
            feedforward: torque besides that of the error, N.m.

        Returns:
            (torque, integral for the next sample), N.m.
        """
        error = reference - speed
        wanted = feedforward + self.proportional_gain * error + integral
        torque = min(max(wanted, limits[0]), limits[1])
        grown = integral + self.sample_time * self.integral_gain * error
        if self.integral_gain > 0.0:
            tracking = max(self.sample_time, self.proportional_gain / self.integral_gain)
            grown -= self.sample_time / tracking * (wanted - torque)
        return torque, grown


class EngineState(NamedTuple):
    """State of an engine, which may be set to an old one.

    Attributes:
        speed: rad/s. angle: rad. integral: of the governor, N.m. torque: held until the next sample, N.m.
        wait: time to the next sample, s. work_in: of the torque of the engine since the start, J.
        work_out: done on the load, J. impulse_out: of the load, N.m.s.
    """

    speed: float
    angle: float = 0.0
    integral: float = 0.0
    torque: float = 0.0
    wait: float = 0.0
    work_in: float = 0.0
    work_out: float = 0.0
    impulse_out: float = 0.0


class LoadTorque(NamedTuple):
    """Load of the coming step: T = value + inertia omega'.

    Attributes:
        value: N.m. inertia: that turns with the engine, kg.m2.
    """

    value: float
    inertia: float = 0.0


class Engine:
    """An engine with governor.

    Args:
        inertia: of rotor and all that turns with it, kg.m2. limits: of the torque. governor: of the speed.
        reference: speed the governor is asked for, rad/s; may be set at any time.
        speed: at the start, rad/s. torque: held by the governor's integral at the start, N.m.

    Attributes:
        state: all that changes in a step. inertia, limits, governor, reference: as given.
    """

    def __init__(
        self,
        inertia: float,
        limits: EngineMap,
        governor: Governor,
        reference: float,
        speed: float,
        torque: float = 0.0,
    ) -> None:
        _positive("inertia", inertia, "kg.m2")
        for name, value in (("reference", reference), ("speed", speed), ("torque", torque)):
            if not math.isfinite(value):
                raise ValueError(f"{name} must be a finite number, is {value}")
        self.inertia, self.limits, self.governor = inertia, limits, governor
        self.reference = reference
        self.state = EngineState(speed, integral=torque)

    @property
    def speed(self) -> float:
        """Speed now, rad/s."""
        return self.state.speed

    @property
    def energy_stored(self) -> float:
        """Kinetic energy, J."""
        return 0.5 * self.inertia * self.state.speed**2

    def advance(self, step: float, load: LoadTorque) -> None:
        """Advance by a step, s, of any length."""
        self.state = self.after(step, load)

    def after(self, step: float, load: LoadTorque | None) -> EngineState:
        """The state after a step, s, of any length; the engine stays where it is.

        Args:
            step: s.
            load: on the engine. None: its speed stays as it is and all torque goes on to the load, as with an
                engine whose rotor is simulated elsewhere: it knows its speed at the beginning of a step only.

        Raises:
            ValueError: the step is not positive.
        """
        _positive("step", step, "seconds")
        state, left = self.state, step
        sample_time = self.governor.sample_time
        while True:
            if state.wait <= _ROUNDING * sample_time:
                limits = self.limits.limits(state.speed)
                torque, integral = self.governor.sample(state.integral, self.reference, state.speed, limits)
                state = state._replace(torque=torque, integral=integral, wait=state.wait + sample_time)
            # to the next sample the acceleration is constant
            h = min(state.wait, left)
            left -= h
            mean, end, on_load = state.speed, state.speed, state.torque
            if load is not None:
                acceleration = (state.torque - load.value) / (self.inertia + load.inertia)
                mean, end = state.speed + 0.5 * h * acceleration, state.speed + h * acceleration
                on_load = state.torque - self.inertia * acceleration
            turned = h * mean
            state = state._replace(
                speed=end,
                angle=state.angle + turned,
                wait=state.wait - h,
                work_in=state.work_in + state.torque * turned,
                work_out=state.work_out + on_load * turned,
                impulse_out=state.impulse_out + h * on_load,
            )
            if left <= _ROUNDING * min(sample_time, step):
                return state
