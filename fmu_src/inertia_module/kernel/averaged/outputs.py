"""Outputs of fidelity averaged: the means of the torques, their ripple and peak, the mean energy."""

from .balance import mean_input_torque, mesh_share
from .legs import LOCKED, RESTING, choose_leg
from .rates import energy_at, ripple_at, side_at
from .run import leg_speed, torque_at, trend


def map_speed(d, x):
    """The speed v that the map goes with: omega1, or under its torque that of the energy."""
    return x.map_speed if d.by_torque != 0.0 else x.omega1


def averaged_energy(d, x):
    """Mean kinetic energy of the mechanism and the output shaft, J."""
    v = map_speed(d, x)
    energy, _, _ = energy_at(d, side_at(d, v, trend(d, x, x.alpha1)), x, v)
    return energy + 0.5 * d.J3 * x.omega3 * x.omega3


def write_averaged(d, x, y):
    """Mean torques, ripple and peak at the present speeds. Returns the acceleration of link 2.

    Of the mean output torque the mesh has its share, the housing takes the rest.
    """
    v = map_speed(d, x)
    alpha1 = x.alpha1
    side = side_at(d, v, trend(d, x, alpha1))
    leg = choose_leg(d, side, x, v, alpha1)
    omega3 = x.omega3
    x.omega3 = leg_speed(x, leg)
    torque, alpha3, alpha2, _ = torque_at(d, side, x, leg, v, alpha1)
    mesh = mesh_share(d, side, x, x.omega1, torque)
    y.input_torque = mean_input_torque(d, side, x, v, alpha1, alpha3, torque)
    y.mesh_torque = mesh
    y.output_torque = torque
    y.output_acceleration = alpha3
    y.housing_torque = torque + d.b2 * x.omega2 - mesh
    ripple = 0.0
    peak = abs(torque)
    if leg != LOCKED and leg != RESTING:
        ripple, peak = ripple_at(side, x, v)
    x.omega3 = omega3
    y.torque_ripple = ripple
    y.torque_peak = peak
    return alpha2
