"""A communication step of the module with its pulses, from event to event.

The contact mode is chosen, a solver follows it to the next event or to the end of the step, and so on.
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

# share of a communication step that it has at least, where it ends at a switch
SHORTEST = 1e-9
# evaluations that one communication step may take before it is abandoned
MAX_EVALUATIONS = 5e7
# ... contact switches, besides those per turn of the highest harmonic: a pulse has about four
SWITCHES_ALLOWED, SWITCHES_PER_PULSE = 1000.0, 64.0
# ... events in a row that leave the mode as it was
STALLS_ALLOWED = 100


def solve_now(d: Constants, x: State) -> None:
    """Accelerations and torques in the present mode, into d.machine."""
    if x.output_state == RATIO_PRESCRIBED:
        prescribe_motion(d, x, 0.0)
        return
    load_state(d, x)
    if x.rates_cached != 0.0:
        copy_accelerations(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)


def follow_torque(d: Constants, x: State) -> None:
    """Set the acceleration of link 1 from the torque at this instant, if a torque drives it."""
    if d.by_torque != 0.0:
        solve_now(d, x)
        x.alpha1 = d.machine.alpha1


def follow_parameters(d: Constants, x: State) -> None:
    """Apply parameters at an instant: the prescribed speed of link 2, or contact mode and alpha1."""
    if d.fidelity == KINEMATIC:
        impose_ratio(d, x)
        x.mode = DRIVING
    elif d.fidelity != AVERAGED:
        select_mode(d, x, 0.0)
        follow_torque(d, x)


def switch_now(d: Constants, x: State) -> None:
    """Handle the event before which the last step has stopped, if there is one."""
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
        x.rates_cached = 0.0  # losses and guards are not kept from one communication step to the next
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
    allowed = SWITCHES_PER_PULSE * d.harmonic * travel
    switches = x.switches - w.before.switches
    return n_unchanged > STALLS_ALLOWED + allowed or switches > SWITCHES_ALLOWED + allowed


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
            has_changed, stops = switch_or_stop(d, x, w, time > SHORTEST * h)
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
