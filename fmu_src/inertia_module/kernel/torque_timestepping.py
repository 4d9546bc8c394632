"""Method `timestepping` where the input torque is given: impulses on both links, in fixed steps.

With the slip rho = omega1 - omega2 and P, the angular momentum of links 1 and 2 and the imbalances,

    T = P^2 / (2 J) + mu rho^2 / 2      J = J1 + I + J2      mu = (Phi (J2 + k^2 G) - N^2) / J
    P' = M1 - Tc + Th
    sqrt(mu) (sqrt(mu) rho)' = (1 - c) M1 + c (Tc - Th) - P^2 (1/J)' / 2      c = (J1 + I + k B) / J

with ' on 1/J by the slip angle. As in :mod:`.timestepping` the differences of sqrt(mu) and 1/J over the step
stand for their derivatives, so no impulse exceeds what the differences allow, however coarse the step.
"""

import math

from .accumulate import add, assign, wrap_drive_angle, wrap_input_angle
from .inertia import reduced_inertia
from .slots import *
from .timestepping import SMALLEST_DIFFERENCE, follow_shaft, settle, shaft_step

# corrections of the slip angle by the mean of the speeds at both ends
CORRECTIONS = 3


def slip_inertia(d, x, q):
    """(J, c, sqrt(mu), derivative of 1/J by the slip angle)."""
    i, i1, _, b, _, g, _, _ = reduced_inertia(d, q)
    x[X_STEP_EVALUATIONS] += 1.0
    k = d[D_K]
    link1 = d[D_J1] + i
    total = link1 + d[D_J2]
    determinant = d[D_J2] * (link1 + k * (2.0 * b + k * g)) + k * k * (link1 * g - b * b)
    return total, (link1 + k * b) / total, math.sqrt(determinant / total), -k * i1 / (total * total)


def put_slip_inertia(d, x, w):
    """Keep what the step that begins at the present q starts from."""
    w[W_KEPT_TOTAL], w[W_KEPT_SHARE], w[W_KEPT_ROOT], w[W_KEPT_BEND] = slip_inertia(d, x, x[X_Q])


def driven_step(p, d, x, w, torque, load, h):
    """One fixed step; the inertia at its beginning is kept in w, that at its end is left there."""
    inertia3, momentum3 = shaft_step(p, d, x, w, load, h)
    total, share, root, bend = w[W_KEPT_TOTAL], w[W_KEPT_SHARE], w[W_KEPT_ROOT], w[W_KEPT_BEND]
    k = d[D_K]
    begin1 = x[X_OMEGA1]
    begin2 = x[X_OMEGA2]
    slip = begin1 - begin2
    momentum = total * (begin2 + share * slip)
    free_momentum = momentum + torque * h
    end_momentum = free_momentum
    end_slip = slip
    end2 = begin2
    end3 = x[X_OMEGA3]
    clutch = 0.0
    mode = x[X_MODE]
    turned = 0.0
    end_total, end_share, end_root, end_bend = total, share, root, bend
    for _ in range(CORRECTIONS):
        turned = 0.5 * h * (slip + end_slip)
        end_total, end_share, end_root, end_bend = slip_inertia(d, x, x[X_Q] + k * turned)
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
        end2, end3, clutch, housing, mode = settle(
            d, own * end_total / weight, own * free_momentum / weight - lead * free_push, inertia3, momentum3
        )
        end_momentum = free_momentum + housing - clutch
        end_slip = (free_push + mean_share * (free_momentum - end_total * end2)) / weight
    end1 = end2 + end_slip
    # on to just where the inertia at the end is that of: with another the energy would not be what it was
    turned1 = turned + 0.5 * h * (begin2 + end2)
    add(x, X_Q, k * turned)
    wrap_drive_angle(d, x)
    add(x, X_THETA1, turned1)
    wrap_input_angle(x)
    w[W_KEPT_TOTAL], w[W_KEPT_SHARE] = end_total, end_share
    w[W_KEPT_ROOT], w[W_KEPT_BEND] = end_root, end_bend
    add(x, X_ENERGY_IN, torque * turned1)
    x[X_OUTPUT_IMPULSE] += clutch
    x[X_OUTPUT_SQUARE] += clutch * clutch / h
    x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(clutch) / h)
    follow_shaft(p, d, x, w, load, h, end3)
    assign(x, X_OMEGA1, end1)
    assign(x, X_OMEGA2, end2)
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0
