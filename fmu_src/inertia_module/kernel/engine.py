"""A communication step of the module with its pulses, from event to event.

The contact mode is chosen, a solver follows it to the next event or to the end of the step, and so on.
"""

from .accumulate import add, copy
from .codes import AVERAGED, DRIVING, KINEMATIC, OK, STEP_TOO_SMALL, TOO_MANY_SWITCHES, TOO_MUCH_WORK
from .equations.choice import GOES_ON, choose_next_states, choose_states, switch_states
from .equations.motion import evaluate, recall, take_state
from .equations.states import GEARED
from .events.advance import advance_general
from .events.kinematic import advance_kinematic, keep_ratio, prescribe
from .links import fastest_own_rate, prescribed_at_input

# share of a communication step that it has at least, where it ends at a switch
SHORTEST = 1e-9
# evaluations that one communication step may take before it is abandoned
MAX_EVALUATIONS = 5e7
# ... contact switches, besides those per turn of the highest harmonic: a pulse has about four
SWITCHES_ALLOWED, SWITCHES_PER_PULSE = 1000.0, 64.0
# ... events in a row that leave the mode as it was
STALLS_ALLOWED = 100


def solve_now(d, x):
    """Accelerations and torques in the present mode, into d.machine."""
    if x.output_state == GEARED:
        prescribe(d, x, 0.0)
        return
    take_state(d, x)
    if x.rates_cached != 0.0:
        recall(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)


def follow_torque(d, x):
    """Take over the acceleration of link 1 that its torque gives it now, where that is given."""
    if d.by_torque != 0.0:
        solve_now(d, x)
        x.alpha1 = d.machine.alpha1


def follow_parameters(d, x):
    """Write what parameters prescribe at once: the prescribed speed of link 2, or contact mode and alpha1."""
    if d.fidelity == KINEMATIC:
        keep_ratio(d, x)
        x.mode = DRIVING
    elif d.fidelity != AVERAGED:
        choose_states(d, x, 0.0)
        follow_torque(d, x)


def switch_now(d, x):
    """Carry out the switch that the last step has stopped at, if it has."""
    if x.switching == 0.0:
        return
    x.step_evaluations = 0.0
    choose_next_states(d, x)
    x.evaluations += x.step_evaluations
    x.switching = 0.0
    x.torques_continue = 1.0
    follow_torque(d, x)


def run_events(d, x, w, h):
    """Advance the links and the output by h from event to event, or to the first one. Returns a status."""
    if h > MAX_EVALUATIONS * d.max_step:
        return TOO_MUCH_WORK  # each internal step takes an evaluation or more
    start1 = x.omega1
    w.prescribed = prescribed_at_input(d, x)
    w.load = x.load_torque
    time = 0.0
    low = 0.0
    travel = 0.0
    stalls = 0
    if x.torques_continue == 0.0 or x.prescribed != w.prescribed or x.load_prescribed != w.load:
        x.rates_cached = 0.0
        switch_states(d, x, GOES_ON)
    if d.losses != 0.0:
        x.rates_cached = 0.0  # losses and guards are not kept from one communication step to the next
    x.torques_continue = 0.0
    x.prescribed = w.prescribed
    x.load_prescribed = w.load
    event = False
    while time < h:
        remaining = (h - time) - low
        speeds = abs(x.omega1) + abs(x.omega2)
        if x.output_state == GEARED:
            passed = advance_kinematic(d, x, w, remaining)
        else:
            passed, event = advance_general(d, x, w, remaining)
        if passed < 0.0:
            return STEP_TOO_SMALL
        if passed >= remaining:
            time = h
        else:
            time, low = add(time, low, passed)
        if d.by_torque == 0.0:
            x.omega1 = start1 + w.prescribed * time
            x.omega1_low = 0.0
        travel += passed * d.k * (speeds + abs(x.omega1) + abs(x.omega2))
        if d.elastic != 0.0:
            travel += passed * fastest_own_rate(d, x)
        if event:
            x.rates_cached = 0.0
            if w.stops != 0.0:
                copy(w.kept.numbers, x.numbers)
            changed = choose_next_states(d, x)
            switched = x.mode != w.kept.mode or x.slip_sign != w.kept.slip_sign
            if changed and switched and w.stops != 0.0 and time > SHORTEST * h:
                copy(x.numbers, w.kept.numbers)
                x.switching = 1.0
                x.length = time
                return OK
            stalls = 0 if changed else stalls + 1
            allowed = SWITCHES_PER_PULSE * d.harmonic * travel
            switches = x.switches - w.before.switches
            if stalls > STALLS_ALLOWED + allowed or switches > SWITCHES_ALLOWED + allowed:
                return TOO_MANY_SWITCHES
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    x.torques_continue = 0.0 if event else 1.0
    return OK
