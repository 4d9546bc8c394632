"""Outputs and locals at the present instant, from the state and the inputs held in it.

A shell may leave the late ones until they are read.
"""

import math

from .audit import is_audited
from .averaged.outputs import averaged_energy, write_averaged
from .codes import AVERAGED, DRIVING, ELASTIC, FREE, HELD_DRIVING, KINEMATIC
from .contact import torque_carried
from .layout import imbalance_in_fixed_frame
from .links import kinetic_energy, torques
from .run import accelerations_now
from .shaft import load_behind_freewheel, stored_in_shaft


def shaft_in_energy(p, x):
    """Speed with which J3 enters the energy: prescribed motion ends at the output, before J3."""
    return 0.0 if p.fidelity == KINEMATIC else x.omega3


def stored_energy(p, d, x):
    """Kinetic energy of the mechanism and the energy of an elastic output, J."""
    if p.fidelity == AVERAGED:
        return averaged_energy(d, x)
    if x.known != 0.0:
        return x.motion_energy + 0.5 * d.J3 * x.omega3 * x.omega3
    stored = kinetic_energy(d, x.q, x.omega1, x.omega2, shaft_in_energy(p, x))
    return stored + stored_in_shaft(d, x) if p.fidelity == ELASTIC else stored


def write_torques(p, d, x, y):
    """Instantaneous torques in the present mode. Returns the acceleration of link 2."""
    if p.fidelity == AVERAGED:
        return write_averaged(d, x, y)
    output = 0.0
    housing = 0.0
    load, _ = load_behind_freewheel(d, x)
    if p.fidelity == KINEMATIC:
        alpha2 = p.kinematic_ratio * x.alpha1
    else:
        _, alpha2 = accelerations_now(d, x)
    drive, mesh = torques(d, x.q, x.omega1, x.alpha1, x.omega2, alpha2)
    if p.fidelity == KINEMATIC:
        output = mesh - d.J2 * alpha2 - d.b2 * x.omega2
    elif x.mode == DRIVING:
        output, _ = torque_carried(d, load, 0.0, x.omega2, alpha2, 0.0)
    elif x.mode != FREE:
        output = load if x.mode == HELD_DRIVING else 0.0
        housing = output - mesh
    y.input_torque = drive
    y.mesh_torque = mesh
    y.output_torque = output
    y.housing_torque = housing
    return alpha2


def write_imbalance(d, x, y, alpha2):
    """Position, velocity and acceleration of imbalance 0 of module 0 in the fixed frame."""
    k = d.k
    px, py, pz, vx, vy, vz, ax, ay, az = imbalance_in_fixed_frame(
        d,
        x.q,
        x.theta1,
        x.omega1,
        x.alpha1,
        k * (x.omega1 - x.omega2),
        k * (x.alpha1 - alpha2),
    )
    y.imbalance_x = px
    y.imbalance_y = py
    y.imbalance_z = pz
    y.imbalance_velocity_x = vx
    y.imbalance_velocity_y = vy
    y.imbalance_velocity_z = vz
    y.imbalance_acceleration = math.sqrt(ax * ax + ay * ay + az * az)
    y.imbalance_acceleration_x = ax
    y.imbalance_acceleration_y = ay
    y.imbalance_acceleration_z = az


def write_outputs(x, y):
    """Outputs and locals that stand in the state as they are."""
    y.omega2 = x.omega2
    y.omega_out = x.omega3 - x.relative
    y.input_speed = x.omega1
    y.omega_hub = x.omega3
    y.shaft_twist = x.twist
    y.input_torque_mean = x.input_torque_mean
    y.output_torque_mean = x.output_torque_mean
    y.drive_angle = x.q
    y.drive_turns = x.drive_turns
    y.input_angle = x.theta1
    y.input_turns = x.input_turns
    y.contact_mode = x.mode
    y.contact_switches = x.switches
    y.rhs_evaluations = x.evaluations
    y.energy_in = x.energy_in
    y.energy_out = x.energy_out
    y.energy_lost = x.lost_shaft + x.lost_viscous
    y.energy_lost_viscous = x.lost_viscous
    y.energy_lost_shaft = x.lost_shaft


def write_late_outputs(p, d, x, y):
    """Outputs and locals that take more work than some steps do: torques, audit, imbalance."""
    y.torque_ripple = x.torque_ripple
    y.torque_peak = x.torque_peak
    stored = x.energy_stored if is_audited(p) else stored_energy(p, d, x)
    passed = x.energy_in - x.energy_out - y.energy_lost
    y.energy_stored = stored
    y.energy_residual = passed - (stored - x.energy_start)
    alpha2 = write_torques(p, d, x, y)
    write_imbalance(d, x, y, alpha2)
