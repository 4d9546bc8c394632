"""Outputs of fidelity averaged: the means of the torques, their ripple and peak, the mean energy."""

from .average import leg_speed, torque_at
from .average_legs import LOCKED, RESTING, choose_leg, header_at
from .average_rates import energy_at, mean_input_torque, ripple_at
from .slots import *


def averaged_energy(d, x):
    """Mean kinetic energy of the mechanism and the output shaft, J."""
    header = header_at(x[X_OMEGA1], x[X_ALPHA1])
    energy, _, _ = energy_at(d, x, header, x[X_OMEGA1], x[X_OMEGA3])
    return energy + 0.5 * d[D_J3] * x[X_OMEGA3] * x[X_OMEGA3]


def write_averaged(d, x, y):
    """Mean torques, ripple and peak at the present speeds. Returns the acceleration of link 2.

    The mean mesh torque is the share rho = omega3 / omega1 of the output torque, the housing takes
    the rest: power balances in the mean.
    """
    omega1 = x[X_OMEGA1]
    alpha1 = x[X_ALPHA1]
    omega3 = x[X_OMEGA3]
    header = header_at(omega1, alpha1)
    leg = choose_leg(d, x, header, omega1, alpha1, x[X_LOAD_TORQUE])
    torque, alpha3, alpha2 = torque_at(d, x, header, leg, omega1, alpha1, x[X_LOAD_TORQUE])
    mesh = torque * omega3 / omega1 if torque != 0.0 and omega1 != 0.0 else 0.0
    y[Y_INPUT_TORQUE] = mean_input_torque(d, x, header, omega1, alpha1, leg_speed(x, leg), alpha3, torque)
    y[Y_MESH_TORQUE] = mesh
    y[Y_OUTPUT_TORQUE] = torque
    y[Y_HOUSING_TORQUE] = torque - mesh
    ripple = 0.0
    peak = abs(torque)
    if leg != LOCKED and leg != RESTING:
        ripple, peak = ripple_at(d, x, header, omega1, leg_speed(x, leg))
    y[Y_TORQUE_RIPPLE] = ripple
    y[Y_TORQUE_PEAK] = peak
    return alpha2
