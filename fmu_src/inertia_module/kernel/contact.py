"""Ideal freewheels as complementarity conditions: which contact mode holds (docs/mechanics.md).

0 <= omega2 _|_ Th >= 0  (housing)        0 <= omega3 - omega2 _|_ Tc >= 0  (output)
"""

from .codes import DRIVING, FREE, HELD, HELD_DRIVING
from .links import motion, prescribed_at_input, torque_scale
from .shaft import load_behind_freewheel

# a torque below this fraction of its scale is zero: the sign of its rate decides
TORQUE_ROUNDING = 1e-13


def is_held(x):
    """Tell whether the housing freewheel holds link 2 in the present mode."""
    return x.mode == HELD or x.mode == HELD_DRIVING


def torque_carried(d, load, load_rate, omega2, alpha2, jerk2):
    """Tc that drives the output with link 2, N m, and its rate, N m/s: J3 omega3' = Tc - b3 omega3 - load."""
    return load + d.b3 * omega2 + d.J3 * alpha2, load_rate + d.b3 * alpha2 + d.J3 * jerk2


def sign_or_trend(value, rate, zero):
    """Tell whether value is positive, or zero within rounding and growing."""
    if value > zero:
        return True
    return value >= -zero and rate > 0.0


def select_mode(d, q, omega1, omega2, omega3, prescribed, load, load_rate, rounding):
    """Contact mode of the 2 x 2 complementarity problem on accelerations.

    A freewheel counts as touching where its relative velocity is exactly zero: the event search
    and the impulses set it so. The matrix of the problem is a P-matrix, so the mode is unique but
    for ties, which the next derivative decides.

    Args:
        prescribed: see links.prescribed_at_input.
        load, load_rate: torque on the output shaft behind the freewheel (the load, or that of an
            elastic shaft), N m, and how it changes, N m/s.
        rounding: fraction of its scale below which a torque is zero, so that its rate decides.
    """
    housing = d.housing != 0.0 and omega2 == 0.0
    output = d.output == 0.0 or omega3 == omega2
    if not output and not housing:
        return FREE
    slip = d.k * (omega1 - omega2)
    if housing:
        alpha1, _, _, free, trend, _, _ = motion(d, q, omega1, omega2, prescribed, True, 0.0, 0.0, 0.0, 0.0)
        # the same zeros as in the search for events: the load counts only where it takes part
        zero_free = rounding * torque_scale(d, omega1, alpha1, slip, prescribed)
        zero = zero_free + rounding * abs(load)
        if not output:
            return FREE if sign_or_trend(free, trend, zero_free) else HELD
        if d.output == 0.0 or (load > 0.0 or (load == 0.0 and load_rate >= 0.0)):
            return DRIVING if sign_or_trend(free - load, trend - load_rate, zero) else HELD_DRIVING
        if not sign_or_trend(free, trend, zero_free):
            return HELD  # the load itself pulls the shaft away
    if d.output == 0.0:
        return DRIVING
    alpha1, alpha2, jerk2, _, _, _, _ = motion(
        d, q, omega1, omega2, prescribed, False, d.J3, d.b3, load, load_rate
    )
    torque, rate = torque_carried(d, load, load_rate, omega2, alpha2, jerk2)
    zero = rounding * (torque_scale(d, omega1, alpha1, slip, prescribed) + abs(load) + d.b3 * abs(omega2))
    return DRIVING if sign_or_trend(torque, rate, zero) else FREE


def present_mode(d, x, rounding):
    """Contact mode of the state in x."""
    load, rate = load_behind_freewheel(d, x)
    prescribed = prescribed_at_input(d, x)
    return select_mode(d, x.q, x.omega1, x.omega2, x.omega3, prescribed, load, rate, rounding)


def choose_mode(d, x, rounding):
    """Choose the contact mode anew and count a switch if it is another."""
    mode = present_mode(d, x, rounding)
    if mode != x.mode:
        x.mode = mode
        x.step_switches += 1.0
