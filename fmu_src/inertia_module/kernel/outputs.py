"""Outputs and locals at the present instant, from the state and the inputs held in it.

A shell may leave the late ones until they are read.
"""

import math

from .average_outputs import averaged_energy, write_averaged
from .dynamics import kinetic_energy, motion, prescribed_torques
from .layout import imbalance_in_fixed_frame
from .shaft import relative_rate, shaft_torque, stored_in_shaft
from .slots import *


def shaft_in_energy(p, x):
    """Speed with which J3 enters the energy: prescribed motion ends at the output, before J3."""
    return 0.0 if p[P_FIDELITY] == KINEMATIC else x[X_OMEGA3]


def shaft_load(p, d, x):
    """Torque on the hub behind the output freewheel, the load or that of the elastic shaft, and its rate.

    The rate is that behind a hub of constant speed.
    """
    load = x[X_LOAD_TORQUE]
    if p[P_FIDELITY] != ELASTIC:
        return load, 0.0
    torque = shaft_torque(d, x)
    rate = d[D_STIFFNESS] * x[X_RELATIVE] + d[D_DAMPING] * relative_rate(d, x, load, torque, 0.0)
    return torque, rate


def stored_energy(p, d, x):
    """Kinetic energy of the mechanism and the energy of an elastic output, J."""
    if p[P_FIDELITY] == AVERAGED:
        return averaged_energy(d, x)
    stored = kinetic_energy(d, x[X_Q], x[X_OMEGA1], x[X_OMEGA2], shaft_in_energy(p, x))
    return stored + stored_in_shaft(d, x) if p[P_FIDELITY] == ELASTIC else stored


def write_torques(p, d, x, y):
    """Instantaneous torques in the present mode. Returns the acceleration of link 2."""
    mode = x[X_MODE]
    q = x[X_Q]
    omega1 = x[X_OMEGA1]
    alpha1 = x[X_ALPHA1]
    omega2 = x[X_OMEGA2]
    load, _ = shaft_load(p, d, x)
    output = 0.0
    housing = 0.0
    if p[P_FIDELITY] == AVERAGED:
        return write_averaged(d, x, y)
    if p[P_FIDELITY] == KINEMATIC:
        alpha2 = p[P_KINEMATIC_RATIO] * alpha1
        drive, mesh = prescribed_torques(d, q, omega1, alpha1, omega2, alpha2)
        output = mesh - d[D_J2] * alpha2
    elif mode == DRIVING:
        alpha2, drive, output, mesh = motion(d, q, omega1, alpha1, omega2, d[D_J3], load)
    elif mode == FREE:
        alpha2, drive, _, mesh = motion(d, q, omega1, alpha1, omega2, 0.0, 0.0)
    else:
        alpha2 = 0.0
        drive, mesh = prescribed_torques(d, q, omega1, alpha1, 0.0, 0.0)
        output = load if mode == HELD_DRIVING else 0.0
        housing = output - mesh
    y[Y_INPUT_TORQUE] = drive
    y[Y_MESH_TORQUE] = mesh
    y[Y_OUTPUT_TORQUE] = output
    y[Y_HOUSING_TORQUE] = housing
    return alpha2


def write_imbalance(d, x, y, alpha2):
    """Position, velocity and acceleration of imbalance 0 of module 0 in the fixed frame."""
    k = d[D_K]
    px, py, pz, vx, vy, vz, ax, ay, az = imbalance_in_fixed_frame(
        d,
        x[X_Q],
        x[X_THETA1],
        x[X_OMEGA1],
        x[X_ALPHA1],
        k * (x[X_OMEGA1] - x[X_OMEGA2]),
        k * (x[X_ALPHA1] - alpha2),
    )
    y[Y_POSITION_X] = px
    y[Y_POSITION_Y] = py
    y[Y_POSITION_Z] = pz
    y[Y_VELOCITY_X] = vx
    y[Y_VELOCITY_Y] = vy
    y[Y_VELOCITY_Z] = vz
    y[Y_ACCELERATION] = math.sqrt(ax * ax + ay * ay + az * az)
    y[Y_ACCELERATION_X] = ax
    y[Y_ACCELERATION_Y] = ay
    y[Y_ACCELERATION_Z] = az


def write_outputs(x, y):
    """Outputs and locals that stand in the state as they are."""
    y[Y_OMEGA2] = x[X_OMEGA2]
    y[Y_OMEGA_OUT] = x[X_OMEGA3] - x[X_RELATIVE]
    y[Y_INPUT_SPEED] = x[X_OMEGA1]
    y[Y_OMEGA_HUB] = x[X_OMEGA3]
    y[Y_SHAFT_TWIST] = x[X_TWIST]
    y[Y_INPUT_TORQUE_MEAN] = x[X_INPUT_TORQUE_MEAN]
    y[Y_OUTPUT_TORQUE_MEAN] = x[X_OUTPUT_TORQUE_MEAN]
    y[Y_DRIVE_ANGLE] = x[X_Q]
    y[Y_DRIVE_TURNS] = x[X_DRIVE_TURNS]
    y[Y_INPUT_ANGLE] = x[X_THETA1]
    y[Y_INPUT_TURNS] = x[X_INPUT_TURNS]
    y[Y_CONTACT_MODE] = x[X_MODE]
    y[Y_CONTACT_SWITCHES] = x[X_SWITCHES]
    y[Y_RHS_EVALUATIONS] = x[X_EVALUATIONS]
    y[Y_ENERGY_IN] = x[X_ENERGY_IN]
    y[Y_ENERGY_OUT] = x[X_ENERGY_OUT]
    y[Y_ENERGY_LOST] = x[X_ENERGY_LOST]


def write_late_outputs(p, d, x, y):
    """Outputs and locals that take more work than some steps do: torques, audit, imbalance."""
    y[Y_TORQUE_RIPPLE] = x[X_TORQUE_RIPPLE]
    y[Y_TORQUE_PEAK] = x[X_TORQUE_PEAK]
    stored = stored_energy(p, d, x)
    passed = x[X_ENERGY_IN] - x[X_ENERGY_OUT] - x[X_ENERGY_LOST]
    y[Y_ENERGY_STORED] = stored
    y[Y_ENERGY_RESIDUAL] = passed - (stored - x[X_ENERGY_START])
    alpha2 = write_torques(p, d, x, y)
    write_imbalance(d, x, y, alpha2)
