"""Exact motion of z'' + rate z' + square z = 0, and of its integrals, in every damping regime.

The answer to an impulse is a closed form, of exponentials that only fade. Its integrals would cancel in
closed form where the characteristic numbers meet each other (critical damping) or zero (soft shaft, short
step). They are Gauss sums over a short part of the step, and found over twice the time from those over the
time: scaling and squaring, by sums of what is mostly positive. The cost grows with the logarithm of the
step, and nothing overflows. Moler and Van Loan, Nineteen dubious ways to compute the exponential of a
matrix, SIAM Review 45 (2003), methods 3 and 14.
"""

import math

from ..gauss import GAUSS_NODE_1, GAUSS_NODE_2, GAUSS_WEIGHT_1, GAUSS_WEIGHT_2, GAUSS_WEIGHT_3

# up to this fast * t a sum over the nodes within [0, 1] is exact to rounding
SHORT = 1.0 / 64.0
NODES = (GAUSS_NODE_1, GAUSS_NODE_2, 0.5, 1.0 - GAUSS_NODE_2, 1.0 - GAUSS_NODE_1)
WEIGHTS = (GAUSS_WEIGHT_1, GAUSS_WEIGHT_2, GAUSS_WEIGHT_3, GAUSS_WEIGHT_2, GAUSS_WEIGHT_1)


def characteristic(rate, square):
    """Characteristic numbers of z'' + rate z' + square z, rate >= 0 and square > 0.

    Returns:
        (swing, slow, fast), 1/s. Underdamped: -slow +- i swing, and fast is their magnitude.
        Else swing = 0 and they are -slow and -fast, slow <= fast.
    """
    half = 0.5 * rate
    natural = math.sqrt(square)
    root = math.sqrt(abs(natural - half)) * math.sqrt(natural + half)
    if natural > half:
        return root, half, natural
    fast = half + root
    # the slow one by Vieta: half - root would cancel at strong damping
    return 0.0, square / fast, fast


def free(swing, slow, fast, t):
    """Answers at t to an initial displacement 1 and to an initial rate 1.

    Returns:
        (step, impulse, impulse'): z(t) from (1, 0), z(t) and z'(t) from (0, 1).
    """
    if swing > 0.0:
        fading = math.exp(-slow * t)
        cosine = fading * math.cos(swing * t)
        impulse = fading * math.sin(swing * t) / swing
        return cosine + slow * impulse, impulse, cosine - slow * impulse
    spread = fast - slow
    fading = math.exp(-fast * t)
    impulse = t * fading
    if spread > 0.0:
        impulse = math.exp(-slow * t) * -math.expm1(-spread * t) / spread
    return fading + fast * impulse, impulse, fading - slow * impulse


def responses(rate, square, swing, slow, fast, t):
    """Everything a step of length t > 0 needs.

    Args:
        rate, square: of the equation, 1/s and 1/s^2. swing, slow, fast: of characteristic. t: s.

    Returns:
        (step, slope, impulse, one, two, three, four): answer to a displacement 1, rate of the answer to
        an impulse 1, this answer, and its first to fourth integrals from 0 to t.
    """
    part = t
    while fast * part > SHORT:
        part *= 0.5
    one = two = three = four = 0.0
    for n in range(5):
        left = part - part * NODES[n]
        _, impulse, _ = free(swing, slow, fast, part * NODES[n])
        share = part * WEIGHTS[n] * impulse
        one += share
        two += share * left
        three += share * left * left / 2.0
        four += share * left * left * left / 6.0
    while part < t:
        _, impulse, slope = free(swing, slow, fast, part)
        # the integrals of step: impulse + rate one and so on
        four += impulse * (three + rate * four) + slope * four
        four += part * (three + part * (0.5 * two + part / 6.0 * one))
        three += impulse * (two + rate * three) + slope * three + part * (two + 0.5 * part * one)
        two += impulse * (one + rate * two) + slope * two + part * one
        one += impulse * (impulse + rate * one) + slope * one
        part *= 2.0
    step, impulse, slope = free(swing, slow, fast, t)
    return step, slope, impulse, one, two, three, four
