"""The guards of a contact mode where the input torque is given, positive while the mode goes on.

held: what is left of the threshold that F has to pass; free: omega2 and omega3 - omega2; driving: omega2
and Tc. All at an instant of the step in hand, with exact rates per second.
"""

from .dormand_prince import dense_change, dense_rate
from .slots import *
from .torque_dynamics import acceleration_and_jerk
from .torque_stages import is_held


def is_guarded(d, x, which):
    """Whether this guard can end the present mode."""
    if which == LINK2:
        return d[D_HOUSING] != 0.0
    return d[D_OUTPUT] != 0.0 and not is_held(x)


def threshold(x, w):
    """Torque that F has to pass to release link 2: that of the load where the output shaft rests too, N m."""
    return w[W_LOAD] if x[X_MODE] == HELD_DRIVING else 0.0


def instant(d, x, w, q, omega1, omega2):
    """acceleration_and_jerk of the step in hand."""
    x[X_STEP_EVALUATIONS] += 1.0
    return acceleration_and_jerk(
        d, q, omega1, omega2, w[W_DRIVE_TORQUE], is_held(x), w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE], 0.0
    )


def guard(d, x, w, which, t, omega2, motion):
    """A guard and its rate, the time t into the step, where link 2 has this speed and instant this motion."""
    _, alpha2, jerk2, free, free_rate = motion
    if is_held(x):
        return threshold(x, w) - free, -free_rate
    if which == LINK2:
        return omega2, alpha2
    if x[X_MODE] == DRIVING:
        return w[W_LOAD] + d[D_J3] * alpha2, d[D_J3] * jerk2
    slowing = w[W_LOAD] / d[D_J3]
    return x[X_OMEGA3] - slowing * t - omega2, -slowing - alpha2


def driven_guard_inside(d, x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma.

    Velocities are those of the dense output; a torque is evaluated exactly at its state.
    """
    h = w[W_STEP]
    omega2 = x[X_OMEGA2] + dense_change(w, W_DENSE_OMEGA2, sigma)
    if is_held(x) or (which == OUTPUT and x[X_MODE] == DRIVING):
        q = x[X_Q] + dense_change(w, W_DENSE_Q, sigma)
        omega1 = x[X_OMEGA1] + dense_change(w, W_DENSE_OMEGA1, sigma)
        motion = instant(d, x, w, q, omega1, omega2)
        value, rate = guard(d, x, w, which, sigma * h, omega2, motion)
        return value, h * rate
    rate = dense_rate(w, W_DENSE_OMEGA2, sigma)
    if which == LINK2:
        return omega2, rate
    slowing = h * w[W_LOAD] / d[D_J3]
    return x[X_OMEGA3] - slowing * sigma - omega2, -slowing - rate
