"""Complementarity problem: try every combination of states, take the one that violates no condition.

0 <= omega2 _|_ Th + drag >= 0      0 <= omega3 - omega2 _|_ Tc + drag >= 0      slip _|_ what friction leaves
"""

from ..links import prescribed_at_input
from .motion import evaluate, take_state
from .states import LOCKED, OPEN, contact_mode, is_rough, may_be_housing, may_be_output, may_slip

# share of the torques by which what has just ended seems to go on, and still has ended
ENDED = 1e-3
# share of the torques that is rounding, so that at the beginning of a step the one before goes on
GOES_ON = -1e-12
NO_TORQUE = 1e-300
# share of the torques below which a violation is none
ROUNDING = 1e-13


def worst_of_freewheel(state, drag, torque, speed, push):
    """By how much a freewheel misses its condition, N m; push: torque that its slip accelerates with.

    A spring may always be there that does not overrun: it settles on less than the drag, or lets go.
    """
    if state == OPEN:
        return -push if speed <= 0.0 else 0.0
    return -torque - drag if state == LOCKED else 0.0


def violation(d, x, prescribed, load):
    """By how much the states in x miss their conditions, as a share of the torques."""
    m = d.machine
    evaluate(d, x, prescribed, load, False)
    inertia = d.J2 + d.J3 + d.F_by_alpha1
    worst = 0.0
    if d.housing != 0.0:
        push = inertia * m.alpha2
        worst = worst_of_freewheel(x.housing_state, d.housing_drag, m.housing, m.omega2, push)
    if d.output != 0.0:
        slip = m.omega3 - m.omega2
        push = inertia * (m.alpha3 - m.alpha2)
        output = worst_of_freewheel(x.output_state, d.output_drag, m.output, slip, push)
        worst = max(worst, output)
    if x.slip_sign == 0.0:
        worst = max(worst, -d.k * m.margin)
    elif m.omega1 == m.omega2 and is_rough(d):
        worst = max(worst, -x.slip_sign * inertia * (m.alpha1 - m.alpha2))
    torques = abs(m.mesh) + abs(m.housing) + abs(m.output) + abs(load) + d.housing_drag + d.output_drag
    accelerated = abs(m.alpha1) + abs(m.alpha2) + abs(m.alpha3)
    return max(worst, 0.0) / (torques + inertia * accelerated + NO_TORQUE)


def take_speeds(x):
    """Speeds of parts that move together, exactly equal."""
    if x.slip_sign == 0.0:
        x.omega2 = x.omega1
        x.omega2_low = x.omega1_low
    if x.output_state == LOCKED:
        x.omega3 = x.omega2
        x.omega3_low = x.omega2_low


def choose_states(d, x, before_misses):
    """Choose what freewheels and slip do from now on, into x.

    Args:
        before_misses: what is added to the violation of what they did before, as a share of the torques.
    """
    take_state(d, x)
    prescribed = prescribed_at_input(d, x)
    before = (x.housing_state, x.output_state, x.slip_sign)
    best = before
    least = 1e300
    flow, spin = 1.0, 0.0
    for number in range(0 if is_rough(d) else 18, 27):
        # of equals the first: link 2 stays held, a shaft that nothing pulls away touches it, and only then
        housing = float((number // 3 + 1) % 3)
        output = float(number % 3 if housing == OPEN else (number + 1) % 3)
        sign = float(number // 9 - 1)
        possible = may_be_housing(d, x, housing) and may_be_output(d, x, output) and may_slip(d, x, sign)
        if not possible:
            continue
        x.housing_state, x.output_state, x.slip_sign = housing, output, sign
        missing = max(violation(d, x, prescribed, x.load_torque) - ROUNDING, 0.0)
        if (housing, output, sign) == before:
            missing += before_misses
        if missing < least:
            least = missing
            best = (housing, output, sign)
            flow, spin = d.machine.flow_sign, d.machine.spin_signs
    x.housing_state, x.output_state, x.slip_sign = best
    x.flow_sign, x.spin_signs = flow, spin
    x.step_evaluations += 1.0
    take_speeds(x)
    mode = contact_mode(x)
    if mode != x.mode:
        x.mode = mode
        x.step_switches += 1.0


def choose_next_states(d, x):
    """Choose them after an event. Returns whether they have changed."""
    before = (x.housing_state, x.output_state, x.slip_sign)
    if x.slip_reached_zero != 0.0:
        x.omega2 = x.omega1
        x.omega2_low = x.omega1_low
        if x.output_state == LOCKED:
            x.omega3 = x.omega2
            x.omega3_low = x.omega2_low
    choose_states(d, x, ENDED if x.ended != 0.0 else 0.0)
    return before != (x.housing_state, x.output_state, x.slip_sign)
