"""The estimated error of a collocation step with the elastic output, over the allowed one."""

from ..codes import FREE
from ..links import response
from .collocation import change, embedded_error
from .followed import shaft_frequency, share_of_pulses
from .radau import GAMMA, STAGES
from .shaft_stages import damp_error

# the method's error of a swing with the amplitude A is A (error / A)^(5/3), error being the embedded
# formula's: A^(2/5) V^(3/5) instead of V allows it the same share of the speed V
SWING_POWER = 0.4


def embedded_tolerance(tolerance):
    """Tolerance for the embedded formula of order 5 that leaves the method of order 9 this one (Hairer)."""
    return 0.1 * tolerance**0.6


def fastest_speed(x):
    """Largest of all speeds at the beginning of the step, rad/s."""
    shaft = max(abs(x.omega3), abs(x.omega3 - x.relative))
    return max(max(abs(x.omega1), abs(x.omega2)), shaft)


def fastest_at_end(w):
    """Largest of all speeds at the end of the step in hand, rad/s."""
    last = STAGES - 1
    omega3 = w.stage_omega3[last]
    shaft = max(abs(omega3), abs(omega3 - w.stage_relative[last]))
    return max(max(abs(w.stage_omega1[last]), abs(w.stage_omega2[last])), shaft)


def step_error(d, x, w, rates, compliance, followed, swing, fastest):
    """Estimated error of the step in hand over the allowed one.

    Args:
        rates: (alpha1, omega2', omega3', rate of omega3 - omega4) at the beginning.
        followed, swing: whether the shaft's own motion is, and its amplitude if a load excites it, rad/s.
    """
    h = w.step
    fastest = max(fastest, fastest_at_end(w))
    rate1, rate2, rate3, rate_relative = rates
    error_q = d.k * h * embedded_error(x.omega2, w.stage_omega2)
    if d.by_torque != 0.0:
        error_q -= d.k * h * embedded_error(x.omega1, w.stage_omega1)
    error3 = h * embedded_error(rate3, w.rate3)
    relative = h * embedded_error(rate_relative, w.rate_relative)
    twist = h * embedded_error(x.relative, w.stage_relative)
    twist, error3, relative = damp_error(d, GAMMA * h, compliance, twist, error3, relative)
    # what hub and driven mass have in common: the speed of their centre; of a hub at rest, the driven mass's
    part = d.J4 * compliance / (1.0 + d.J4 * compliance) if compliance > 0.0 else 1.0
    moved3 = change(w, w.rate3)
    moved_relative = change(w, w.rate_relative)
    moved = max(abs(moved3), abs(moved3 - part * moved_relative))
    error = abs(error_q)
    if fastest > 0.0:
        share = response(d, d.J2 + d.J3 + d.J4)
        error = max(error, abs(error3 - part * relative) / max(share * fastest, moved))
        if x.mode == FREE:
            error2 = h * embedded_error(rate2, w.rate2)
            share = response(d, d.J2)
            error = max(error, abs(error2) / max(share * fastest, abs(change(w, w.rate2))))
        if d.by_torque != 0.0:
            error1 = h * embedded_error(rate1, w.rate1)
            share = response(d, d.J1)
            error = max(error, abs(error1) / max(share * fastest, abs(change(w, w.rate1))))
        if followed:
            speed = max(abs(relative), shaft_frequency(d, compliance) * abs(twist))
            share = share_of_pulses(d) if swing > 0.0 else response(d, d.J2 + d.J3)
            allowed = max(max(share * fastest, swing), max(moved, abs(moved_relative)))
            if 0.0 < swing < allowed:
                allowed *= (swing / allowed) ** SWING_POWER
            error = max(error, speed / allowed)
    return error / embedded_tolerance(d.tolerance)
