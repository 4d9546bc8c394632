"""The guards of a contact mode, positive while it goes on, at an instant of the step in hand; rates are
exact.

held: what is left of the torque that F has to pass, Tc - F; free: omega2 and omega3 - omega2; driving: omega2
and the torque Tc. With an elastic output the hub or its shaft torque stands for the load.
"""

from .codes import CLOSED_FORM, COLLOCATED, DRIVING, GENERAL, HELD_DRIVING, LINK2, OUTPUT
from .contact import is_held, torque_carried
from .general.guards import general_guard
from .links import held_torque, motion
from .output_shaft import coasting, coasting_fourth_bound
from .solvers.collocated_guards import collocated_fourth_bound, collocated_guard
from .solvers.interpolant import dense_change, dense_fourth_bound, dense_rate, dense_rate_fourth_bound


def is_guarded(d, x, which):
    """Tell whether this guard can end the present mode of a rigid output."""
    if which == LINK2:
        return d.housing != 0.0
    return d.output != 0.0 and not is_held(x)


def threshold(x, w):
    """Torque that F has to pass to release link 2: that of the load where the output shaft rests too, N m."""
    return w.load if x.mode == HELD_DRIVING else 0.0


def guard(d, x, w, which, t, omega2, alpha2, jerk2, free, free_rate):
    """A guard and its rate, the time t into the step, where links.motion gives this of link 2."""
    if is_held(x):
        return threshold(x, w) - free, -free_rate
    if which == LINK2:
        return omega2, alpha2
    if x.mode == DRIVING:
        return torque_carried(d, w.load, 0.0, omega2, alpha2, jerk2)
    omega3, rate3 = coasting(d, x, w.load, t)
    return omega3 - omega2, rate3 - alpha2


def instant(d, x, w, q, omega1, omega2):
    """links.motion in the step in hand."""
    x.step_evaluations += 1.0
    return motion(
        d, q, omega1, omega2, w.prescribed, is_held(x), w.carried, w.carried_friction, w.carried_torque, 0.0
    )


def keep_motion(x, now):
    """Keep what links.motion says of the present state."""
    x.rate1, x.rate2, x.jerk2, x.free, x.free_rate, x.momentum, x.motion_energy = now
    x.rates_cached = 1.0


def guard_inside(d, x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma.

    Velocities are those of the dense output (or of the collocation polynomials, with the elastic output); a
    torque is evaluated exactly at its state.
    """
    if w.solver == COLLOCATED:
        return collocated_guard(d, x, w, which, sigma)
    if w.solver == GENERAL:
        return general_guard(x, w, which, sigma)
    h = w.step
    t = sigma * h
    if w.solver == CLOSED_FORM:
        x.step_evaluations += 1.0
        q = x.q + d.k * t * (x.omega1 + 0.5 * w.prescribed * t)
        torque, rate = held_torque(d, q, x.omega1 + w.prescribed * t, w.prescribed)
        return threshold(x, w) - torque, -h * rate
    omega2 = x.omega2
    if not is_held(x):
        omega2 += dense_change(w.dense_omega2, sigma)
    if is_held(x) or (which == OUTPUT and x.mode == DRIVING):
        omega1 = x.omega1 + (dense_change(w.dense_omega1, sigma) if d.by_torque != 0.0 else w.prescribed * t)
        q = x.q + dense_change(w.dense_q, sigma)
        _, alpha2, jerk2, free, free_rate, _, _ = instant(d, x, w, q, omega1, omega2)
        value, rate = guard(d, x, w, which, t, omega2, alpha2, jerk2, free, free_rate)
        return value, h * rate
    alpha2 = dense_rate(w.dense_omega2, sigma) / h
    value, rate = guard(d, x, w, which, t, omega2, alpha2, 0.0, 0.0, 0.0)
    return value, h * rate


def held_fourth_bound(d, x, w, scale):
    """Bound of the fourth derivative of F by the fraction of the step, the speed of link 1 given.

    From Bernstein's inequality for trigonometric polynomials in q, F being no larger than the scale.
    """
    h = w.step
    fastest = max(abs(x.omega1), abs(x.omega1 + w.prescribed * h))
    if fastest == 0.0:
        return 0.0
    phase = h * (d.harmonic * d.k * fastest + 3.5 * abs(w.prescribed) / fastest)
    return scale * (phase * phase) * (phase * phase)


def fourth_bound_inside(d, x, w, which, scale, phase):
    """Bound of the fourth derivative of a guard by the fraction of the step in hand.

    Args:
        scale: upper bound of the torques, N m. phase: advance of the highest harmonic in the step, rad.
    """
    if w.solver == CLOSED_FORM:
        return held_fourth_bound(d, x, w, scale)
    if w.solver == COLLOCATED:
        own = is_held(x) and which == LINK2 and d.by_torque == 0.0
        return collocated_fourth_bound(d, x, w, which) + (held_fourth_bound(d, x, w, scale) if own else 0.0)
    if is_held(x):
        return scale * (phase * phase) * (phase * phase)
    if which == OUTPUT and x.mode == DRIVING:
        return d.J3 * dense_rate_fourth_bound(w.dense_omega2) / w.step + d.b3 * dense_fourth_bound(
            w.dense_omega2
        )
    own = dense_fourth_bound(w.dense_omega2)
    return own + coasting_fourth_bound(d, x, w.load, w.step) if which == OUTPUT else own
