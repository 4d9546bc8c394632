"""Dormand and Prince's embedded pair 8(5,3) with dense output of order 7, for (q, omega2).

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.5. Stages
are written out as scalars: that is what compiles to fast code. What the dense output and the
quadratures need of them (stages 1, 6 to 13 and the three extra ones) goes to the workspace.
"""

import math

from .dormand_prince_table import *
from .dynamics import stage_rates
from .slots import *


def store(w, base, r1, r6, r7, r8, r9, r10, r11, r12):
    """Keep one stage quantity (stages 1 and 6 to 12) at w[base]."""
    w[base] = r1
    w[base + 1] = r6
    w[base + 2] = r7
    w[base + 3] = r8
    w[base + 4] = r9
    w[base + 5] = r10
    w[base + 6] = r11
    w[base + 7] = r12


def weigh(w, base, c1, c6, c7, c8, c9, c10, c11, c12):
    """Weighted sum of the stage quantity kept at w[base]."""
    return (
        c1 * w[base]
        + c6 * w[base + 1]
        + c7 * w[base + 2]
        + c8 * w[base + 3]
        + c9 * w[base + 4]
        + c10 * w[base + 5]
        + c11 * w[base + 6]
        + c12 * w[base + 7]
    )


def result(w, base):
    """Mean over the step, of order 8, of the quantity whose stages are at w[base]."""
    return weigh(w, base, B1, B6, B7, B8, B9, B10, B11, B12)


def stages(d, w, q, omega2, rate1, momentum1):
    """The twelve stages of the step in hand from (q, omega2); rates and momentum of each go to w.

    rate1 and momentum1 are omega2' and P at the beginning.
    """
    k = d[D_K]
    h = w[W_STEP]
    omega1 = w[W_OMEGA1]
    alpha1 = w[W_ALPHA1]
    shaft_inertia = w[W_SHAFT_INERTIA]
    shaft_torque = w[W_SHAFT_TORQUE]
    u1 = k * (omega1 - omega2)
    v1 = rate1
    m1 = momentum1

    o = omega1 + C2 * h * alpha1
    y = omega2 + h * (A2_1 * v1)
    x = q + h * (A2_1 * u1)
    u2 = k * (o - y)
    v2, _ = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C3 * h * alpha1
    y = omega2 + h * (A3_1 * v1 + A3_2 * v2)
    x = q + h * (A3_1 * u1 + A3_2 * u2)
    u3 = k * (o - y)
    v3, _ = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C4 * h * alpha1
    y = omega2 + h * (A4_1 * v1 + A4_3 * v3)
    x = q + h * (A4_1 * u1 + A4_3 * u3)
    u4 = k * (o - y)
    v4, _ = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C5 * h * alpha1
    y = omega2 + h * (A5_1 * v1 + A5_3 * v3 + A5_4 * v4)
    x = q + h * (A5_1 * u1 + A5_3 * u3 + A5_4 * u4)
    u5 = k * (o - y)
    v5, _ = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C6 * h * alpha1
    y = omega2 + h * (A6_1 * v1 + A6_4 * v4 + A6_5 * v5)
    x = q + h * (A6_1 * u1 + A6_4 * u4 + A6_5 * u5)
    u6 = k * (o - y)
    v6, m6 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C7 * h * alpha1
    y = omega2 + h * (A7_1 * v1 + A7_4 * v4 + A7_5 * v5 + A7_6 * v6)
    x = q + h * (A7_1 * u1 + A7_4 * u4 + A7_5 * u5 + A7_6 * u6)
    u7 = k * (o - y)
    v7, m7 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C8 * h * alpha1
    y = omega2 + h * (A8_1 * v1 + A8_4 * v4 + A8_5 * v5 + A8_6 * v6 + A8_7 * v7)
    x = q + h * (A8_1 * u1 + A8_4 * u4 + A8_5 * u5 + A8_6 * u6 + A8_7 * u7)
    u8 = k * (o - y)
    v8, m8 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C9 * h * alpha1
    y = omega2 + h * (A9_1 * v1 + A9_4 * v4 + A9_5 * v5 + A9_6 * v6 + A9_7 * v7 + A9_8 * v8)
    x = q + h * (A9_1 * u1 + A9_4 * u4 + A9_5 * u5 + A9_6 * u6 + A9_7 * u7 + A9_8 * u8)
    u9 = k * (o - y)
    v9, m9 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C10 * h * alpha1
    y = omega2 + h * (
        A10_1 * v1 + A10_4 * v4 + A10_5 * v5 + A10_6 * v6 + A10_7 * v7 + A10_8 * v8 + A10_9 * v9
    )
    x = q + h * (A10_1 * u1 + A10_4 * u4 + A10_5 * u5 + A10_6 * u6 + A10_7 * u7 + A10_8 * u8 + A10_9 * u9)
    u10 = k * (o - y)
    v10, m10 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + C11 * h * alpha1
    y = omega2 + h * (
        A11_1 * v1
        + A11_4 * v4
        + A11_5 * v5
        + A11_6 * v6
        + A11_7 * v7
        + A11_8 * v8
        + A11_9 * v9
        + A11_10 * v10
    )
    x = q + h * (
        A11_1 * u1
        + A11_4 * u4
        + A11_5 * u5
        + A11_6 * u6
        + A11_7 * u7
        + A11_8 * u8
        + A11_9 * u9
        + A11_10 * u10
    )
    u11 = k * (o - y)
    v11, m11 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    o = omega1 + h * alpha1
    y = omega2 + h * (
        A12_1 * v1
        + A12_4 * v4
        + A12_5 * v5
        + A12_6 * v6
        + A12_7 * v7
        + A12_8 * v8
        + A12_9 * v9
        + A12_10 * v10
        + A12_11 * v11
    )
    x = q + h * (
        A12_1 * u1
        + A12_4 * u4
        + A12_5 * u5
        + A12_6 * u6
        + A12_7 * u7
        + A12_8 * u8
        + A12_9 * u9
        + A12_10 * u10
        + A12_11 * u11
    )
    u12 = k * (o - y)
    v12, m12 = stage_rates(d, x, o, alpha1, y, shaft_inertia, shaft_torque)

    store(w, W_RATE_Q, u1, u6, u7, u8, u9, u10, u11, u12)
    store(w, W_RATE_OMEGA2, v1, v6, v7, v8, v9, v10, v11, v12)
    store(w, W_MOMENTUM, m1, m6, m7, m8, m9, m10, m11, m12)


def error_norm(w, scale_q, scale_omega2, third, scale_third):
    """Estimated error of the step over the allowed one (Hairer's mix of orders 5 and 3).

    third: one more block of rates, whose integral counts where an error scale_third of it is allowed (else
    0): P with a ramp of omega1, or omega1' where that is a state.
    """
    e5 = (ERR5_1, ERR5_6, ERR5_7, ERR5_8, ERR5_9, ERR5_10, ERR5_11, ERR5_12)
    e3 = (ERR3_1, ERR3_6, ERR3_7, ERR3_8, ERR3_9, ERR3_10, ERR3_11, ERR3_12)
    q5 = weigh(w, W_RATE_Q, *e5) / scale_q
    q3 = weigh(w, W_RATE_Q, *e3) / scale_q
    v5 = weigh(w, W_RATE_OMEGA2, *e5) / scale_omega2
    v3 = weigh(w, W_RATE_OMEGA2, *e3) / scale_omega2
    sum5 = q5 * q5 + v5 * v5
    sum3 = q3 * q3 + v3 * v3
    if scale_third > 0.0:
        p5 = weigh(w, third, *e5) / scale_third
        p3 = weigh(w, third, *e3) / scale_third
        sum5 += p5 * p5
        sum3 += p3 * p3
    mix = sum5 + 0.01 * sum3
    if mix == 0.0:
        return 0.0
    return w[W_STEP] * sum5 / math.sqrt(2.0 * mix)


def keep_end(d, w, omega2, rate, momentum):
    """Keep omega2, its rate and P at the end of the step (offset 8 of each block)."""
    w[W_RATE_Q + 8] = d[D_K] * (w[W_OMEGA1] + w[W_STEP] * w[W_ALPHA1] - omega2)
    w[W_RATE_OMEGA2 + 8] = rate
    w[W_MOMENTUM + 8] = momentum


def weigh_stage_14(w, base):
    """Weighted sum that leads to the extra stage 14."""
    return (
        A14_1 * w[base]
        + A14_7 * w[base + 2]
        + A14_8 * w[base + 3]
        + A14_9 * w[base + 4]
        + A14_10 * w[base + 5]
        + A14_11 * w[base + 6]
        + A14_12 * w[base + 7]
        + A14_13 * w[base + 8]
    )


def weigh_stage_15(w, base):
    """Weighted sum that leads to the extra stage 15."""
    return (
        A15_1 * w[base]
        + A15_6 * w[base + 1]
        + A15_7 * w[base + 2]
        + A15_8 * w[base + 3]
        + A15_11 * w[base + 6]
        + A15_12 * w[base + 7]
        + A15_13 * w[base + 8]
        + A15_14 * w[base + 9]
    )


def weigh_stage_16(w, base):
    """Weighted sum that leads to the extra stage 16."""
    return (
        A16_1 * w[base]
        + A16_6 * w[base + 1]
        + A16_7 * w[base + 2]
        + A16_8 * w[base + 3]
        + A16_9 * w[base + 4]
        + A16_13 * w[base + 8]
        + A16_14 * w[base + 9]
        + A16_15 * w[base + 10]
    )


def keep_extra_stage(d, w, offset, node, q, omega2):
    """Evaluate one extra stage at (q, omega2) and keep it at this offset of each block."""
    omega1 = w[W_OMEGA1] + node * w[W_STEP] * w[W_ALPHA1]
    rate, momentum = stage_rates(d, q, omega1, w[W_ALPHA1], omega2, w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE])
    w[W_RATE_Q + offset] = d[D_K] * (omega1 - omega2)
    w[W_RATE_OMEGA2 + offset] = rate
    w[W_MOMENTUM + offset] = momentum


def extra_stages(d, w, q, omega2):
    """Stages 14 to 16, wanted only where the inside of the step is."""
    h = w[W_STEP]
    x = q + h * weigh_stage_14(w, W_RATE_Q)
    y = omega2 + h * weigh_stage_14(w, W_RATE_OMEGA2)
    keep_extra_stage(d, w, 9, C14, x, y)
    x = q + h * weigh_stage_15(w, W_RATE_Q)
    y = omega2 + h * weigh_stage_15(w, W_RATE_OMEGA2)
    keep_extra_stage(d, w, 10, C15, x, y)
    x = q + h * weigh_stage_16(w, W_RATE_Q)
    y = omega2 + h * weigh_stage_16(w, W_RATE_OMEGA2)
    keep_extra_stage(d, w, 11, C16, x, y)


def dense_coefficients(w, base, target):
    """Seven coefficients at w[target] of the interpolant of the quantity whose rates are at w[base]."""
    h = w[W_STEP]
    change = h * result(w, base)
    w[target] = change
    w[target + 1] = h * w[base] - change
    w[target + 2] = 2.0 * change - h * (w[base] + w[base + 8])
    w[target + 3] = h * (
        D4_1 * w[base]
        + D4_6 * w[base + 1]
        + D4_7 * w[base + 2]
        + D4_8 * w[base + 3]
        + D4_9 * w[base + 4]
        + D4_10 * w[base + 5]
        + D4_11 * w[base + 6]
        + D4_12 * w[base + 7]
        + D4_13 * w[base + 8]
        + D4_14 * w[base + 9]
        + D4_15 * w[base + 10]
        + D4_16 * w[base + 11]
    )
    w[target + 4] = h * (
        D5_1 * w[base]
        + D5_6 * w[base + 1]
        + D5_7 * w[base + 2]
        + D5_8 * w[base + 3]
        + D5_9 * w[base + 4]
        + D5_10 * w[base + 5]
        + D5_11 * w[base + 6]
        + D5_12 * w[base + 7]
        + D5_13 * w[base + 8]
        + D5_14 * w[base + 9]
        + D5_15 * w[base + 10]
        + D5_16 * w[base + 11]
    )
    w[target + 5] = h * (
        D6_1 * w[base]
        + D6_6 * w[base + 1]
        + D6_7 * w[base + 2]
        + D6_8 * w[base + 3]
        + D6_9 * w[base + 4]
        + D6_10 * w[base + 5]
        + D6_11 * w[base + 6]
        + D6_12 * w[base + 7]
        + D6_13 * w[base + 8]
        + D6_14 * w[base + 9]
        + D6_15 * w[base + 10]
        + D6_16 * w[base + 11]
    )
    w[target + 6] = h * (
        D7_1 * w[base]
        + D7_6 * w[base + 1]
        + D7_7 * w[base + 2]
        + D7_8 * w[base + 3]
        + D7_9 * w[base + 4]
        + D7_10 * w[base + 5]
        + D7_11 * w[base + 6]
        + D7_12 * w[base + 7]
        + D7_13 * w[base + 8]
        + D7_14 * w[base + 9]
        + D7_15 * w[base + 10]
        + D7_16 * w[base + 11]
    )


def dense_change(w, target, sigma):
    """Change since the beginning of the step at the fraction sigma of it (order 7)."""
    rest = 1.0 - sigma
    y = (w[target + 5] + sigma * w[target + 6]) * rest
    y = (w[target + 4] + y) * sigma
    y = (w[target + 3] + y) * rest
    y = (w[target + 2] + y) * sigma
    y = (w[target + 1] + y) * rest
    return (w[target] + y) * sigma


def dense_rate(w, target, sigma):
    """Derivative of dense_change in sigma."""
    rest = 1.0 - sigma
    y = w[target + 5] + sigma * w[target + 6]
    slope = w[target + 6] * rest - y
    y = w[target + 4] + y * rest
    slope = slope * sigma + y
    y = w[target + 3] + y * sigma
    slope = slope * rest - y
    y = w[target + 2] + y * rest
    slope = slope * sigma + y
    y = w[target + 1] + y * sigma
    slope = slope * rest - y
    return slope * sigma + w[target] + y * rest


def quadrature(w, base, sigma):
    """Integral over the step (sigma < 0) or its part sigma of the quantity whose stages are at w[base]."""
    if sigma < 0.0:
        return w[W_STEP] * result(w, base)
    dense_coefficients(w, base, W_DENSE_OTHER)
    return dense_change(w, W_DENSE_OTHER, sigma)
