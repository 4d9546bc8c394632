"""Event indicators (guards): quantities that stay positive as long as freewheels and slip keep their states.

- freewheel that overruns: its slip;
- locked freewheel: its torque plus its drag;
- freewheel within its engagement angle: the remaining angle, and its backward speed;
- links 1 and 2 that slip: the slip times its sign;
- links 1 and 2 that stick: the friction reserve;
- meshes with losses: their torques times the signs that the losses depend on.
"""

from ..equations.states import ENGAGED_COMPLIANT, IN_BACKLASH, LOCKED, OVERRUNNING, has_friction, is_open
from ..records import Constants, Doubles, Machine, State, Workspace
from ..tableau import NODES, dense_change, dense_rate, last_stage

# Numbers of the indicators
HOUSING = 0
OUTPUT = 1
SLIP = 2
# Reversal of a freewheel within its engagement angle
HOUSING_BACK = 3
OUTPUT_BACK = 4
FLOW = 5  # Torque of the mesh 2-16
TAU6 = 6  # Torque tau6 in the mesh 17-6 of satellite 0; the other satellites follow
# Fraction of the range of an indicator in a step. If all stages are above it, there is no zero between them
CLEAR_FRACTION = 0.25


def n_indicators(d: Constants) -> int:
    """Return the number of event indicators; the torques of the meshes 17-6 are the last ones."""
    if d.losses == 0.0:
        return SLIP
    if d.satellite_loss == 0.0:
        return TAU6
    return TAU6 + int(d.satellites)


def is_watched(d: Constants, x: State, which: int) -> bool:
    """Return True if this event indicator can end the present contact mode."""
    if which == SLIP:
        return has_friction(d)
    if which >= FLOW:
        return x.slip_sign != 0.0 and (which > FLOW or d.mesh_loss != 0.0)
    if which == HOUSING_BACK:
        return x.housing_state == IN_BACKLASH or (x.housing_state == LOCKED and x.play_housing > 0.0)
    if which == OUTPUT_BACK:
        return x.output_state == IN_BACKLASH or (x.output_state == LOCKED and x.play_output > 0.0)
    return (d.housing_freewheel if which == HOUSING else d.output_freewheel) != 0.0


def freewheel_state(x: State, which: int) -> float:
    """Return the state of the freewheel of an indicator."""
    return x.housing_state if which == HOUSING or which == HOUSING_BACK else x.output_state


def is_play(x: State, which: int) -> bool:
    """Return True if the indicator is the remaining engagement angle of a freewheel."""
    return which < SLIP and freewheel_state(x, which) == IN_BACKLASH


def is_speed(x: State, which: int) -> bool:
    """Return True if the indicator is a speed or an angle, whose rate is known; otherwise it is a torque."""
    if which == SLIP:
        return x.slip_sign != 0.0
    return which < FLOW and is_open(freewheel_state(x, which))


def is_spring(x: State, which: int) -> bool:
    """Return True if the indicator is the torque of the spring of a freewheel."""
    return which < SLIP and freewheel_state(x, which) == ENGAGED_COMPLIANT


def housing_indicator(d: Constants, x: State, m: Machine) -> tuple[float, float]:
    """Return the indicator of the housing freewheel and its rate (see value_and_rate)."""
    if x.housing_state == OVERRUNNING:
        return m.omega2, m.alpha2
    if x.housing_state == IN_BACKLASH:
        return m.play_housing, m.omega2
    return m.housing + d.housing_drag, m.housing + d.housing_drag


def output_indicator(d: Constants, x: State, m: Machine) -> tuple[float, float]:
    """Return the indicator of the output freewheel and its rate (see value_and_rate)."""
    if x.output_state == OVERRUNNING:
        return m.omega3 - m.omega2, m.alpha3 - m.alpha2
    if x.output_state == IN_BACKLASH:
        return m.play_output, m.omega3 - m.omega2
    return m.output + d.output_drag, m.output + d.output_drag


def slip_indicator(x: State, m: Machine) -> tuple[float, float]:
    """Return the indicator of the slip of links 1 and 2, and its rate (see value_and_rate)."""
    if x.slip_sign == 0.0:
        return m.friction_reserve, m.friction_reserve
    return x.slip_sign * (m.omega1 - m.omega2), x.slip_sign * (m.alpha1 - m.alpha2)


def reversal_indicator(x: State, m: Machine, which: int) -> tuple[float, float]:
    """Return the indicator of a freewheel that turns back, and its rate (see value_and_rate)."""
    if which == HOUSING_BACK:
        return (-m.omega2, -m.alpha2) if x.housing_state == IN_BACKLASH else (-m.housing, -m.housing)
    if x.output_state == IN_BACKLASH:
        return m.omega2 - m.omega3, m.alpha2 - m.alpha3
    return -m.output, -m.output


def value_and_rate(d: Constants, x: State, m: Machine, which: int) -> tuple[float, float]:
    """Return an event indicator and its rate.

    Args:
        d: Constants.
        x: State.
        m: d.machine after motion.evaluate.
        which: Number of the indicator.

    Returns:
        Value, rate; of a torque, whose rate is not known, the value again.
    """
    if which == FLOW:
        return x.flow_sign * m.flow_torque, x.flow_sign * m.flow_torque
    if which >= TAU6:
        return m.mesh_friction_by[which - TAU6], m.mesh_friction_by[which - TAU6]
    if which == SLIP:
        return slip_indicator(x, m)
    if which == HOUSING:
        return housing_indicator(d, x, m)
    if which == OUTPUT:
        return output_indicator(d, x, m)
    return reversal_indicator(x, m, which)


def range_of(values: Doubles, last: int) -> tuple[float, float]:
    """Return the minimum and the maximum of the values up to a stage."""
    low = high = values[0]
    for n in range(1, last + 1):
        low = min(low, values[n])
        high = max(high, values[n])
    return low, high


def is_clear(x: State, w: Workspace, which: int) -> bool:
    """Return True if the stages of the step exclude a zero crossing of an indicator.

    One of three conditions is sufficient: all values are far above zero; the indicator is a speed that only
    grows, or only falls to a positive value; or it rises from its initial value at all stages.
    """
    values = w.indicators[which].value
    pair = int(w.pair)
    last = last_stage(pair)
    low, high = range_of(values, last)
    if low > CLEAR_FRACTION * (high - low):
        return True
    if is_speed(x, which):
        lowest, highest = range_of(w.indicators[which].rate, last)
        if lowest >= 0.0 or (highest <= 0.0 and values[last] > 0.0):
            return True
    start = values[0]
    min_growth = max_growth = values[last] - start
    for n in range(1, last + 1):
        growth = (values[n] - start) / NODES[pair + n]
        min_growth = min(min_growth, growth)
        max_growth = max(max_growth, growth)
    return start >= 0.0 and min_growth > CLEAR_FRACTION * (max_growth - min_growth)


def fitted_guard(x: State, w: Workspace, which: int, sigma: float) -> float:
    """Return an indicator at the fraction sigma of the step by its dense output.

    A negative value at the beginning is round-off and is subtracted, except for a spring.
    """
    dense, start = w.indicators[which].dense, w.indicators[which].value[0]
    if is_speed(x, which):
        return max(start, 0.0) + dense_change(dense, sigma)
    return dense_rate(dense, sigma) / w.step - (0.0 if is_spring(x, which) else min(start, 0.0))
