"""The module with its pulses, step by step of an embedded pair or a stiff method up to the next event."""

import math

from ..accumulate import add, add_loss, wrap_drive_angle, wrap_input_angle
from ..codes import FREEWHEEL, JOURNAL, MESH, NONE, SHAFT, VISCOUS
from ..links import response
from ..loads import INSIDE_PHASE, sample_load
from ..search import first_crossing
from ..shaft import fastest_own_rate
from ..solvers.step_size import REJECTIONS, carry_size, first_size, next_factor
from ..tableau import END, LONG, NODES, PARTS, SHORT, SHORT_END, THIRDS
from .choice import take_speeds, torques_at
from .error import CUSP, fastest_speed, step_error
from .guards import (
    FLOW,
    HOUSING,
    OUTPUT,
    SLIP,
    SPIN,
    fit_guard,
    fit_through,
    general_fourth_bound,
    how_many_guards,
    is_clear,
    is_speed,
    is_spring,
    is_watched,
    value_and_rate,
)
from .motion import evaluate, recall, take_state
from .rosenbrock import differentiate, look_inside, make_stiff_step, set_part
from .satellites import with_sign_changed
from .stages import cut_step, keep_rates, make_inside, make_step, take_changed, weighed_rate
from .states import IDEAL, LOCKED, LOSSY, OPEN, WOUND, is_rough, is_wound

# stage inside the step at which the force on the bearing is seen
SEEN = 9
# phase of the highest harmonic within one step, and between two looks at a guard, rad
STEP_PHASE = 4.0
LOOK_PHASE = 1.0
# phase of shaft and springs within a step from which on it is a stiff one, and its share of STEP_PHASE; steps
# tried to end at an event, and how near to it, in tolerances of its range
STIFF = 4.0
STIFF_SHARE = 0.5
LANDINGS, SEARCHES = 60, 4
NEAR_SPEED, NEAR_TORQUE = 1e-2, 0.1
# ... and up to which the few stages of a short step tell what a guard does
QUIET_PHASE = 2.0
# ... where a link is far lighter at an angle than at others, so that its speed has a spike there, and where
# the output can swing, which errors of long steps are estimated too low for
SHORT_PHASE = 1.0
# steps are often as long as is stable, and a little longer are tried in vain
SAFETY = 0.8
SHORT_SAFETY = 0.9
# share of its size that a step keeps where a freewheel has switched, and phase that is tried first then: an
# error of a longer step may be estimated far too low
AFRESH = 0.5
AFRESH_PHASE = 1.0
# share of the allowed error that a step of the pair of order 5 may have: there are many of them
SHORT_SHARE = 0.1
# how fast the longest step of the pair of order 5 is thought to grow while the other one is used
SHORT_GROWTH = 1.05
# a guard below this share of the speeds, or of the torques, is zero
VELOCITY_ROUNDING = 1e-13
TORQUE_ROUNDING = 1e-13


def advance_of_phase(d, x, w):
    """Advance of the highest harmonic in the step in hand, rad."""
    slip = abs(x.omega1 - x.omega2)
    end = abs(x.omega1 + w.change.omega1 - x.omega2 - w.change.omega2)
    return w.step * d.harmonic * d.k * max(slip, end)


def longest_step(d, x, w, remaining):
    """Longest step that is searched for events: a bounded phase of the highest harmonic."""
    m = d.machine
    step = min(remaining, d.max_step)
    phase = SHORT_PHASE if d.lightest < CUSP or d.elastic != 0.0 else STEP_PHASE
    scale = d.harmonic * d.k
    slip = abs(x.omega1 - x.omega2)
    if scale * slip * step > phase:
        step = phase / (scale * slip)
    growth = scale * abs(m.alpha1 - m.alpha2)
    if 0.5 * growth * step * step > phase:
        step = math.sqrt(2.0 * phase / growth)
    return step


def try_short_step(d, x, w, remaining):
    """Make the step to the end of the time remaining by the pair of order 5, where that will do.

    It will where the error is allowed and no guard comes near zero. Returns as try_steps.
    """
    w.short = 1.0
    w.stiffly = 0.0
    make_step(d, x, w, remaining)
    fastest = fastest_speed(d, x, w)
    error = step_error(d, x, w, fastest) / SHORT_SHARE
    x.short_size = next_factor(error, 5.0, SHORT_SAFETY) * remaining
    if not error <= 1.0 or advance_of_phase(d, x, w) > QUIET_PHASE:
        return -1.0
    rough = is_rough(d)
    for guard in range(how_many_guards(d)):
        if is_watched(d, x, guard, rough) and not is_clear(x, w, guard):
            return -1.0
    return fastest


def try_steps(d, x, w, limit):
    """Make the longest step of allowed error. Returns the largest speed in it, or -1 where none will do."""
    w.short = 0.0
    h = first_size(x, limit)
    own = fastest_own_rate(d, x) if d.elastic != 0.0 else 0.0
    differentiated = False
    for attempt in range(REJECTIONS):
        w.stiffly = 1.0 if h * own > STIFF else 0.0
        if w.stiffly != 0.0:
            if not differentiated:
                differentiate(d, x, w)
                differentiated = True
            h = min(h, max(STIFF_SHARE * longest_step(d, x, w, 1e300), STIFF / own))
            make_stiff_step(d, x, w, h)
        else:
            make_step(d, x, w, h)
        fastest = fastest_speed(d, x, w)
        error = step_error(d, x, w, fastest)
        if w.stiffly != 0.0:
            factor = next_factor(error, 5.0, SHORT_SAFETY)
        else:
            factor = next_factor(error, 8.0, SAFETY)
        if error <= 1.0:
            carry_size(x, h, factor, attempt)
            return fastest
        h *= factor
    return -1.0


def land(d, x, w, which, zero, sigma):
    """Make the stiff step end where the guard falls. Returns whether it does."""
    one = w.watched[which]
    low, high = 0.0, w.step
    value_low, value_high = one.value[0], one.value[PARTS]
    share = NEAR_SPEED if is_speed(x, which) else NEAR_TORQUE
    near = max(4.0 * zero, share * d.tolerance * max(abs(value_low), abs(value_high)))
    t = sigma * high
    was_above = False
    for landing in range(LANDINGS):
        make_stiff_step(d, x, w, t)
        take_changed(d, x, w.change)
        evaluate(d, x, w.prescribed, w.load, True)
        x.step_evaluations += 1.0
        value, rate = value_and_rate(d, x, d.machine, which)
        if -near <= value <= 0.0:
            return True
        # a secant that never stays at one end (Illinois)
        above = value > 0.0
        if above:
            low, value_low = t, value
            value_high *= 0.5 if landing > 0 and was_above else 1.0
            if value_high >= 0.0 and landing > SEARCHES:
                return False  # a crossing of the fit alone
        else:
            high, value_high = t, value
            value_low *= 0.5 if landing > 0 and not was_above else 1.0
        was_above = above
        move = low
        if is_speed(x, which) and rate < 0.0:
            move = t - (value + 0.5 * near) / rate
        elif value_high < 0.0 < value_low:
            move = low + (high - low) * (value_low + 0.5 * near) / (value_low - value_high)
        t = move if low < move < high else 0.5 * (low + high)
    return value <= 0.0


def guard_tolerance(d, x, w, which, fastest):
    """Threshold below which a guard counts as crossed."""
    if is_speed(x, which):
        fastest_output = max(abs(x.omega2), max(abs(x.omega2 + w.change.omega2), abs(x.omega3)))
        return VELOCITY_ROUNDING * max(response(d, d.J2) * fastest, fastest_output)
    m = d.machine
    share = max(TORQUE_ROUNDING, d.tolerance) if is_spring(x, which) else TORQUE_ROUNDING
    return share * torques_at(d, m, w.prescribed, w.load)


def first_event(d, x, w, fastest, cleared):
    """Earliest fall of a guard, but of the one cleared, in the step just made: (part of it or -1, which)."""
    earliest = -1.0
    which = NONE
    inside = False
    rough = is_rough(d)
    looks = 1 + int(math.floor(min(advance_of_phase(d, x, w), STEP_PHASE) / LOOK_PHASE))
    for guard in range(how_many_guards(d)):
        if guard == cleared or not is_watched(d, x, guard, rough):
            continue
        if is_clear(x, w, guard):
            continue
        if w.stiffly != 0.0:
            fit_through(x, w, guard)
        else:
            if not inside:
                make_inside(d, x, w)
                inside = True
            fit_guard(w, guard)
        zero = guard_tolerance(d, x, w, guard, fastest)
        sigma = first_crossing(d, x, w, guard, zero, general_fourth_bound(x, w, guard), looks)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = guard
    return earliest, which


def end_at_event(d, x, w, fastest):
    """Let the stiff step end at the first event in it, if any.

    Returns:
        (part of the step that is left or -1, the guard that falls there or NONE).
    """
    h = w.step
    cleared = NONE
    for part in range(1, PARTS + 1):
        look_inside(d, x, w, part)
    recall(x.now, d.machine)
    for _ in range(2):
        sigma, which = first_event(d, x, w, fastest, cleared)
        if sigma < 0.0:
            break
        if land(d, x, w, which, guard_tolerance(d, x, w, which, fastest), sigma):
            return w.step / h, which
        cleared = which  # a crossing of the fit alone: what of the other guards?
        make_stiff_step(d, x, w, h)
    set_part(d, x, w, 1.0)
    return -1.0, NONE


def balance(d, x, w):
    """Impulses and work of the step in hand by the balances, exact in its ends, without losses by load.

    M1 - Tc + Th is the rate of the angular momentum; what M1 does while link 2 is held is kinetic energy. A
    ramp of the input speed has its integrals.
    """
    change = w.change
    if d.elastic == 0.0 and x.output_state == LOCKED:
        change.output = d.J3 * change.omega3 + w.load * w.step + d.b3 * change.turned3
    passed = d.machine.momentum - w.momentum + change.output
    passed += d.b1 * change.theta1 + d.b2 * (change.theta1 - change.q / d.k)
    if d.by_torque != 0.0:
        change.housing = passed - w.prescribed * w.step
    elif w.prescribed == 0.0:
        change.drive = passed
        if x.housing_state == LOCKED:
            lost = (d.b1 + d.k * d.k * d.bq) * change.theta1
            change.drive = (d.machine.energy - w.energy) / x.omega1 + lost if x.omega1 != 0.0 else 0.0
        change.housing = passed - change.drive
        change.work_in = x.omega1 * change.drive


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
        add_loss(x, SHAFT, change.lost[SHAFT])
    work = change.work_in if d.by_torque == 0.0 else w.prescribed * change.theta1
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, w.load * change.turned3)
    if d.viscous != 0.0:
        add_loss(x, VISCOUS, change.lost[VISCOUS])
    if d.losses != 0.0:
        x.wound_housing += change.wound_housing
        x.wound_output += change.wound_output
        for cause in (MESH, JOURNAL, FREEWHEEL):
            add_loss(x, cause, change.lost[cause])
    x.input_impulse += change.drive
    x.housing_impulse += change.housing
    x.output_impulse += change.output
    x.output_square += change.square
    x.turned3 += change.turned3


def see_peak(x, w, sigma):
    """See the output torque at the stages up to this part of the step in hand; those beyond have none."""
    pair, last = (SHORT, SHORT_END) if w.short != 0.0 else (LONG, END)
    if w.stiffly != 0.0:
        pair, last = THIRDS, PARTS
    for n in range(last + 1):
        if NODES[pair + n] <= sigma:
            x.torque_peak = max(x.torque_peak, abs(w.rates[n].output))


def meet(d, x, which):
    """Set a speed that has met its limit there exactly."""
    x.rates_cached = 0.0
    if which == HOUSING:
        x.omega2 = 0.0
        x.omega2_low = 0.0
    elif which == OUTPUT:
        if x.housing_state == LOCKED or (d.housing != 0.0 and d.housing_stiffness == 0.0 and x.omega3 < 0.0):
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
        meet(d, x, HOUSING)
    if d.output != 0.0 and x.output_state == OPEN and x.omega3 < x.omega2:
        meet(d, x, OUTPUT)


def has_fallen(d, x, w, which):
    """Tell whether a guard has, by the state at the end of the step in hand."""
    take_state(d, x)
    evaluate(d, x, w.prescribed, w.load, True)
    x.step_evaluations += 1.0
    value, _ = value_and_rate(d, x, d.machine, which)
    return value <= 0.0


def unwind(d, x, which):
    """Forget the wind-up of a freewheel that lets go; what its spring still holds is lost."""
    if which == HOUSING and x.housing_state == WOUND:
        add_loss(x, FREEWHEEL, 0.5 * d.housing_stiffness * x.wound_housing * x.wound_housing)
        x.wound_housing = 0.0
    if which == OUTPUT and x.output_state == WOUND:
        add_loss(x, FREEWHEEL, 0.5 * d.freewheel_stiffness * x.wound_output * x.wound_output)
        x.wound_output = 0.0


def see_inside(d, x, w):
    """See the bearing's force at a stage inside the step, where the drive turns far."""
    if w.short != 0.0 or d.harmonic * abs(w.change.q) < INSIDE_PHASE:
        return
    if w.stiffly != 0.0:
        rates = w.rates[1]
        set_part(d, x, w, 1.0 / PARTS)
        q = x.q + w.change.q
        set_part(d, x, w, 1.0)
    else:
        rates = w.rates[SEEN]
        q = x.q + w.step * weighed_rate(w, SEEN, SEEN, 0)
    sample_load(d, x, q, rates.theta1, rates.theta1 - rates.q / d.k, rates.omega1, rates.omega2)


def begin_step(d, x, w):
    """Accelerations, torques and rates at the beginning of a step, or those kept from the one before."""
    m = d.machine
    take_speeds(x)
    take_state(d, x)
    if x.rates_cached != 0.0:
        recall(m, x.now)
    else:
        evaluate(d, x, w.prescribed, w.load, True)
        x.step_evaluations += 1.0
    x.rates_cached = 0.0
    w.momentum, w.energy = m.momentum, m.energy
    keep_rates(d, x, w, 0, LOSSY if d.losses != 0.0 else IDEAL)
    sample_load(d, x, x.q, x.omega1, x.omega2, m.alpha1, m.alpha2)


def make_steps(d, x, w, remaining):
    """Make a step of allowed error, to the end of the time remaining or short of it.

    Returns:
        (largest speed in it or -1 where none will do, fraction of the earliest event in it or -1, its guard).
    """
    limit = longest_step(d, x, w, remaining)
    if limit >= remaining and (remaining <= x.short_size or x.short_size == 0.0):
        fastest = try_short_step(d, x, w, remaining)
        if fastest >= 0.0:
            recall(x.now, d.machine)
            return fastest, -1.0, NONE
    x.short_size *= SHORT_GROWTH  # so that it is tried again
    fastest = try_steps(d, x, w, limit)
    if fastest < 0.0:
        return fastest, -1.0, NONE
    if w.stiffly != 0.0:
        sigma, which = end_at_event(d, x, w, fastest)
        return fastest, sigma, which
    recall(x.now, d.machine)
    sigma, which = first_event(d, x, w, fastest, NONE)
    return fastest, sigma, which


def take_over(d, x, w, sigma):
    """Take the step in hand over, or its part up to an event."""
    kept = 1.0
    if sigma < 0.0:
        see_inside(d, x, w)
        recall(d.machine, x.now)
    elif w.stiffly != 0.0:
        kept = sigma  # it ends there
    elif is_wound(x):
        make_step(d, x, w, sigma * w.step)
    else:
        cut_step(d, x, w, sigma)
        kept = sigma
    if d.losses == 0.0:
        balance(d, x, w)
        x.rates_cached = 1.0 if sigma < 0.0 else 0.0
    commit(d, x, w)
    see_peak(x, w, kept)


def pass_event(d, x, which):
    """Change what an event changes at once, and tell of what kind it was."""
    x.ended = 0.0
    x.slip_reached_zero = 0.0
    if which == FLOW:
        x.flow_sign = -x.flow_sign
    elif which > FLOW:
        x.spin_signs = with_sign_changed(x.spin_signs, which - SPIN)
    elif which != NONE:
        rate = d.harmonic * d.k * abs(x.omega1 - x.omega2)
        x.step_size = min(AFRESH * x.step_size, AFRESH_PHASE / max(rate, 1e-300))
        if is_speed(x, which):
            x.slip_reached_zero = 1.0 if which == SLIP and x.housing_state != LOCKED else 0.0
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
    fastest, sigma, which = make_steps(d, x, w, remaining)
    if fastest < 0.0:
        return -1.0, False
    wound = is_wound(x) and w.stiffly == 0.0
    take_over(d, x, w, sigma)
    meet_limits(d, x)
    if wound and which != NONE and not has_fallen(d, x, w, which):
        # stiff springs make the inside of a step coarse: where an event seems to be a step has to end with it
        x.step_size *= AFRESH
        which = NONE
    pass_event(d, x, which)
    return w.step, NONE != which < FLOW
