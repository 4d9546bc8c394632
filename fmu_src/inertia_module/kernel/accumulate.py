"""Arrays, and angles that are wrapped into one period.

The length of the period is exact to two doubles, so many revolutions lose no digits.
"""

import math

from .records import Constants, Doubles, State

TWO_PI = 6.283185307179586
TWO_PI_LOW = 2.4492935982947064e-16


def add_loss(x: State, cause: int, lost: float) -> None:
    """Add the energy, J, that a cause of losses has dissipated (equations.losses.CAUSES)."""
    x.lost[cause] += lost
    x.step_lost += lost


def total(numbers: Doubles) -> float:
    """Return the sum of an array."""
    result = 0.0
    for n in range(len(numbers)):
        result += numbers[n]
    return result


def clear(numbers: Doubles) -> None:
    """Fill an array with zeros."""
    for n in range(len(numbers)):
        numbers[n] = 0.0


def copy(target: Doubles, source: Doubles) -> None:
    """Copy the first numbers of an array that is at least as long as the target."""
    for n in range(len(target)):
        target[n] = source[n]


def wrap(angle: float, period: float, period_low: float) -> tuple[float, float]:
    """Wrap an angle into [0, period].

    Args:
        angle: rad.
        period: Leading part of the period, rad.
        period_low: Remainder of the period, which one double cannot hold, rad.

    Returns:
        (angle, number of periods removed); rad and 1.
    """
    rest = angle % period if angle >= 0.0 else -(-angle % period)  # of the sign of angle: exact
    periods = float(math.floor((angle - rest) / period + 0.5))
    rest -= periods * period_low
    if rest < 0.0:
        rest += period
        periods -= 1.0
    elif rest >= period:
        rest -= period
        periods += 1.0
    return rest, periods


def wrap_drive_angle(d: Constants, x: State) -> None:
    """Wrap q into a period and count the revolutions removed."""
    if not 0.0 <= x.q < d.period:
        x.q, periods = wrap(x.q, d.period, d.period_low)
        x.drive_turns += d.period_turns * periods


def wrap_input_angle(x: State) -> None:
    """Wrap theta1 into a revolution and count the revolutions removed."""
    if not 0.0 <= x.theta1 < TWO_PI:
        x.theta1, periods = wrap(x.theta1, TWO_PI, TWO_PI_LOW)
        x.input_turns += periods


def turn_output(x: State) -> None:
    """Add the angle of the step to the angle of the output shaft, wrap it and count revolutions."""
    x.output_angle += x.turned3
    if not 0.0 <= x.output_angle < TWO_PI:
        x.output_angle, turns = wrap(x.output_angle, TWO_PI, TWO_PI_LOW)
        x.output_turns += turns
