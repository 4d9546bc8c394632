"""Exact motion of z'' + rate z' + square z = 0, and of its integrals, in every damping regime.

The answer to an impulse is a closed form, of exponentials that only fade. Its integrals, divided
differences of the exponential, would cancel in closed form where the characteristic numbers meet each
other (critical damping) or zero (soft shaft, short step). They are found over a part of the step, where
the equation, integrated, gives each from the next two, and then from each time to twice that time:
scaling and squaring, with sums of what is mostly positive. The cost grows with the logarithm of
the step; nothing overflows.
Moler and Van Loan, Nineteen dubious ways to compute the exponential of a matrix, SIAM Review 45 (2003),
methods 3 and 14.
"""

import math

# up to this fast * t the equation gives the integrals, from the one of this order down
SHORT = 0.25
HIGHEST = 13


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


def integrals(rate, square, t):
    """First to fourth integral of the answer to an impulse 1, for fast * t up to SHORT.

    Integral n is t^(n+1)/(n+1)! less rate times the next and square times the one after.
    """
    damp = rate * t
    spring = square * t * t
    # each over its t^(n+1)/(n+1)!
    five = 1.0
    four = 1.0
    for n in range(HIGHEST, 3, -1):
        five, four = four, 1.0 - (damp * four + spring * five / (n + 3.0)) / (n + 2.0)
    three = 1.0 - (damp * four + spring * five / 6.0) / 5.0
    two = 1.0 - (damp * three + spring * four / 5.0) / 4.0
    one = 1.0 - (damp * two + spring * three / 4.0) / 3.0
    square_half = 0.5 * t * t
    cube = square_half * t / 3.0
    return square_half * one, cube * two, 0.25 * t * cube * three, 0.05 * t * t * cube * four


def short_part(fast, t):
    """Part of t that is short, and how often doubled it is t."""
    count = 0
    while fast * t > SHORT:
        t *= 0.5
        count += 1
    return t, count


def responses(rate, square, swing, slow, fast, t):
    """Everything a step of length t > 0 needs.

    Args:
        rate, square: of the equation, 1/s and 1/s^2. swing, slow, fast: of characteristic. t: s.

    Returns:
        (step, slope, impulse, one, two, three, four): answer to a displacement 1, rate of the answer to
        an impulse 1, this answer, and its first to fourth integrals from 0 to t.
    """
    part, count = short_part(fast, t)
    one, two, three, four = integrals(rate, square, part)
    for _ in range(count):
        step, impulse, slope = free(swing, slow, fast, part)
        # the integrals of step: impulse + rate one and so on
        four += impulse * (three + rate * four) + slope * four
        four += part * (three + part * (0.5 * two + part / 6.0 * one))
        three += impulse * (two + rate * three) + slope * three + part * (two + 0.5 * part * one)
        two += impulse * (one + rate * two) + slope * two + part * one
        one += impulse * (impulse + rate * one) + slope * one
        part *= 2.0
    step, impulse, slope = free(swing, slow, fast, t)
    return step, slope, impulse, one, two, three, four
