"""Motion of the shaft over a step: value at the end, integrals, integral of the square.

Twist, slip, speed of the driven mass and their rates all move as

    z1' = z2 - rate z1      z2' = z3 - square z1      z3' = z4      z4' = 0

from a z at the beginning: z1(t) = z1 slope + z2 impulse + z3 one + z4 two, of propagator.responses.
The integral of its square is a quadratic form of the z. The form's matrix, the Gramian W, is a Gauss sum
over a short part of the step and doubled: W(2t) = W(t) + E(t)^T W(t) E(t), where z(t) = E(t) z. As a sum
of squares it is exact to rounding for any stiffness and step, and it owes nothing to the balance of energy.
Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Automatic Control 23 (1978).
"""

from ..accumulate import add, copy
from .propagator import NODES, SHORT, WEIGHTS, responses


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
    for i in range(16):
        d.gramian[i] = 0.0
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
