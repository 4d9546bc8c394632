"""Outputs and locals at the present instant, from the state and the inputs held in it.

A shell may leave the late ones until they are read.
"""

from .accumulate import TWO_PI, total
from .averaged.run import averaged_energy, write_averaged
from .codes import AVERAGED, ELASTIC, KINEMATIC, RIGID
from .engine import solve_now
from .equations.motion import stored_besides
from .links import kinetic_energy
from .loads import write_loads


def is_audited(d):
    """Return True if the energies of a communication step are checked; averaged checks its own steps."""
    return d.fidelity >= RIGID


def stored_energy(d, x):
    """Kinetic energy of the mechanism and the energy of an elastic output, J."""
    if d.fidelity == AVERAGED:
        return averaged_energy(d, x)
    besides = stored_besides(d, x) if d.losses != 0.0 else 0.0
    # prescribed motion ends at the output, before J3
    omega3 = 0.0 if d.fidelity == KINEMATIC else x.omega3
    stored = besides + kinetic_energy(d, x.q, x.omega1, x.omega2, omega3)
    if d.fidelity == ELASTIC:
        omega4 = x.omega3 - x.relative
        stored += 0.5 * d.J4 * omega4 * omega4 + 0.5 * d.shaft_stiffness * x.twist * x.twist
    return stored


def write_torques(d, x, y):
    """Instantaneous torques in the present mode. Returns the acceleration of link 2."""
    if d.fidelity == AVERAGED:
        return write_averaged(d, x, y)
    solve_now(d, x)
    m = d.machine
    y.output_acceleration = m.alpha3 - m.rate_relative
    y.input_torque = m.drive
    y.mesh_torque = m.mesh
    y.output_torque = m.output
    y.housing_torque = m.housing
    return m.alpha2


def write_means(d, x, y):
    """Means over the step, all impulses included: the changes of momenta leave nothing to integrate."""
    length = x.length if x.length > 0.0 else 1.0
    housing = x.housing_impulse / length
    if d.losses == 0.0 and d.fidelity != AVERAGED:
        housing = d.housing * max(housing, 0.0)  # it only pushes: below zero is rounding
    y.mesh_torque_mean = x.mesh_impulse / length
    y.housing_torque_mean = housing
    y.loss_power_mean = x.step_lost / length


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
    y.output_angle = x.output_angle
    y.output_turns = x.output_turns
    y.input_flange_angle = x.theta1 + TWO_PI * x.input_turns
    y.output_flange_angle = x.output_angle + TWO_PI * x.output_turns
    y.contact_mode = x.mode
    y.contact_switches = x.switches
    y.housing_engagements = x.housing_engagements
    y.output_engagements = x.output_engagements
    y.rhs_evaluations = x.evaluations
    y.energy_in = x.energy_in
    y.energy_out = x.energy_out
    y.energy_lost = total(x.lost)
    for cause in range(len(x.lost)):
        y.numbers[cause] = x.lost[cause]  # energy_lost_viscous and so on: y begins with them


def write_late_outputs(d, x, y):
    """Outputs and locals that take more work than some steps do: torques, audit, imbalance."""
    y.torque_ripple = x.torque_ripple
    y.torque_peak = x.torque_peak
    y.housing_torque_peak = x.housing_torque_peak
    y.housing_slip_peak = d.housing * x.housing_slip_peak
    y.output_slip_peak = d.output * x.output_slip_peak
    stored = x.energy_stored if is_audited(d) else stored_energy(d, x)
    passed = x.energy_in - x.energy_out - y.energy_lost
    y.energy_stored = stored
    y.energy_residual = passed - (stored - x.energy_start)
    alpha2 = write_torques(d, x, y)
    y.input_acceleration = x.alpha1
    write_means(d, x, y)
    write_loads(d, x, y, alpha2)
