"""Outputs and local variables at the present time, from the state and the inputs that it holds.

Late outputs take longer to compute. The FMU computes them when they are read.
"""

from .accumulate import TWO_PI, total
from .averaged.mean_motion import averaged_energy, write_averaged
from .codes import AVERAGED, KINEMATIC, RIGID
from .engine import solve_present
from .equations.losses import FREEWHEEL, JOURNAL, MESH, SHAFT, VISCOUS, WINDAGE
from .equations.motion import potential_energy
from .links import kinetic_energy
from .loads import write_loads
from .records import Constants, Outputs, State


def stored_energy(d: Constants, x: State) -> float:
    """Return the stored energy, J: kinetic energy, weights and springs.

    Args:
        d: Constants.
        x: State.
    """
    if d.fidelity == AVERAGED:
        return averaged_energy(d, x)
    potential = potential_energy(d, x) if d.losses != 0.0 else 0.0
    # The prescribed motion of fidelity kinematic ends at the output freewheel, upstream of J3
    omega3 = 0.0 if d.fidelity == KINEMATIC else x.omega3
    stored = potential + kinetic_energy(d, x.q, x.omega1, x.omega2, omega3)
    if d.rigid_shaft != 0.0:
        stored += 0.5 * d.balancer * d.J4 * omega3 * omega3
    if d.elastic != 0.0:
        omega4 = x.omega3 - x.relative
        stored += 0.5 * d.J4 * omega4 * omega4 + 0.5 * d.shaft_stiffness * x.twist * x.twist
    return stored


def shaft_twist(d: Constants, x: State) -> float:
    """Return the twist of a shaft that is rigid: its torque over its stiffness, rad.

    Args:
        d: Constants; d.machine is written.
        x: State.
    """
    solve_present(d, x)
    torque = (1.0 - d.balancer) * d.J4 * d.machine.alpha3 + d.driven_friction * x.omega3 + x.load_torque
    return torque / d.shaft_stiffness


def write_torques(d: Constants, x: State, y: Outputs) -> float:
    """Write the instantaneous torques and the acceleration of the output.

    Args:
        d: Constants; d.machine is written.
        x: State.
        y: Outputs, written.

    Returns:
        Acceleration of link 2, rad/s^2.
    """
    if d.fidelity == AVERAGED:
        return write_averaged(d, x, y)
    solve_present(d, x)
    m = d.machine
    y.output_acceleration = m.alpha3 - m.rate_relative
    y.input_torque = m.drive
    y.mesh_torque = m.mesh
    y.output_torque = m.output
    y.housing_torque = m.housing
    return m.alpha2


def write_step_means(d: Constants, x: State, y: Outputs) -> None:
    """Write the means over the last step, impulses included.

    Args:
        d: Constants.
        x: State with the impulses of the step.
        y: Outputs, written.
    """
    length = x.length if x.length > 0.0 else 1.0
    housing = x.housing_impulse / length
    if d.losses == 0.0 and d.fidelity != AVERAGED:
        housing = d.housing_freewheel * max(
            housing, 0.0
        )  # The freewheel only pushes: a negative value is round-off
    y.mesh_torque_mean = x.mesh_impulse / length
    y.housing_torque_mean = housing
    y.loss_power_mean = x.step_lost / length


def write_outputs(x: State, y: Outputs) -> None:
    """Write the outputs and local variables that are copies of fields of the state.

    Args:
        x: State.
        y: Outputs, written.
    """
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
    y.energy_lost_viscous = x.lost[VISCOUS]
    y.energy_lost_shaft = x.lost[SHAFT]
    y.energy_lost_mesh = x.lost[MESH]
    y.energy_lost_journal = x.lost[JOURNAL]
    y.energy_lost_freewheel = x.lost[FREEWHEEL]
    y.energy_lost_windage = x.lost[WINDAGE]


def write_late_outputs(d: Constants, x: State, y: Outputs) -> None:
    """Write the late outputs and local variables: torques, energy balance, reaction forces.

    Args:
        d: Constants; d.machine is written.
        x: State.
        y: Outputs with the other ones already written; written.
    """
    y.torque_ripple = x.torque_ripple
    y.torque_peak = x.torque_peak
    y.housing_torque_peak = x.housing_torque_peak
    y.housing_slip_peak = d.housing_freewheel * x.housing_slip_peak
    y.output_slip_peak = d.output_freewheel * x.output_slip_peak
    stored = x.energy_stored if d.fidelity >= RIGID else stored_energy(d, x)
    net = x.energy_in - x.energy_out - y.energy_lost
    y.energy_stored = stored
    y.energy_residual = net - (stored - x.energy_start)
    alpha2 = write_torques(d, x, y)
    y.input_acceleration = x.alpha1
    write_step_means(d, x, y)
    write_loads(d, x, y, alpha2)
