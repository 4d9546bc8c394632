"""One collocation step with the elastic output: the stages in each contact mode.

Unknown are the rates of omega1, omega2 and omega3 at the five stages; q follows from both links, the twist
and the driven mass from omega3 (:mod:`.shaft_stages`). The equations are those of :mod:`..links`, by Newton's
method,

    Phi alpha1 - N omega2' + R1 - M1 = 0
    (J2 + k^2 G + carried) omega2' - N alpha1 - R2 + b omega2 + Ts = 0

the first of them only where M1 is given. While link 2 drives, omega2 and omega3 have the same rates.
"""

from ..codes import DRIVING, HELD_DRIVING
from ..contact import is_held
from ..inertia import reduced_inertia, second_derivative_of_b
from .collocation import eliminate, mean, row
from .radau import MATRIX, SQUARE, STAGES
from .shaft_stages import follow_hub, prepare_shaft, start_torques

# Newton converges quadratically: with an update this small relative to the rates the next is rounding
LAST_UPDATE = 1e-7
ITERATIONS = 12


def compute_speeds(d, x, w, h):
    """Speeds of both links and q at the stages from the rates of the speeds."""
    for i in range(STAGES):
        w.stage_omega1[i] = x.omega1 + h * row(MATRIX, i, w.rate1)
        w.stage_omega2[i] = x.omega2 + h * row(MATRIX, i, w.rate2)
    for i in range(STAGES):
        turned1 = row(MATRIX, i, w.stage_omega1)
        turned2 = row(MATRIX, i, w.stage_omega2)
        w.stage_q[i] = x.q + d.k * h * (turned1 - turned2)


def set_equations(d, w, h, i, carried):
    """Row i of the equations of motion and of their derivatives in the rates of both speeds.

    Args:
        carried: inertia that link 2 carries besides the shaft, J3 or 0, kg m^2.
    """
    k = d.k
    omega1 = w.stage_omega1[i]
    friction = d.b2 + (d.b3 if carried > 0.0 else 0.0)
    rate1 = w.rate1[i]
    rate2 = w.rate2[i]
    inertia, i1, i2, b, b1, g, g1, g2 = reduced_inertia(d, w.stage_q[i])
    rate_q = k * (omega1 - w.stage_omega2[i])
    coupling = k * (b + k * g)
    own = d.J2 + carried + k * k * g
    r2 = 0.5 * k * (g1 * rate_q * rate_q - i1 * omega1 * omega1) + k * d.bq * rate_q
    # derivatives of the demands by q, by q' and by omega1
    r2_q = 0.5 * k * (g2 * rate_q * rate_q - i2 * omega1 * omega1)
    r2_rate = k * g1 * rate_q + k * d.bq
    coupling_q = k * (b1 + k * g1)
    second_q = k * h * h * (k * k * g1 * rate2 - coupling_q * rate1 - r2_q)
    second_rate = -k * h * r2_rate
    base = STAGES * i
    for j in range(STAGES):
        w.corner[base + j] = -second_q * SQUARE[base + j] - (second_rate - h * friction) * MATRIX[base + j]
    w.corner[base + i] += own
    w.right_side[i] = own * rate2 - coupling * rate1 - r2 + friction * w.stage_omega2[i]
    if carried > 0.0:
        w.right_side[i] += w.stage_shaft_torque[i] + row(w.shaft, i, w.rate2)
        for j in range(STAGES):
            w.corner[base + j] += w.shaft[base + j]
    if d.by_torque == 0.0:
        return
    second_derivative = second_derivative_of_b(d, w.stage_q[i])
    phi = d.J1 + inertia + k * (2.0 * b + k * g)
    r1 = (i1 * omega1 + b1 * rate_q) * rate_q + d.b1 * omega1 + r2
    r1_q = (i2 * omega1 + second_derivative * rate_q) * rate_q + r2_q
    r1_rate = i1 * omega1 + 2.0 * b1 * rate_q + r2_rate
    r2_speed = -k * i1 * omega1
    r1_speed = i1 * rate_q + d.b1 + r2_speed
    phi_q = i1 + k * (2.0 * b1 + k * g1)
    first_q = k * h * h * (phi_q * rate1 - coupling_q * rate2 + r1_q)
    first_rate = k * h * r1_rate
    columns = (STAGES + 1) * i
    for j in range(STAGES):
        once = MATRIX[base + j]
        twice = SQUARE[base + j]
        w.jacobian[base + j] = first_q * twice + (first_rate + h * r1_speed) * once
        w.columns[columns + j] = -first_q * twice - first_rate * once
        w.lower[base + j] = second_q * twice + (second_rate - h * r2_speed) * once
    w.jacobian[base + i] += phi
    w.columns[columns + i] -= coupling
    w.lower[base + i] -= coupling
    w.columns[columns + STAGES] = phi * rate1 - coupling * rate2 - w.prescribed + r1


def eliminate_link1(w):
    """Eliminate the rates of omega1 from the equations of link 2."""
    for i in range(STAGES):
        for n in range(STAGES):
            lower = w.lower[STAGES * i + n]
            columns = (STAGES + 1) * n
            for j in range(STAGES):
                w.corner[STAGES * i + j] -= lower * w.columns[columns + j]
            w.right_side[i] -= lower * w.columns[columns + STAGES]


def solve_updates(d, w, held):
    """Solve for the updates of the rates: of omega2 in w.right_side, of omega1 in w.update1."""
    if d.by_torque != 0.0:
        eliminate(w.jacobian, STAGES + 1, w.columns)
        if not held:
            eliminate_link1(w)
    if held:
        for i in range(STAGES):
            w.right_side[i] = 0.0
    else:
        eliminate(w.corner, 1, w.right_side)
    for i in range(STAGES):
        w.update1[i] = 0.0
        if d.by_torque != 0.0:
            columns = (STAGES + 1) * i
            value = w.columns[columns + STAGES]
            for j in range(STAGES):
                value -= w.columns[columns + j] * w.right_side[j]
            w.update1[i] = value


def guess_rates(w, rate1, rate2):
    """Rates of both speeds that Newton's method begins from, the same at all stages."""
    for n in range(STAGES):
        w.rate1[n] = rate1
        w.rate2[n] = rate2


def solve_links(d, x, w, h, carried):
    """Newton's method for the rates of both speeds, link 2 carrying an inertia. Whether it converged.

    It begins from the rates that are there, those at the beginning of the step or of the same step tried
    before at another length.
    """
    held = is_held(x)
    if held and d.by_torque == 0.0:
        compute_speeds(d, x, w, h)
        return True
    fastest = max(abs(x.omega1), abs(x.omega2))
    natural = d.harmonic * d.k * fastest * fastest
    for _ in range(ITERATIONS):
        compute_speeds(d, x, w, h)
        for i in range(STAGES):
            set_equations(d, w, h, i, carried)
        x.step_evaluations += STAGES
        solve_updates(d, w, held)
        update = 0.0
        largest = natural
        for i in range(STAGES):
            update = max(update, max(abs(w.update1[i]), abs(w.right_side[i])))
            w.rate1[i] -= w.update1[i]
            w.rate2[i] -= w.right_side[i]
            largest = max(largest, max(abs(w.rate1[i]), abs(w.rate2[i])))
        if not largest < 1e300:
            break
        if update <= LAST_UPDATE * largest:
            compute_speeds(d, x, w, h)
            return True
    guess_rates(w, w.prescribed if d.by_torque == 0.0 else 0.0, 0.0)
    return False


def compute_release(d, x, w):
    """F at the stages while link 2 is held, N m."""
    k = d.k
    for i in range(STAGES):
        omega1 = w.stage_omega1[i]
        _, i1, _, b, _, g, g1, _ = reduced_inertia(d, w.stage_q[i])
        r2 = 0.5 * k * (g1 * k * k - i1) * omega1 * omega1 + k * k * d.bq * omega1
        w.stage_release[i] = r2 + k * (b + k * g) * w.rate1[i]
    x.step_evaluations += STAGES


def solve_hub(d, w, omega3):
    """Rates of the hub while nothing but shaft and friction act on it: J3 v + b3 omega3 + Ts = 0."""
    for n in range(STAGES * STAGES):
        w.jacobian[n] = w.shaft[n] + w.step * d.b3 * MATRIX[n]
    for i in range(STAGES):
        w.jacobian[(STAGES + 1) * i] += d.J3
        w.rate3[i] = -w.stage_shaft_torque[i] - d.b3 * omega3
    eliminate(w.jacobian, 1, w.rate3)


def solve_stages(d, x, w, h):
    """All stages of a step h from the state in x, in its contact mode. Returns whether they converged."""
    mode = x.mode
    w.step = h
    prepare_shaft(d, w, h)
    start_torques(d, x, w, h, w.load)
    for n in range(STAGES):
        w.rate3[n] = 0.0
    if not solve_links(d, x, w, h, d.J3 if mode == DRIVING else 0.0):
        return False
    if d.by_torque != 0.0:
        w.alpha1 = mean(w.rate1)
        if is_held(x):
            compute_release(d, x, w)
    if mode == DRIVING:
        for n in range(STAGES):
            w.rate3[n] = w.rate2[n]
    elif mode != HELD_DRIVING:
        solve_hub(d, w, x.omega3)
    follow_hub(d, x, w, h, w.load)
    for n in range(STAGES):
        output_torque = 0.0
        if mode == DRIVING:
            output_torque = d.J3 * w.rate3[n] + d.b3 * w.stage_omega3[n] + w.stage_shaft_torque[n]
        elif mode == HELD_DRIVING:
            output_torque = w.stage_shaft_torque[n]
        w.stage_output_torque[n] = output_torque
    return True
