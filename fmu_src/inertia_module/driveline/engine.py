"""Engine or motor upstream of a module: limits of its torque, its governor, and the interface inertia.

In a torque-driven module the inertia of the rotor belongs to link 1. The model of the engine is then its
torque map and its governor, which samples the speed of link 1 at communication points. coupling.md
compares other couplings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..common.errors import must_be
from ..kernel.codes import DRIVE_TORQUE
from ..kernel.links import inertia_at_input
from ..model import Module
from .sources import Table, interpolate

if TYPE_CHECKING:
    from .discrete_system import DiscreteSystem, Numbers

__all__ = [
    "EngineMap",
    "Governor",
    "InterfaceInertia",
    "governed_engine",
    "interface_inertia",
    "torque_driven",
]


def check_drag(name: str, torques: Sequence[float]) -> None:
    """Reject drag torques with the opposite sign convention.

    Args:
        name: Name of the torques in the message.
        torques: Magnitudes of the torque against the motion, N.m.

    Raises:
        ValueError: A torque is negative.
    """
    if min(torques) < 0.0:
        raise ValueError(
            f"{must_be(name, 'at least 0 N.m', min(torques))}. Drag is the magnitude of the torque against"
            " the motion. Reverse the sign of a negative motoring torque (the convention of VECTO)."
        )


def check_rising(speed: Sequence[float]) -> None:
    """Reject breakpoints that do not strictly increase, because a torque over speed has no steps.

    Args:
        speed: Breakpoints, rad/s.

    Raises:
        ValueError: The breakpoints do not increase.
    """
    for before, after in pairwise(speed):
        if not before < after:
            raise ValueError(must_be("speed", "strictly increasing", f"{after:g} after {before:g}"))


@dataclass(frozen=True)
class EngineMap:
    """Limits of the engine torque over the speed, linear between breakpoints, constant beyond them.

    Attributes:
        speed: Breakpoints, rad/s, strictly increasing, length n.
        full_load: Torque at full load, N.m, non-negative, length n.
        drag: Torque against the motion without fuel, N.m, non-negative, length n.

    Raises:
        ValueError: The breakpoints do not increase, a torque is negative, or lengths differ.
    """

    speed: tuple[float, ...]
    full_load: tuple[float, ...]
    drag: tuple[float, ...]

    def __post_init__(self) -> None:
        check_rising(self.speed)
        for name, torques in (("full_load", self.full_load), ("drag", self.drag)):
            try:
                Table(self.speed, torques)
            except ValueError as error:
                raise ValueError(f"speed and {name}: {error}") from None
        if min(self.full_load) < 0.0:
            raise ValueError(must_be("full_load", "at least 0 N.m", min(self.full_load)))
        check_drag("drag", self.drag)

    def limits(self, speed: float) -> tuple[float, float]:
        """Return minimum and maximum torque at a speed, N.m; drag acts only on a rotating engine.

        Args:
            speed: Speed of the engine, rad/s.
        """
        drag = interpolate(self.speed, self.drag, speed) if speed > 0.0 else 0.0
        return -drag, interpolate(self.speed, self.full_load, speed)


@dataclass(frozen=True)
class Governor:
    """Sampled PI speed governor with anti-windup by back-calculation.

    If the torque saturates, the integral tracks the limit with the time constant of the governor,
    proportional_gain / integral_gain, or with the sample time if this is longer.
    Source: Åström and Murray, Feedback Systems (2nd edition 2021), section 11.4.

    Attributes:
        proportional_gain: Proportional gain, N.m.s/rad.
        integral_gain: Integral gain, N.m/rad.
        sample_time: Sample time, s.

    Raises:
        ValueError: A gain is negative or not finite, or the sample time is not positive.
    """

    proportional_gain: float
    integral_gain: float
    sample_time: float = 0.005

    def __post_init__(self) -> None:
        if not (math.isfinite(self.sample_time) and self.sample_time > 0.0):
            raise ValueError(must_be("sample_time", "a positive number of seconds", self.sample_time))
        for name in ("proportional_gain", "integral_gain"):
            gain = getattr(self, name)
            if not (math.isfinite(gain) and gain >= 0.0):
                raise ValueError(must_be(name, "finite and at least 0", gain))

    def sample(
        self,
        integral: float,
        reference: float,
        speed: float,
        limits: tuple[float, float],
        feedforward: float = 0.0,
    ) -> tuple[float, float]:
        """Compute one sample of the governor.

        Args:
            integral: Integral of the previous sample, N.m.
            reference: Reference speed, rad/s.
            speed: Measured speed, rad/s.
            limits: Minimum and maximum torque, N.m.
            feedforward: Torque added to the PI terms, N.m.

        Returns:
            Torque, and integral for the next sample, N.m.
        """
        error = reference - speed
        unlimited = feedforward + self.proportional_gain * error + integral
        torque = min(max(unlimited, limits[0]), limits[1])
        next_integral = integral + self.sample_time * self.integral_gain * error
        if self.integral_gain > 0.0:
            tracking_time = max(self.sample_time, self.proportional_gain / self.integral_gain)
            next_integral -= self.sample_time / tracking_time * (unlimited - torque)
        return torque, next_integral


def governed_engine(
    step: float,
    torque_map: EngineMap,
    *,
    idle: float,
    top_speed: float,
    proportional_gain: float,
    integral_gain: float = 0.0,
) -> DiscreteSystem:
    """Make an engine with governors of its idle speed and its top speed.

    The throttle interpolates between drag (0) and full load (1). One governor raises the torque below the
    idle speed, another one cuts it above the top speed. The torque is constant in each step.

    Args:
        step: Communication step, s.
        torque_map: Limits of the torque over the speed.
        idle: Idle speed, rad/s.
        top_speed: Top speed, rad/s.
        proportional_gain: Proportional gain of both governors, N.m.s/rad.
        integral_gain: Integral gain of both governors, N.m/rad.

    Returns:
        A system with the inputs throttle, 0 to 1, and input_speed, rad/s, and the output drive_torque, N.m.
        Its states are the integrals of both governors, N.m.

    Raises:
        ValueError: A gain is negative or not finite.
    """
    from .discrete_system import DiscreteSystem

    governor = Governor(proportional_gain, integral_gain, step)

    def law(_: float, x: Numbers, u: Numbers) -> tuple[list[float], list[float]]:
        throttle, speed = u
        closed, full = torque_map.limits(speed)
        throttle_torque = closed + throttle * (full - closed)
        raised_torque, idle_integral = governor.sample(x[0], idle, speed, (throttle_torque, full))
        torque, top_integral = governor.sample(x[1], top_speed, speed, (closed, raised_torque))
        return [torque], [idle_integral, top_integral]

    signals, integrals = ["throttle", "input_speed"], ["idle_integral", "top_integral"]
    return DiscreteSystem("engine", step, signals, ["drive_torque"], law, integrals)


def torque_driven(parameters: Mapping[str, float], inertia: float) -> dict[str, float]:
    """Return the parameters of a torque-driven module with the rotor of its engine on link 1.

    Args:
        parameters: Parameters of the module that differ from the defaults, SI, by name.
        inertia: Inertia of the rotor, kg.m2.
    """
    input_inertia = parameters.get("input_inertia", 0.0) + inertia
    return {**parameters, "drive": float(DRIVE_TORQUE), "input_inertia": input_inertia}


class InterfaceInertia(NamedTuple):
    """Interface inertia over the pinion-shaft angle.

    Attributes:
        minimum: Minimum, kg.m2.
        mean: Mean, kg.m2.
        maximum: Maximum, kg.m2.
    """

    minimum: float
    mean: float
    maximum: float

    @property
    def middle(self) -> float:
        """Return the mean of minimum and maximum, kg.m2."""
        return 0.5 * (self.minimum + self.maximum)


def interface_inertia(parameters: Mapping[str, float]) -> InterfaceInertia:
    """Compute the interface inertia of a module: the inertia that a jump of the input speed accelerates.

    With link 2 locked, the interface inertia is Phi = J1 + I + 2 k B + k^2 G. If link 2 is free or drives the
    output shaft, it is smaller: Phi - k^2 (B + k G)^2 / (J + k^2 G), where J is J2 or J2 + J3. Phi is
    therefore the maximum for an engine.

    Args:
        parameters: Parameters of the module that differ from the defaults, SI, by name.

    Returns:
        Minimum, mean and maximum of Phi over a period of the pinion-shaft angle.

    Raises:
        ParameterError: The module rejects the parameters.
    """
    module = Module("plain")
    module.check(**{**parameters, "fidelity": 2.0})
    revolutions = int(module.derived.period_turns)
    angles = np.linspace(0.0, 2.0 * math.pi * revolutions, 180 * revolutions, endpoint=False)
    values = [inertia_at_input(module.derived, float(q)) for q in angles]
    return InterfaceInertia(min(values), sum(values) / len(values), max(values))
