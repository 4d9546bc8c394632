"""Method `timestepping` where the input torque is given: impulses on both links, in fixed steps.

With the slip rho = omega1 - omega2 and P, the angular momentum of links 1 and 2 and the imbalances,

    T = P^2 / (2 J) + mu rho^2 / 2      J = J1 + I + J2      mu = (Phi (J2 + k^2 G) - N^2) / J
    P' = M1 - Tc + Th
    sqrt(mu) (sqrt(mu) rho)' = (1 - c) M1 + c (Tc - Th) - P^2 (1/J)' / 2      c = (J1 + I + k B) / J

with ' on 1/J by the slip angle. As in :mod:`.timestepping` the differences of sqrt(mu) and 1/J over the step
stand for their derivatives, so no impulse exceeds what the differences allow, however coarse the step.
"""

import math

from ..accumulate import add, wrap_drive_angle, wrap_input_angle
from ..inertia import reduced_inertia
from .timestepping import SMALLEST_DIFFERENCE, follow_shaft, settle, shaft_step

# corrections of the slip angle by the mean of the speeds at both ends
CORRECTIONS = 3


def slip_inertia(d, x, q):
    """(J, c, sqrt(mu), derivative of 1/J by the slip angle)."""
    i, i1, _, b, _, g, _, _ = reduced_inertia(d, q)
    x.step_evaluations += 1.0
    k = d.k
    link1 = d.J1 + i
    total = link1 + d.J2
    determinant = d.J2 * (link1 + k * (2.0 * b + k * g)) + k * k * (link1 * g - b * b)
    return total, (link1 + k * b) / total, math.sqrt(determinant / total), -k * i1 / (total * total)


def keep_slip_inertia(d, x, w):
    """Keep what the step that begins at the present q starts from."""
    w.kept_total, w.kept_share, w.kept_root, w.kept_bend = slip_inertia(d, x, x.q)


def driven_step(p, d, x, w, torque, load, h):
    """One fixed step; the inertia at its beginning is kept in w, that at its end is left there."""
    inertia3, momentum3 = shaft_step(p, d, x, w, load, h)
    total, share, root, bend = w.kept_total, w.kept_share, w.kept_root, w.kept_bend
    k = d.k
    begin1 = x.omega1
    begin2 = x.omega2
    slip = begin1 - begin2
    momentum = total * (begin2 + share * slip)
    free_momentum = momentum + torque * h
    end_momentum = free_momentum
    end_slip = slip
    end2 = begin2
    end3 = x.omega3
    output_impulse = 0.0
    mode = x.mode
    turned = 0.0
    end_total, end_share, end_root, end_bend = total, share, root, bend
    for _ in range(CORRECTIONS):
        turned = 0.5 * h * (slip + end_slip)
        end_total, end_share, end_root, end_bend = slip_inertia(d, x, x.q + k * turned)
        slope = 0.5 * (bend + end_bend)
        if abs(k * turned) > SMALLEST_DIFFERENCE:
            slope = (1.0 / end_total - 1.0 / total) / turned
        square = (momentum * momentum + momentum * end_momentum + end_momentum * end_momentum) / 3.0
        middle = 0.5 * (root + end_root)
        push = h * (torque * (1.0 - 0.5 * (share + end_share)) - 0.5 * square * slope)
        # middle end_root slip = free_push - c (Ph - Pc): not divided by mu, which may vanish
        free_push = middle * root * slip + push
        own = middle * end_root
        # impulses act in the middle of the step, unless c changes its sign on the way
        mean_share = 0.5 * (share + end_share)
        if mean_share * end_share < 0.0:
            mean_share = end_share
        weight = own + mean_share * end_share * end_total
        lead = end_share * end_total / weight
        end2, end3, output_impulse, housing, mode = settle(
            d, own * end_total / weight, own * free_momentum / weight - lead * free_push, inertia3, momentum3
        )
        end_momentum = free_momentum + housing - output_impulse
        end_slip = (free_push + mean_share * (free_momentum - end_total * end2)) / weight
    end1 = end2 + end_slip
    # on to just where the inertia at the end is that of: with another the energy would not be what it was
    turned1 = turned + 0.5 * h * (begin2 + end2)
    x.q, x.q_low = add(x.q, x.q_low, k * turned)
    wrap_drive_angle(d, x)
    x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned1)
    wrap_input_angle(x)
    w.kept_total, w.kept_share = end_total, end_share
    w.kept_root, w.kept_bend = end_root, end_bend
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, torque * turned1)
    x.output_impulse += output_impulse
    x.output_square += output_impulse * output_impulse / h
    x.torque_peak = max(x.torque_peak, abs(output_impulse) / h)
    follow_shaft(p, d, x, w, load, h, end3)
    x.omega1 = end1
    x.omega1_low = 0.0
    x.omega2 = end2
    x.omega2_low = 0.0
    if mode != x.mode:
        x.mode = mode
        x.step_switches += 1.0
