"""Impulses and works of the torques over a step, its mean square and peak: in one place for all solvers.

With the torque given its impulse is the torque times the time and its work the torque times the angle of link
1. With the speed given M1 - Tc + Th is the rate of the angular momentum P and Tc = J3 omega3' + load, so the
impulses are exact in the end values, and so is the work while omega1 is constant. With a ramp alpha1 of it
the work takes the integral of P as well: that of omega1 dP is omega1 P less alpha1 times it.
"""

from .accumulate import add, add_loss
from .codes import SHAFT, VISCOUS
from .links import angular_momentum, friction_power, inertia_at_input
from .output_shaft import turn
from .solvers.radau import MATRIX
from .solvers.radau import NODES as RADAU_NODES
from .solvers.radau import STAGES as RADAU_STAGES

# five-point Gauss-Legendre rule on [0, 1]
GAUSS_NODE_1 = 0.04691007703066802
GAUSS_NODE_2 = 0.23076534494715845
GAUSS_WEIGHT_1 = 0.11846344252809454
GAUSS_WEIGHT_2 = 0.23931433524968324
GAUSS_WEIGHT_3 = 0.28444444444444444


def add_work_in(x, work):
    """Add work of the input torque, J."""
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, work)


def held_angle(d, q, omega1, alpha1, t):
    """Drive angle after the time t with link 2 held and the speed of link 1 given."""
    return q + d.k * t * (omega1 + 0.5 * alpha1 * t)


def inertia_integral(d, x, q, omega1, alpha1, start, end):
    """Integral of Phi over the time from start to end while link 2 is held (five-point Gauss rule)."""
    h = end - start
    near = inertia_at_input(d, held_angle(d, q, omega1, alpha1, start + GAUSS_NODE_1 * h))
    near += inertia_at_input(d, held_angle(d, q, omega1, alpha1, end - GAUSS_NODE_1 * h))
    mid = inertia_at_input(d, held_angle(d, q, omega1, alpha1, start + GAUSS_NODE_2 * h))
    mid += inertia_at_input(d, held_angle(d, q, omega1, alpha1, end - GAUSS_NODE_2 * h))
    centre = inertia_at_input(d, held_angle(d, q, omega1, alpha1, start + 0.5 * h))
    x.step_evaluations += 5.0
    return h * (GAUSS_WEIGHT_1 * near + GAUSS_WEIGHT_2 * mid + GAUSS_WEIGHT_3 * centre)


def add_held_works(d, x, q, omega1, alpha1, h, integral_of_phi):
    """Impulse and work of M1 over h, link 2 held and the speed prescribed: link 1 alone turns, with Phi(q).

    Returns:
        Its kinetic energy at the end, J.
    """
    end = omega1 + alpha1 * h
    before = inertia_at_input(d, q)
    after = inertia_at_input(d, held_angle(d, q, omega1, alpha1, h))
    x.step_evaluations += 2.0
    energy = 0.5 * after * end * end
    # link 1 and the drives, which turn k times as fast
    friction = d.b1 + d.k * d.k * d.bq
    lost = friction * h * (omega1 * end + alpha1 * h * alpha1 * h / 3.0)
    add_loss(x, VISCOUS, lost)
    add_work_in(x, energy - 0.5 * before * omega1 * omega1 + lost)
    x.input_impulse += 0.5 * (after * end - before * omega1 + alpha1 * integral_of_phi)
    x.input_impulse += friction * h * 0.5 * (omega1 + end)
    return energy


def add_shaft_works(d, x, w):
    """Collocation step: impulse, square and peak of Tc, work on the load, and what damping and friction take.

    The work of the balancer counts as negative loss. Order 9.
    """
    h = w.step
    out = 0.0
    lost = 0.0
    friction_work = 0.0
    for n in range(RADAU_STAGES):
        relative = w.stage_relative[n]
        omega4 = w.stage_omega3[n] - relative
        output_torque = w.stage_output_torque[n]
        weight = h * MATRIX[RADAU_STAGES * (RADAU_STAGES - 1) + n]
        balancing = d.balancer * d.J4 * w.rate3[n]
        out += weight * omega4
        lost += weight * (d.damping * relative * relative + (d.friction * omega4 - balancing) * omega4)
        friction_work += weight * d.b3 * w.stage_omega3[n] * w.stage_omega3[n]
        x.output_square += weight * output_torque * output_torque
        x.output_impulse += weight * output_torque
        x.torque_peak = max(x.torque_peak, abs(output_torque))
    turn(x, w.load, out)
    add_loss(x, SHAFT, lost)
    add_loss(x, VISCOUS, friction_work)


def add_link_losses(d, x, w):
    """Collocation step: what the friction of links 1, 2 and the drives takes."""
    if d.viscous == 0.0:
        return
    lost = 0.0
    for n in range(RADAU_STAGES):
        power = friction_power(d, w.stage_omega1[n], w.stage_omega2[n], d.b2)
        lost += w.step * MATRIX[RADAU_STAGES * (RADAU_STAGES - 1) + n] * power
    add_loss(x, VISCOUS, lost)


def add_moving_works(d, x, w, start1, momentum):
    """Collocation step with link 2 in motion and the speed prescribed: impulse and work of M1; momentum: P
    before.
    """
    h = w.step
    alpha1 = w.prescribed
    momentum_end = angular_momentum(d, x.q, x.omega1, x.omega2)
    x.step_evaluations += 2.0
    resisting_impulse = 0.0
    moment = 0.0
    for n in range(RADAU_STAGES):
        weight = h * MATRIX[RADAU_STAGES * (RADAU_STAGES - 1) + n]
        resisting = w.stage_output_torque[n] + d.b1 * w.stage_omega1[n] + d.b2 * w.stage_omega2[n]
        resisting_impulse += weight * resisting
        if alpha1 != 0.0:
            inside = angular_momentum(d, w.stage_q[n], w.stage_omega1[n], w.stage_omega2[n])
            moment += weight * (h * RADAU_NODES[n] * resisting - inside)
            x.step_evaluations += 1.0
    impulse = momentum_end - momentum + resisting_impulse
    x.input_impulse += impulse
    if alpha1 == 0.0:
        add_work_in(x, start1 * impulse)
    else:
        add_work_in(x, x.omega1 * momentum_end - start1 * (momentum - resisting_impulse) + alpha1 * moment)
