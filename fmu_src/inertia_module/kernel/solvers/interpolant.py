"""Results, errors and the inside of a step of the embedded pair, from the rates at its stages."""

import math

from .dormand_prince import (
    DENSE_3,
    DENSE_4,
    DENSE_5,
    DENSE_6,
    END,
    RESULT,
    STAGES,
    dense_3,
    dense_4,
    dense_5,
    dense_6,
    fifth,
    third,
)
from .dormand_prince import sum_12 as result
from .dormand_prince_5 import fourth
from .dormand_prince_5 import sum_6 as short_result


def error_norm(w, scale_q, scale_omega2, others, scale_others):
    """Estimated error of the step over the allowed one (Hairer's mix of orders 5 and 3).

    Args:
        others: one more block of rates, whose integral counts where an error scale_others of it is allowed
            (else 0): P with a ramp of omega1, or omega1' where that is a state.
    """
    q5 = fifth(w.rate_q) / scale_q
    q3 = third(w.rate_q) / scale_q
    v5 = fifth(w.rate_omega2) / scale_omega2
    v3 = third(w.rate_omega2) / scale_omega2
    sum5 = q5 * q5 + v5 * v5
    sum3 = q3 * q3 + v3 * v3
    if scale_others > 0.0:
        p5 = fifth(others) / scale_others
        p3 = third(others) / scale_others
        sum5 += p5 * p5
        sum3 += p3 * p3
    mix = sum5 + 0.01 * sum3
    if mix == 0.0:
        return 0.0
    return w.step * sum5 / math.sqrt(2.0 * mix)


def fit_dense(h, rates, dense):
    """Coefficients of the interpolant of a quantity with these rates at all stages, into dense."""
    change = h * result(rates)
    dense[0] = change
    dense[1] = h * rates[0] - change
    dense[2] = 2.0 * change - h * (rates[0] + rates[END])
    dense[3] = h * dense_3(rates)
    dense[4] = h * dense_4(rates)
    dense[5] = h * dense_5(rates)
    dense[6] = h * dense_6(rates)


def dense_change(dense, sigma):
    """Change since the beginning of the step at the fraction sigma of it (order 7)."""
    rest = 1.0 - sigma
    y = (dense[5] + sigma * dense[6]) * rest
    y = (dense[4] + y) * sigma
    y = (dense[3] + y) * rest
    y = (dense[2] + y) * sigma
    y = (dense[1] + y) * rest
    return (dense[0] + y) * sigma


def dense_rate(dense, sigma):
    """Derivative of dense_change in sigma."""
    rest = 1.0 - sigma
    y = dense[5] + sigma * dense[6]
    slope = dense[6] * rest - y
    y = dense[4] + y * rest
    slope = slope * sigma + y
    y = dense[3] + y * sigma
    slope = slope * rest - y
    y = dense[2] + y * rest
    slope = slope * sigma + y
    y = dense[1] + y * sigma
    slope = slope * rest - y
    return slope * sigma + dense[0] + y * rest


def dense_fourth_bound(dense):
    """Bound of the fourth derivative of dense_change in sigma."""
    return 24.0 * abs(dense[3]) + 72.0 * (abs(dense[4]) + abs(dense[5])) + 96.0 * abs(dense[6])


def dense_rate_fourth_bound(dense):
    """Bound of the fourth derivative of dense_rate in sigma."""
    return 120.0 * abs(dense[4]) + 360.0 * abs(dense[5]) + 720.0 * abs(dense[6])


def short_error_norm(w, scale_q, scale_omega2, others, scale_others):
    """Error of a step of the pair of order 5: root of the mean square."""
    q = fourth(w.rate_q) / scale_q
    v = fourth(w.rate_omega2) / scale_omega2
    square = q * q + v * v
    if scale_others > 0.0:
        p = fourth(others) / scale_others
        square += p * p
    return w.step * math.sqrt(0.5 * square)


def step_mean(w, rates):
    """Mean over the step in hand of the quantity with these rates at its stages."""
    return short_result(rates) if w.short != 0.0 else result(rates)


def integral(w, values, sigma):
    """Integral over the step (sigma < 0) or its part sigma of a quantity with these values at the stages."""
    if sigma < 0.0:
        return w.step * step_mean(w, values)
    fit_dense(w.step, values, w.dense_other)
    return dense_change(w.dense_other, sigma)


def inside_weights(sigma, weights):
    """Write the weights of the rates at the stages in dense_change at the fraction sigma into weights."""
    rest = 1.0 - sigma
    for n in range(STAGES):
        whole = RESULT[n] if n < END else 0.0
        begin = 1.0 if n == 0 else 0.0
        end = 1.0 if n == END else 0.0
        y = DENSE_4[n] + rest * (DENSE_5[n] + sigma * DENSE_6[n])
        y = 2.0 * whole - begin - end + rest * (DENSE_3[n] + sigma * y)
        weights[n] = sigma * (whole + rest * (begin - whole + sigma * y))
