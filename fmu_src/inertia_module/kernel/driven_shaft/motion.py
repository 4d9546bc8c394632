"""Motion of the shaft over a step: value at the end, integrals, integral of the square.

Twist, slip, speed of the driven mass and their rates all move as

    z1' = z2 - rate z1      z2' = z3 - square z1      z3' = z4      z4' = 0

from a z at the beginning: z1(t) = z1 slope + z2 impulse + z3 one + z4 two, of responses.
The integral of its square is a quadratic form of the z. The form's matrix, the Gramian W, is a Gauss sum
over a short part of the step and doubled: W(2t) = W(t) + E(t)^T W(t) E(t), where z(t) = E(t) z. As a sum
of squares it is exact to rounding for any stiffness and step, and it owes nothing to the balance of energy.
Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Automatic Control 23 (1978).

Exact motion of z'' + rate z' + square z = 0, and of its integrals, in every damping regime.

The answer to an impulse is a closed form, of exponentials that only fade. Its integrals would cancel in
closed form where the characteristic numbers meet each other (critical damping) or zero (soft shaft, short
step). They are Gauss sums over a short part of the step, and found over twice the time from those over the
time: scaling and squaring, by sums of what is mostly positive. The cost grows with the logarithm of the
step, and nothing overflows. Moler and Van Loan, Nineteen dubious ways to compute the exponential of a
matrix, SIAM Review 45 (2003), methods 3 and 14.
"""

import math

from ..accumulate import add, clear, copy
from ..tableau import GAUSS_NODES as NODES
from ..tableau import GAUSS_WEIGHTS as WEIGHTS

# up to this fast * t a sum over the nodes within [0, 1] is exact to rounding
SHORT = 1.0 / 64.0


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


def write_move(d, w, t):
    """Put E(t) into w.move, row by row."""
    step, slope, impulse, one, two, _, _ = responses(d.rate, d.square, d.swing, d.slow, d.fast, t)
    copy(w.move, (
        slope, impulse, one, two,
        -d.square * impulse, step, impulse + d.rate * one, one + d.rate * two,
        0.0, 0.0, 1.0, t,
        0.0, 0.0, 0.0, 1.0,
    ))  # fmt: skip


def write_gramian(d, w, t):
    """Put the Gramian over t into d, row by row."""
    part = t
    while d.fast * part > SHORT:
        part *= 0.5
    clear(d.gramian)
    for n in range(5):
        write_move(d, w, part * NODES[n])
        for i in range(16):
            d.gramian[i] += part * WEIGHTS[n] * w.move[i // 4] * w.move[i % 4]
    while part < t:
        write_move(d, w, part)
        for i in range(16):
            w.product[i] = 0.0
            for k in range(4):
                w.product[i] += d.gramian[i - i % 4 + k] * w.move[4 * k + i % 4]
        for i in range(16):
            for k in range(4):
                d.gramian[i] += w.move[4 * k + i // 4] * w.product[4 * k + i % 4]
        part *= 2.0


def keep_step(d, w, h):
    """Put Gramian and responses of a step h into d, unless they are there: most steps are alike."""
    if h != d.step:
        d.step = h
        write_gramian(d, w, h)
        copy(d.responses, responses(d.rate, d.square, d.swing, d.slow, d.fast, h))


def integral(d, z, order):
    """Integral of a motion over the step kept; that of the integral for order 2, z1 at the end for 0."""
    total = 0.0
    for n in range(4):
        total += z[n] * d.responses[n + order + 1]
    return total


def square_integral(d, z):
    """Integral of the square of a motion over the step kept."""
    total = 0.0
    for i in range(16):
        total += z[i // 4] * z[i % 4] * d.gramian[i]
    return total


def end(d, z, rate, low):
    """z1 at the end of the step kept, with its low part: small changes add up, else nothing old is left."""
    change = integral(d, rate, 1)
    if abs(change) < 0.5 * abs(z[0]):
        return add(z[0], low, change)
    return integral(d, z, 0), 0.0
