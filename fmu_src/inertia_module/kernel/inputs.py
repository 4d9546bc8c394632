"""The inputs of a step: checked, extrapolated, taken over into the state."""

from .accumulate import begin_sums
from .codes import (
    BAD_DRIVE_TORQUE,
    BAD_DRIVE_TORQUE_RATE,
    BAD_LOAD_TORQUE,
    BAD_LOAD_TORQUE_RATE,
    BAD_OMEGA1,
    BAD_OMEGA1_RATE,
    DRIVE_SPEED,
    OK,
)
from .limits import LARGEST_SPEED, LARGEST_TORQUE, SMALLEST_SPEED


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u.omega1) <= LARGEST_SPEED:
        return BAD_OMEGA1
    if not abs(u.load_torque) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    if not abs(u.drive_torque) <= LARGEST_TORQUE:
        return BAD_DRIVE_TORQUE
    return OK


def check_rates(u, h):
    """Status of the rates of the inputs that are prescribed: no input becomes absurd within the step h."""
    if u.omega1_rate_given != 0.0:
        if not abs(u.omega1 + u.omega1_rate * h) <= LARGEST_SPEED:
            return BAD_OMEGA1_RATE
    if u.load_torque_rate_given != 0.0:
        if not abs(u.load_torque + u.load_torque_rate * h) <= LARGEST_TORQUE:
            return BAD_LOAD_TORQUE_RATE
    if u.drive_torque_rate_given != 0.0:
        if not abs(u.drive_torque + u.drive_torque_rate * h) <= LARGEST_TORQUE:
            return BAD_DRIVE_TORQUE_RATE
    return OK


def input_speed(u):
    """omega1, rad/s, or zero where it is too slow to be squared."""
    omega1 = u.omega1
    return omega1 if abs(omega1) >= SMALLEST_SPEED else 0.0


def take_speed(p, x, speed, rate_given, rate, h):
    """Slope of a given speed over the coming step: its rate if given, or that of the last step if so held."""
    slope = 0.0
    if rate_given != 0.0:
        slope = rate
    elif p.input_hold != 0.0 and x.held_step > 0.0:
        slope = (speed - x.held_input) / x.held_step
    x.held_input = speed
    x.held_step = h
    return slope


def mean_torque(torque, rate_given, rate, h):
    """Mean of a given torque over the coming step: with its rate given, that at the middle."""
    return torque + 0.5 * h * rate if rate_given != 0.0 else torque


def begin(p, u, x, h):
    """Take the inputs of the coming step and clear its sums. Returns the jump of omega1."""
    jump = 0.0
    if p.drive == DRIVE_SPEED:
        omega1 = input_speed(u)
        jump = omega1 - x.omega1
        x.alpha1 = take_speed(p, x, omega1, u.omega1_rate_given, u.omega1_rate, h)
    x.load_torque = mean_torque(u.load_torque, u.load_torque_rate_given, u.load_torque_rate, h)
    x.drive_torque = mean_torque(u.drive_torque, u.drive_torque_rate_given, u.drive_torque_rate, h)
    x.length = h
    x.step_lost = 0.0
    x.largest_square = 0.0
    x.seen = 0.0
    begin_sums(x)
    return jump
