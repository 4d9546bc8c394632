"""Contact mode selection by enumeration of a complementarity problem.

    0 <= omega2          _|_ Th + T_d >= 0        housing freewheel with the drag T_d
    0 <= omega3 - omega2 _|_ Tc + T_d >= 0        output freewheel with the drag T_d
    slip                 _|_ friction reserve     links 1 and 2

Three states of each of the three contacts give 27 modes. The mode with the smallest violation is selected.
Inside its engagement angle a freewheel transmits only its drag, and its slip can have either sign.
"""

import math

from ..links import prescribed_at_input, torque_scale
from ..records import Constants, Machine, State
from . import states
from .motion import copy_accelerations, evaluate, load_state

# Violations are relative to the torques
HYSTERESIS = 1e-3  # Added for the mode that a torque event has ended
CONTINUATION_BIAS = -1e-13  # Added for the present mode at the start of a step, larger than round-off
VIOLATION_RTOL = 1e-14  # Below it the conditions are satisfied
TIE_BREAK = (
    1e-12  # Violation of a relaxed spring, so that a freewheel that overruns with its drag comes first
)
MIN_TORQUE_SCALE = 1e-300  # N m, prevents a division by zero
LOOKAHEAD_PHASE = 1e-4  # rad of the highest harmonic, the length of the look-ahead
MAX_PHASE_RATE = 1e300  # rad/s, beyond it there is no look-ahead
N_FREEWHEEL_MODES = 9  # Combinations of freewheel states, for each sign of the slip (0, 1, -1)
N_MODES = 3 * N_FREEWHEEL_MODES


def complementarity_violation(
    state: float,
    drag: float,
    torque: float,
    speed: float,
    slip_torque: float,
    wind_up: float,
    backlash: float,
) -> float:
    """Return the violation of the complementarity condition of one freewheel, N m.

    A spring with a deflection violates nothing: it relaxes to less than the drag or releases the freewheel.

    Args:
        state: State of the freewheel.
        drag: Torque of its drag, N m.
        torque: Torque of the freewheel, N m.
        speed: Overrunning speed, rad/s.
        slip_torque: Inertia times the rate of ``speed``, N m.
        wind_up: Deflection of its spring, rad.
        backlash: Remaining engagement angle, rad.
    """
    if state == states.OVERRUNNING:
        return -slip_torque if speed <= 0.0 else 0.0
    if state == states.IN_BACKLASH:
        return slip_torque if speed == 0.0 else 0.0
    if state == states.LOCKED:
        return max(-torque - drag, torque) if backlash > 0.0 else -torque - drag
    return slip_torque if wind_up == 0.0 and speed == 0.0 and drag == 0.0 else 0.0


def spring_violation(state: float, drag: float, wind_up: float, speed: float) -> float:
    """Return the relative violation of a relaxed spring: TIE_BREAK if drag can hold the freewheel instead.

    Args:
        state: State of the freewheel.
        drag: Torque of its drag, N m.
        wind_up: Deflection of its spring, rad.
        speed: Overrunning speed, rad/s.
    """
    is_relaxed = state == states.ENGAGED_COMPLIANT and wind_up == 0.0 and speed == 0.0
    return TIE_BREAK if is_relaxed and drag > 0.0 else 0.0


def torque_magnitude(d: Constants, m: Machine, prescribed: float, load: float) -> float:
    """Return the sum of the torque magnitudes at an instant, the scale of the zero test, N m.

    Args:
        d: Constants.
        m: Motion after evaluate.
        prescribed: Acceleration or torque of link 1, rad/s^2 or N m.
        load: Load torque, N m.
    """
    bound = torque_scale(d, m.omega1, m.alpha1, d.k * (m.omega1 - m.omega2), prescribed)
    return abs(m.mesh) + abs(m.housing) + abs(m.output) + abs(load) + bound


def slip_violation(d: Constants, x: State, m: Machine, inertia: float, torques: float) -> float:
    """Return the relative violation of the condition of the slip of links 1 and 2.

    Args:
        d: Constants.
        x: State; the sign of the slip is read.
        m: Motion after evaluate.
        inertia: Scale that converts accelerations to torques, kg m^2.
        torques: Scale of the torques, N m.
    """
    if x.slip_sign == 0.0:
        return max(-d.k * m.friction_reserve, 0.0) / torques
    if x.slip_sign * (m.omega1 - m.omega2) <= 0.0 and states.has_friction(d):
        return max(-x.slip_sign * inertia * (m.alpha1 - m.alpha2), 0.0) / torques
    return 0.0


def mode_violation(d: Constants, x: State, prescribed: float, load: float) -> float:
    """Evaluate ``d.machine`` in the mode in ``x`` and return the violation of its conditions.

    Each condition is relative to the torques that act on its contact. Links 1 and 2 are therefore compared
    without the load, because an overrunning freewheel or a relaxed shaft does not transmit it.

    Args:
        d: Constants; ``d.machine`` is read and written.
        x: State; the contact mode is read.
        prescribed: Acceleration or torque of link 1, rad/s^2 or N m.
        load: Load torque, N m.
    """
    m = d.machine
    evaluate(d, x, prescribed, load, False)
    inertia = d.J2 + d.J3 + d.F_by_alpha1
    torques = torque_magnitude(d, m, prescribed, 0.0) + inertia * abs(m.alpha2) + MIN_TORQUE_SCALE
    violation = slip_violation(d, x, m, inertia, torques)
    torques += d.housing_drag + d.output_drag
    if d.housing_freewheel != 0.0:
        state, drag, wind_up = x.housing_state, d.housing_drag, m.wound_housing
        slip_torque = inertia * m.alpha2
        housing_violation = complementarity_violation(
            state, drag, m.housing, m.omega2, slip_torque, wind_up, m.play_housing
        )
        violation = max(violation, housing_violation / torques)
        violation += spring_violation(state, drag, wind_up, m.omega2)
    if d.output_freewheel != 0.0:
        torques += (abs(load) if d.elastic == 0.0 else 0.0) + inertia * abs(m.alpha3)
        state, drag, wind_up = x.output_state, d.output_drag, m.wound_output
        slip = m.omega3 - m.omega2
        slip_torque = inertia * (m.alpha3 - m.alpha2)
        output_violation = complementarity_violation(
            state, drag, m.output, slip, slip_torque, wind_up, m.play_output
        )
        violation = max(violation, output_violation / torques)
        violation += spring_violation(state, drag, wind_up, slip)
    return violation


def enforce_equal_speeds(x: State) -> None:
    """Set the speeds of parts that are locked together bitwise equal."""
    if x.slip_sign == 0.0:
        x.omega2 = x.omega1
    if x.output_state == states.LOCKED:
        x.omega3 = x.omega2


def state_in_backlash(state: float, backlash: float) -> float:
    """Return IN_BACKLASH for an engaged spring inside the engagement angle, otherwise ``state``."""
    return states.IN_BACKLASH if state == states.ENGAGED_COMPLIANT and backlash > 0.0 else state


def set_mode(d: Constants, x: State, number: int) -> bool:
    """Set contact mode ``number`` in ``x`` and return True if speeds, wind-up and backlash admit it.

    The order of the modes breaks ties: sticking before slipping, and link 2 held before free. If link 2 is
    held, the output freewheel is engaged before overrunning; if link 2 is free, overrunning comes first.

    Args:
        d: Constants.
        x: State; freewheel states and the sign of the slip are written.
        number: 0 to N_MODES - 1.
    """
    housing = float((number // 3 + 1) % 3)
    output = float(number % 3 if housing == states.OVERRUNNING else (number + 1) % 3)
    if d.freewheel_angles == 0.0 and (
        housing == states.ENGAGED_COMPLIANT or output == states.ENGAGED_COMPLIANT
    ):
        return False
    x.housing_state = state_in_backlash(housing, x.play_housing)
    x.output_state = state_in_backlash(output, x.play_output)
    x.slip_sign = float((number // 9 + 1) % 3 - 1)
    return states.is_mode_admissible(d, x)


def extrapolate_motion(d: Constants, x: State) -> None:
    """Advance the motion in ``d.machine`` by a small explicit step, to see which quantities grow.

    The step is LOOKAHEAD_PHASE of the fastest angle. The accelerations in ``d.machine`` must be valid.
    """
    m = d.machine
    acceleration = abs(m.alpha1) + abs(m.alpha2) + abs(m.alpha3) + abs(m.rate_relative)
    speed = abs(m.omega1) + abs(m.omega2) + abs(m.omega3) + math.sqrt(acceleration)
    phase_rate = d.harmonic * d.k * speed
    if d.elastic != 0.0:
        phase_rate += math.sqrt(d.shaft_stiffness / d.J3)
    if not 0.0 < phase_rate < MAX_PHASE_RATE:
        return
    time = LOOKAHEAD_PHASE / phase_rate
    m.q += time * d.k * (m.omega1 - m.omega2)
    m.twist += time * (m.relative + 0.5 * time * m.rate_relative)
    m.relative += time * m.rate_relative
    m.omega1 += time * m.alpha1
    m.omega2 += time * m.alpha2
    m.omega3 += time * m.alpha3


def enumerate_modes(
    d: Constants,
    x: State,
    housing_before: float,
    output_before: float,
    slip_before: float,
    bias: float,
    use_lookahead: bool,
) -> tuple[int, int]:
    """Return the mode with the smallest violation, now or LOOKAHEAD_PHASE later.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State; the last mode tried is left in it.
        housing_before: State of the housing freewheel before.
        output_before: State of the output freewheel before.
        slip_before: Sign of the slip before.
        bias: Added to the relative violation of the mode before.
        use_lookahead: True to compare the modes that satisfy their conditions a moment later.

    Returns:
        (mode, n): number of the mode; number of modes that satisfy their conditions.
    """
    prescribed = prescribed_at_input(d, x)
    best = 0
    min_violation = 1e300
    n_satisfied = 0
    first, end = 0, N_MODES
    if not states.has_friction(d):
        first, end = N_FREEWHEEL_MODES, 2 * N_FREEWHEEL_MODES  # The slip is positive by convention
    for number in range(first, end):
        if not set_mode(d, x, number):
            continue
        load_state(d, x)
        violation = mode_violation(d, x, prescribed, x.load_torque)
        if use_lookahead and violation > -CONTINUATION_BIAS:
            continue  # Another mode satisfies its conditions now and for a moment at least
        if use_lookahead and violation <= VIOLATION_RTOL:
            extrapolate_motion(d, x)
            violation = mode_violation(d, x, prescribed, x.load_torque)
        violation = max(violation - VIOLATION_RTOL, 0.0)
        n_satisfied += violation == 0.0
        is_same = x.housing_state == housing_before and x.output_state == output_before
        if is_same and x.slip_sign == slip_before:
            violation += bias
        if violation < min_violation:
            min_violation = violation
            best = number
    return best, n_satisfied


def select_mode(d: Constants, x: State, bias: float) -> None:
    """Select the contact mode for the motion in ``x`` and write it with its accelerations and torques.

    If several modes satisfy their conditions, the mode is selected that satisfies them a moment later.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State; the contact mode, signs and ``x.now`` are written.
        bias: Added to the relative violation of the present mode.
    """
    housing, output, slip = x.housing_state, x.output_state, x.slip_sign
    best, n_satisfied = enumerate_modes(d, x, housing, output, slip, bias, False)
    if n_satisfied > 1:
        best, _ = enumerate_modes(d, x, housing, output, slip, bias, True)
    set_mode(d, x, best)
    enforce_equal_speeds(x)
    load_state(d, x)
    evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)
    x.flow_sign, x.tau6_signs = d.machine.flow_sign, d.machine.tau6_signs
    copy_accelerations(x.now, d.machine)
    x.rates_cached = 0.0 if d.losses != 0.0 else 1.0
    x.mode = states.contact_mode(x)


def switch_mode(d: Constants, x: State, bias: float) -> None:
    """Select the contact mode during a motion, and count the evaluation and the freewheel switching events.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State; the contact mode and the counters are written.
        bias: Added to the relative violation of the present mode.
    """
    mode, housing, output = x.mode, x.housing_state, x.output_state
    select_mode(d, x, bias)
    x.step_evaluations += 1.0
    m = d.machine
    if x.mode != mode:
        x.switches += 1.0
    if states.is_engagement(housing, x.housing_state, d.housing_drag, d.housing_engagement_angle, m.housing):
        x.housing_engagements += 1.0
    if states.is_engagement(output, x.output_state, d.output_drag, d.output_engagement_angle, m.output):
        x.output_engagements += 1.0


def select_mode_after_event(d: Constants, x: State) -> bool:
    """Select the contact mode after an event and return True if it has changed.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State; ``slip_reached_zero`` and ``mode_ended`` describe the event.
    """
    housing, output, slip = x.housing_state, x.output_state, x.slip_sign
    if x.slip_reached_zero != 0.0:
        x.slip_sign = 0.0
        enforce_equal_speeds(x)
    switch_mode(d, x, HYSTERESIS if x.mode_ended != 0.0 else 0.0)
    return x.housing_state != housing or x.output_state != output or x.slip_sign != slip
