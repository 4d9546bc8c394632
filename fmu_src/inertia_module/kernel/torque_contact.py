"""Which contact mode holds where the input torque is given: :mod:`.contact` with alpha1 a result."""

from .contact import sign_or_trend
from .slots import *
from .torque_dynamics import acceleration_and_jerk, driven_torque_scale


def select_driven_mode(d, q, omega1, omega2, omega3, torque, load, load_rate, rounding):
    """Contact mode of the 2 x 2 complementarity problem on accelerations, link 1 free under its torque.

    Args:
        torque: M1, N m. load, load_rate: as for contact.select_mode.
        rounding: fraction of its scale below which a torque is zero, so that its rate decides.
    """
    housing = d[D_HOUSING] != 0.0 and omega2 == 0.0
    output = d[D_OUTPUT] == 0.0 or omega3 == omega2
    alpha1, _, _, free, trend = acceleration_and_jerk(d, q, omega1, omega2, torque, True, 0.0, 0.0, 0.0)
    scale = driven_torque_scale(d, omega1, alpha1, d[D_K] * (omega1 - omega2), torque)
    zero = rounding * (scale + abs(load))
    if not output:
        if not housing:
            return FREE
        return FREE if sign_or_trend(free, trend, rounding * scale) else HELD
    if housing and (d[D_OUTPUT] == 0.0 or (load > 0.0 or (load == 0.0 and load_rate >= 0.0))):
        return DRIVING if sign_or_trend(free - load, trend - load_rate, zero) else HELD_DRIVING
    if d[D_OUTPUT] == 0.0:
        return DRIVING
    if housing and not sign_or_trend(free, trend, rounding * scale):
        return HELD  # the load itself pulls the shaft away
    _, alpha2, jerk2, _, _ = acceleration_and_jerk(
        d, q, omega1, omega2, torque, False, d[D_J3], load, load_rate
    )
    closing = load + d[D_J3] * alpha2
    return DRIVING if sign_or_trend(closing, load_rate + d[D_J3] * jerk2, zero) else FREE
