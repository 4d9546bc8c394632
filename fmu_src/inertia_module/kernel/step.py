"""Start, and advance by a communication step, whose energies are looked at before it is answered.

What the input has put in goes out, is lost or is stored. Whatever has gone wrong in a step that nobody has
thought of, energy from nowhere, a freewheel that let go too late, shows in their balance.
"""

import math

from . import codes
from .accumulate import TWO_PI, clear, copy, total, turn_output, wrap_drive_angle
from .averaged.run import end_step, jump_averaged, run_averaged, speed_at_start, takes_up_jump
from .averaged.torque_map import build_map
from .derive import derive
from .engine import follow_parameters, follow_torque, run_events, solve_now, switch_now
from .equations.satellites import jams
from .events.kinematic import keep_ratio
from .impulse import jump_input
from .inputs import begin, check_hold, check_inputs, check_step, input_speed
from .links import fastest_own_rate, is_stiff
from .outputs import is_audited, stored_energy, write_late_outputs, write_outputs

# share of the tolerance that a step is tried again with whose energies do not balance
MORE_CARE = 1e-3
# share of the energies of the step and of the speeds that may be missing: so many tolerances, but neither
# rounding nor a tenth
TOLERANCES = 1e3
LEAST = 1e-6
MOST = 0.1
# J: less than that is rounding of any machine that moves
NOTHING = 1e-30
# tolerance of a step whose results are to be differenced
PRECISE = 1e-11
# share of the speeds by which a given one that the last step should have come to misses it by rounding
SAME_SPEED = 1e-14
# phase, rad, in which torques change as rounding of momenta does their means
INSTANT = 1e-8


def check_parameters(p, d):
    """Derive the constants and check the parameters together. Returns a status."""
    status = derive(p, d)
    return codes.JAMMED if status == codes.OK and d.losses + d.lossy != 0.0 and jams(d) else status


def check(p, d, u):
    """Derive the constants and check parameters and inputs. Returns a status."""
    status = check_parameters(p, d)
    return check_inputs(u) if status == codes.OK else status


def start(p, d, u, x, y, w):
    """Derive the constants and set state and outputs at the end of initialisation. Returns a status."""
    status = check(p, d, u)
    if status != codes.OK:
        return status
    if d.fidelity == codes.AVERAGED:
        status = build_map(p, d, w)
        if status != codes.OK:
            return status
    clear(x.numbers)
    x.omega1 = input_speed(u)
    x.held_input = x.omega1
    x.load_torque = u.load_torque
    x.drive_torque = u.drive_torque
    x.q = d.drive_angle_start
    wrap_drive_angle(d, x)
    x.omega2 = d.omega2_start
    x.omega3 = d.omega_out_start
    # a freewheel that overruns has done so before
    x.play_housing = d.housing_engagement_angle if x.omega2 > 0.0 else 0.0
    x.play_output = d.output_engagement_angle if x.omega3 > x.omega2 else 0.0
    if d.fidelity == codes.AVERAGED:
        x.omega1 = speed_at_start(d, x)
        end_step(d, x)
        x.omega1 = x.held_input  # the map has it but for rounding
        x.switches = 0.0
    else:
        follow_parameters(d, x)
    x.energy_start = stored_energy(d, x)
    x.energy_stored = x.energy_start
    write_outputs(x, y)
    write_late_outputs(d, x, y)
    return codes.OK


def tune(p, d, x, w):
    """Derive the constants anew from parameters that have changed between steps. Returns a status.

    What the state knows of the last step no longer holds; with a status other than OK it is left as it was.
    """
    status = check_parameters(p, d)
    if status == codes.OK and d.fidelity == codes.AVERAGED:
        status = build_map(p, d, w)
    if status == codes.OK:
        switch_now(d, x)
        x.torques_continue = 0.0
        x.rates_cached = 0.0
    return status


def is_instant(d, x, h):
    """Tell whether impulses of the step are those of the torques at its end, but for rounding of momenta.

    These are then in d.machine.
    """
    m = d.machine
    fastest = abs(x.omega1) + abs(x.omega2) + abs(x.omega3) + abs(x.relative)
    swings = fastest_own_rate(d, x) if d.elastic != 0.0 else 0.0
    if d.fidelity == codes.AVERAGED or not h * (d.harmonic * d.k * fastest + swings) < INSTANT:
        return False
    solve_now(d, x)
    missing = abs(x.input_impulse - h * m.drive) + abs(x.housing_impulse - h * m.housing)
    missing += abs(x.output_impulse - h * m.output)
    return missing <= SAME_SPEED * fastest * (d.J1 + m.i + d.k * d.k * m.g + d.J2 + d.J3)


def pass_mesh(d, x, output):
    """Impulse that the mesh has passed to link 2, by its momentum: J2 omega2' = M2 - b2 omega2 - Tc + Th."""
    x.mesh_impulse = output - x.housing_impulse
    if d.fidelity != codes.AVERAGED:  # there what it gains is the pulses'
        x.mesh_impulse += d.J2 * (x.omega2 - x.begin_omega2)
    if d.viscous != 0.0:
        turned1 = x.theta1 - x.begin_theta1 + TWO_PI * (x.input_turns - x.begin_input_turns)
        turned = x.q - x.begin_q + TWO_PI * (x.drive_turns - x.begin_drive_turns)
        x.mesh_impulse += d.b2 * (turned1 - turned / d.k)


def end(d, x, h, jump, input_jump, output_jump):
    """Means over the step, all impulses included; where they cannot be told the torques of its end."""
    pass_mesh(d, x, output_jump + x.output_impulse)
    if jump == 0.0 and is_instant(d, x, h):
        m = d.machine
        x.input_impulse, x.mesh_impulse, x.housing_impulse = h * m.drive, h * m.mesh, h * m.housing
        x.output_impulse = h * m.output
        x.output_square = x.output_impulse * (x.output_impulse / h)
    x.input_torque_mean = (input_jump + x.input_impulse) / h
    x.output_torque_mean = (output_jump + x.output_impulse) / h
    mean = x.output_impulse / h
    variance = x.output_square / h - mean * mean
    x.torque_ripple = math.sqrt(variance) if variance > 0.0 else 0.0
    turn_output(x)
    x.evaluations += x.step_evaluations


def is_finite(x):
    """Tell whether the motion, its energies and its means are: all else follows from them."""
    motion = (abs(x.q) + abs(x.theta1)) + (abs(x.omega2) + abs(x.omega3))
    shaft = (abs(x.relative) + abs(x.twist)) + abs(x.omega1)
    energies = (abs(x.energy_in) + abs(x.energy_out)) + abs(total(x.lost))
    means = abs(x.input_torque_mean) + (abs(x.output_torque_mean) + abs(x.torque_ripple))
    return (motion + shaft) + (energies + means) < 1e300


def advance(d, u, x, y, w, h, operation):
    """Advance by the communication step h, s, or to the first switch in it (operation STEP_TO_SWITCH).

    A status other than OK leaves state and outputs as they were.

    Args:
        operation: that asks for it; with STEP_ONLY and STEP_TO_SWITCH the late outputs stay as they were,
            with STEP_PRECISELY differences of results are free of the noise of the tolerance.
    """
    status = check_step(u, h)
    if status == codes.OK and d.drive == codes.DRIVE_SPEED:
        status = check_hold(d.input_hold, x, u.omega1, u.omega1_rate_given, h)
    if status != codes.OK:
        return status
    copy(w.before.numbers, x.numbers)
    w.tolerance = min(d.tolerance, PRECISE) if operation == codes.STEP_PRECISELY else d.tolerance
    status = run(d, u, x, w, h)
    if status == codes.NOT_BALANCED:
        copy(x.numbers, w.before.numbers)
        w.tolerance = max(MORE_CARE * w.tolerance, 1e-14)
        status = run(d, u, x, w, h)
    if status != codes.OK:
        copy(x.numbers, w.before.numbers)
        return status
    write_outputs(x, y)
    if operation != codes.STEP_ONLY and operation != codes.STEP_TO_SWITCH:
        write_late_outputs(d, x, y)
    return codes.OK


def change(after, after_low, before, before_low):
    """Change of a compensated sum."""
    return (after - before) + (after_low - before_low)


def audit(d, x, before, stored, tolerance):
    """Tell whether the energies of the step balance: OK or NOT_BALANCED.

    Args:
        before: state before the step. stored: energy after it, J, kept in x. tolerance: of the step.
    """
    put_in = change(x.energy_in, x.energy_in_low, before.energy_in, before.energy_in_low)
    put_out = change(x.energy_out, x.energy_out_low, before.energy_out, before.energy_out_low)
    lost = x.step_lost
    missing = put_in - put_out - lost - (stored - before.energy_stored)
    energies = abs(put_in) + abs(put_out) + abs(lost) + abs(stored) + abs(before.energy_stored)
    x.energy_stored = stored
    fastest = max(abs(x.omega1), abs(before.omega1))
    share = max(LEAST, min(TOLERANCES * tolerance, MOST))
    slow = share * fastest  # speeds that may be missing: of a slow swing all that there is
    allowed = share * energies + (d.J1 + d.J2 + d.J3 + d.J4) * slow * slow
    return codes.OK if abs(missing) <= allowed + NOTHING else codes.NOT_BALANCED


def apply_jump(d, u, x, h, jump):
    """Apply a jump of the speed of link 1, or of a prescribed ratio. Returns impulses of M1 and Tc, N m s."""
    if d.fidelity != codes.AVERAGED:
        x.torques_continue = 0.0
        return jump_input(d, x, jump, d.fidelity == codes.ELASTIC and is_stiff(d, x, u.omega1))
    if takes_up_jump(d, x, jump, h):
        x.alpha1 += jump / h
        return 0.0, 0.0
    return jump_averaged(d, x, jump), 0.0


def run(d, u, x, w, h):
    """Advance the state by h under the inputs, and look at its energies. Returns a status."""
    switch_now(d, x)
    jump = begin(d, u, x, h)
    if abs(jump) <= SAME_SPEED * (abs(x.omega1) + abs(x.alpha1) * h + abs(x.omega2) + abs(x.omega3)):
        x.omega1 += jump  # (as a jump it would let freewheels go)
        jump = 0.0
    input_jump = output_jump = 0.0
    if jump != 0.0 or (d.fidelity == codes.KINEMATIC and x.omega2 != d.kinematic_ratio * x.omega1):
        input_jump, output_jump = apply_jump(d, u, x, h, jump)
    start1 = x.omega1
    if d.fidelity == codes.AVERAGED:
        status = run_averaged(d, x, w, h)
    else:
        status = run_events(d, x, w, h)
    if status != codes.OK:
        return status
    if d.by_torque == 0.0:
        x.omega1 = start1 + x.alpha1 * x.length
        x.omega1_low = 0.0
        if d.fidelity == codes.KINEMATIC:
            keep_ratio(d, x)
    else:
        if d.fidelity != codes.AVERAGED:
            follow_torque(d, x)
        x.input_impulse = x.drive_torque * x.length
    end(d, x, x.length, jump, input_jump, output_jump)
    if not is_finite(x):
        return codes.NOT_FINITE
    return audit(d, x, w.before, stored_energy(d, x), w.tolerance) if is_audited(d) else codes.OK
