"""Method `timestepping`: fixed steps, complementarity of impulses and end velocities in each (Moreau).

No event is searched for, so every step costs the same. With V = I omega1^2 / 2 and the inertia
N = G + J2/k^2 of q', link 2 obeys

    k sqrt(N) (sqrt(N) q')' = J2 alpha1 + k dV/dq - k B alpha1 - Th + Tc

which is stepped with the differences of sqrt(N) and V over the step instead of their derivatives (a
discrete gradient): without contact the kinetic energy changes by what V does, and no impulse exceeds
what the differences allow, however coarse the step.
"""

import math

from .accumulate import add, assign, wrap_drive_angle
from .inertia import reduced_inertia
from .slots import *

# below this change of q, rad, the derivative of V is more exact than its difference
SMALLEST_DIFFERENCE = 1e-5
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


def shaft_step(p, d, x, load, h):
    """Inertia of the hub over the step and its momentum without contact; the elastic shaft is implicit.

    Returns:
        (inertia, momentum, torque of the shaft at the end if the hub keeps its speed, its gain in
        omega3'): omega3 at the end is (momentum + Pc) / inertia.
    """
    if p[P_FIDELITY] != ELASTIC:
        return d[D_J3], d[D_J3] * x[X_OMEGA3] - h * load, load, 0.0
    friction = d[D_FRICTION] * h
    stiff = d[D_STIFFNESS] * h * h + d[D_DAMPING] * h
    relative = x[X_RELATIVE]
    uniform = d[D_STIFFNESS] * (x[X_TWIST] + relative * h) + d[D_DAMPING] * relative
    drag = d[D_FRICTION] * (x[X_OMEGA3] - relative) + load
    share = stiff / (d[D_J4] + friction + stiff)
    torque = uniform + share * (drag - uniform)
    gain = share * (d[D_J4] * (1.0 - d[D_BALANCER]) + friction)
    inertia = d[D_J3] + gain
    return inertia, inertia * x[X_OMEGA3] - h * torque, torque, gain


def settle(d, inertia2, momentum2, inertia3, momentum3):
    """The complementarity problem of impulses and end velocities.

    Returns:
        (omega2, omega3, Pc, Ph, contact mode) at the end of the step.
    """
    free2 = momentum2 / inertia2 if inertia2 > 0.0 else 0.0
    free3 = momentum3 / inertia3
    if d[D_OUTPUT] != 0.0:
        if free2 <= free3 and (free2 >= 0.0 or d[D_HOUSING] == 0.0):
            return free2, free3, 0.0, 0.0, FREE
        if d[D_HOUSING] != 0.0 and momentum2 <= 0.0 and free3 >= 0.0:
            return 0.0, free3, 0.0, -momentum2, HELD
    together = (momentum2 + momentum3) / (inertia2 + inertia3)
    if d[D_HOUSING] == 0.0 or together > 0.0:
        return together, together, inertia3 * together - momentum3, 0.0, DRIVING
    return 0.0, 0.0, -momentum3, -momentum3 - momentum2, HELD_DRIVING


def follow_shaft(p, d, x, load, h, end3, torque, gain):
    """Twist, driven mass and works of the shaft for the end speed of the hub; its state is taken over."""
    begin3 = x[X_OMEGA3]
    begin4 = begin3 - x[X_RELATIVE]
    end4 = end3
    if p[P_FIDELITY] == ELASTIC:
        change3 = end3 - begin3
        shaft = torque + gain * change3 / h
        friction = d[D_FRICTION] * h
        stiff = d[D_STIFFNESS] * h * h + d[D_DAMPING] * h
        uniform = d[D_STIFFNESS] * (x[X_TWIST] + x[X_RELATIVE] * h) + d[D_DAMPING] * x[X_RELATIVE]
        drag = d[D_FRICTION] * begin4 + load
        driven = d[D_J4] * (1.0 - d[D_BALANCER]) * change3 + friction * change3
        change = (driven + h * (drag - uniform)) / (d[D_J4] + friction + stiff)
        add(x, X_RELATIVE, change)
        relative = x[X_RELATIVE]
        add(x, X_TWIST, h * relative)
        end4 = end3 - relative
        middle4 = 0.5 * (begin4 + end4)
        damping = (shaft - d[D_STIFFNESS] * x[X_TWIST]) * relative
        balancing = d[D_BALANCER] * d[D_J4] * change3 * middle4
        add(x, X_ENERGY_LOST, h * (damping + d[D_FRICTION] * end4 * middle4) - balancing)
    add(x, X_ENERGY_OUT, h * load * 0.5 * (begin4 + end4))
    assign(x, X_OMEGA3, end3)


def one_step(p, d, x, w, omega1, alpha1, load, h):
    """One fixed step; the inertia at its beginning is kept in w, that at its end is left there."""
    inertia3, momentum3, torque, gain = shaft_step(p, d, x, load, h)
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
    follow_shaft(p, d, x, load, h, end3, torque, gain)
    assign(x, X_OMEGA2, end2)
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0


def steps_in(d, h):
    """Number of equal steps no longer than max_step in a communication step h."""
    return max(1.0, math.ceil(h / d[D_MAX_STEP] - 1e-9))
