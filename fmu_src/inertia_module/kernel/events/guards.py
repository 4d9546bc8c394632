"""Guards: quantities that stay positive as long as freewheels and slip keep their states.

Of a freewheel that overruns its speed, of one that is locked its torque with its drag; of one that turns back
through its play what is left of it, and that it does not turn again. Of links that slip
the slip by its sign, of links that stick together what is left of the friction that holds them. Of the meshes
their torques, by the signs that the losses go by.
"""

from ..equations.satellites import MANY
from ..equations.states import CLOSING, LOCKED, OPEN, WOUND, is_open, is_rough
from ..tableau import NODES, PARTS, THIRDS, dense_change, dense_rate, last_stage

HOUSING = 0
OUTPUT = 1
SLIP = 2
# ... of a freewheel within its play, besides
HOUSING_BACK = 3
OUTPUT_BACK = 4
FLOW = 5
SPIN = 6
# share of the step over which the slope of a torque inside it is differenced
APART = 1e-4
# share of its range in the step that a guard stays above at all stages if it does between them
CLEAR = 0.25


def how_many_guards(d):
    """How many guards there are: the torques of the meshes 17-6 are the last ones."""
    if d.losses == 0.0:
        return SLIP
    if d.satellite_loss == 0.0 or d.satellites > MANY:
        return SPIN
    return SPIN + int(d.satellites)


def is_watched(d, x, which):
    """Tell whether this guard can end what is."""
    if which == SLIP:
        return is_rough(d)
    if which >= FLOW:
        return x.slip_sign != 0.0 and (which > FLOW or d.mesh_loss != 0.0)
    if which == HOUSING_BACK:
        return x.housing_state == CLOSING or (x.housing_state == LOCKED and x.play_housing > 0.0)
    if which == OUTPUT_BACK:
        return x.output_state == CLOSING or (x.output_state == LOCKED and x.play_output > 0.0)
    return (d.housing if which == HOUSING else d.output) != 0.0


def state_of(x, which):
    """State of the freewheel that the guard is of."""
    return x.housing_state if which == HOUSING or which == HOUSING_BACK else x.output_state


def is_play(x, which):
    """Tell whether the guard is the play that is left of a freewheel."""
    return which < SLIP and state_of(x, which) == CLOSING


def is_speed(x, which):
    """Tell whether the guard is a speed or an angle, whose rate is known, else a torque."""
    if which == SLIP:
        return x.slip_sign != 0.0
    return which < FLOW and is_open(state_of(x, which))


def is_spring(x, which):
    """Tell whether the guard is the torque of a freewheel's spring."""
    return which < SLIP and state_of(x, which) == WOUND


def is_exact(x, which):
    """Tell whether the guard is looked at by the equations inside a step, not by its fit.

    The freewheel's torque and what is left of friction end a mode: the fit is off by what the step is.
    """
    return which < FLOW and not is_speed(x, which) and not is_spring(x, which)


def value_and_rate(d, x, m, which):
    """A guard, and its rate if it is a speed, else itself once more; m: d.machine after motion.evaluate."""
    if which == FLOW:
        return x.flow_sign * m.torque, x.flow_sign * m.torque
    if which >= SPIN:
        return m.spun_by[which - SPIN], m.spun_by[which - SPIN]
    if which == SLIP:
        return m.margin, (x.slip_sign * (m.alpha1 - m.alpha2) if x.slip_sign != 0.0 else m.margin)
    if which == HOUSING:
        if x.housing_state == OPEN:
            return m.omega2, m.alpha2
        if x.housing_state == CLOSING:
            return m.play_housing, m.omega2
        return m.housing + d.housing_drag, m.housing + d.housing_drag
    if which == OUTPUT:
        if x.output_state == OPEN:
            return m.omega3 - m.omega2, m.alpha3 - m.alpha2
        if x.output_state == CLOSING:
            return m.play_output, m.omega3 - m.omega2
        return m.output + d.output_drag, m.output + d.output_drag
    if which == HOUSING_BACK:
        if x.housing_state == CLOSING:
            return -m.omega2, -m.alpha2
        return -m.housing, -m.housing
    if x.output_state == CLOSING:
        return m.omega2 - m.omega3, m.alpha2 - m.alpha3
    return -m.output, -m.output


def ends_of(values, last):
    """The least and the largest of the values up to stage last."""
    low = high = values[0]
    for n in range(1, last + 1):
        low = min(low, values[n])
        high = max(high, values[n])
    return low, high


def is_clear(x, w, which):
    """Tell whether a guard does not fall in the step, by its stages.

    It is far above zero at all of them, or grows away from its beginning, or it is a speed that only grows or
    only falls, not to zero.
    """
    values = w.watched[which].value
    pair = int(w.pair)
    last = last_stage(pair)
    low, high = ends_of(values, last)
    if low > CLEAR * (high - low):
        return True
    if is_speed(x, which):
        lowest, highest = ends_of(w.watched[which].rate, last)
        if lowest >= 0.0 or (highest <= 0.0 and values[last] > 0.0):
            return True
    start = values[0]
    least = most = values[last] - start
    for n in range(1, last + 1):
        growth = (values[n] - start) / NODES[pair + n]
        least = min(least, growth)
        most = max(most, growth)
    return start >= 0.0 and least > CLEAR * (most - least)


def fit_through(x, w, which):
    """Fit the inside of the stiff step through its ends and thirds, a speed by the rates at the ends too."""
    one = w.watched[which]
    change = one.value[PARTS] - one.value[0]
    first = 4.5 * (one.value[1] - one.value[0] - change / 3.0)
    second = 4.5 * (one.value[2] - one.value[0] - change / 1.5)
    one.dense[0] = change
    one.dense[1] = 2.0 * first - second
    one.dense[2] = 3.0 * (second - first)
    one.dense[3] = one.dense[4] = one.dense[5] = one.dense[6] = 0.0
    if is_speed(x, which):
        begin, end = w.step * one.rate[0] - change, change - w.step * one.rate[PARTS]
        one.dense[1] = begin
        one.dense[2] = end - begin
        one.dense[3] = 2.25 * (first + second - begin - end)


def fitted_guard(x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma, from its fit.

    What the guard lacks of zero at the beginning is rounding, and left out, but that of a spring.
    """
    one = w.watched[which]
    start = one.value[0]
    if w.pair == THIRDS:
        shift = 0.0 if is_spring(x, which) else min(start, 0.0)
        return start - shift + dense_change(one.dense, sigma), dense_rate(one.dense, sigma)
    if is_speed(x, which):
        return max(start, 0.0) + dense_change(one.dense, sigma), dense_rate(one.dense, sigma)
    per_step = 1.0 / w.step
    value = per_step * dense_rate(one.dense, sigma)
    slope = per_step * (dense_rate(one.dense, sigma + APART) - dense_rate(one.dense, sigma - APART))
    return value - (0.0 if is_spring(x, which) else min(start, 0.0)), 0.5 * slope / APART


def fourth_bound_of_fit(x, w, which):
    """Bound of the fourth derivative of the fit."""
    dense = w.watched[which].dense
    if is_speed(x, which) or w.pair == THIRDS:
        return 24.0 * abs(dense[3]) + 72.0 * (abs(dense[4]) + abs(dense[5])) + 96.0 * abs(dense[6])
    return (120.0 * abs(dense[4]) + 360.0 * abs(dense[5]) + 720.0 * abs(dense[6])) / w.step
