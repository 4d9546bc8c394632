"""Motion of the shaft over a step: value at the end, integrals, integral of the square.

Twist, slip, speed of the driven mass and their rates all move as

    z1' = z2 - rate z1      z2' = z3 - square z1      z3' = z4      z4' = 0

from a z at the beginning: z1(t) = z1 slope + z2 impulse + z3 one + z4 two, of responses.
The integral of its square is a quadratic form of the z, its matrix the Gramian W. Over a part of the step
so short that nothing swings or fades W and the integrals of the answer to an impulse are Gauss sums; then
both are doubled: W(2t) = W(t) + E(t)^T W(t) E(t), where z(t) = E(t) z. The answer itself is a closed form,
of exponentials that only fade; its integrals would cancel in closed form where the characteristic numbers
meet each other (critical damping) or zero (soft shaft, short step). So all is exact to rounding for any
stiffness and step, nothing overflows, and nothing is owed to the balance of energy. Moler and Van Loan,
Nineteen dubious ways to compute the exponential of a matrix, SIAM Review 45 (2003), methods 3 and 14; Van
Loan, Computing integrals involving the matrix exponential, IEEE Trans. Automatic Control 23 (1978).
"""

import math

from ..accumulate import add, clear
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


def short_integrals(d, t):
    """First to fourth integral from 0 to t of the answer to an impulse 1, t so short that a sum is exact."""
    one = two = three = four = 0.0
    for n in range(5):
        left = t - t * NODES[n]
        _, impulse, _ = free(d.swing, d.slow, d.fast, t * NODES[n])
        share = t * WEIGHTS[n] * impulse
        one += share
        two += share * left
        three += share * left * left / 2.0
        four += share * left * left * left / 6.0
    return one, two, three, four


def write_row(matrix, row, a, b, c, d):
    """Write the four numbers of a row into a 4x4 matrix."""
    matrix[4 * row] = a
    matrix[4 * row + 1] = b
    matrix[4 * row + 2] = c
    matrix[4 * row + 3] = d


def write_move(d, w, t, one, two):
    """Put E(t) into w.move, row by row, from the first two of these integrals."""
    step, impulse, slope = free(d.swing, d.slow, d.fast, t)
    write_row(w.move, 0, slope, impulse, one, two)
    write_row(w.move, 1, -d.square * impulse, step, impulse + d.rate * one, one + d.rate * two)
    write_row(w.move, 2, 0.0, 0.0, 1.0, t)
    write_row(w.move, 3, 0.0, 0.0, 0.0, 1.0)


def double_gramian(d, w):
    """Double the time of the Gramian in d, that of w.move."""
    for i in range(16):
        w.product[i] = 0.0
        for k in range(4):
            w.product[i] += d.gramian[i - i % 4 + k] * w.move[4 * k + i % 4]
    for i in range(16):
        for k in range(4):
            d.gramian[i] += w.move[4 * k + i // 4] * w.product[4 * k + i % 4]


def keep_step(d, w, h):
    """Put Gramian and responses of a step h into d, unless they are there: most steps are alike."""
    if h == d.step:
        return
    d.step = h
    part = h
    while d.fast * part > SHORT:
        part *= 0.5
    clear(d.gramian)
    for n in range(5):
        one, two, _, _ = short_integrals(d, part * NODES[n])
        write_move(d, w, part * NODES[n], one, two)
        for i in range(16):
            d.gramian[i] += part * WEIGHTS[n] * w.move[i // 4] * w.move[i % 4]
    one, two, three, four = short_integrals(d, part)
    rate = d.rate
    while part < h:
        write_move(d, w, part, one, two)
        double_gramian(d, w)
        slope, impulse = w.move[0], w.move[1]
        # the integrals of step: impulse + rate one and so on
        four += impulse * (three + rate * four) + slope * four
        four += part * (three + part * (0.5 * two + part / 6.0 * one))
        three += impulse * (two + rate * three) + slope * three + part * (two + 0.5 * part * one)
        two += impulse * (one + rate * two) + slope * two + part * one
        one += impulse * (impulse + rate * one) + slope * one
        part *= 2.0
    _, impulse, slope = free(d.swing, d.slow, d.fast, h)
    d.responses[0] = slope
    d.responses[1] = impulse
    d.responses[2] = one
    d.responses[3] = two
    d.responses[4] = three
    d.responses[5] = four


def integral(d, z, order):
    """Integral of a motion over the step kept; that of the integral for order 2, z1 at the end for 0."""
    total = 0.0
    for n in range(4):
        total += z[n] * d.responses[n + order]
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
