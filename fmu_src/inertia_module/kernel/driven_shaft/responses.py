"""Answers of the propagator to a step and at the nodes of Gauss's rule within it, kept for steps as long.

Most communication steps are alike, and the answers are most of the cost of a step.
"""

from .propagator import SHORT, responses

# Gauss-Legendre rule of order 24 on [-1, 1] (Abramowitz and Stegun, table 25.4)
NODES = (
    0.1252334085114689,
    0.3678314989981802,
    0.5873179542866175,
    0.7699026741943047,
    0.9041172563704749,
    0.9815606342467192,
)


def is_short(d, h):
    """Whether no mode changes by more than exp(3) within h: one interval of Gauss's rule will do."""
    return d.fast * h < SHORT


def keep_responses(d, h):
    """Put the answers to a step h in their places in d, unless they are there."""
    if h == d.step:
        return
    step, slope, impulse, one, two, three, four = responses(d.rate, d.square, d.swing, d.slow, d.fast, h)
    d.step = h
    d.responses[0] = step
    d.responses[1] = slope
    d.responses[2] = impulse
    d.responses[3] = one
    d.responses[4] = two
    d.responses[5] = three
    d.responses[6] = four
    if is_short(d, h):
        for n in range(6):
            keep_node(d, 8 * n, 0.5 * h - 0.5 * h * NODES[n])
            keep_node(d, 8 * n + 4, 0.5 * h + 0.5 * h * NODES[n])


def keep_node(d, place, t):
    """Put what the motion at t follows from in its place."""
    _, slope, impulse, one, two, _, _ = responses(d.rate, d.square, d.swing, d.slow, d.fast, t)
    d.nodes[place] = slope
    d.nodes[place + 1] = impulse
    d.nodes[place + 2] = one
    d.nodes[place + 3] = two
