"""Exact motion of the shaft over a step: end value, integrals, integral of the square.

Twist, slip, speed of the driven mass and their rates are each a motion z1 of the same linear system,

    z1' = z2 - damping_rate z1      z2' = z3 - frequency_squared z1      z3' = z4      z4' = 0

so z(t) = E(t) z(0). The first row of E(t) has the responses to z1 = 1 and to z2 = 1 (impulse response). The
other two entries are the first and second integral of the impulse response. The integral of z1^2 is a
quadratic form of z(0) whose matrix is the Gramian W.

The responses have a closed form, with decaying exponentials only. Their integrals would suffer from
cancellation in closed form: near critical damping, for soft shafts and for short steps. So the integrals and
W are Gauss sums over a part of the step in which nothing oscillates or decays much. This part is then doubled
until it covers the step, with W(2t) = W(t) + E(t)^T W(t) E(t).

The result is exact to round-off for any stiffness and step, without overflow. Scaling and squaring of the
augmented matrix exponential would be shorter but less accurate. Its relative errors for shafts of the unit
tests and steps of 0.1 s are 6e-9 (stiff shaft) and 1e-7 (light mass), and there are no correct digits for a
light mass with strong damping.

Sources: C. Moler and C. Van Loan, Nineteen dubious ways to compute the exponential of a matrix, SIAM Review
45 (2003), methods 3 and 14; C. Van Loan, Computing integrals involving the matrix exponential, IEEE Trans.
Automatic Control 23 (1978).
"""

import math

from ..accumulate import clear
from ..records import Doubles, ShaftConstants, ShaftWorkspace
from ..tableau import GAUSS_NODES, GAUSS_WEIGHTS, N_GAUSS_NODES

MAX_QUADRATURE_PHASE = 1.0 / 64.0  # fast_rate * t up to which a Gauss sum over t is exact to round-off


def characteristic_rates(damping_rate: float, frequency_squared: float) -> tuple[float, float, float]:
    """Return the characteristic rates of z'' + damping_rate z' + frequency_squared z = 0, 1/s.

    Args:
        damping_rate: At least 0, 1/s.
        frequency_squared: Above 0, 1/s^2.

    Returns:
        (damped_frequency, slow_rate, fast_rate). Underdamped: the roots are -slow_rate +- i damped_frequency,
        and fast_rate is their magnitude. Otherwise: damped_frequency is 0 and the roots are -slow_rate and
        -fast_rate.
    """
    half = 0.5 * damping_rate
    natural = math.sqrt(frequency_squared)
    root = math.sqrt(abs(natural - half)) * math.sqrt(natural + half)
    if natural > half:
        return root, half, natural
    fast_rate = half + root
    # The slow root by Vieta: half - root would cancel at strong damping
    return 0.0, frequency_squared / fast_rate, fast_rate


def free_response(
    damped_frequency: float, slow_rate: float, fast_rate: float, t: float
) -> tuple[float, float, float]:
    """Return the responses at a time to an initial displacement of 1 and to an initial rate of 1.

    Args:
        damped_frequency: 1/s, 0 if not underdamped (characteristic_rates).
        slow_rate: 1/s.
        fast_rate: 1/s.
        t: Time, s.

    Returns:
        (step, impulse, impulse'): z(t) from z = 1, z' = 0; z(t) and z'(t) from z = 0, z' = 1.
    """
    if damped_frequency > 0.0:
        decay = math.exp(-slow_rate * t)
        cosine = decay * math.cos(damped_frequency * t)
        impulse = decay * math.sin(damped_frequency * t) / damped_frequency
        return cosine + slow_rate * impulse, impulse, cosine - slow_rate * impulse
    spread = fast_rate - slow_rate
    decay = math.exp(-fast_rate * t)
    impulse = t * decay
    if spread > 0.0:
        impulse = math.exp(-slow_rate * t) * -math.expm1(-spread * t) / spread
    return decay + fast_rate * impulse, impulse, decay - slow_rate * impulse


def impulse_integrals(d: ShaftConstants, t: float) -> tuple[float, float, float, float]:
    """Return the first to fourth integral of the impulse response from 0 to t.

    Args:
        d: Constants of the shaft.
        t: Time, s, with fast_rate t <= MAX_QUADRATURE_PHASE.
    """
    first = second = third = fourth = 0.0
    for n in range(N_GAUSS_NODES):
        left = t - t * GAUSS_NODES[n]
        _, impulse, _ = free_response(d.damped_frequency, d.slow_rate, d.fast_rate, t * GAUSS_NODES[n])
        term = t * GAUSS_WEIGHTS[n] * impulse
        first += term
        second += term * left
        third += term * left * left / 2.0
        fourth += term * left * left * left / 6.0
    return first, second, third, fourth


def write_row(matrix: Doubles, row: int, a: float, b: float, c: float, d: float) -> None:
    """Write a row of a 4 x 4 matrix.

    Args:
        matrix: 16 numbers, row by row, written.
        row: Number of the row.
        a: First number of the row.
        b: Second number.
        c: Third number.
        d: Fourth number.
    """
    matrix[4 * row] = a
    matrix[4 * row + 1] = b
    matrix[4 * row + 2] = c
    matrix[4 * row + 3] = d


def write_transition(d: ShaftConstants, w: ShaftWorkspace, t: float, first: float, second: float) -> None:
    """Write the transition matrix E(t) to w.transition.

    Args:
        d: Constants of the shaft.
        w: Workspace of the shaft.
        t: Time, s.
        first: First integral of the impulse response from 0 to t.
        second: Second integral.
    """
    step, impulse, slope = free_response(d.damped_frequency, d.slow_rate, d.fast_rate, t)
    rate = d.damping_rate
    write_row(w.transition, 0, slope, impulse, first, second)
    write_row(
        w.transition, 1, -d.frequency_squared * impulse, step, impulse + rate * first, first + rate * second
    )
    write_row(w.transition, 2, 0.0, 0.0, 1.0, t)
    write_row(w.transition, 3, 0.0, 0.0, 0.0, 1.0)


def double_gramian(d: ShaftConstants, w: ShaftWorkspace) -> None:
    """Double the time of the Gramian: W + E^T W E.

    Args:
        d: Constants of the shaft; the Gramian is updated.
        w: Workspace with the transition matrix over the present time; w.product is overwritten.
    """
    for i in range(16):
        w.product[i] = 0.0
        for k in range(4):
            w.product[i] += d.gramian[i - i % 4 + k] * w.transition[4 * k + i % 4]
    for i in range(16):
        for k in range(4):
            d.gramian[i] += w.transition[4 * k + i // 4] * w.product[4 * k + i % 4]


def cache_step(d: ShaftConstants, w: ShaftWorkspace, h: float) -> None:
    """Compute the Gramian and the responses of a step, unless the last step had the same length.

    Args:
        d: Constants of the shaft; step, gramian and responses are written.
        w: Workspace of the shaft; transition and product are overwritten.
        h: Length of the step, s.
    """
    if h == d.step:
        return
    d.step = h
    part = h
    while d.fast_rate * part > MAX_QUADRATURE_PHASE:
        part *= 0.5
    clear(d.gramian)
    for n in range(N_GAUSS_NODES):
        first, second, _, _ = impulse_integrals(d, part * GAUSS_NODES[n])
        write_transition(d, w, part * GAUSS_NODES[n], first, second)
        for i in range(16):
            d.gramian[i] += part * GAUSS_WEIGHTS[n] * w.transition[i // 4] * w.transition[i % 4]
    first, second, third, fourth = impulse_integrals(d, part)
    rate = d.damping_rate
    while part < h:
        write_transition(d, w, part, first, second)
        double_gramian(d, w)
        slope, impulse = w.transition[0], w.transition[1]
        # Integrals of the step response: impulse + rate first, first + rate second and so on
        fourth += impulse * (third + rate * fourth) + slope * fourth
        fourth += part * (third + part * (0.5 * second + part / 6.0 * first))
        third += impulse * (second + rate * third) + slope * third + part * (second + 0.5 * part * first)
        second += impulse * (first + rate * second) + slope * second + part * first
        first += impulse * (impulse + rate * first) + slope * first
        part *= 2.0
    _, impulse, slope = free_response(d.damped_frequency, d.slow_rate, d.fast_rate, h)
    d.responses[0] = slope
    d.responses[1] = impulse
    d.responses[2] = first
    d.responses[3] = second
    d.responses[4] = third
    d.responses[5] = fourth


def integral(d: ShaftConstants, z: Doubles, order: int) -> float:
    """Return the integral of a motion over the step that cache_step has computed.

    Args:
        d: Constants of the shaft.
        z: z1 to z4 at the beginning of the step.
        order: 1 for the integral, 2 for the integral of the integral, 0 for the value at the end.
    """
    total = 0.0
    for n in range(4):
        total += z[n] * d.responses[n + order]
    return total


def square_integral(d: ShaftConstants, z: Doubles) -> float:
    """Return the integral of the square of a motion over the step that cache_step has computed.

    Args:
        d: Constants of the shaft.
        z: z1 to z4 at the beginning of the step.
    """
    total = 0.0
    for i in range(16):
        total += z[i // 4] * z[i % 4] * d.gramian[i]
    return total


def end_value(d: ShaftConstants, z: Doubles, rate: Doubles) -> float:
    """Return a motion at the end of the step that cache_step has computed, with its round-off.

    A small change is added to the initial value. After a large change the value is computed directly, because
    the initial value has decayed. The smaller of both has less round-off.

    Args:
        d: Constants of the shaft.
        z: z1 to z4 of the motion at the beginning of the step.
        rate: z1 to z4 of its rate.
    """
    change = integral(d, rate, 1)
    if abs(change) < 0.5 * abs(z[0]):
        return z[0] + change
    return integral(d, z, 0)
