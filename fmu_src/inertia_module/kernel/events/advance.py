"""One internal step of the module with its pulses, up to the first event in it.

advance_to_event makes a step of allowed error (step_size), locates the first event in it (location), adds the
changes up to this event to the state and handles the event.
"""

from ..accumulate import add_loss, wrap_drive_angle, wrap_input_angle
from ..codes import NO_EVENT
from ..equations.choice import enforce_equal_speeds
from ..equations.losses import FREEWHEEL, MESH, SHAFT, VISCOUS
from ..equations.motion import copy_accelerations, load_state
from ..equations.satellites import gravity_potential, toggle_bit
from ..equations.states import ENGAGED_COMPLIANT, IN_BACKLASH, LOCKED, OVERRUNNING, is_open
from ..fields import N_CAUSES
from ..impulse import apply_plastic_impact, has_rigid_housing_contact
from ..layout import imbalance_position
from ..links import energy_of_links, momentum_of_links
from ..loads import include_last_step, store_beginning
from ..records import Constants, Integrated, State, Workspace
from ..tableau import (
    NODES,
    STAGES_BY_TIME,
    last_stage,
    parabola_extremum,
    stage_order_range,
)
from . import guards
from .energy import balance, energy_made, work_of_balancer
from .location import first_event
from .stages import cut_step, reuse_end, solve_motion, store_rates
from .step_size import longest_step, make_accepted_step

FIRST_PHASE = 1.0  # rad of the highest harmonic, of the first step in a new contact mode
MAX_REPEATS = 20  # Attempts at a step that makes energy, each half as long as the last
MIN_PLAY = 1e-300  # rad, minimum remaining engagement angle before the event at its end


def remaining_play(state: float, play: float, turned: float, engagement_angle: float) -> float:
    """Return the remaining engagement angle of a freewheel after a step, rad.

    It is between MIN_PLAY and the whole angle until the event at its end. In a locked freewheel it does not
    change, because a locked freewheel turns only by round-off.

    Args:
        state: State of the freewheel.
        play: Remaining engagement angle before the step, rad.
        turned: Angle that the freewheel has turned back in the step, rad.
        engagement_angle: Whole angle, rad.
    """
    if not is_open(state):
        return play
    return max(MIN_PLAY if state == IN_BACKLASH else 0.0, min(play - turned, engagement_angle))


def update_freewheel_angles(d: Constants, x: State, change: Integrated) -> None:
    """Update wind-up and remaining engagement angle by the angles that the freewheels have turned back."""
    housing, output = x.housing_state, x.output_state
    if housing == ENGAGED_COMPLIANT:
        x.wound_housing += change.wound_housing
    if output == ENGAGED_COMPLIANT:
        x.wound_output += change.wound_output
    x.play_housing = remaining_play(housing, x.play_housing, change.wound_housing, d.housing_engagement_angle)
    x.play_output = remaining_play(output, x.play_output, change.wound_output, d.output_engagement_angle)


def add_changes(d: Constants, x: State, w: Workspace) -> None:
    """Add the changes over the present step to the state and to its sums."""
    change = w.change
    if d.averaged == 0.0:
        x.last_step, x.last_turn = w.step, change.q
    x.q += change.q
    wrap_drive_angle(d, x)
    x.theta1 += change.theta1
    wrap_input_angle(x)
    x.omega1 += change.omega1
    x.omega2 += change.omega2
    if d.elastic + d.rigid_shaft != 0.0:
        add_loss(x, SHAFT, -work_of_balancer(d, x, change))
    x.omega3 += change.omega3
    if d.elastic != 0.0:
        x.twist += change.twist
        x.relative += change.relative
        add_loss(x, SHAFT, change.lost[SHAFT])
    work = change.work_in if d.by_torque == 0.0 else w.prescribed * change.theta1
    x.energy_in += work
    x.energy_out += w.load * change.turned3
    if d.viscous != 0.0:
        add_loss(x, VISCOUS, change.lost[VISCOUS])
    if d.losses != 0.0:
        update_freewheel_angles(d, x, change)
        for cause in range(MESH, N_CAUSES):
            add_loss(x, cause, change.lost[cause])
    x.input_impulse += change.drive
    x.housing_impulse += change.housing
    x.output_impulse += change.output
    x.output_square += change.square
    x.turned3 += change.turned3


def include_in_peaks(
    x: State, output: float, housing: float, housing_slip: float, output_slip: float
) -> None:
    """Include an instant in the peaks of torques, N m, and of slips of freewheels that overrun, rad/s.

    Args:
        x: State; the peaks are updated.
        output: Torque of the output freewheel, N m.
        housing: Torque of the housing freewheel, N m.
        housing_slip: Slip of the housing freewheel, rad/s.
        output_slip: Slip of the output freewheel, rad/s.
    """
    x.torque_peak = max(x.torque_peak, abs(output))
    x.housing_torque_peak = max(x.housing_torque_peak, abs(housing))
    if x.housing_state == OVERRUNNING:
        x.housing_slip_peak = max(x.housing_slip_peak, housing_slip)
    if x.output_state == OVERRUNNING:
        x.output_slip_peak = max(x.output_slip_peak, output_slip)


def include_step(x: State, w: Workspace, sigma: float) -> None:
    """Include the present step in the peaks: its stages, and the extrema of parabolas through three of them.

    Args:
        x: State; the peaks are updated.
        w: Workspace with the stages of the step.
        sigma: Fraction of the step that counts.
    """
    pair = int(w.pair)
    slip2, slip3 = w.indicators[guards.HOUSING].value, w.indicators[guards.OUTPUT].value
    for n in range(last_stage(pair) + 1):
        if NODES[pair + n] <= sigma:
            include_in_peaks(x, w.rates[n].output, w.rates[n].housing, slip2[n], slip3[n])
    first, count = stage_order_range(pair)
    for n in range(first, first + count - 2):
        i, j, k = int(STAGES_BY_TIME[n]), int(STAGES_BY_TIME[n + 1]), int(STAGES_BY_TIME[n + 2])
        t, u, v = NODES[pair + i], NODES[pair + j], NODES[pair + k]
        if u <= sigma:
            a, b, c = w.rates[i], w.rates[j], w.rates[k]
            include_in_peaks(
                x,
                parabola_extremum(t, u, v, a.output, b.output, c.output, sigma),
                parabola_extremum(t, u, v, a.housing, b.housing, c.housing, sigma),
                parabola_extremum(t, u, v, slip2[i], slip2[j], slip2[k], sigma),
                parabola_extremum(t, u, v, slip3[i], slip3[j], slip3[k], sigma),
            )


def count_loaded(d: Constants, x: State, w: Workspace) -> None:
    """Count the engagement of a freewheel that only its drag has locked, and that now transmits torque."""
    begin, end = w.rates[0], w.rates[last_stage(int(w.pair))]
    if d.housing_drag > 0.0 and x.housing_state == LOCKED and d.housing_engagement_angle == 0.0:
        x.housing_engagements += 1.0 if begin.housing <= 0.0 < end.housing else 0.0
    if d.output_drag > 0.0 and x.output_state == LOCKED and d.output_engagement_angle == 0.0:
        x.output_engagements += 1.0 if begin.output <= 0.0 < end.output else 0.0


def set_to_limit(d: Constants, x: State, which: int) -> None:
    """Set the speed whose event indicator has crossed zero exactly to its limit."""
    x.rates_cached = 0.0
    if which == guards.HOUSING or which == guards.HOUSING_BACK:
        x.omega2 = 0.0
        if x.output_state == LOCKED:
            x.omega3 = 0.0
    elif which == guards.OUTPUT or which == guards.OUTPUT_BACK:
        if x.housing_state == LOCKED or (has_rigid_housing_contact(d, x) and x.omega3 < 0.0):
            x.omega3 = 0.0
        x.omega2 = x.omega3
    elif x.housing_state == LOCKED:
        if d.by_torque != 0.0:
            x.omega1 = 0.0
    else:
        x.omega2 = x.omega1


def remove_negative_slips(d: Constants, x: State) -> None:
    """Set overrunning speeds that are negative by round-off exactly to their limits."""
    if d.housing_freewheel != 0.0 and x.housing_state == OVERRUNNING and x.omega2 < 0.0:
        set_to_limit(d, x, guards.HOUSING)
    if d.output_freewheel != 0.0 and x.output_state == OVERRUNNING and x.omega3 < x.omega2:
        set_to_limit(d, x, guards.OUTPUT)


def release_spring(d: Constants, x: State, which: int) -> None:
    """Set the wind-up of a freewheel that opens to 0. The energy of its spring is lost."""
    if which == guards.HOUSING and x.housing_state == ENGAGED_COMPLIANT:
        add_loss(x, FREEWHEEL, 0.5 * d.housing_stiffness * x.wound_housing * x.wound_housing)
        x.wound_housing = 0.0
    if which == guards.OUTPUT and x.output_state == ENGAGED_COMPLIANT:
        add_loss(x, FREEWHEEL, 0.5 * d.freewheel_stiffness * x.wound_output * x.wound_output)
        x.wound_output = 0.0


def begin_step(d: Constants, x: State, w: Workspace) -> None:
    """Write accelerations, torques and rates at the beginning of a step, or reuse the last results."""
    m = d.machine
    enforce_equal_speeds(x)
    load_state(d, x)
    if x.rates_cached != 0.0:
        copy_accelerations(m, x.now)
    else:
        solve_motion(d, x, w)
    if x.rates_cached != 0.0 and d.losses != 0.0:
        reuse_end(d, x, w)
    else:
        store_rates(d, x, w, 0)
    x.rates_cached = 0.0
    w.momentum = momentum_of_links(d, m.i, m.b, x.omega1, x.omega2)
    w.energy = energy_of_links(d, m.i, m.b, m.g, x.omega1, x.omega2)
    w.potential = 0.0
    if d.weight != 0.0:
        w.potential, _, _ = gravity_potential(d, imbalance_position(d, x.q, 0.0), x.theta1)
    store_beginning(d, x, m.omega1, m.alpha1, d.k * (m.omega1 - m.omega2), d.k * (m.alpha1 - m.alpha2))


def finish_changes(d: Constants, x: State, w: Workspace, sigma: float, has_event: bool) -> None:
    """Complete the changes over the present step, or over its part up to an event.

    The motion at the end is written to ``d.machine``.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State at the beginning of the step.
        w: Workspace with the step; it is cut to the part.
        sigma: Fraction of the step.
        has_event: True if an event ends it.
    """
    if has_event:
        cut_step(d, x, w, sigma)
    else:
        copy_accelerations(d.machine, x.now)
    if d.losses == 0.0:
        balance(d, x, w)


def accept_step(d: Constants, x: State, w: Workspace, sigma: float, has_event: bool) -> None:
    """Add the changes over the present step to the state, with its sums and peaks.

    Args:
        d: Constants; ``d.machine`` holds the end of the step.
        x: State, advanced.
        w: Workspace with the step and its changes.
        sigma: Fraction of the step before the cut.
        has_event: True if an event ends it.
    """
    x.rates_cached = 0.0 if has_event else 1.0
    add_changes(d, x, w)
    include_step(x, w, sigma)
    if has_event:
        m = d.machine
        include_in_peaks(x, m.output, m.housing, x.omega2, x.omega3 - x.omega2)
        include_last_step(d, x, x.omega1, m.alpha1, d.k * (x.omega1 - x.omega2), d.k * (m.alpha1 - m.alpha2))
    else:
        count_loaded(d, x, w)
    remove_negative_slips(d, x)


def engage(d: Constants, x: State, which: int) -> None:
    """Engage a freewheel at the end of its engagement angle, by an impact if it is rigid."""
    x.rates_cached = 0.0
    if which == guards.HOUSING:
        x.play_housing = 0.0
        x.housing_engagements += 1.0
        rigid = d.housing_stiffness == 0.0
    else:
        x.play_output = 0.0
        x.output_engagements += 1.0
        rigid = d.freewheel_stiffness == 0.0
    if rigid:
        apply_plastic_impact(d, x)


def handle_event(d: Constants, x: State, which: int) -> None:
    """Apply the immediate changes of an event: mesh sign, impact, or a speed that reaches its limit.

    Args:
        d: Constants.
        x: State; ``mode_ended`` and ``slip_reached_zero`` describe the event for select_mode_after_event.
        which: Number of the event indicator, or NO_EVENT.
    """
    x.mode_ended = 0.0
    x.slip_reached_zero = 0.0
    if which == guards.FLOW:
        x.flow_sign = -x.flow_sign
    elif which > guards.FLOW:
        x.tau6_signs = toggle_bit(x.tau6_signs, which - guards.TAU6)
    elif which != NO_EVENT:
        # The error estimate of the first step in a new contact mode may be far too low
        slip = d.harmonic * d.k * abs(x.omega1 - x.omega2)
        if x.step_size * slip > FIRST_PHASE:
            x.step_size = FIRST_PHASE / slip
        if guards.is_speed(x, which):
            x.slip_reached_zero = 1.0 if which == guards.SLIP and x.housing_state != LOCKED else 0.0
            if guards.is_play(x, which):
                engage(d, x, which)
            else:
                set_to_limit(d, x, which)
        else:
            x.mode_ended = 1.0
            release_spring(d, x, which)


def advance_to_event(d: Constants, x: State, w: Workspace, remaining: float) -> tuple[float, bool]:
    """Advance by one internal step, or to the first event in it.

    A step that makes more than the allowed energy is repeated with half its length.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State, advanced.
        w: Workspace with load, prescribed quantity of link 1 and tolerance.
        remaining: Time to the end of the communication step, s.

    Returns:
        Time passed, s, or -1 if no step is small enough; True if the contact mode may change now.
    """
    begin_step(d, x, w)
    limit = longest_step(d, x, remaining)
    sigma, which = 1.0, NO_EVENT
    for _ in range(MAX_REPEATS):
        if not make_accepted_step(d, x, w, remaining, limit):
            return -1.0, False
        copy_accelerations(x.now, d.machine)
        sigma, which = first_event(d, x, w)
        limit = 0.5 * w.step
        finish_changes(d, x, w, sigma, which != NO_EVENT)
        if energy_made(d, x, w) <= 1.0:
            break
    accept_step(d, x, w, sigma, which != NO_EVENT)
    handle_event(d, x, which)
    return w.step, which != NO_EVENT and which < guards.FLOW
