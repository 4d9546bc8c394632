"""A communication step of the module with its pulses, from event to event.

run_events is the event loop. It selects a contact mode, advances to the first event, and repeats this until
the end of the step.
"""

from .accumulate import copy
from .codes import AVERAGED, DRIVING, KINEMATIC, OK, STEP_TOO_SMALL, TOO_MANY_SWITCHES, TOO_MUCH_WORK
from .equations.choice import CONTINUATION_BIAS, select_mode, select_mode_after_event, switch_mode
from .equations.motion import copy_accelerations, evaluate, load_state
from .equations.states import RATIO_PRESCRIBED
from .events.advance import advance_to_event
from .events.kinematic import advance_kinematic, impose_ratio, prescribe_motion
from .links import fastest_own_rate, prescribed_at_input
from .records import Constants, State, Workspace

MIN_STEP_FRACTION = 1e-9  # Of the communication step, before it may end at a change of the contact mode
MAX_EVALUATIONS = 5e7  # Of the equations of motion in a communication step
# Maximum number of changes of the contact mode in a communication step: a constant, and a number per radian
# of the highest harmonic (a pulse has about four changes)
MAX_SWITCHES, MAX_SWITCHES_PER_RAD = 1000.0, 64.0
MAX_UNCHANGED = 100  # Events in a row that leave the contact mode unchanged


def solve_now(d: Constants, x: State) -> None:
    """Write accelerations and torques in the present contact mode to d.machine."""
    if x.output_state == RATIO_PRESCRIBED:
        prescribe_motion(d, x, 0.0)
        return
    load_state(d, x)
    if x.rates_cached != 0.0:
        copy_accelerations(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)


def follow_torque(d: Constants, x: State) -> None:
    """Write the present acceleration of link 1 to the state if a torque drives it."""
    if d.by_torque != 0.0:
        solve_now(d, x)
        x.alpha1 = d.machine.alpha1


def follow_parameters(d: Constants, x: State) -> None:
    """Write the prescribed speed of link 2, or the contact mode and alpha1, after a change of parameters."""
    if d.fidelity == KINEMATIC:
        impose_ratio(d, x)
        x.mode = DRIVING
    elif d.fidelity != AVERAGED:
        select_mode(d, x, 0.0)
        follow_torque(d, x)


def switch_now(d: Constants, x: State) -> None:
    """Select the contact mode if the last step has stopped just before an event."""
    if x.switching == 0.0:
        return
    x.step_evaluations = 0.0
    select_mode_after_event(d, x)
    x.evaluations += x.step_evaluations
    x.switching = 0.0
    x.torques_continue = 1.0
    follow_torque(d, x)


def begin_events(d: Constants, x: State, w: Workspace) -> None:
    """Read the inputs of the step; select the contact mode again if they have changed."""
    w.prescribed = prescribed_at_input(d, x)
    w.load = x.load_torque
    if x.torques_continue == 0.0 or x.prescribed != w.prescribed or x.load_prescribed != w.load:
        x.rates_cached = 0.0
        switch_mode(d, x, CONTINUATION_BIAS)
    if d.losses != 0.0:
        x.rates_cached = 0.0  # Rates of losses and event indicators are not part of the state
    x.torques_continue = 0.0
    x.prescribed = w.prescribed
    x.load_prescribed = w.load


def switch_or_stop(d: Constants, x: State, w: Workspace, can_stop: bool) -> tuple[bool, bool]:
    """Select the contact mode after an event, or stop just before it changes.

    Args:
        d: constants.
        x: state.
        w: workspace.
        can_stop: whether the communication step may end here.

    Returns:
        (whether the mode has changed, whether the communication step ends just before that).
    """
    x.rates_cached = 0.0
    if w.stops != 0.0:
        copy(w.kept.numbers, x.numbers)
    has_changed = select_mode_after_event(d, x)
    if not has_changed:
        x.step_size *= 0.5  # the dense output is too coarse for the event indicators
    is_switch = x.mode != w.kept.mode or x.slip_sign != w.kept.slip_sign
    stops = w.stops != 0.0 and can_stop and has_changed and is_switch
    if stops:
        copy(x.numbers, w.kept.numbers)
        x.switching = 1.0
    return has_changed, stops


def phase_passed(d: Constants, x: State, passed: float, speeds: float) -> float:
    """Return the phase by which pinion shafts and elastic shaft have advanced, rad.

    Args:
        d: constants.
        x: state at the end of the time.
        passed: time, s.
        speeds: sum of the speeds of links 1 and 2 at the beginning, rad/s.
    """
    phase = passed * d.k * (speeds + abs(x.omega1) + abs(x.omega2))
    return phase + passed * fastest_own_rate(d, x) if d.elastic != 0.0 else phase


def has_too_many_switches(d: Constants, x: State, w: Workspace, travel: float, n_unchanged: int) -> bool:
    """Return True if there were more events than the pulses of this communication step can cause.

    Args:
        d: Constants.
        x: State.
        w: Workspace with the state before the step.
        travel: Phase since the beginning of the step, rad.
        n_unchanged: Number of events in a row that have not changed the contact mode.
    """
    allowed = MAX_SWITCHES_PER_RAD * d.harmonic * travel
    switches = x.switches - w.before.switches
    return n_unchanged > MAX_UNCHANGED + allowed or switches > MAX_SWITCHES + allowed


def run_events(d: Constants, x: State, w: Workspace, h: float) -> int:
    """Integrate from event to event over the time h, s, or up to the first event, and return the status."""
    if h > MAX_EVALUATIONS * d.max_step:
        return TOO_MUCH_WORK  # Each internal step takes an evaluation or more
    start1 = x.omega1
    time = travel = 0.0
    n_unchanged = 0
    event = False
    begin_events(d, x, w)
    while time < h:
        remaining = h - time
        speeds = abs(x.omega1) + abs(x.omega2)
        if x.output_state == RATIO_PRESCRIBED:
            passed = advance_kinematic(d, x, w, remaining)
        else:
            passed, event = advance_to_event(d, x, w, remaining)
        if passed < 0.0:
            return STEP_TOO_SMALL
        time = h if passed >= remaining else time + passed
        if d.by_torque == 0.0:
            x.omega1 = start1 + w.prescribed * time
        travel += phase_passed(d, x, passed, speeds)
        if event:
            has_changed, stops = switch_or_stop(d, x, w, time > MIN_STEP_FRACTION * h)
            if stops:
                x.length = time
                return OK
            n_unchanged = 0 if has_changed else n_unchanged + 1
            if has_too_many_switches(d, x, w, travel, n_unchanged):
                return TOO_MANY_SWITCHES
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    x.torques_continue = 0.0 if event else 1.0
    return OK
