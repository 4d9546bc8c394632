"""Initialisation and communication steps, with a check of the energy balance of each step.

The input work is equal to the output work, the losses and the change of the stored energy. Any error of a
step, such as energy from nowhere or a freewheel that opens too late, violates this balance.
"""

import math

from . import codes
from .accumulate import TWO_PI, clear, copy, total, turn_output, wrap_drive_angle
from .averaged.integrate import run_averaged
from .averaged.mean_motion import jump_averaged, takes_up_jump, update_end
from .averaged.periodic_orbit import find_orbit, hold_output, release_angle
from .averaged.torque_map import build_map
from .checks import check_parameters
from .engine import (
    handle_pending_event,
    run_events,
    run_kinematic,
    solve_present,
    update_alpha1,
    update_motion,
)
from .events.kinematic import impose_ratio
from .impulse import jump_input
from .inputs import check_hold, check_inputs, check_step, read_inputs
from .links import fastest_rate
from .outputs import shaft_twist, stored_energy, write_late_outputs, write_outputs
from .parameters import derive_constants
from .records import Constants, Inputs, Outputs, Parameters, State, Workspace

# Allowed imbalance over the energies of the step: AUDIT_TOLERANCES times the tolerance, within two limits
AUDIT_TOLERANCES, MIN_AUDIT_SHARE, MAX_AUDIT_SHARE = 1e3, 1e-6, 0.1
SUM_RTOL = 1e-14  # Relative round-off of the sums since the start
ENERGY_ATOL = 1e-30  # J, below the energy of any machine that moves
DIFFERENCING_TOLERANCE = 1e-11  # Maximum tolerance of STEP_FOR_DIFFERENCING
MAX_ORBIT_TOLERANCE = 1e-9  # Of a periodic orbit: in free flight an error persists from period to period
INSTANT_PHASE = 1e-8  # rad; in a shorter step the changes of momenta are round-off
SPEED_RTOL = 1e-14  # Relative round-off of speeds, also of a speed that the importer computes


def check(p: Parameters, d: Constants, u: Inputs) -> int:
    """Derive the constants, check parameters and inputs, and return the status."""
    derive_constants(p, d)
    status = check_parameters(d)
    return check_inputs(u) if status == codes.OK else status


def check_and_restore_map(p: Parameters, d: Constants, u: Inputs, w: Workspace) -> int:
    """Check parameters and inputs, and build the map of averaged again if it has been overwritten.

    A change of parameters that was rejected may have overwritten it.

    Returns:
        Status.
    """
    status = check(p, d, u)
    if status == codes.OK and d.fidelity == codes.AVERAGED and d.map_ready < 0.0:
        status = build_map(p, d, w)
    return status


def start(p: Parameters, d: Constants, u: Inputs, x: State, y: Outputs, w: Workspace) -> int:
    """Derive the constants, set state and outputs at the end of initialisation, and return the status."""
    status = check(p, d, u)
    if status != codes.OK:
        return status
    if d.fidelity == codes.AVERAGED:
        status = build_map(p, d, w)
        if status != codes.OK:
            return status
    clear(x.numbers)
    x.omega1 = u.omega1
    x.last_input_speed = x.omega1
    x.load_torque = u.load_torque
    x.drive_torque = u.drive_torque
    x.q = d.drive_angle_start
    wrap_drive_angle(d, x)
    x.omega2 = d.omega2_start
    x.omega3 = d.omega_out_start
    # A freewheel that overruns at the start has its whole engagement angle before it
    x.play_housing = d.housing_engagement_angle if x.omega2 > 0.0 else 0.0
    x.play_output = d.output_engagement_angle if x.omega3 > x.omega2 else 0.0
    if d.fidelity == codes.AVERAGED:
        update_end(d, x)
        x.switches = 0.0
    else:
        update_motion(d, x)
    if d.rigid_shaft != 0.0:
        x.twist = shaft_twist(d, x)
    x.energy_start = stored_energy(d, x)
    x.energy_stored = x.energy_start
    write_outputs(x, y)
    write_late_outputs(d, x, y)
    return codes.OK


def update_parameters(p: Parameters, d: Constants, x: State, w: Workspace) -> int:
    """Derive the constants again after a change of tunable parameters between steps, and return the status.

    Torques and rates of the last step no longer hold. If the status is not OK, the state is unchanged.
    """
    derive_constants(p, d)
    status = check_parameters(d)
    if status == codes.OK and d.fidelity == codes.AVERAGED:
        status = build_map(p, d, w)
    if status == codes.OK:
        handle_pending_event(d, x)
        x.torques_continue = 0.0
        x.rates_cached = 0.0
    return status


def start_steady(
    p: Parameters, d: Constants, u: Inputs, x: State, y: Outputs, w: Workspace, length: float
) -> int:
    """Start the module at the end of a period of its periodic orbit, with the output at its initial speed.

    The sums and means in the outputs are those over this period.

    Args:
        p: Parameters.
        d: Constants, written; the inertia of the output is very large afterwards (hold_output).
        u: Inputs.
        x: State, written.
        y: Outputs, written.
        w: Workspace.
        length: Angle of the pinion shaft in a period, rad.

    Returns:
        Status: OK, or NO_CYCLIC_STEADY_STATE if links 1 and 2 stick together.
    """
    status = check(p, d, u)
    if status != codes.OK:
        return status
    hold_output(d)
    w.tolerance = min(d.tolerance, MAX_ORBIT_TOLERANCE)
    d.map_evaluations = w.orbit_torque = 0.0
    w.orbit_start = release_angle(d, 1.0 if u.omega1 > 0.0 else -1.0)
    time = find_orbit(d, x, w, u.omega1, d.omega_out_start / abs(u.omega1), length)
    if time < 0.0:
        return codes.NO_CYCLIC_STEADY_STATE
    x.length = time
    write_means(d, x, time)
    x.energy_stored = stored_energy(d, x)
    write_outputs(x, y)
    write_late_outputs(d, x, y)
    return codes.OK


def is_instant(d: Constants, x: State, h: float) -> bool:
    """Return True if the impulses of a short step are equal to the torques at its end times its length.

    A host that rounds its time makes steps of 1e-17 s, in which changes of momenta are round-off. If the
    result is True, the torques at the end of the step are in ``d.machine``.
    """
    m = d.machine
    if d.fidelity == codes.AVERAGED or not h * fastest_rate(d, x) < INSTANT_PHASE:
        return False
    solve_present(d, x)
    difference = abs(x.input_impulse - h * m.drive) + abs(x.housing_impulse - h * m.housing)
    difference += abs(x.output_impulse - h * m.output)
    fastest = abs(x.omega1) + abs(x.omega2) + abs(x.omega3) + abs(x.relative)
    return difference <= SPEED_RTOL * fastest * (d.J1 + m.i + d.k * d.k * m.g + d.J2 + d.J3)


def write_mesh_impulse(d: Constants, x: State) -> None:
    """Write the impulse of M2 by the momentum of link 2: J2 omega2' = M2 - b2 omega2 - Tc + Th."""
    x.mesh_impulse = x.output_jump + x.output_impulse - x.housing_impulse
    if d.fidelity != codes.AVERAGED:  # The mean mesh torque includes the momentum that the pulses store
        x.mesh_impulse += d.J2 * (x.omega2 - x.begin_omega2)
    if d.viscous != 0.0:
        angle1 = x.theta1 - x.begin_theta1 + TWO_PI * (x.input_turns - x.begin_input_turns)
        angle_q = x.q - x.begin_q + TWO_PI * (x.drive_turns - x.begin_drive_turns)
        x.mesh_impulse += d.b2 * (angle1 - angle_q / d.k)


def write_means(d: Constants, x: State, h: float) -> None:
    """Write the means over the step, or the torques at the end of a very short step (is_instant)."""
    write_mesh_impulse(d, x)
    if x.input_jump == 0.0 and x.output_jump == 0.0 and is_instant(d, x, h):
        m = d.machine
        x.input_impulse, x.mesh_impulse, x.housing_impulse = h * m.drive, h * m.mesh, h * m.housing
        x.output_impulse = h * m.output
        x.output_square = x.output_impulse * (x.output_impulse / h)
    x.input_torque_mean = (x.input_jump + x.input_impulse) / h
    x.output_torque_mean = (x.output_jump + x.output_impulse) / h
    mean = x.output_impulse / h
    variance = x.output_square / h - mean * mean
    x.torque_ripple = math.sqrt(variance) if variance > 0.0 else 0.0
    turn_output(x)
    x.evaluations += x.step_evaluations


def is_finite(x: State) -> bool:
    """Return True if motion, energies and means are finite. All other results follow from them."""
    motion = (abs(x.q) + abs(x.theta1)) + (abs(x.omega2) + abs(x.omega3))
    shaft = (abs(x.relative) + abs(x.twist)) + abs(x.omega1)
    energies = (abs(x.energy_in) + abs(x.energy_out)) + abs(total(x.lost))
    means = abs(x.input_torque_mean) + (abs(x.output_torque_mean) + abs(x.torque_ripple))
    return (motion + shaft) + (energies + means) < 1e300


def advance(d: Constants, u: Inputs, x: State, y: Outputs, w: Workspace, h: float, operation: int) -> int:
    """Advance by a communication step, or up to its first event, and return the status.

    If the status is not OK, state and outputs are unchanged.

    Args:
        d: Constants.
        u: Inputs.
        x: State, advanced.
        y: Outputs, written.
        w: Workspace; ``stops`` is read.
        h: Communication step, s.
        operation: STEP, STEP_ONLY, STEP_UNTIL_EVENT or STEP_FOR_DIFFERENCING (:mod:`.codes`). STEP_ONLY and
            STEP_UNTIL_EVENT leave the late outputs unchanged.
    """
    status = check_step(u, h)
    if status == codes.OK and d.drive == codes.DRIVE_SPEED:
        status = check_hold(d.input_hold, x, u.omega1, u.omega1_has_rate, h)
    if status != codes.OK:
        return status
    copy(w.before.numbers, x.numbers)
    w.tolerance = d.tolerance
    if operation == codes.STEP_FOR_DIFFERENCING:
        w.tolerance = min(d.tolerance, DIFFERENCING_TOLERANCE)
    take_up_inputs(d, u, x, h)
    start1 = x.omega1
    if d.fidelity == codes.AVERAGED:
        status = run_averaged(d, x, w, h)
    elif d.fidelity == codes.KINEMATIC:
        status = run_kinematic(d, x, w, h)
    else:
        status = run_events(d, x, w, h)
    if status == codes.OK:
        status = finish_step(d, x, w, start1)
    if status != codes.OK:
        copy(x.numbers, w.before.numbers)
        return status
    write_outputs(x, y)
    if operation != codes.STEP_ONLY and operation != codes.STEP_UNTIL_EVENT:
        write_late_outputs(d, x, y)
    return codes.OK


def audit(d: Constants, x: State, before: State, stored: float, tolerance: float) -> int:
    """Return OK if the energies of the step balance, otherwise NOT_BALANCED.

    Args:
        d: Constants.
        x: State after the step; its stored energy is written.
        before: State before the step.
        stored: Stored energy after the step, J.
        tolerance: Tolerance of the step.
    """
    work_in = x.energy_in - before.energy_in
    work_out = x.energy_out - before.energy_out
    lost = x.step_lost
    imbalance = work_in - work_out - lost - (stored - before.energy_stored)
    energies = abs(work_in) + abs(work_out) + abs(lost) + abs(stored) + abs(before.energy_stored)
    x.energy_stored = stored
    fastest = max(abs(x.omega1), abs(before.omega1))
    share = max(MIN_AUDIT_SHARE, min(AUDIT_TOLERANCES * tolerance, MAX_AUDIT_SHARE))
    speed_error = share * fastest
    allowed = share * energies + (d.J1 + d.J2 + d.J3 + d.J4) * speed_error * speed_error
    # Round-off of the energies since the start
    allowed += SUM_RTOL * (abs(x.energy_in) + abs(x.energy_out) + abs(total(x.lost)))
    return codes.OK if abs(imbalance) <= allowed + ENERGY_ATOL else codes.NOT_BALANCED


def take_up_inputs(d: Constants, u: Inputs, x: State, h: float) -> None:
    """Read the inputs of a step; apply a jump of the input speed or of a prescribed ratio."""
    handle_pending_event(d, x)
    jump = read_inputs(d, u, x, h)
    if abs(jump) <= SPEED_RTOL * (abs(x.omega1) + abs(x.alpha1) * h + abs(x.omega2) + abs(x.omega3)):
        x.omega1 += jump  # Round-off; a jump would open freewheels
        jump = 0.0
    if jump == 0.0 and (d.fidelity != codes.KINEMATIC or x.omega2 == d.kinematic_ratio * x.omega1):
        return
    if d.fidelity != codes.AVERAGED:
        x.torques_continue = 0.0
        x.input_jump, x.output_jump = jump_input(d, x, jump)
    elif takes_up_jump(d, x, jump, h):
        x.alpha1 += jump / h
    else:
        x.input_jump = jump_averaged(d, x, jump)


def finish_step(d: Constants, x: State, w: Workspace, start1: float) -> int:
    """Write means, twist and energies at the end of a step; return OK if they are finite and balance.

    Args:
        d: Constants.
        x: State at the end of the step, written.
        w: Workspace with the state before the step.
        start1: Speed of link 1 after a jump at the beginning, rad/s.
    """
    if d.by_torque != 0.0:
        if d.fidelity != codes.AVERAGED:
            update_alpha1(d, x)
        x.input_impulse = x.drive_torque * x.length
    else:
        x.omega1 = start1 + x.alpha1 * x.length
    if d.fidelity == codes.KINEMATIC:
        impose_ratio(d, x)
    write_means(d, x, x.length)
    if d.rigid_shaft != 0.0:
        x.twist = shaft_twist(d, x)
    if not is_finite(x):
        return codes.NOT_FINITE
    if d.fidelity < codes.RIGID:
        return codes.OK  # Kinematic motion is prescribed; averaged energies balance by construction
    stored = stored_energy(d, x)
    return audit(d, x, w.before, stored, w.tolerance)
