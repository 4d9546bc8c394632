"""The inputs of a step: checked, extrapolated, taken over into the state."""

from .limits import LARGEST_SPEED, LARGEST_TORQUE, SMALLEST_SPEED
from .slots import *


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u[U_OMEGA1]) <= LARGEST_SPEED:
        return BAD_OMEGA1
    if not abs(u[U_LOAD_TORQUE]) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    if not abs(u[U_DRIVE_TORQUE]) <= LARGEST_TORQUE:
        return BAD_DRIVE_TORQUE
    return OK


def check_rates(u, h):
    """Status of the rates of the inputs that are given: no input becomes absurd within the step h."""
    if u[U_OMEGA1_RATE_GIVEN] != 0.0:
        if not abs(u[U_OMEGA1] + u[U_OMEGA1_RATE] * h) <= LARGEST_SPEED:
            return BAD_OMEGA1_RATE
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        if not abs(u[U_LOAD_TORQUE] + u[U_LOAD_TORQUE_RATE] * h) <= LARGEST_TORQUE:
            return BAD_LOAD_TORQUE_RATE
    if u[U_DRIVE_TORQUE_RATE_GIVEN] != 0.0:
        if not abs(u[U_DRIVE_TORQUE] + u[U_DRIVE_TORQUE_RATE] * h) <= LARGEST_TORQUE:
            return BAD_DRIVE_TORQUE_RATE
    return OK


def input_speed(u):
    """omega1, rad/s, or zero where it is too slow to be squared."""
    omega1 = u[U_OMEGA1]
    return omega1 if abs(omega1) >= SMALLEST_SPEED else 0.0


def extrapolate_input(p, u, x, h):
    """Slope of omega1 over the coming step and the jump that is left at its beginning."""
    omega1 = input_speed(u)
    alpha1 = 0.0
    if u[U_OMEGA1_RATE_GIVEN] != 0.0:
        alpha1 = u[U_OMEGA1_RATE]
    elif p[P_INPUT_HOLD] != 0.0 and x[X_HELD_STEP] > 0.0:
        alpha1 = (omega1 - x[X_HELD_INPUT]) / x[X_HELD_STEP]
    x[X_HELD_INPUT] = omega1
    x[X_HELD_STEP] = h
    return alpha1, omega1 - x[X_OMEGA1]


def begin(p, u, x, h):
    """Take the inputs of the coming step and clear its sums. Returns the jump of omega1.

    A torque counts by its mean over the step: with its rate given, that at the middle.
    """
    jump = 0.0
    if p[P_DRIVE] == DRIVE_SPEED:
        alpha1, jump = extrapolate_input(p, u, x, h)
        x[X_ALPHA1] = alpha1
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        x[X_LOAD_TORQUE] += 0.5 * h * u[U_LOAD_TORQUE_RATE]
    x[X_DRIVE_TORQUE] = u[U_DRIVE_TORQUE]
    if u[U_DRIVE_TORQUE_RATE_GIVEN] != 0.0:
        x[X_DRIVE_TORQUE] += 0.5 * h * u[U_DRIVE_TORQUE_RATE]
    x[X_INPUT_IMPULSE] = 0.0
    x[X_OUTPUT_IMPULSE] = 0.0
    x[X_OUTPUT_SQUARE] = 0.0
    x[X_TORQUE_PEAK] = 0.0
    x[X_STEP_SWITCHES] = 0.0
    x[X_STEP_EVALUATIONS] = 0.0
    return jump
