"""Inputs of a communication step: checks, hold and rates. The sums over the step begin at 0.

The record u has all inputs, then the rate of each, then a flag for each rate (1 if it is set).
The first input is a speed, the others are torques (interface.models checks this order).
"""

from .codes import BAD_HOLD, BAD_INPUT, BAD_RATE, BAD_STEP, DRIVE_SPEED, OK
from .fields import OF_MOTION, OF_SUMS, STATE, SUMS
from .links import prescribed_at_input
from .records import Constants, Inputs, ShaftInputs, ShaftState, State

MAX_SPEED = 1e5  # rad/s
MAX_TORQUE = 1e7  # N m
MAX_STEP = 1e6  # s
MIN_STEP = 1e-30  # s, below any round-off of the importer's time; the square of its inverse does not overflow
MAX_INPUTS = (MAX_SPEED, MAX_TORQUE, MAX_TORQUE)  # Maximum magnitude of each input

# reset_sums clears the sums by their positions
assert STATE[OF_MOTION : OF_MOTION + OF_SUMS] == SUMS


def check_inputs(u: Inputs | ShaftInputs) -> int:
    """Return OK if all inputs are finite and within their range, otherwise BAD_INPUT + number of the input.

    Args:
        u: Inputs.
    """
    for n in range(len(u.numbers) // 3):
        if not abs(u.numbers[n]) <= MAX_INPUTS[n]:
            return BAD_INPUT + n
    return OK


def check_step(u: Inputs | ShaftInputs, h: float) -> int:
    """Return the status of a communication step: its length, its inputs, and inputs with a rate at its end.

    Args:
        u: Inputs.
        h: Length of the step, s.
    """
    if not MIN_STEP <= h <= MAX_STEP:
        return BAD_STEP
    status = check_inputs(u)
    if status != OK:
        return status
    count = len(u.numbers) // 3
    for n in range(count):
        has_rate = u.numbers[2 * count + n] != 0.0
        if has_rate and not abs(u.numbers[n] + u.numbers[count + n] * h) <= MAX_INPUTS[n]:
            return BAD_RATE + n
    return OK


def check_hold(hold: float, x: ShaftState | State, speed: float, has_rate: float, h: float) -> int:
    """Return BAD_HOLD if a linearly extrapolated speed exceeds its range in the step, otherwise OK.

    Args:
        hold: Parameter input_hold; 0 keeps the input constant over the step.
        x: State with last_input_speed and the length of the last step.
        speed: Input speed, rad/s.
        has_rate: Not 0 if the rate of the speed is set, which then replaces the extrapolation.
        h: Length of the step, s.
    """
    if hold == 0.0 or has_rate != 0.0 or x.length == 0.0:
        return OK
    # abs(speed + change / length * h) <= limit, without a division
    extrapolated = abs(speed * x.length + (speed - x.last_input_speed) * h)
    return OK if extrapolated <= MAX_SPEED * x.length else BAD_HOLD


def update_held_speed(
    hold: float, x: ShaftState | State, speed: float, has_rate: float, rate: float
) -> float:
    """Store the input speed for the next extrapolation and return its slope over the step, rad/s^2.

    The slope is the rate of the input if it is set, or the slope over the last step with linear hold, or 0.

    Args:
        hold: Parameter input_hold; 0 keeps the input constant over the step.
        x: State with last_input_speed (written) and the length of the last step.
        speed: Input speed at the beginning of the step, rad/s.
        has_rate: Not 0 if the rate is set.
        rate: Rate of the input speed, rad/s^2.
    """
    slope = 0.0
    if has_rate != 0.0:
        slope = rate
    elif hold != 0.0 and x.length > 0.0:
        slope = (speed - x.last_input_speed) / x.length
    x.last_input_speed = speed
    return slope


def mean_torque(torque: float, has_rate: float, rate: float, h: float) -> float:
    """Return the mean of an input torque over the step, N m.

    Args:
        torque: Torque at the beginning of the step, N m.
        has_rate: Not 0 if the rate is set.
        rate: Rate of the torque, N m/s.
        h: Length of the step, s.
    """
    return torque + 0.5 * h * rate if has_rate != 0.0 else torque


def read_inputs(d: Constants, u: Inputs, x: State, h: float) -> float:
    """Copy the inputs of a communication step to the state and reset its sums.

    Args:
        d: Constants.
        u: Inputs.
        x: State, written.
        h: Length of the step, s.

    Returns:
        Jump of omega1 at the beginning of the step, rad/s; 0 if the torque is prescribed.
    """
    jump = 0.0
    prescribed, load = prescribed_at_input(d, x), x.load_torque
    if d.drive == DRIVE_SPEED:
        jump = u.omega1 - x.omega1
        x.alpha1 = update_held_speed(d.input_hold, x, u.omega1, u.omega1_has_rate, u.omega1_rate)
    x.load_torque = mean_torque(u.load_torque, u.load_torque_has_rate, u.load_torque_rate, h)
    x.drive_torque = mean_torque(u.drive_torque, u.drive_torque_has_rate, u.drive_torque_rate, h)
    if prescribed_at_input(d, x) != prescribed or x.load_torque != load:
        x.torques_continue = 0.0
    x.length = h
    reset_sums(x)
    return jump


def reset_sums(x: State) -> None:
    """Store the motion at the beginning of a step (or period) and set the sums over it to 0.

    Args:
        x: State, written.
    """
    x.begin_q = x.q
    x.begin_omega2 = x.omega2
    x.begin_theta1 = x.theta1
    x.begin_input_turns = x.input_turns
    x.begin_drive_turns = x.drive_turns
    for n in range(OF_MOTION, OF_MOTION + OF_SUMS):
        x.numbers[n] = 0.0
