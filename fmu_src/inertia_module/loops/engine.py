"""An engine or motor in front of a module: limits of its torque, its governor, and what the module carries.

Driven by torque the module carries the rotor, and what is left of the engine is its map and its sampled
governor, which sees the speed of link 1 at communication points. docs/coupling.md compares other ways.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..common.errors import must_be
from ..kernel.codes import DRIVE_TORQUE
from ..kernel.links import inertia_at_input
from ..memory import Module
from .sources import Table, between

__all__ = ["EngineMap", "Governor", "InterfaceInertia", "interface_inertia", "torque_driven"]


def check_drag(name: str, torques: Sequence[float]) -> None:
    """Reject torques with the sign of another convention.

    Args:
        name: name of the torques in the message.
        torques: size of the torque against the motion, N.m.

    Raises:
        ValueError: a torque is negative.
    """
    if min(torques) < 0.0:
        raise ValueError(
            f"{must_be(name, 'at least 0 N.m', min(torques))}. Drag is the magnitude of the torque against"
            " the motion. Reverse the sign of a negative motoring torque (the convention of VECTO)."
        )


def check_rising(speed: Sequence[float]) -> None:
    """Raise a ValueError if speeds, rad/s, do not increase: a torque over the speed has no steps."""
    for before, after in pairwise(speed):
        if not before < after:
            raise ValueError(must_be("speed", "strictly increasing", f"{after:g} after {before:g}"))


@dataclass(frozen=True)
class EngineMap:
    """Limits of the torque over the speed, linear between breakpoints, constant beyond them.

    Attributes:
        speed: breakpoints, rad/s, rising. greatest: torque at full load, N.m, at each of them, from 0.
        drag: torque against the motion without fuel, N.m, from 0.

    Raises:
        ValueError: breakpoints that do not rise, or torques negative or not one for each.
    """

    speed: tuple[float, ...]
    greatest: tuple[float, ...]
    drag: tuple[float, ...]

    def __post_init__(self) -> None:
        check_rising(self.speed)
        for name, torques in (("greatest", self.greatest), ("drag", self.drag)):
            try:
                Table(self.speed, torques)
            except ValueError as error:
                raise ValueError(f"speed and {name}: {error}") from None
        if min(self.greatest) < 0.0:
            raise ValueError(must_be("greatest", "at least 0 N.m", min(self.greatest)))
        check_drag("drag", self.drag)

    def limits(self, speed: float) -> tuple[float, float]:
        """Least and greatest torque at a speed, N.m. The drag acts on a turning engine only."""
        drag = between(self.speed, self.drag, speed) if speed > 0.0 else 0.0
        return -drag, between(self.speed, self.greatest, speed)


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


def torque_driven(parameters: Mapping[str, float], inertia: float) -> dict[str, float]:
    """Parameters of a module that is driven by torque and carries the rotor of its engine.

    Args:
        parameters: of the module, those that differ from the defaults. inertia: of the engine, kg.m2.
    """
    own = parameters.get("input_inertia", 0.0)
    return {**parameters, "drive": float(DRIVE_TORQUE), "input_inertia": own + inertia}


class InterfaceInertia(NamedTuple):
    """Interface inertia over the angle of the drive, kg.m2."""

    least: float
    mean: float
    greatest: float

    @property
    def middle(self) -> float:
        """Mean of the least and the greatest, kg.m2."""
        return 0.5 * (self.least + self.greatest)


def interface_inertia(parameters: Mapping[str, float]) -> InterfaceInertia:
    """The interface inertia of a module: what its input shaft feels when its speed changes suddenly.

    With link 2 held, omega1 turns everything: Phi = J1 + I + 2 k B + k^2 G. Where link 2 is free to follow,
    or drives the shaft, less of it answers a jump: Phi - k^2 (B + k G)^2 / (J + k^2 G), with J = J2 or
    J2 + J3. So Phi is the most an engine can meet.

    Args:
        parameters: those that differ from the defaults.

    Raises:
        Refused: the module refuses the parameters.
    """
    module = Module("plain")
    module.check(**{**parameters, "fidelity": 2.0})
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, 2.0 * math.pi * turns, 180 * turns, endpoint=False)
    values = [float(inertia_at_input(module.derived, float(q))) for q in angles]  # type: ignore[no-untyped-call]
    return InterfaceInertia(min(values), sum(values) / len(values), max(values))
