"""Jacobi's integral: what a step at constant omega1 conserves, and the end of the step put right by it.

At constant omega1 the energy (J2 + k^2 G) v^2 / 2 - I omega1^2 / 2 of the slip v = omega1 - omega2 changes by
the work of the load on the slip and by nothing else. Errors of it do not die out: those of thousands of
steps, each within the tolerance, add up. So a step ends with the slip that has this energy.
Source: Arnold, Mathematical Methods of Classical Mechanics; Hairer, Lubich and Wanner, Geometric Numerical
Integration, section IV.4 (projection).
"""

from ..links import inertia_of
from .interpolant import dense_change, dense_rate

# square of the slip, over that of omega1, below which it is slow
SLOW = 0.01
# largest correction over the error allowed: the estimate of a long step may be that far off
MOST = 100.0
# most that the moment of coming to rest is shifted, as a fraction of the step
SHIFT = 1e-3


def is_conserved(d, w):
    """Whether the step in hand has Jacobi's integral: the speed of link 1 is given, and constant."""
    return d.by_torque == 0.0 and w.given == 0.0


def slipping_inertia(d, w, inertia):
    """J2 + k^2 G and what link 2 carries, kg m^2; inertia: (I, B, G)."""
    return d.J2 + w.carried + d.k * d.k * inertia[2]


def slip_energy(d, w, inertia, omega1, omega2):
    """Energy of the slip, J."""
    slip = omega1 - omega2
    return 0.5 * (slipping_inertia(d, w, inertia) * slip * slip - inertia[0] * omega1 * omega1)


def energy_missing(d, w, inertia, omega1, omega2):
    """What the energy of the slip lacks at the end of the step in hand, J."""
    return w.energy + w.carried_torque * w.change_q / d.k - slip_energy(d, w, inertia, omega1, omega2)


def restore_energy(d, x, w, inertia, allowed):
    """Correct omega2 at the end of the step in hand by what the energy of the slip lacks.

    Where the slip is too slow to tell, the correction is left to the steps that follow: w.energy is what the
    energy should be.

    Args:
        inertia: (I, B, G) at the end. allowed: error that the step may have of omega2, rad/s.
    """
    omega1 = x.omega1
    omega2 = x.omega2 + w.change2
    missing = energy_missing(d, w, inertia, omega1, omega2)
    w.energy += w.carried_torque * w.change_q / d.k
    slip = omega1 - omega2
    square = slip * slip + SLOW * omega1 * omega1
    if square > 0.0:
        most = MOST * allowed
        gain = missing / slipping_inertia(d, w, inertia) * slip / square
        w.change2 -= max(-most, min(most, gain))


def rest_by_energy(d, x, w, sigma):
    """Fraction of the step where link 2 comes to rest by its energy, near that of the dense output."""
    rate = dense_rate(w.dense_omega2, sigma)
    w.change_q = dense_change(w.dense_q, sigma)
    inertia = inertia_of(d, x.q + w.change_q)
    x.step_evaluations += 1.0
    own = slipping_inertia(d, w, inertia) * x.omega1
    # the speed that link 2 still has
    move = energy_missing(d, w, inertia, x.omega1, 0.0)
    if not abs(move) < SHIFT * abs(own * rate):
        return sigma
    return min(1.0, sigma + move / (own * rate))
