"""Method `timestepping`: fixed steps, complementarity of impulses and end velocities in each (Moreau).

No event is searched for, so every step costs the same. With V = I omega1^2 / 2 and the inertia
N = G + J2/k^2 of q', link 2 obeys

    k sqrt(N) (sqrt(N) q')' = J2 alpha1 + k dV/dq - k B alpha1 - Th + Tc

which is stepped with the differences of sqrt(N) and V over the step instead of their derivatives (a
discrete gradient): without contact the kinetic energy changes by what V does, and no impulse exceeds
what the differences allow, however coarse the step. An elastic shaft moves exactly behind a
hub that accelerates uniformly over the step, or is damped out if the step cannot resolve it.
"""

import math

from .accumulate import add, assign, wrap_drive_angle
from .inertia import reduced_inertia
from .propagator import characteristic, responses
from .slots import *

# below this change of q, rad, the derivative of V is more exact than its difference
SMALLEST_DIFFERENCE = 1e-5
# phase of the shaft's own oscillation, rad, up to which a step resolves it
RESOLVED = 0.5
# corrections of q by the mean of the speeds at both ends
CORRECTIONS = 2


def put_inertia(d, x, w):
    """Keep I, I', B, G and the angular momentum's parts of the present q for the step that begins there."""
    i, i1, _, b, _, g, _, _ = reduced_inertia(d, x[X_Q])
    x[X_STEP_EVALUATIONS] += 1.0
    w[W_KEPT_I] = i
    w[W_KEPT_I1] = i1
    w[W_KEPT_B] = b
    w[W_KEPT_G] = g


def link2_step(d, x, w, omega1, alpha1, h, end2):
    """Inertia of link 2 over the step and its momentum without contact, for a guess of its end speed.

    Returns:
        (inertia, momentum): omega2 at the end is (momentum + Ph - Pc) / inertia.
    """
    k = d[D_K]
    middle1 = omega1 + 0.5 * alpha1 * h
    rate_q = k * (omega1 - x[X_OMEGA2])
    change_q = k * h * (middle1 - 0.5 * (x[X_OMEGA2] + end2))
    i_end, i1_end, _, b_end, _, g_end, _, _ = reduced_inertia(d, x[X_Q] + change_q)
    x[X_STEP_EVALUATIONS] += 1.0
    own = d[D_J2] / (k * k)
    root = math.sqrt(w[W_KEPT_G] + own)
    root_end = math.sqrt(g_end + own)
    middle = 0.5 * k * (root + root_end)
    if abs(change_q) > SMALLEST_DIFFERENCE:
        slope = (i_end - w[W_KEPT_I]) / change_q
    else:
        slope = 0.5 * (w[W_KEPT_I1] + i1_end)
    mean_b = 0.5 * (w[W_KEPT_B] + b_end)
    push = h * (0.5 * k * middle1 * middle1 * slope + alpha1 * (d[D_J2] - k * mean_b))
    inertia = k * middle * root_end
    return inertia, inertia * (omega1 + alpha1 * h) - middle * root * rate_q - push


def kept_momentum(d, w, omega1, omega2):
    """P = (J1 + I) omega1 + B q' + J2 omega2 with the inertia kept."""
    return (d[D_J1] + w[W_KEPT_I]) * omega1 + w[W_KEPT_B] * d[D_K] * (omega1 - omega2) + d[D_J2] * omega2


def put_shaft(p, d, w, h):
    """Answers of the elastic shaft over a step h, the hub accelerating uniformly: kept in w.

    They are exact while the step resolves the shaft, and those of the implicit Euler method, which
    damps whatever it does not resolve, where it does not.
    """
    if p[P_FIDELITY] != ELASTIC:
        return
    friction = d[D_FRICTION]
    free = 1.0 - d[D_BALANCER]
    if d[D_STIFFNESS] * (1.0 / d[D_J3] + 1.0 / d[D_J4]) * h * h > RESOLVED * RESOLVED:
        share = 1.0 / (d[D_J4] + (friction + d[D_DAMPING] + d[D_STIFFNESS] * h) * h)
        w[W_SLOPE] = d[D_J4] * share
        w[W_IMPULSE] = h * w[W_SLOPE]
        w[W_SUM] = h * w[W_IMPULSE]
        w[W_RELATIVE_GAIN] = (d[D_J4] * free + friction * h) * h * share
        w[W_TWIST_GAIN] = h * w[W_RELATIVE_GAIN]
        w[W_LAG] = h
        return
    rate = (d[D_DAMPING] + friction) / d[D_J4]
    square = d[D_STIFFNESS] / d[D_J4]
    swing, slow, fast = characteristic(rate, square)
    _, w[W_SLOPE], w[W_IMPULSE], w[W_SUM], two, _, _ = responses(rate, square, swing, slow, fast, h)
    w[W_RELATIVE_GAIN] = free * w[W_IMPULSE] + friction / d[D_J4] * w[W_SUM]
    w[W_TWIST_GAIN] = free * w[W_SUM] + friction / d[D_J4] * two
    w[W_LAG] = 0.5 * h


def shaft_step(p, d, x, w, load, h):
    """Inertia of the hub over the step and its momentum without contact, with the shaft behind it.

    Returns:
        (inertia, momentum): omega3 at the end is (momentum + Pc) / inertia.
    """
    omega3 = x[X_OMEGA3]
    if p[P_FIDELITY] != ELASTIC:
        return d[D_J3], d[D_J3] * omega3 - h * load
    relative, twist = coasting_shaft(d, x, w, load)
    friction = d[D_FRICTION]
    # momentum that the shaft takes from a hub of constant speed, and more for each rad/s of it
    taken = d[D_J4] * (x[X_RELATIVE] - relative) + friction * (h * omega3 - (twist - x[X_TWIST])) + load * h
    own = d[D_J4] * ((1.0 - d[D_BALANCER]) * h - w[W_RELATIVE_GAIN])
    gain = (own + friction * (w[W_LAG] * h - w[W_TWIST_GAIN])) / h
    return d[D_J3] + gain, (d[D_J3] + gain) * omega3 - taken


def coasting_shaft(d, x, w, load):
    """Relative speed and twist at the end of the step if the hub keeps its speed."""
    relative = x[X_RELATIVE]
    push = (d[D_FRICTION] * x[X_OMEGA3] + load - d[D_STIFFNESS] * x[X_TWIST]) / d[D_J4]
    end = relative * w[W_SLOPE] + push * w[W_IMPULSE]
    return end, x[X_TWIST] + relative * w[W_IMPULSE] + push * w[W_SUM]


def settle(d, inertia2, momentum2, inertia3, momentum3):
    """The complementarity problem of impulses and end velocities.

    Returns:
        (omega2, omega3, Pc, Ph, contact mode) at the end of the step.
    """
    free2 = momentum2 / inertia2 if inertia2 > 0.0 else 0.0
    free3 = momentum3 / inertia3
    # ties as in contact.select_mode: link 2 stays held, and a shaft that nothing pulls away touches it
    held = d[D_HOUSING] != 0.0 and momentum2 <= 0.0
    if d[D_OUTPUT] != 0.0:
        if held and free3 > 0.0:
            return 0.0, free3, 0.0, -momentum2, HELD
        if not held and free2 <= free3:
            return free2, free3, 0.0, 0.0, FREE
    together = (momentum2 + momentum3) / (inertia2 + inertia3)
    if d[D_HOUSING] == 0.0 or together > 0.0:
        return together, together, inertia3 * together - momentum3, 0.0, DRIVING
    return 0.0, 0.0, -momentum3, -momentum3 - momentum2, HELD_DRIVING


def follow_shaft(p, d, x, w, load, h, end3):
    """Take over the end speed of the hub, with twist, driven mass and works of the shaft behind it."""
    begin3 = x[X_OMEGA3]
    begin4 = begin3 - x[X_RELATIVE]
    lag = w[W_LAG] if p[P_FIDELITY] == ELASTIC else 0.5 * h
    turned4 = h * begin3 + lag * (end3 - begin3)
    if p[P_FIDELITY] == ELASTIC:
        change3 = end3 - begin3
        before = x[X_RELATIVE]
        relative, twist = coasting_shaft(d, x, w, load)
        relative += w[W_RELATIVE_GAIN] * change3 / h
        twist += w[W_TWIST_GAIN] * change3 / h
        turned4 -= twist - x[X_TWIST]
        end4 = end3 - relative
        lost = 0.5 * h * d[D_DAMPING] * (before * before + relative * relative)
        lost += 0.5 * h * d[D_FRICTION] * (begin4 * begin4 + end4 * end4)
        lost -= d[D_BALANCER] * d[D_J4] * change3 * 0.5 * (begin4 + end4)
        add(x, X_ENERGY_LOST, lost)
        assign(x, X_RELATIVE, relative)
        assign(x, X_TWIST, twist)
    add(x, X_ENERGY_OUT, load * turned4)
    assign(x, X_OMEGA3, end3)


def one_step(p, d, x, w, omega1, alpha1, load, h):
    """One fixed step; the inertia at its beginning is kept in w, that at its end is left there."""
    inertia3, momentum3 = shaft_step(p, d, x, w, load, h)
    begin2 = x[X_OMEGA2]
    end2 = begin2
    end3 = x[X_OMEGA3]
    clutch = 0.0
    housing = 0.0
    mode = x[X_MODE]
    for _ in range(CORRECTIONS):
        inertia2, momentum2 = link2_step(d, x, w, omega1, alpha1, h, end2)
        end2, end3, clutch, housing, mode = settle(d, inertia2, momentum2, inertia3, momentum3)
    middle1 = omega1 + 0.5 * alpha1 * h
    before = kept_momentum(d, w, omega1, begin2)
    add(x, X_Q, d[D_K] * h * (middle1 - 0.5 * (begin2 + end2)))
    wrap_drive_angle(d, x)
    put_inertia(d, x, w)
    impulse = kept_momentum(d, w, omega1 + alpha1 * h, end2) - before + clutch - housing
    x[X_INPUT_IMPULSE] += impulse
    add(x, X_ENERGY_IN, impulse * middle1)
    x[X_OUTPUT_IMPULSE] += clutch
    x[X_OUTPUT_SQUARE] += clutch * clutch / h
    x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(clutch) / h)
    follow_shaft(p, d, x, w, load, h, end3)
    assign(x, X_OMEGA2, end2)
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0


def steps_in(d, h):
    """Number of equal steps no longer than max_step in a communication step h."""
    return max(1.0, math.ceil(h / d[D_MAX_STEP] - 1e-9))
