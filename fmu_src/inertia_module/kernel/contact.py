"""Ideal freewheels as complementarity conditions: which contact mode holds (DESIGN section 3).

0 <= omega2 _|_ Th >= 0  (housing)        0 <= omega3 - omega2 _|_ Tc >= 0  (output)
"""

from .dynamics import free_torque, free_torque_rate, torque_scale
from .inertia import reduced_inertia
from .slots import *

# a torque below this fraction of its scale is zero: the sign of its rate decides
TORQUE_ROUNDING = 1e-13


def sign_or_trend(value, rate, zero):
    """Whether value is positive, or zero within rounding and growing."""
    if value > zero:
        return True
    return value >= -zero and rate > 0.0


def select_mode(d, q, omega1, alpha1, omega2, omega3, load, load_rate):
    """Contact mode of the 2 x 2 complementarity problem on accelerations.

    A freewheel counts as touching where its relative velocity is exactly zero: the event search
    and the impulses set it so. The matrix of the problem is a P-matrix, so the mode is unique but
    for ties, which the next derivative decides.

    Args:
        load, load_rate: torque on the output shaft behind the freewheel (the load, or that of an
            elastic shaft), N m, and how it changes, N m/s.
    """
    k = d[D_K]
    housing = d[D_HOUSING] != 0.0 and omega2 == 0.0
    output = d[D_OUTPUT] == 0.0 or omega3 == omega2
    _, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    rate_q = k * (omega1 - omega2)
    free = free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1)
    inertia = d[D_J2] + k * k * g
    # the same zeros as in the search for events: the load counts only where it takes part
    zero_free = TORQUE_ROUNDING * torque_scale(d, omega1, alpha1, rate_q)
    zero = zero_free + TORQUE_ROUNDING * abs(load)
    shaft = d[D_J3]
    if not output:
        if not housing:
            return FREE
        trend = free_torque_rate(d, omega1, alpha1, rate_q, k * alpha1, i1, i2, b1, g1, g2)
        return FREE if sign_or_trend(free, trend, zero_free) else HELD
    if housing and (d[D_OUTPUT] == 0.0 or (load > 0.0 or (load == 0.0 and load_rate >= 0.0))):
        trend = free_torque_rate(d, omega1, alpha1, rate_q, k * alpha1, i1, i2, b1, g1, g2)
        return DRIVING if sign_or_trend(free - load, trend - load_rate, zero) else HELD_DRIVING
    if d[D_OUTPUT] == 0.0:
        return DRIVING
    if housing:
        trend = free_torque_rate(d, omega1, alpha1, rate_q, k * alpha1, i1, i2, b1, g1, g2)
        if not sign_or_trend(free, trend, zero_free):
            return HELD  # the load itself pulls the shaft away
    alpha2 = free / inertia if inertia > 0.0 else 0.0
    trend = free_torque_rate(d, omega1, alpha1, rate_q, k * (alpha1 - alpha2), i1, i2, b1, g1, g2)
    closing = shaft * free + inertia * load
    closing_rate = shaft * trend + k * k * g1 * rate_q * load + inertia * load_rate
    return DRIVING if sign_or_trend(closing, closing_rate, zero * (shaft + inertia)) else FREE
