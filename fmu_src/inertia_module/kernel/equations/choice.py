"""Complementarity problem: try every combination of states, take the one that violates no condition.

0 <= omega2 _|_ Th + drag >= 0      0 <= omega3 - omega2 _|_ Tc + drag >= 0      slip _|_ what friction leaves

A freewheel with play left takes no torque but its drag, and may slip either way.
"""

import math

from ..links import prescribed_at_input, torque_scale
from . import states
from .motion import evaluate, recall, take_state

# share of the torques by which what has just ended seems to go on, and still has ended
ENDED = 1e-3
# share of the torques that is rounding, so that at the beginning of a step the one before goes on
GOES_ON = -1e-13
NO_TORQUE = 1e-300
# phase by which is looked ahead, rad
AHEAD = 1e-4
# share of the torques below which a violation is none
ROUNDING = 1e-14
# share by which a freewheel that overruns with its drag comes before one whose spring is relaxed
RELAXED = 1e-12


def worst_of_freewheel(state, drag, torque, speed, push, wound, play):
    """By how much a freewheel misses its condition, N m.

    A spring that is wound up is there: it settles on less than the drag, or lets go.

    Args:
        push: torque that its slip accelerates with. wound: of its spring, rad. play: left, rad.
    """
    if state == states.OPEN:
        return -push if speed <= 0.0 else 0.0
    if state == states.CLOSING:
        return push if speed == 0.0 else 0.0
    if state == states.LOCKED:
        return max(-torque - drag, torque) if play > 0.0 else -torque - drag
    return push if wound == 0.0 and speed == 0.0 and drag == 0.0 else 0.0


def relaxed(state, drag, wound, speed):
    """Violation of a spring that carries nothing yet: it holds only where the drag keeps it from slipping."""
    return RELAXED if state == states.WOUND and drag > 0.0 and wound == 0.0 and speed == 0.0 else 0.0


def torques_at(d, m, prescribed, load):
    """Scale of the torques of an instant, N m: what one of them is to be called zero against."""
    bound = torque_scale(d, m.omega1, m.alpha1, d.k * (m.omega1 - m.omega2), prescribed)
    return abs(m.mesh) + abs(m.housing) + abs(m.output) + abs(load) + bound


def violation(d, x, prescribed, load):
    """By how much the states in x miss their conditions, as a share of the torques."""
    m = d.machine
    evaluate(d, x, prescribed, load, False)
    inertia = d.J2 + d.J3 + d.F_by_alpha1
    # each by what it feels: links 1 and 2 no load behind a freewheel that overruns or a shaft not twisted yet
    torques = torques_at(d, m, prescribed, 0.0) + inertia * abs(m.alpha2) + NO_TORQUE
    worst = 0.0
    if x.slip_sign == 0.0:
        worst = max(-d.k * m.margin, 0.0) / torques
    elif x.slip_sign * (m.omega1 - m.omega2) <= 0.0 and states.is_rough(d):
        worst = max(-x.slip_sign * inertia * (m.alpha1 - m.alpha2), 0.0) / torques
    torques += d.housing_drag + d.output_drag
    if d.housing != 0.0:
        state, push, wound = x.housing_state, inertia * m.alpha2, m.wound_housing
        missing = worst_of_freewheel(state, d.housing_drag, m.housing, m.omega2, push, wound, m.play_housing)
        worst = max(worst, missing / torques) + relaxed(state, d.housing_drag, wound, m.omega2)
    if d.output != 0.0:
        torques += (abs(load) if d.elastic == 0.0 else 0.0) + inertia * abs(m.alpha3)
        slip = m.omega3 - m.omega2
        state, push, wound = x.output_state, inertia * (m.alpha3 - m.alpha2), m.wound_output
        missing = worst_of_freewheel(state, d.output_drag, m.output, slip, push, wound, m.play_output)
        worst = max(worst, missing / torques) + relaxed(state, d.output_drag, wound, slip)
    return worst


def take_speeds(x):
    """Speeds of parts that move together, exactly equal."""
    if x.slip_sign == 0.0:
        x.omega2 = x.omega1
        x.omega2_low = x.omega1_low
    if x.output_state == states.LOCKED:
        x.omega3 = x.omega2
        x.omega3_low = x.omega2_low


def with_play(state, play):
    """State of a freewheel: where play is left there is no spring to wind up, and it may close."""
    return states.CLOSING if state == states.WOUND and play > 0.0 else state


def try_combination(d, x, number):
    """Set the states of this number, 0 to 26, in x. Returns whether speeds, wind-up and play allow them.

    Of equals the first is taken: links that need not slip stick, link 2 stays held, a shaft that nothing
    pulls away touches it then, and only then.
    """
    housing = float((number // 3 + 1) % 3)
    output = float(number % 3 if housing == states.OPEN else (number + 1) % 3)
    if d.turning == 0.0 and (housing == states.WOUND or output == states.WOUND):
        return False
    x.housing_state = with_play(housing, x.play_housing)
    x.output_state = with_play(output, x.play_output)
    x.slip_sign = float((number // 9 + 1) % 3 - 1)
    return states.are_allowed(d, x)


def step_ahead(d, x):
    """Take d.machine ahead by so little that signs tell what grows: the accelerations are in it."""
    m = d.machine
    accelerated = abs(m.alpha1) + abs(m.alpha2) + abs(m.alpha3) + abs(m.rate_relative)
    fastest = d.harmonic * d.k * (abs(m.omega1) + abs(m.omega2) + abs(m.omega3) + math.sqrt(accelerated))
    if d.elastic != 0.0:
        fastest += math.sqrt(d.shaft_stiffness / d.J3)
    if not 0.0 < fastest < 1e300:
        return
    time = AHEAD / fastest
    m.q += time * d.k * (m.omega1 - m.omega2)
    m.twist += time * (m.relative + 0.5 * time * m.rate_relative)
    m.relative += time * m.rate_relative
    m.omega1 += time * m.alpha1
    m.omega2 += time * m.alpha2
    m.omega3 += time * m.alpha3


def least_violation(d, x, housing_before, output_before, slip_before, before_misses, ahead):
    """Find the combination of states that misses its conditions least, now or a moment ahead.

    Args:
        d: constants.
        x: state; the combination is left in it.
        housing_before: state of the housing freewheel before.
        output_before: state of the output freewheel before.
        slip_before: sign of the slip before.
        before_misses: added to the violation of the combination before, as a share of the torques.
        ahead: True for a moment ahead.

    Returns:
        (its number, how many miss none).
    """
    prescribed = prescribed_at_input(d, x)
    best = 0
    least = 1e300
    equal = 0
    first, end = 9, 18
    if states.is_rough(d):
        first, end = 0, 27
    for number in range(first, end):
        if not try_combination(d, x, number):
            continue
        take_state(d, x)
        missing = violation(d, x, prescribed, x.load_torque)
        if ahead and missing > -GOES_ON:
            continue  # others do not miss theirs now, and are there for a moment at least
        if ahead and missing <= ROUNDING:
            step_ahead(d, x)
            missing = violation(d, x, prescribed, x.load_torque)
        missing = max(missing - ROUNDING, 0.0)
        equal += missing == 0.0
        is_same = x.housing_state == housing_before and x.output_state == output_before
        if is_same and x.slip_sign == slip_before:
            missing += before_misses
        if missing < least:
            least = missing
            best = number
    return best, equal


def choose_states(d, x, before_misses):
    """Choose what freewheels and slip do from now on, into x.

    Args:
        before_misses: what is added to the violation of what they did before, as a share of the torques.
    """
    housing, output, slip = x.housing_state, x.output_state, x.slip_sign
    best, equal = least_violation(d, x, housing, output, slip, before_misses, False)
    if equal > 1:
        best, _ = least_violation(d, x, housing, output, slip, before_misses, True)
    try_combination(d, x, best)
    take_speeds(x)
    take_state(d, x)
    evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)
    x.flow_sign, x.spin_signs = d.machine.flow_sign, d.machine.spin_signs
    recall(x.now, d.machine)
    x.rates_cached = 0.0 if d.losses != 0.0 else 1.0
    x.mode = states.contact_mode(x)


def switch_states(d, x, before_misses):
    """Choose them in the course of a motion, where each choice and what it switches counts."""
    if x.output_state == states.GEARED:
        return
    mode = x.mode
    choose_states(d, x, before_misses)
    x.step_evaluations += 1.0
    m = d.machine
    housing = states.carries(x.housing_state, d.housing_drag, d.housing_engagement_angle, m.housing)
    output = states.carries(x.output_state, d.output_drag, d.output_engagement_angle, m.output)
    states.count_switch(x, mode, x.mode, housing, output)


def choose_next_states(d, x):
    """Choose them after an event. Returns whether they have changed."""
    housing, output, slip = x.housing_state, x.output_state, x.slip_sign
    if x.slip_reached_zero != 0.0:
        x.slip_sign = 0.0
        take_speeds(x)
    switch_states(d, x, ENDED if x.ended != 0.0 else 0.0)
    return x.housing_state != housing or x.output_state != output or x.slip_sign != slip
