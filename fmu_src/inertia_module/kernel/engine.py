"""A communication step: the event loop of the module with its pulses, and the loop of fidelity kinematic.

run_events makes internal steps (events.advance), each up to the first event in it, and selects the contact
mode after each event.
"""

from .accumulate import copy
from .codes import AVERAGED, DRIVING, KINEMATIC, OK, STEP_TOO_SMALL, TOO_MUCH_WORK
from .equations.choice import CONTINUATION_BIAS, select_mode, select_mode_after_event, switch_mode
from .equations.motion import copy_accelerations, evaluate, load_state
from .equations.states import RATIO_PRESCRIBED
from .events.advance import advance_to_event
from .events.kinematic import advance_kinematic, impose_ratio, prescribe_motion
from .links import prescribed_at_input
from .records import Constants, State, Workspace

MIN_STEP_FRACTION = 1e-9  # Of the communication step, before it may end at a change of the contact mode
MAX_EVALUATIONS = 5e7  # Of the equations of motion in a communication step


def solve_present(d: Constants, x: State) -> None:
    """Write accelerations and torques in the present contact mode to d.machine."""
    if x.output_state == RATIO_PRESCRIBED:
        prescribe_motion(d, x, 0.0)
        return
    load_state(d, x)
    if x.rates_cached != 0.0:
        copy_accelerations(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)


def update_alpha1(d: Constants, x: State) -> None:
    """Write the present acceleration of link 1 to the state if its torque is prescribed."""
    if d.by_torque != 0.0:
        solve_present(d, x)
        x.alpha1 = d.machine.alpha1


def update_motion(d: Constants, x: State) -> None:
    """Update speeds or the contact mode after a change of parameters.

    Fidelity kinematic: the prescribed speed of link 2. Rigid and elastic: the contact mode and alpha1.
    """
    if d.fidelity == KINEMATIC:
        impose_ratio(d, x)
        x.mode = DRIVING
    elif d.fidelity != AVERAGED:
        select_mode(d, x, 0.0)
        update_alpha1(d, x)


def handle_pending_event(d: Constants, x: State) -> None:
    """Select the contact mode if the last step has stopped just before an event."""
    if x.event_pending == 0.0:
        return
    x.step_evaluations = 0.0
    select_mode_after_event(d, x)
    x.evaluations += x.step_evaluations
    x.event_pending = 0.0
    x.torques_continue = 1.0
    update_alpha1(d, x)


def begin_events(d: Constants, x: State, w: Workspace) -> None:
    """Begin the event loop; select the contact mode again if its torques have changed."""
    w.prescribed = prescribed_at_input(d, x)
    w.load = x.load_torque
    if x.torques_continue == 0.0:
        x.rates_cached = 0.0
        switch_mode(d, x, CONTINUATION_BIAS)
    if d.losses != 0.0:
        x.rates_cached = 0.0  # Rates of losses and event indicators are not part of the state
    x.torques_continue = 0.0


def switch_or_stop(d: Constants, x: State, w: Workspace, can_stop: bool) -> bool:
    """Select the contact mode after an event, or stop just before it changes.

    Args:
        d: Constants.
        x: State.
        w: Workspace; ``stops`` is read, ``saved`` is written.
        can_stop: True if the communication step may end here.

    Returns:
        True if the communication step ends just before the change.
    """
    x.rates_cached = 0.0
    if w.stops != 0.0:
        copy(w.saved.numbers, x.numbers)
    has_changed = select_mode_after_event(d, x)
    if not has_changed:
        x.step_size *= 0.5  # The dense output was too inaccurate for the event indicators
    if w.stops == 0.0 or not can_stop or not has_changed:
        return False
    if x.mode == w.saved.mode and x.slip_sign == w.saved.slip_sign:
        return False  # A freewheel has changed its state but not whether it transmits torque
    copy(x.numbers, w.saved.numbers)
    x.event_pending = 1.0
    return True


def run_events(d: Constants, x: State, w: Workspace, h: float) -> int:
    """Integrate from event to event over the time h, s, or up to the first event, and return the status."""
    if h > MAX_EVALUATIONS * d.max_step:
        return TOO_MUCH_WORK  # Each internal step needs at least one evaluation
    start1 = x.omega1
    time = 0.0
    event = False
    begin_events(d, x, w)
    while time < h:
        passed, event = advance_to_event(d, x, w, h - time)
        if passed < 0.0:
            return STEP_TOO_SMALL
        time = h if passed >= h - time else time + passed
        if d.by_torque == 0.0:
            x.omega1 = start1 + w.prescribed * time
        if event and switch_or_stop(d, x, w, time > MIN_STEP_FRACTION * h):
            x.length = time
            return OK
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    x.torques_continue = 0.0 if event else 1.0
    return OK


def run_kinematic(d: Constants, x: State, w: Workspace, h: float) -> int:
    """Advance a module of fidelity kinematic by the time h, s, and return the status."""
    if h > MAX_EVALUATIONS * d.max_step:
        return TOO_MUCH_WORK
    start1 = x.omega1
    time = 0.0
    w.prescribed = x.alpha1
    while time < h:
        passed = advance_kinematic(d, x, w, h - time)
        time = h if passed >= h - time else time + passed
        x.omega1 = start1 + x.alpha1 * time
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    return OK
