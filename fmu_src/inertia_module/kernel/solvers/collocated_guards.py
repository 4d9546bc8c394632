"""The guards of a contact mode inside a collocation step, and the step that ends where one falls."""

from ..codes import DRIVING, FREE, HELD, HELD_DRIVING, LINK2, OUTPUT
from ..links import held_torque
from .collocation import fit, fit_integral, polynomial, polynomial_fourth_bound
from .elastic_stages import solve_stages
from .radau import STAGES

# attempts to make a step end at a crossing
LANDINGS = 60


def fit_polynomials(d, x, w):
    """Polynomials of the speeds and of the torque that the guards need, for the step in hand."""
    h = w.step
    mode = x.mode
    if mode == FREE or mode == DRIVING:
        fit_integral(w.rate2, x.omega2, h, w.polynomial_2)
    elif d.by_torque != 0.0:
        for n in range(STAGES):
            w.right_side[n] = w.stage_output_torque[n] - w.stage_release[n]
        fit(w.right_side, w.polynomial_2)
    if mode == FREE or mode == HELD:
        fit_integral(w.rate3, x.omega3, h, w.polynomial_3)
    if mode == DRIVING or mode == HELD_DRIVING:
        fit(w.stage_output_torque, w.polynomial_torque)


def collocated_guard(d, x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma.

    held: -F and omega3; free: omega2 and omega3 - omega2; driving: omega2 and Tc; held and driving:
    Tc - F and Tc. F is exact where omega1 is given, the rest comes from the collocation polynomials.
    """
    mode = x.mode
    h = w.step
    if mode == FREE or mode == DRIVING:
        if which == LINK2:
            return polynomial(w.polynomial_2, STAGES + 1, sigma)
        if mode == DRIVING:
            return polynomial(w.polynomial_torque, STAGES, sigma)
        value3, rate3 = polynomial(w.polynomial_3, STAGES + 1, sigma)
        value2, rate2 = polynomial(w.polynomial_2, STAGES + 1, sigma)
        return value3 - value2, rate3 - rate2
    if which == OUTPUT:
        if mode == HELD:
            return polynomial(w.polynomial_3, STAGES + 1, sigma)
        return polynomial(w.polynomial_torque, STAGES, sigma)
    if d.by_torque != 0.0:
        return polynomial(w.polynomial_2, STAGES, sigma)
    value = 0.0
    rate = 0.0
    if mode == HELD_DRIVING:
        value, rate = polynomial(w.polynomial_torque, STAGES, sigma)
    t = sigma * h
    omega1 = x.omega1 + w.prescribed * t
    q = x.q + d.k * t * (x.omega1 + 0.5 * w.prescribed * t)
    torque, slope = held_torque(d, q, omega1, w.prescribed)
    x.step_evaluations += 1.0
    return value - torque, rate - h * slope


def collocated_fourth_bound(d, x, w, which):
    """Bound of the fourth derivative of what a guard takes from the polynomials."""
    mode = x.mode
    if mode == HELD and which == LINK2 and d.by_torque == 0.0:
        return 0.0
    if which == LINK2 and (mode != HELD_DRIVING or d.by_torque != 0.0):
        return polynomial_fourth_bound(w.polynomial_2)
    if mode == DRIVING or mode == HELD_DRIVING:
        return polynomial_fourth_bound(w.polynomial_torque)
    fourth_bound = polynomial_fourth_bound(w.polynomial_3)
    return fourth_bound + polynomial_fourth_bound(w.polynomial_2) if mode == FREE else fourth_bound


def land(d, x, w, which, zero, sigma):
    """Make the step end where the guard falls below -zero, near the fraction sigma of the one in hand.

    The end of a step is far more accurate than its inside, so the step is made anew until its end is there.

    Returns:
        Whether it ends with the guard below -zero (else the crossing was one of the polynomial alone).
    """
    low = 0.0
    high = w.step
    t = sigma * high
    crossed = False
    for _ in range(LANDINGS):
        if not solve_stages(d, x, w, t):
            return False
        fit_polynomials(d, x, w)
        value, rate = collocated_guard(d, x, w, which, 1.0)
        if -4.0 * zero <= value < -zero:
            return True
        if value < -zero:
            high = t
            crossed = True
        else:
            low = t
        move = t - t * (value + 2.0 * zero) / rate if rate < 0.0 else low
        if not low < move < high:
            move = 0.5 * (low + high)
        if not low < move < high:
            break
        t = move
    if crossed and t != high:
        solve_stages(d, x, w, high)
        fit_polynomials(d, x, w)
    return crossed
