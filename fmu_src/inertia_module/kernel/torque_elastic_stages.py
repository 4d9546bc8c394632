"""Stages of a collocation step of the elastic output where the input torque is given.

The rates of omega1 are unknown as well: Newton's method for

    Phi alpha1 - N omega2' = M1 - R1        (J2 + k^2 G + carried) omega2' - N alpha1 + Ts = R2

at all stages (:mod:`.torque_dynamics`), the shaft eliminated as in :mod:`.shaft`.
"""

import math

from .collocation import eliminate, row
from .inertia import coupling_bend, reduced_inertia
from .radau_table import STAGES
from .slots import *
from .torque_dynamics import acceleration, seen_inertia
from .torque_stages import is_held

# Newton converges quadratically: with an update this small relative to the rates the next is rounding
LAST_UPDATE = 1e-7
ITERATIONS = 12


def put_link_stages(d, x, w, h):
    """Speeds of both links and q at the stages from the rates of the speeds."""
    k = d[D_K]
    for i in range(STAGES):
        w[W_STAGE_OMEGA1 + i] = x[X_OMEGA1] + h * row(d, D_RADAU, i, w, W_RATE1)
        w[W_STAGE_OMEGA2 + i] = x[X_OMEGA2] + h * row(d, D_RADAU, i, w, W_RATE2)
    for i in range(STAGES):
        turned1 = row(d, D_RADAU, i, w, W_STAGE_OMEGA1)
        turned2 = row(d, D_RADAU, i, w, W_STAGE_OMEGA2)
        w[W_STAGE_Q + i] = x[X_Q] + k * h * (turned1 - turned2)


def put_link_equations(d, w, h, i, carried):
    """Row i of both equations of motion and of their derivatives in the rates of both speeds.

    Args:
        carried: inertia that link 2 carries besides the shaft, J3 or 0, kg m^2.
    """
    k = d[D_K]
    omega1 = w[W_STAGE_OMEGA1 + i]
    q = w[W_STAGE_Q + i]
    rate1 = w[W_RATE1 + i]
    rate2 = w[W_RATE2 + i]
    inertia, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, q)
    rate_q = k * (omega1 - w[W_STAGE_OMEGA2 + i])
    phi = d[D_J1] + inertia + k * (2.0 * b + k * g)
    coupling = k * (b + k * g)
    own = d[D_J2] + carried + k * k * g
    demand2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1)
    demand1 = (i1 * omega1 + b1 * rate_q) * rate_q + demand2
    # derivatives of the demands by q, by q' and by omega1
    demand2_q = 0.5 * k * (g2 * rate_q * rate_q - i2 * omega1 * omega1)
    demand1_q = (i2 * omega1 + coupling_bend(d, q) * rate_q) * rate_q + demand2_q
    demand2_rate = k * g1 * rate_q
    demand1_rate = i1 * omega1 + 2.0 * b1 * rate_q + demand2_rate
    demand2_speed = -k * i1 * omega1
    demand1_speed = i1 * rate_q + demand2_speed
    phi_q = i1 + k * (2.0 * b1 + k * g1)
    coupling_q = k * (b1 + k * g1)
    first_q = k * h * h * (phi_q * rate1 - coupling_q * rate2 + demand1_q)
    second_q = k * h * h * (k * k * g1 * rate2 - coupling_q * rate1 - demand2_q)
    first_rate = k * h * demand1_rate
    second_rate = -k * h * demand2_rate
    base = STAGES * i
    columns = W_LINK_COLUMNS + (STAGES + 1) * i
    for j in range(STAGES):
        once = d[D_RADAU + base + j]
        twice = d[D_RADAU_SQUARE + base + j]
        w[W_JACOBIAN + base + j] = first_q * twice + (first_rate + h * demand1_speed) * once
        w[columns + j] = -first_q * twice - first_rate * once
        w[W_LINK_LOWER + base + j] = second_q * twice + (second_rate - h * demand2_speed) * once
        w[W_LINK_CORNER + base + j] = -second_q * twice - second_rate * once
    w[W_JACOBIAN + base + i] += phi
    w[columns + i] -= coupling
    w[W_LINK_LOWER + base + i] -= coupling
    w[W_LINK_CORNER + base + i] += own
    w[columns + STAGES] = phi * rate1 - coupling * rate2 - w[W_DRIVE_TORQUE] + demand1
    w[W_RIGHT_SIDE + i] = own * rate2 - coupling * rate1 - demand2
    if carried > 0.0:
        w[W_RIGHT_SIDE + i] += w[W_STAGE_SHAFT_TORQUE + i] + row(w, W_SHAFT, i, w, W_RATE2)
        for j in range(STAGES):
            w[W_LINK_CORNER + base + j] += w[W_SHAFT + base + j]


def put_updates(w, held):
    """Solve for the updates of the rates: of omega2 at W_RIGHT_SIDE, of omega1 at W_LINK_UPDATE."""
    eliminate(w, W_JACOBIAN, STAGES + 1, W_LINK_COLUMNS)
    if held:
        for i in range(STAGES):
            w[W_RIGHT_SIDE + i] = 0.0
    else:
        for i in range(STAGES):
            for n in range(STAGES):
                lower = w[W_LINK_LOWER + STAGES * i + n]
                columns = W_LINK_COLUMNS + (STAGES + 1) * n
                for j in range(STAGES):
                    w[W_LINK_CORNER + STAGES * i + j] -= lower * w[columns + j]
                w[W_RIGHT_SIDE + i] -= lower * w[columns + STAGES]
        eliminate(w, W_LINK_CORNER, 1, W_RIGHT_SIDE)
    for i in range(STAGES):
        columns = W_LINK_COLUMNS + (STAGES + 1) * i
        value = w[columns + STAGES]
        for j in range(STAGES):
            value -= w[columns + j] * w[W_RIGHT_SIDE + j]
        w[W_LINK_UPDATE + i] = value


def put_release(d, x, w):
    """F at the stages while link 2 is held, N m."""
    k = d[D_K]
    for i in range(STAGES):
        omega1 = w[W_STAGE_OMEGA1 + i]
        _, i1, _, b, _, g, g1, _ = reduced_inertia(d, w[W_STAGE_Q + i])
        rate_q = k * omega1
        demand2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1)
        w[W_STAGE_RELEASE + i] = demand2 + k * (b + k * g) * w[W_RATE1 + i]
    x[X_STEP_EVALUATIONS] += STAGES


def guess_rates(w, rate1, rate2):
    """Rates of both speeds that Newton's method begins from, the same at all stages."""
    for n in range(STAGES):
        w[W_RATE1 + n] = rate1
        w[W_RATE2 + n] = rate2


def solve_links(d, x, w, h, carried):
    """Newton's method for the rates of both speeds, link 2 carrying an inertia. Whether it converged.

    It begins from the rates that are there, those at the beginning of the step or of the same step tried
    before at another length.
    """
    held = is_held(x)
    fastest = max(abs(x[X_OMEGA1]), abs(x[X_OMEGA2]))
    natural = d[D_HARMONIC] * d[D_K] * fastest * fastest
    for _ in range(ITERATIONS):
        put_link_stages(d, x, w, h)
        for i in range(STAGES):
            put_link_equations(d, w, h, i, carried)
        x[X_STEP_EVALUATIONS] += STAGES
        put_updates(w, held)
        update = 0.0
        largest = natural
        for i in range(STAGES):
            update = max(update, max(abs(w[W_LINK_UPDATE + i]), abs(w[W_RIGHT_SIDE + i])))
            w[W_RATE1 + i] -= w[W_LINK_UPDATE + i]
            w[W_RATE2 + i] -= w[W_RIGHT_SIDE + i]
            largest = max(largest, max(abs(w[W_RATE1 + i]), abs(w[W_RATE2 + i])))
        if not largest < 1e300:
            break
        if update <= LAST_UPDATE * largest:
            put_link_stages(d, x, w, h)
            if held:
                put_release(d, x, w)
            return True
    guess_rates(w, 0.0, 0.0)
    return False


def put_driven_start(d, x, w, torque):
    """Accelerations of both links at the beginning of the step, the guess for its stages, and an inertia.

    Args:
        torque: of the shaft, N m.

    Returns:
        (alpha1, omega2', inertia): what link 2 shows the shaft, without J3 and with link 1 free under its
        torque, kg m^2.
    """
    mode = x[X_MODE]
    driving = mode == DRIVING
    omega1, omega2, given = x[X_OMEGA1], x[X_OMEGA2], w[W_DRIVE_TORQUE]
    x[X_STEP_EVALUATIONS] += 1.0
    alpha1, alpha2 = acceleration(
        d, x[X_Q], omega1, omega2, given, is_held(x), d[D_J3] if driving else 0.0, torque if driving else 0.0
    )
    guess_rates(w, alpha1, alpha2)
    return alpha1, alpha2, 0.0 if is_held(x) else seen_inertia(d, x[X_Q])


def driven_horizon(d, w, remaining, phase):
    """Time from now on whose pulses a step is to be measured by, where link 1 accelerates at W_ALPHA1."""
    growth = d[D_HARMONIC] * d[D_K] * abs(w[W_ALPHA1])
    return math.sqrt(2.0 * phase / growth) if 0.5 * growth * remaining * remaining > phase else remaining
