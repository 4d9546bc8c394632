"""Two FMUs instead of one: the module and the driven shaft, coupled through the hub.

The module drives the hub (its output shaft, J3) against the torque of the shaft; the shaft is turned at the
hub's speed. Unlike the input side nothing impulsive passes: a spring's torque follows the speed by an
integral, so what limits the step is the swing of the hub on the spring, z = h^2 c/J3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..instance import Fmu

JACOBI, MODULE_FIRST, SHAFT_FIRST = "jacobi", "module first", "shaft first"
_ORDERS = (JACOBI, MODULE_FIRST, SHAFT_FIRST)
_PROBE = 1.0  # rad/s


@dataclass(frozen=True)
class ShaftScheme:
    """A scheme that couples module and shaft.

    Attributes:
        order: jacobi, module first or shaft first.
        mean: whether the module gets the step mean of the shaft's torque, else its value at an instant.
        derivatives: whether speed and torque go on with their derivatives (of outputs, extrapolated; between
            two known speeds, the ramp between them).
        implicit: the module's step is tried, taken back and made again with the mean torque that its
            directional derivative and the shaft's linear answer lead to.

    Raises:
        ValueError: an unknown order, or one that makes no sense.
    """

    order: str = MODULE_FIRST
    mean: bool = False
    derivatives: bool = False
    implicit: bool = False

    def __post_init__(self) -> None:
        if self.order not in _ORDERS:
            raise ValueError(f"order = {self.order!r} is refused: allowed is {', '.join(_ORDERS)}")
        if self.implicit and (self.order != MODULE_FIRST or not (self.mean and self.derivatives)):
            raise ValueError(
                "an implicit shaft coupling is refused: allowed is module first, with means and derivatives"
            )
        if self.order == SHAFT_FIRST and not self.mean:
            raise ValueError(
                "mean = False is refused with shaft first: allowed is the mean of the step just made"
            )


SHAFT_SCHEMES: Mapping[str, ShaftScheme] = MappingProxyType(
    {
        "mean, jacobi": ShaftScheme(JACOBI, mean=True),
        "mean, module first": ShaftScheme(mean=True),
        "mean, shaft first": ShaftScheme(SHAFT_FIRST, mean=True),
        "mean, shaft first, derivatives": ShaftScheme(SHAFT_FIRST, mean=True, derivatives=True),
        "instant, jacobi": ShaftScheme(JACOBI),
        "instant, jacobi, derivatives": ShaftScheme(JACOBI, derivatives=True),
        "instant, module first": ShaftScheme(),
        "instant, module first, derivatives": ShaftScheme(derivatives=True),
        "implicit": ShaftScheme(mean=True, derivatives=True, implicit=True),
    }
)


class CoupledShaft:
    """A module and a driven shaft behind it.

    Args:
        module: a started FMU of the module, rigid. shaft: a started FMU of the driven shaft, whose hub turns
            at omega_out of the module and whose input_hold is constant. scheme: of coupling.

    Attributes:
        steps: steps of the module, those taken back included. derivatives: directional derivatives.

    Raises:
        ValueError: the speeds differ.
    """

    def __init__(self, module: Fmu, shaft: Fmu, scheme: ShaftScheme) -> None:
        speed, hub = module["omega_out"], shaft["hub_speed"]
        if abs(speed - hub) > 1e-9 * max(1.0, abs(speed)):
            raise ValueError(
                f"hub_speed = {hub:g} rad/s is refused: allowed is the module's omega_out = {speed:g}"
            )
        self.module, self.shaft, self.scheme = module, shaft, scheme
        self.steps = self.derivatives = 0
        self._torque = shaft["shaft_torque"]
        self._left = 0.0  # impulse the module has yet to be given, N.m.s
        self._answers: dict[float, float] = {}

    def step(self, h: float) -> None:
        """Advance both by a communication step, s.

        Raises:
            DriveError: one of the FMUs refused the step.
        """
        scheme, speed = self.scheme, self.module["omega_out"]
        if scheme.implicit:
            self._implicit(h, speed)
        elif scheme.order == SHAFT_FIRST:
            self._extrapolate_shaft(h, speed)
            self._move_module(h, self._torque, 0.0)
        elif scheme.order == JACOBI:
            torque, rate = self._torque, self._torque_rate()
            self._extrapolate_shaft(h, speed)
            self._move_module(h, torque, rate)
        else:
            self._move_module(h, self._torque, self._torque_rate())
            after = self.module["omega_out"]
            if scheme.derivatives:
                self._move_shaft(h, speed, (after - speed) / h)
            else:
                self._move_shaft(h, after, 0.0)

    def _torque_rate(self) -> float:
        if self.scheme.mean or not self.scheme.derivatives:
            return 0.0
        return self.shaft.rates(("shaft_torque",))[0]

    def _extrapolate_shaft(self, h: float, speed: float) -> None:
        rate = self.module.rates(("omega_out",))[0] if self.scheme.derivatives else 0.0
        self._move_shaft(h, speed, rate)

    def _move_module(self, h: float, torque: float, rate: float) -> None:
        self.module.set(load_torque=torque)
        if rate != 0.0:
            self.module.set_rates(load_torque=rate)
        self.module.advance(h)
        self.steps += 1

    def _move_shaft(self, h: float, speed: float, rate: float) -> None:
        self.shaft.set(hub_speed=speed)
        if self.scheme.derivatives:
            self.shaft.set_rates(hub_speed=rate)
        self.shaft.advance(h)
        self._torque = self.shaft["shaft_torque_mean" if self.scheme.mean else "shaft_torque"]

    def _answer(self, h: float, speed: float, end: float) -> float:
        """Mean torque of the shaft over a step in which the hub goes linearly to a speed; taken back."""
        kept = self.shaft.keep()
        try:
            self._move_shaft(h, speed, (end - speed) / h)
            return self._torque
        finally:
            self.shaft.go_back(kept)
            self.shaft.forget(kept)

    def _slope(self, h: float, speed: float) -> float:
        """Change of the shaft's mean torque with the speed at the end of the step: the shaft is linear."""
        if h not in self._answers:
            still, moved = self._answer(h, speed, speed), self._answer(h, speed, speed + _PROBE)
            self._answers[h] = (moved - still) / _PROBE
        return self._answers[h]

    def _implicit(self, h: float, speed: float) -> None:
        slope, last = self._slope(h, speed), self._torque
        kept = self.module.keep()
        try:
            self._move_module(h, last, 0.0)
            tried = self.module["omega_out"]
            answer = self._answer(h, speed, tried)
            (change,) = self.module.jacobian(("omega_out",), ("load_torque",))[0]
            self.derivatives += 1
            # a speed that falls with the load can only make the answer softer
            gain = slope * min(change, 0.0)
            torque = (answer - gain * last) / (1.0 - gain) + self._left / h
            self.module.go_back(kept)
            self._move_module(h, torque, 0.0)
        finally:
            self.module.forget(kept)
        self._move_shaft(h, speed, (self.module["omega_out"] - speed) / h)
        self._left += h * (self._torque - torque)


def growth(scheme: ShaftScheme, z: float, damping: float = 0.0) -> float:
    """Growth in a step of the swing of a free hub against a heavy driven mass, from theory.

    The hub's step is exact for the torque given and the shaft's for the speed given, so a step is a linear
    map of (omega, twist c h/J3, last torque h/J3), found here column by column.

    Args:
        scheme: of coupling. z: h^2 c/J3. damping: h d/J3.
    """

    def ramp_torque(twist: float, start: float, end: float) -> tuple[float, float, float]:
        """(twist at the end, mean torque, torque at the end) behind a hub that goes from start to end."""
        after = twist + 0.5 * z * (start + end)
        mean = twist + z * (start / 3.0 + end / 6.0) + damping * 0.5 * (start + end)
        return after, mean, after + damping * end

    def step(state: NDArray[np.float64]) -> NDArray[np.float64]:
        speed, twist, torque, rate = state
        if scheme.implicit:
            _, free, _ = ramp_torque(twist, speed, 0.0)
            per_speed = z / 6.0 + 0.5 * damping
            end = (speed - free) / (1.0 + per_speed)
            after, mean, _ = ramp_torque(twist, speed, end)
            return np.array([end, after, mean, 0.0])
        guess = speed + (rate if scheme.derivatives else 0.0)
        if scheme.order == SHAFT_FIRST:
            after, mean, _ = ramp_torque(twist, speed, guess)
            return np.array([speed - mean, after, mean, -mean])
        slope = 0.5 * z * speed if scheme.derivatives and not scheme.mean else 0.0
        end = speed - torque - slope
        if scheme.order == JACOBI:
            after, mean, last = ramp_torque(twist, speed, guess)
        elif scheme.derivatives:
            after, mean, last = ramp_torque(twist, speed, end)
        else:
            after, mean, last = ramp_torque(twist, end, end)
        return np.array([end, after, mean if scheme.mean else last, end - speed])

    matrix = np.column_stack([step(column) for column in np.eye(4)])
    return float(np.abs(np.linalg.eigvals(matrix)).max())
