"""The inputs of a step: checked, extrapolated, taken over into the state."""

from .codes import BAD_HOLD, BAD_INPUT, BAD_RATE, BAD_STEP, DRIVE_SPEED, OK
from .fields import OF_MOTION, OF_SUMS

# limits of inputs and of a communication step: rad/s, N m, s
LARGEST_SPEED, LARGEST_TORQUE, LARGEST_STEP = 1e6, 1e12, 1e6
# shorter than any remainder that a host's time leaves by rounding; rates over it can be squared
SMALLEST_STEP = 1e-30
# a slower input counts as none: its square is no normal double
SMALLEST_SPEED = 1e-150
# largest magnitudes of the inputs, in their order: a speed, then torques
LARGEST = (LARGEST_SPEED, LARGEST_TORQUE, LARGEST_TORQUE)


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    for n in range(len(u.numbers) // 3):
        if not abs(u.numbers[n]) <= LARGEST[n]:
            return BAD_INPUT + n
    return OK


def check_step(u, h):
    """Status of a step of h: its length, its inputs, and what those with a given rate come to at its end."""
    if not SMALLEST_STEP <= h <= LARGEST_STEP:
        return BAD_STEP
    status = check_inputs(u)
    if status != OK:
        return status
    count = len(u.numbers) // 3
    for n in range(count):
        # behind all inputs stand their rates, and behind these whether they are given
        if u.numbers[2 * count + n] != 0.0 and not abs(u.numbers[n] + u.numbers[count + n] * h) <= LARGEST[n]:
            return BAD_RATE + n
    return OK


def check_hold(hold, x, speed, rate_given, h):
    """Status of a speed that the coming step extrapolates linearly: it must stay within its limits.

    Args:
        hold: input_hold.
        x: state with held_input, and length of the last step.
        speed: input, rad/s.
        rate_given: whether its rate is given instead.
        h: length of the coming step, s.
    """
    if hold == 0.0 or rate_given != 0.0 or x.length == 0.0:
        return OK
    # abs(speed + change / length * h) <= limit, without a division
    reach = abs(speed * x.length + (speed - x.held_input) * h)
    return OK if reach <= LARGEST_SPEED * x.length else BAD_HOLD


def input_speed(u):
    """omega1, rad/s, or zero where it is too slow to be squared."""
    omega1 = u.omega1
    return omega1 if abs(omega1) >= SMALLEST_SPEED else 0.0


def take_speed(hold, x, speed, rate_given, rate):
    """Slope of a given speed over the coming step: its rate if given, or that of the last step if so held.

    Args:
        hold: input_hold. x: state with held_input, and length of the last step. speed: rad/s. rate: rad/s^2.
    """
    slope = 0.0
    if rate_given != 0.0:
        slope = rate
    elif hold != 0.0 and x.length > 0.0:
        slope = (speed - x.held_input) / x.length
    x.held_input = speed
    return slope


def mean_torque(torque, rate_given, rate, h):
    """Mean of a given torque over the coming step: with its rate given, that at the middle."""
    return torque + 0.5 * h * rate if rate_given != 0.0 else torque


def begin(d, u, x, h):
    """Take the inputs of the coming step and clear its sums. Returns the jump of omega1."""
    jump = 0.0
    if d.drive == DRIVE_SPEED:
        omega1 = input_speed(u)
        jump = omega1 - x.omega1
        x.alpha1 = take_speed(d.input_hold, x, omega1, u.omega1_rate_given, u.omega1_rate)
    x.load_torque = mean_torque(u.load_torque, u.load_torque_rate_given, u.load_torque_rate, h)
    x.drive_torque = mean_torque(u.drive_torque, u.drive_torque_rate_given, u.drive_torque_rate, h)
    x.length = h
    begin_sums(x)
    return jump


def begin_sums(x):
    """Begin the sums over a communication step, or over a period of a steady motion."""
    x.begin_q = x.q
    x.begin_omega2 = x.omega2
    x.begin_theta1 = x.theta1
    x.begin_input_turns = x.input_turns
    x.begin_drive_turns = x.drive_turns
    for n in range(OF_MOTION, OF_MOTION + OF_SUMS):
        x.numbers[n] = 0.0
