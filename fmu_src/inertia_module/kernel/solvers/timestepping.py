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

from ..accumulate import add, wrap_drive_angle
from ..codes import DRIVING, ELASTIC, FREE, HELD, HELD_DRIVING
from ..driven_shaft.propagator import characteristic, responses
from ..inertia import reduced_inertia

# below this change of q, rad, the derivative of V is more exact than its difference
SMALLEST_DIFFERENCE = 1e-5
# phase of the shaft's own oscillation, rad, up to which a step resolves it
RESOLVED = 0.5
# corrections of q by the mean of the speeds at both ends
CORRECTIONS = 2


def keep_inertia(d, x, w):
    """Keep I, I', B, G and the angular momentum's parts of the present q for the step that begins there."""
    i, i1, _, b, _, g, _, _ = reduced_inertia(d, x.q)
    x.step_evaluations += 1.0
    w.kept_i = i
    w.kept_i1 = i1
    w.kept_b = b
    w.kept_g = g


def link2_step(d, x, w, omega1, alpha1, h, end2):
    """Inertia of link 2 over the step and its momentum without contact, for a guess of its end speed.

    Returns:
        (inertia, momentum): omega2 at the end is (momentum + Ph - Pc) / inertia.
    """
    k = d.k
    middle1 = omega1 + 0.5 * alpha1 * h
    rate_q = k * (omega1 - x.omega2)
    change_q = k * h * (middle1 - 0.5 * (x.omega2 + end2))
    i_end, i1_end, _, b_end, _, g_end, _, _ = reduced_inertia(d, x.q + change_q)
    x.step_evaluations += 1.0
    own = d.J2 / (k * k)
    root = math.sqrt(w.kept_g + own)
    root_end = math.sqrt(g_end + own)
    middle = 0.5 * k * (root + root_end)
    if abs(change_q) > SMALLEST_DIFFERENCE:
        slope = (i_end - w.kept_i) / change_q
    else:
        slope = 0.5 * (w.kept_i1 + i1_end)
    mean_b = 0.5 * (w.kept_b + b_end)
    push = h * (0.5 * k * middle1 * middle1 * slope + alpha1 * (d.J2 - k * mean_b))
    inertia = k * middle * root_end
    return inertia, inertia * (omega1 + alpha1 * h) - middle * root * rate_q - push


def kept_momentum(d, w, omega1, omega2):
    """P = (J1 + I) omega1 + B q' + J2 omega2 with the inertia kept."""
    return (d.J1 + w.kept_i) * omega1 + w.kept_b * d.k * (omega1 - omega2) + d.J2 * omega2


def prepare_shaft_step(p, d, w, h):
    """Answers of the elastic shaft over a step h, the hub accelerating uniformly: kept in w.

    They are exact while the step resolves the shaft, and those of the implicit Euler method, which
    damps whatever it does not resolve, where it does not.
    """
    if p.fidelity != ELASTIC:
        return
    friction = d.friction
    free = 1.0 - d.balancer
    if d.stiffness * (1.0 / d.J3 + 1.0 / d.J4) * h * h > RESOLVED * RESOLVED:
        share = 1.0 / (d.J4 + (friction + d.damping + d.stiffness * h) * h)
        w.slope = d.J4 * share
        w.impulse = h * w.slope
        w.sum = h * w.impulse
        w.relative_gain = (d.J4 * free + friction * h) * h * share
        w.twist_gain = h * w.relative_gain
        w.lag = h
        return
    rate = (d.damping + friction) / d.J4
    square = d.stiffness / d.J4
    swing, slow, fast = characteristic(rate, square)
    _, w.slope, w.impulse, w.sum, two, _, _ = responses(rate, square, swing, slow, fast, h)
    w.relative_gain = free * w.impulse + friction / d.J4 * w.sum
    w.twist_gain = free * w.sum + friction / d.J4 * two
    w.lag = 0.5 * h


def shaft_step(p, d, x, w, load, h):
    """Inertia of the hub over the step and its momentum without contact, with the shaft behind it.

    Returns:
        (inertia, momentum): omega3 at the end is (momentum + Pc) / inertia.
    """
    omega3 = x.omega3
    if p.fidelity != ELASTIC:
        return d.J3, d.J3 * omega3 - h * load
    relative, twist = coasting_shaft(d, x, w, load)
    friction = d.friction
    # momentum that the shaft takes from a hub of constant speed, and more for each rad/s of it
    taken = d.J4 * (x.relative - relative) + friction * (h * omega3 - (twist - x.twist)) + load * h
    own = d.J4 * ((1.0 - d.balancer) * h - w.relative_gain)
    gain = (own + friction * (w.lag * h - w.twist_gain)) / h
    return d.J3 + gain, (d.J3 + gain) * omega3 - taken


def coasting_shaft(d, x, w, load):
    """Relative speed and twist at the end of the step if the hub keeps its speed."""
    relative = x.relative
    push = (d.friction * x.omega3 + load - d.stiffness * x.twist) / d.J4
    end = relative * w.slope + push * w.impulse
    return end, x.twist + relative * w.impulse + push * w.sum


def settle(d, inertia2, momentum2, inertia3, momentum3):
    """The complementarity problem of impulses and end velocities.

    Returns:
        (omega2, omega3, Pc, Ph, contact mode) at the end of the step.
    """
    free2 = momentum2 / inertia2 if inertia2 > 0.0 else 0.0
    free3 = momentum3 / inertia3
    # ties as in contact.select_mode: link 2 stays held, and a shaft that nothing pulls away touches it
    held = d.housing != 0.0 and momentum2 <= 0.0
    if d.output != 0.0:
        if held and free3 > 0.0:
            return 0.0, free3, 0.0, -momentum2, HELD
        if not held and free2 <= free3:
            return free2, free3, 0.0, 0.0, FREE
    together = (momentum2 + momentum3) / (inertia2 + inertia3)
    if d.housing == 0.0 or together > 0.0:
        return together, together, inertia3 * together - momentum3, 0.0, DRIVING
    return 0.0, 0.0, -momentum3, -momentum3 - momentum2, HELD_DRIVING


def follow_shaft(p, d, x, w, load, h, end3):
    """Take over the end speed of the hub, with twist, driven mass and works of the shaft behind it."""
    begin3 = x.omega3
    begin4 = begin3 - x.relative
    lag = w.lag if p.fidelity == ELASTIC else 0.5 * h
    turned4 = h * begin3 + lag * (end3 - begin3)
    if p.fidelity == ELASTIC:
        change3 = end3 - begin3
        before = x.relative
        relative, twist = coasting_shaft(d, x, w, load)
        relative += w.relative_gain * change3 / h
        twist += w.twist_gain * change3 / h
        turned4 -= twist - x.twist
        end4 = end3 - relative
        lost = 0.5 * h * d.damping * (before * before + relative * relative)
        lost += 0.5 * h * d.friction * (begin4 * begin4 + end4 * end4)
        lost -= d.balancer * d.J4 * change3 * 0.5 * (begin4 + end4)
        x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, lost)
        x.relative = relative
        x.relative_low = 0.0
        x.twist = twist
        x.twist_low = 0.0
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * turned4)
    x.omega3 = end3
    x.omega3_low = 0.0


def one_step(p, d, x, w, omega1, alpha1, load, h):
    """One fixed step; the inertia at its beginning is kept in w, that at its end is left there."""
    inertia3, momentum3 = shaft_step(p, d, x, w, load, h)
    begin2 = x.omega2
    end2 = begin2
    end3 = x.omega3
    output_impulse = 0.0
    housing = 0.0
    mode = x.mode
    for _ in range(CORRECTIONS):
        inertia2, momentum2 = link2_step(d, x, w, omega1, alpha1, h, end2)
        end2, end3, output_impulse, housing, mode = settle(d, inertia2, momentum2, inertia3, momentum3)
    middle1 = omega1 + 0.5 * alpha1 * h
    before = kept_momentum(d, w, omega1, begin2)
    x.q, x.q_low = add(x.q, x.q_low, d.k * h * (middle1 - 0.5 * (begin2 + end2)))
    wrap_drive_angle(d, x)
    keep_inertia(d, x, w)
    impulse = kept_momentum(d, w, omega1 + alpha1 * h, end2) - before + output_impulse - housing
    x.input_impulse += impulse
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, impulse * middle1)
    x.output_impulse += output_impulse
    x.output_square += output_impulse * output_impulse / h
    x.torque_peak = max(x.torque_peak, abs(output_impulse) / h)
    follow_shaft(p, d, x, w, load, h, end3)
    x.omega2 = end2
    x.omega2_low = 0.0
    if mode != x.mode:
        x.mode = mode
        x.step_switches += 1.0


def steps_in(d, h):
    """Number of equal steps no longer than max_step in a communication step h."""
    return max(1.0, math.ceil(h / d.max_step - 1e-9))
