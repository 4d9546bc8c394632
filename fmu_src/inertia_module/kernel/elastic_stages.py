"""One collocation step with the elastic output: the stages in each contact mode.

Unknown are the rates of omega2 and omega3 at the five stages; q follows from omega2, the twist and the
driven mass from omega3 (:mod:`.shaft`). While link 2 drives, both rates are one.
"""

from .collocation import eliminate, mean, row
from .dynamics import free_torque
from .inertia import reduced_inertia
from .radau_table import NODES, STAGES
from .shaft import follow_hub, prepare_shaft, put_start_torque
from .slots import *
from .torque_elastic_stages import solve_links

# Newton converges quadratically: with an update this small relative to the rates the next is rounding
LAST_UPDATE = 1e-7
ITERATIONS = 12


def put_link2_stages(d, x, w, h):
    """omega2 and q at the stages from the rates of omega2."""
    k = d[D_K]
    omega1 = w[W_OMEGA1]
    alpha1 = w[W_ALPHA1]
    for i in range(STAGES):
        w[W_STAGE_OMEGA2 + i] = x[X_OMEGA2] + h * row(d, D_RADAU, i, w, W_RATE2)
    for i in range(STAGES):
        t = h * NODES[i]
        turned2 = h * row(d, D_RADAU, i, w, W_STAGE_OMEGA2)
        w[W_STAGE_Q + i] = x[X_Q] + k * (t * (omega1 + 0.5 * alpha1 * t) - turned2)


def put_equation(d, w, h, i, carried):
    """Row i of the equations of motion of link 2 and of their derivatives in its rates."""
    k = d[D_K]
    alpha1 = w[W_ALPHA1]
    omega1 = w[W_OMEGA1] + alpha1 * h * NODES[i]
    q = w[W_STAGE_Q + i]
    _, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    rate_q = k * (omega1 - w[W_STAGE_OMEGA2 + i])
    inertia = d[D_J2] + k * k * g + carried
    rate = w[W_RATE2 + i]
    w[W_RIGHT_SIDE + i] = inertia * rate - free_torque(d, omega1, alpha1, rate_q, i1, b, g, g1)
    slope = k * ((k * g1 + b1) * alpha1 + 0.5 * g2 * rate_q * rate_q - 0.5 * i2 * omega1 * omega1)
    in_q = -k * h * h * (k * k * g1 * rate - slope)
    in_speed = k * k * g1 * rate_q * h
    base = STAGES * i
    for j in range(STAGES):
        w[W_JACOBIAN + base + j] = in_q * d[D_RADAU_SQUARE + base + j] + in_speed * d[D_RADAU + base + j]
    w[W_JACOBIAN + base + i] += inertia
    if carried > 0.0:
        w[W_RIGHT_SIDE + i] += w[W_STAGE_SHAFT_TORQUE + i] + row(w, W_SHAFT, i, w, W_RATE2)
        for j in range(STAGES):
            w[W_JACOBIAN + base + j] += w[W_SHAFT + base + j]


def solve_link2(d, x, w, h, carried):
    """Newton's method for the rates of omega2, link 2 carrying the inertia carried (J3, or 0 if free).

    Returns:
        Whether it converged.
    """
    for n in range(STAGES):
        w[W_RATE2 + n] = 0.0
    for _ in range(ITERATIONS):
        put_link2_stages(d, x, w, h)
        for i in range(STAGES):
            put_equation(d, w, h, i, carried)
        x[X_STEP_EVALUATIONS] += STAGES
        eliminate(w, W_JACOBIAN, 1, W_RIGHT_SIDE)
        update = 0.0
        largest = 0.0
        for n in range(STAGES):
            update = max(update, abs(w[W_RIGHT_SIDE + n]))
            w[W_RATE2 + n] -= w[W_RIGHT_SIDE + n]
            largest = max(largest, abs(w[W_RATE2 + n]))
        if not largest < 1e300:
            return False
        if update <= LAST_UPDATE * largest:
            put_link2_stages(d, x, w, h)
            return True
    return False


def solve_hub(d, w):
    """Rates of the hub while nothing but the shaft acts on it: J3 v + Ts = 0."""
    for n in range(STAGES * STAGES):
        w[W_JACOBIAN + n] = w[W_SHAFT + n]
    for i in range(STAGES):
        w[W_JACOBIAN + (STAGES + 1) * i] += d[D_J3]
        w[W_RATE3 + i] = -w[W_STAGE_SHAFT_TORQUE + i]
    eliminate(w, W_JACOBIAN, 1, W_RATE3)


def solve_stages(d, x, w, h):
    """All stages of a step h from the state in x, in its contact mode. Returns whether they converged."""
    mode = x[X_MODE]
    load = w[W_LOAD]
    w[W_STEP] = h
    prepare_shaft(d, w, h)
    put_start_torque(d, x, w, h, load)
    for n in range(STAGES):
        w[W_RATE3 + n] = 0.0
    if w[W_COLLOCATED] == DRIVEN_COLLOCATED:
        if not solve_links(d, x, w, h, d[D_J3] if mode == DRIVING else 0.0):
            return False
        w[W_ALPHA1] = mean(d, w, W_RATE1)
    elif mode == HELD or mode == HELD_DRIVING:
        for n in range(STAGES):
            w[W_RATE2 + n] = 0.0
        put_link2_stages(d, x, w, h)
    elif not solve_link2(d, x, w, h, d[D_J3] if mode == DRIVING else 0.0):
        return False
    if mode == DRIVING:
        for n in range(STAGES):
            w[W_RATE3 + n] = w[W_RATE2 + n]
    elif mode != HELD_DRIVING:
        solve_hub(d, w)
    follow_hub(d, x, w, h, load)
    for n in range(STAGES):
        clutch = 0.0
        if mode == DRIVING:
            clutch = d[D_J3] * w[W_RATE3 + n] + w[W_STAGE_SHAFT_TORQUE + n]
        elif mode == HELD_DRIVING:
            clutch = w[W_STAGE_SHAFT_TORQUE + n]
        w[W_STAGE_CLUTCH + n] = clutch
    return True


def change(d, w, vector):
    """Change over the step of the quantity with rates at w[vector]."""
    return w[W_STEP] * mean(d, w, vector)
