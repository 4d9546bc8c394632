"""The guards of a contact mode, positive while it goes on, at an instant of the step in hand."""

from .codes import COLLOCATED, LINK2
from .contact import is_held
from .general.guards import general_guard, is_exact
from .general.stages import exact_guard
from .solvers.collocated_guards import collocated_fourth_bound, collocated_guard


def guard_inside(d, x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma."""
    if w.solver == COLLOCATED:
        return collocated_guard(d, x, w, which, sigma)
    value, rate = general_guard(x, w, which, sigma)
    if is_exact(x, which):
        value = exact_guard(d, x, w, which, sigma)
    return value, rate


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


def fourth_bound_inside(d, x, w, which, scale):
    """Bound of the fourth derivative of a guard by the fraction of the collocation step in hand.

    Args:
        scale: upper bound of the torques, N m.
    """
    own = is_held(x) and which == LINK2 and d.by_torque == 0.0
    return collocated_fourth_bound(d, x, w, which) + (held_fourth_bound(d, x, w, scale) if own else 0.0)
