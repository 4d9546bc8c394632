"""Fidelity `kinematic`: omega2 = ratio omega1 is prescribed, torques follow by inverse dynamics."""

from .accumulate import add
from .dynamics import prescribed_torques
from .held import (
    GAUSS_NODE_1,
    GAUSS_NODE_2,
    GAUSS_WEIGHT_1,
    GAUSS_WEIGHT_2,
    GAUSS_WEIGHT_3,
)
from .slots import *

# phase of the highest harmonic within one Gauss interval, rad
GAUSS_PHASE = 1.0


def add_node(d, x, ratio, omega1, alpha1, rate, t, weight):
    """Add one Gauss node, the time t into the interval, to the sums over the communication step."""
    speed = omega1 + alpha1 * t
    angle = x[X_Q] + rate * t * (omega1 + 0.5 * alpha1 * t)
    drive, mesh = prescribed_torques(d, angle, speed, alpha1, ratio * speed, ratio * alpha1)
    output = mesh - d[D_J2] * ratio * alpha1
    x[X_STEP_EVALUATIONS] += 1.0
    x[X_INPUT_IMPULSE] += weight * drive
    x[X_OUTPUT_IMPULSE] += weight * output
    x[X_OUTPUT_SQUARE] += weight * output * output
    x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(output))
    add(x, X_ENERGY_IN, weight * drive * speed)
    add(x, X_ENERGY_OUT, weight * output * ratio * speed)


def advance_kinematic(d, x, ratio, omega1, alpha1, remaining):
    """Advance by one interval. Returns the time passed."""
    rate = d[D_K] * (1.0 - ratio)
    h = min(remaining, d[D_MAX_STEP])
    fastest = d[D_HARMONIC] * abs(rate) * max(abs(omega1), abs(omega1 + alpha1 * remaining))
    if fastest * h > GAUSS_PHASE:
        h = GAUSS_PHASE / fastest
    add_node(d, x, ratio, omega1, alpha1, rate, GAUSS_NODE_1 * h, GAUSS_WEIGHT_1 * h)
    add_node(d, x, ratio, omega1, alpha1, rate, GAUSS_NODE_2 * h, GAUSS_WEIGHT_2 * h)
    add_node(d, x, ratio, omega1, alpha1, rate, 0.5 * h, GAUSS_WEIGHT_3 * h)
    add_node(d, x, ratio, omega1, alpha1, rate, h - GAUSS_NODE_2 * h, GAUSS_WEIGHT_2 * h)
    add_node(d, x, ratio, omega1, alpha1, rate, h - GAUSS_NODE_1 * h, GAUSS_WEIGHT_1 * h)
    add(x, X_Q, rate * h * (omega1 + 0.5 * alpha1 * h))
    return h
