"""Results, errors and the inside of a step of the embedded pair, from the rates at its stages."""

import math

from .dormand_prince import DENSE, END, FIFTH, FIRST, STAGES, THIRD, WEIGHTS


def result(rates):
    """Mean over the step, of order 8, of the quantity with these rates at the stages."""
    total = WEIGHTS[STAGES * END] * rates[0]
    for n in range(FIRST[END], END):
        total += WEIGHTS[STAGES * END + n] * rates[n]
    return total


def embedded_errors(rates, scale):
    """Errors of orders 5 and 3 over the step size and the error allowed."""
    fifth = FIFTH[0] * rates[0]
    third = THIRD[0] * rates[0]
    for n in range(FIRST[END], END):
        fifth += FIFTH[n] * rates[n]
        third += THIRD[n] * rates[n]
    return fifth / scale, third / scale


def error_norm(w, scale_q, scale_omega2, third, scale_third):
    """Estimated error of the step over the allowed one (Hairer's mix of orders 5 and 3).

    Args:
        third: one more block of rates, whose integral counts where an error scale_third of it is allowed (else
            0): P with a ramp of omega1, or omega1' where that is a state.
    """
    q5, q3 = embedded_errors(w.rate_q, scale_q)
    v5, v3 = embedded_errors(w.rate_omega2, scale_omega2)
    sum5 = q5 * q5 + v5 * v5
    sum3 = q3 * q3 + v3 * v3
    if scale_third > 0.0:
        p5, p3 = embedded_errors(third, scale_third)
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
    for m in range(4):
        total = DENSE[STAGES * m] * rates[0]
        for n in range(FIRST[END], STAGES):
            total += DENSE[STAGES * m + n] * rates[n]
        dense[3 + m] = h * total


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


def integral(w, values, sigma):
    """Integral over the step (sigma < 0) or its part sigma of a quantity with these values at the stages."""
    if sigma < 0.0:
        return w.step * result(values)
    fit_dense(w.step, values, w.dense_other)
    return dense_change(w.dense_other, sigma)
