"""Impulses, works and losses over one collocation step with the elastic output (order 9)."""

from .accumulate import add
from .collocation import mean
from .dynamics import angular_momentum
from .held import held_angle, held_inertia, mean_inertia
from .radau_table import MATRIX, NODES, STAGES
from .slots import *


def add_shaft_works(d, x, w, load):
    """Impulse, square and peak of Tc, work on the load, and what damping and friction take.

    The work of the balancer counts as negative loss.
    """
    h = w[W_STEP]
    out = 0.0
    lost = 0.0
    square = 0.0
    for n in range(STAGES):
        relative = w[W_STAGE_RELATIVE + n]
        omega4 = w[W_STAGE_OMEGA3 + n] - relative
        clutch = w[W_STAGE_CLUTCH + n]
        weight = h * MATRIX[STAGES - 1][n]
        balancing = d[D_BALANCER] * d[D_J4] * w[W_RATE3 + n]
        out += weight * omega4
        lost += weight * (d[D_DAMPING] * relative * relative + (d[D_FRICTION] * omega4 - balancing) * omega4)
        square += weight * clutch * clutch
        x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(clutch))
    x[X_OUTPUT_IMPULSE] += h * mean(d, w, W_STAGE_CLUTCH)
    x[X_OUTPUT_SQUARE] += square
    add(x, X_ENERGY_OUT, load * out)
    add(x, X_ENERGY_LOST, lost)


def add_moving_works(d, x, w, momentum):
    """Impulse and work of M1 while link 2 moves: M1 - Tc is the rate of the angular momentum P."""
    h = w[W_STEP]
    omega1 = w[W_OMEGA1]
    alpha1 = w[W_ALPHA1]
    end1 = omega1 + alpha1 * h
    momentum_end = angular_momentum(d, x[X_Q], end1, x[X_OMEGA2])
    x[X_STEP_EVALUATIONS] += 2.0
    clutch = h * mean(d, w, W_STAGE_CLUTCH)
    impulse = momentum_end - momentum + clutch
    x[X_INPUT_IMPULSE] += impulse
    if alpha1 == 0.0:
        add(x, X_ENERGY_IN, omega1 * impulse)
        return
    work = end1 * momentum_end - omega1 * momentum + omega1 * clutch
    for n in range(STAGES):
        t = h * NODES[n]
        weight = h * MATRIX[STAGES - 1][n] * alpha1
        inside = angular_momentum(d, w[W_STAGE_Q + n], omega1 + alpha1 * t, w[W_STAGE_OMEGA2 + n])
        work += weight * (t * w[W_STAGE_CLUTCH + n] - inside)
    x[X_STEP_EVALUATIONS] += STAGES
    add(x, X_ENERGY_IN, work)


def add_held_works(d, x, w, q):
    """Impulse and work of M1 while link 2 is held: link 1 alone turns, with the inertia Phi(q)."""
    h = w[W_STEP]
    omega1 = w[W_OMEGA1]
    alpha1 = w[W_ALPHA1]
    end = omega1 + alpha1 * h
    before = held_inertia(d, q)
    after = held_inertia(d, held_angle(d, q, omega1, alpha1, h))
    x[X_STEP_EVALUATIONS] += 2.0
    integral = mean_inertia(d, x, q, omega1, alpha1, 0.0, h) if alpha1 != 0.0 else 0.0
    add(x, X_ENERGY_IN, 0.5 * (after * end * end - before * omega1 * omega1))
    x[X_INPUT_IMPULSE] += 0.5 * (after * end - before * omega1 + alpha1 * integral)
