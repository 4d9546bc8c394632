"""The module with its pulses, step by step of an embedded pair or a stiff method up to the next event."""

from ..accumulate import add, add_loss, wrap_drive_angle, wrap_input_angle
from ..codes import NONE
from ..equations.choice import take_speeds
from ..equations.losses import FREEWHEEL, MESH, SHAFT, VISCOUS
from ..equations.motion import evaluate, recall, take_state
from ..equations.satellites import with_sign_changed
from ..equations.states import CLOSING, LOCKED, OPEN, WOUND, is_open, is_wound
from ..fields import CAUSES
from ..impulse import close_freewheels, holds_link2
from ..links import energy_of_links, momentum_of_links
from ..loads import INSIDE_PHASE, sample_load, see_load
from ..tableau import IN_ORDER, LONG, NODES, PARTS, SHORT, THIRDS, extremum, last_stage, order_of_stages
from . import guards
from .rosenbrock import set_part
from .search import end_at_event, first_event
from .stages import cut_step, keep_end, keep_rates, make_step, move, solve_motion, weighed_rate
from .step_size import AFRESH, longest_step, size_afresh, try_short_step, try_steps

# stages inside the step at which the force on the bearing is seen
SEEN = (5, 9, 10)
# least play that is one, rad
NO_PLAY = 1e-300
# how fast the longest step of the pair of order 5 is thought to grow while the other one is used
SHORT_GROWTH = 1.05


def balance(d, x, w):
    """Impulses and work of the step in hand by the balances, exact in its ends, without losses by load.

    M1 - Tc + Th is the rate of the angular momentum; what M1 does while link 2 is held is kinetic energy. A
    ramp of the input speed has its integrals.
    """
    change = w.change
    if d.elastic == 0.0 and x.output_state == LOCKED:
        change.output = d.J3 * change.omega3 + w.load * w.step + d.b3 * change.turned3
    m = d.machine  # (of its motion nothing is known here)
    omega1, omega2 = x.omega1 + change.omega1, x.omega2 + change.omega2
    passed = momentum_of_links(d, m.i, m.b, omega1, omega2) - w.momentum + change.output
    passed += d.b1 * change.theta1 + d.b2 * (change.theta1 - change.q / d.k)
    if d.by_torque != 0.0:
        change.housing = passed - w.prescribed * w.step
    elif w.prescribed == 0.0:
        change.drive = passed
        if x.housing_state == LOCKED:
            lost = (d.b1 + d.k * d.k * d.bq) * change.theta1
            gained = energy_of_links(d, m.i, m.b, m.g, omega1, omega2) - w.energy
            change.drive = gained / x.omega1 + lost if x.omega1 != 0.0 else 0.0
        change.housing = passed - change.drive
        change.work_in = x.omega1 * change.drive


def left_of_play(state, play, turned, engagement_angle):
    """Play of a freewheel, rad, that has turned back by so much.

    One that overruns has its whole play at most; one that closes has some left until that is an event. One
    that is locked does not turn but by rounding.
    """
    if not is_open(state):
        return play
    return max(NO_PLAY if state == CLOSING else 0.0, min(play - turned, engagement_angle))


def turn_back(d, x, change):
    """Take over by how much freewheels have turned back: into their springs, or out of their play."""
    housing, output = x.housing_state, x.output_state
    if housing == WOUND:
        x.wound_housing += change.wound_housing
    if output == WOUND:
        x.wound_output += change.wound_output
    x.play_housing = left_of_play(housing, x.play_housing, change.wound_housing, d.housing_engagement_angle)
    x.play_output = left_of_play(output, x.play_output, change.wound_output, d.output_engagement_angle)


def commit(d, x, w):
    """Take the step in hand over, with its sums."""
    change = w.change
    x.q, x.q_low = add(x.q, x.q_low, change.q)
    wrap_drive_angle(d, x)
    x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, change.theta1)
    wrap_input_angle(x)
    x.omega1, x.omega1_low = add(x.omega1, x.omega1_low, change.omega1)
    x.omega2, x.omega2_low = add(x.omega2, x.omega2_low, change.omega2)
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change.omega3)
    if d.elastic != 0.0:
        x.twist, x.twist_low = add(x.twist, x.twist_low, change.twist)
        x.relative, x.relative_low = add(x.relative, x.relative_low, change.relative)
        balancing = d.balancer * d.J4 * (x.omega3 - 0.5 * change.omega3) * change.omega3
        add_loss(x, SHAFT, change.lost[SHAFT] - balancing)
    work = change.work_in if d.by_torque == 0.0 else w.prescribed * change.theta1
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, w.load * change.turned3)
    if d.viscous != 0.0:
        add_loss(x, VISCOUS, change.lost[VISCOUS])
    if d.losses != 0.0:
        turn_back(d, x, change)
        for cause in range(MESH, CAUSES):
            add_loss(x, cause, change.lost[cause])
    x.input_impulse += change.drive
    x.housing_impulse += change.housing
    x.output_impulse += change.output
    x.output_square += change.square
    x.turned3 += change.turned3


def see_torques(x, output, housing):
    """Take torques of the freewheels at a moment into their peaks."""
    x.torque_peak = max(x.torque_peak, abs(output))
    x.housing_torque_peak = max(x.housing_torque_peak, abs(housing))


def see_slips(x, housing, output):
    """Take slips of the freewheels that overrun into their peaks."""
    if x.housing_state == OPEN:
        x.housing_slip_peak = max(x.housing_slip_peak, housing)
    if x.output_state == OPEN:
        x.output_slip_peak = max(x.output_slip_peak, output)


def see_peaks(x, w, sigma):
    """Take torques and slips of the freewheels up to this part of the step in hand into their peaks.

    They are those at its stages, and the extrema of parabolas through three stages in a row.
    """
    pair = int(w.pair)
    for n in range(last_stage(pair) + 1):
        if NODES[pair + n] <= sigma:
            see_torques(x, w.rates[n].output, w.rates[n].housing)
            see_slips(x, w.watched[guards.HOUSING].value[n], w.watched[guards.OUTPUT].value[n])
    first, count = order_of_stages(pair)
    for n in range(first, first + count - 2):
        i, j, k = int(IN_ORDER[n]), int(IN_ORDER[n + 1]), int(IN_ORDER[n + 2])
        t, u, v = NODES[pair + i], NODES[pair + j], NODES[pair + k]
        if u <= sigma:
            one, two, three = w.rates[i], w.rates[j], w.rates[k]
            see_torques(
                x,
                extremum(t, u, v, one.output, two.output, three.output, sigma),
                extremum(t, u, v, one.housing, two.housing, three.housing, sigma),
            )
            housing, output = w.watched[guards.HOUSING].value, w.watched[guards.OUTPUT].value
            see_slips(
                x,
                extremum(t, u, v, housing[i], housing[j], housing[k], sigma),
                extremum(t, u, v, output[i], output[j], output[k], sigma),
            )


def see_end(d, x, w):
    """Take the moment before an event, at the end of the step in hand, into all peaks."""
    m = d.machine
    if d.losses != 0.0:
        move(d, x, w.change)
        evaluate(d, x, w.prescribed, w.load, True)
    see_torques(x, m.output, m.housing)
    see_slips(x, m.omega2, m.omega3 - m.omega2)
    see_load(d, x, m.q, m.omega1, m.omega2, m.alpha1, m.alpha2)


def count_loaded(d, x, w):
    """Count freewheels that only their drag has held and that carry at the end of the step in hand."""
    begin, end = w.rates[0], w.rates[last_stage(int(w.pair))]
    if d.housing_drag > 0.0 and x.housing_state == LOCKED and d.housing_engagement_angle == 0.0:
        x.housing_engagements += 1.0 if begin.housing <= 0.0 < end.housing else 0.0
    if d.output_drag > 0.0 and x.output_state == LOCKED and d.output_engagement_angle == 0.0:
        x.output_engagements += 1.0 if begin.output <= 0.0 < end.output else 0.0


def meet(d, x, which):
    """Set a speed that has met its limit there exactly."""
    x.rates_cached = 0.0
    if which == guards.HOUSING or which == guards.HOUSING_BACK:
        x.omega2 = 0.0
        x.omega2_low = 0.0
        if x.output_state == LOCKED:
            x.omega3 = 0.0
            x.omega3_low = 0.0
    elif which == guards.OUTPUT or which == guards.OUTPUT_BACK:
        if x.housing_state == LOCKED or (holds_link2(d, x) and x.omega3 < 0.0):
            x.omega3 = 0.0
            x.omega3_low = 0.0
        x.omega2 = x.omega3
        x.omega2_low = x.omega3_low
    elif x.housing_state == LOCKED:
        if d.by_torque != 0.0:
            x.omega1 = 0.0
            x.omega1_low = 0.0
    else:
        x.omega2 = x.omega1
        x.omega2_low = x.omega1_low


def meet_limits(d, x):
    """Set speeds of freewheels that overrun, but not by more than rounding, exactly to their limits."""
    if d.housing != 0.0 and x.housing_state == OPEN and x.omega2 < 0.0:
        meet(d, x, guards.HOUSING)
    if d.output != 0.0 and x.output_state == OPEN and x.omega3 < x.omega2:
        meet(d, x, guards.OUTPUT)


def has_fallen(d, x, w, which):
    """Tell whether a guard has, by the state at the end of the step in hand."""
    take_state(d, x)
    solve_motion(d, x, w)
    value, _ = guards.value_and_rate(d, x, d.machine, which)
    return value <= NO_PLAY


def unwind(d, x, which):
    """Forget the wind-up of a freewheel that lets go; what its spring still holds is lost."""
    if which == guards.HOUSING and x.housing_state == WOUND:
        add_loss(x, FREEWHEEL, 0.5 * d.housing_stiffness * x.wound_housing * x.wound_housing)
        x.wound_housing = 0.0
    if which == guards.OUTPUT and x.output_state == WOUND:
        add_loss(x, FREEWHEEL, 0.5 * d.freewheel_stiffness * x.wound_output * x.wound_output)
        x.wound_output = 0.0


def see_inside(d, x, w, sigma):
    """See the bearing's force at stages inside this part of the step, where the drive turns far."""
    if w.pair == SHORT or d.harmonic * abs(w.change.q) < INSIDE_PHASE:
        return
    if w.pair == THIRDS:
        rates = w.rates[1]
        set_part(d, x, w, 1.0 / PARTS)
        q = x.q + w.change.q
        set_part(d, x, w, 1.0)
        see_stage(d, x, rates, q)
        return
    for place in range(len(SEEN)):
        n = int(SEEN[place])
        if NODES[n] < sigma:
            see_stage(d, x, w.rates[n], x.q + w.step * weighed_rate(w, n, n, 0, 1))


def see_stage(d, x, rates, q):
    """See the bearing's force at a stage, at this angle of the drive."""
    sample_load(d, x, q, rates.theta1, rates.theta1 - rates.q / d.k, rates.omega1, rates.omega2)


def begin_step(d, x, w):
    """Accelerations, torques and rates at the beginning of a step, or those kept from the one before."""
    m = d.machine
    take_speeds(x)
    take_state(d, x)
    if x.rates_cached != 0.0:
        recall(m, x.now)
    else:
        solve_motion(d, x, w)
    if x.rates_cached != 0.0 and d.losses != 0.0:
        keep_end(d, x, w)
    else:
        keep_rates(d, x, w, 0)
    x.rates_cached = 0.0
    w.momentum = momentum_of_links(d, m.i, m.b, x.omega1, x.omega2)
    w.energy = energy_of_links(d, m.i, m.b, m.g, x.omega1, x.omega2)
    sample_load(d, x, x.q, x.omega1, x.omega2, m.alpha1, m.alpha2)


def take_over(d, x, w, sigma):
    """Take the step in hand over, or its part up to an event."""
    kept = 1.0
    if sigma < 0.0:
        see_inside(d, x, w, 1.0)
        recall(d.machine, x.now)
    elif w.pair == THIRDS:
        kept = sigma  # it ends there
    elif is_wound(x):
        make_step(d, x, w, LONG, sigma * w.step)
    else:
        see_inside(d, x, w, sigma)
        cut_step(d, x, w, sigma)
        kept = sigma
    if sigma >= 0.0:
        see_end(d, x, w)
    elif d.losses != 0.0:
        count_loaded(d, x, w)
    x.rates_cached = 1.0 if sigma < 0.0 else 0.0
    if d.losses == 0.0:
        balance(d, x, w)
    commit(d, x, w)
    see_peaks(x, w, kept)


def engage(d, x, which):
    """Let a freewheel whose play is used up carry: a rigid one by an impact, a spring begins to wind up."""
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
        close_freewheels(d, x)


def pass_event(d, x, which):
    """Change what an event changes at once, and tell of what kind it was."""
    x.ended = 0.0
    x.slip_reached_zero = 0.0
    if which == guards.FLOW:
        x.flow_sign = -x.flow_sign
    elif which > guards.FLOW:
        x.spin_signs = with_sign_changed(x.spin_signs, which - guards.SPIN)
    elif which != NONE:
        if d.elastic != 0.0:  # shaft or springs may swing otherwise now
            x.step_size = min(AFRESH * x.step_size, size_afresh(d, x))
        if guards.is_speed(x, which):
            x.slip_reached_zero = 1.0 if which == guards.SLIP and x.housing_state != LOCKED else 0.0
            if guards.is_play(x, which):
                engage(d, x, which)
            else:
                meet(d, x, which)
        else:
            x.ended = 1.0
            unwind(d, x, which)


def advance_general(d, x, w, remaining):
    """Advance by one step, or to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, whether what freewheels and slip do may change then).
    """
    begin_step(d, x, w)
    fastest = -1.0
    limit = longest_step(d, x, w, remaining)
    if limit >= remaining and (remaining <= x.short_size or x.short_size == 0.0):
        fastest = try_short_step(d, x, w, remaining)
    sigma, which = -1.0, NONE
    if fastest < 0.0:
        x.short_size *= SHORT_GROWTH  # so that it is tried again
        fastest = try_steps(d, x, w, limit)
        if fastest < 0.0:
            return -1.0, False
    if w.pair == THIRDS:
        sigma, which = end_at_event(d, x, w, fastest)
    else:
        recall(x.now, d.machine)
        if w.pair == LONG:
            sigma, which = first_event(d, x, w, fastest, NONE)
    wound = is_wound(x) and w.pair != THIRDS
    take_over(d, x, w, sigma)
    meet_limits(d, x)
    if wound and which != NONE and not has_fallen(d, x, w, which):
        # stiff springs make the inside of a step coarse: where an event seems to be a step has to end with it
        x.step_size = min(x.step_size, AFRESH * w.step / sigma)
        which = NONE
    pass_event(d, x, which)
    return w.step, NONE != which < guards.FLOW
