"""One step of Dormand and Prince's pair with the speed of link 1 as a state: (q, omega1, omega2).

Stages go to the blocks of :mod:`.dormand_prince`, whose results, error and dense output they serve; omega1
stands where P does with a given speed, for its integral is the angle of link 1.
"""

from .dormand_prince import dense_coefficients, weigh_stage_14, weigh_stage_15, weigh_stage_16
from .dormand_prince_table import *
from .slots import *
from .torque_dynamics import acceleration

# weights of the stages before, for the stages 2 to 12
ROWS = (
    (A2_1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A3_1, A3_2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A4_1, 0.0, A4_3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A5_1, 0.0, A5_3, A5_4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A6_1, 0.0, 0.0, A6_4, A6_5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A7_1, 0.0, 0.0, A7_4, A7_5, A7_6, 0.0, 0.0, 0.0, 0.0, 0.0),
    (A8_1, 0.0, 0.0, A8_4, A8_5, A8_6, A8_7, 0.0, 0.0, 0.0, 0.0),
    (A9_1, 0.0, 0.0, A9_4, A9_5, A9_6, A9_7, A9_8, 0.0, 0.0, 0.0),
    (A10_1, 0.0, 0.0, A10_4, A10_5, A10_6, A10_7, A10_8, A10_9, 0.0, 0.0),
    (A11_1, 0.0, 0.0, A11_4, A11_5, A11_6, A11_7, A11_8, A11_9, A11_10, 0.0),
    (A12_1, 0.0, 0.0, A12_4, A12_5, A12_6, A12_7, A12_8, A12_9, A12_10, A12_11),
)
STAGES = 12
# of a stage from the sixth on: how far before its number its place in the blocks is
SKIPPED = 4


def is_held(x):
    """Whether the housing freewheel holds link 2 in the present mode."""
    return x[X_MODE] == HELD or x[X_MODE] == HELD_DRIVING


def keep_stage(d, w, offset, omega1, omega2, alpha1, alpha2):
    """Keep the rates at one stage at this offset of each block."""
    w[W_RATE_Q + offset] = d[D_K] * (omega1 - omega2)
    w[W_RATE_OMEGA1 + offset] = alpha1
    w[W_RATE_OMEGA2 + offset] = alpha2
    w[W_MOMENTUM + offset] = omega1


def torque_stages(d, x, w, alpha1, alpha2):
    """The twelve stages of the step in hand; alpha1 and alpha2 are the accelerations at its beginning."""
    h = w[W_STEP]
    torque = w[W_DRIVE_TORQUE]
    held = is_held(x)
    omega1 = x[X_OMEGA1]
    omega2 = x[X_OMEGA2]
    w[W_ALL_Q] = d[D_K] * (omega1 - omega2)
    w[W_ALL_OMEGA1] = alpha1
    w[W_ALL_OMEGA2] = alpha2
    keep_stage(d, w, 0, omega1, omega2, alpha1, alpha2)
    for n in range(1, STAGES):
        change_q = 0.0
        change1 = 0.0
        change2 = 0.0
        for m in range(n):
            weight = h * ROWS[n - 1][m]
            change_q += weight * w[W_ALL_Q + m]
            change1 += weight * w[W_ALL_OMEGA1 + m]
            change2 += weight * w[W_ALL_OMEGA2 + m]
        o = omega1 + change1
        y = omega2 + change2
        a1, a2 = acceleration(d, x[X_Q] + change_q, o, y, torque, held, w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE])
        w[W_ALL_Q + n] = d[D_K] * (o - y)
        w[W_ALL_OMEGA1 + n] = a1
        w[W_ALL_OMEGA2 + n] = a2
        if n > SKIPPED:
            keep_stage(d, w, n - SKIPPED, o, y, a1, a2)


def keep_extra_stage(d, x, w, offset, change_q, change1, change2):
    """Evaluate one extra stage, its changes since the beginning over h, and keep it."""
    h = w[W_STEP]
    omega1 = x[X_OMEGA1] + h * change1
    omega2 = x[X_OMEGA2] + h * change2
    alpha1, alpha2 = acceleration(
        d,
        x[X_Q] + h * change_q,
        omega1,
        omega2,
        w[W_DRIVE_TORQUE],
        is_held(x),
        w[W_SHAFT_INERTIA],
        w[W_SHAFT_TORQUE],
    )
    keep_stage(d, w, offset, omega1, omega2, alpha1, alpha2)


def put_inside(d, x, w):
    """Stages 14 to 16 and the interpolants of q and both speeds: the inside of the step in hand."""
    a, b, c = W_RATE_Q, W_RATE_OMEGA1, W_RATE_OMEGA2
    keep_extra_stage(d, x, w, 9, weigh_stage_14(w, a), weigh_stage_14(w, b), weigh_stage_14(w, c))
    keep_extra_stage(d, x, w, 10, weigh_stage_15(w, a), weigh_stage_15(w, b), weigh_stage_15(w, c))
    keep_extra_stage(d, x, w, 11, weigh_stage_16(w, a), weigh_stage_16(w, b), weigh_stage_16(w, c))
    x[X_STEP_EVALUATIONS] += 3.0
    dense_coefficients(w, W_RATE_Q, W_DENSE_Q)
    dense_coefficients(w, W_RATE_OMEGA1, W_DENSE_OMEGA1)
    dense_coefficients(w, W_RATE_OMEGA2, W_DENSE_OMEGA2)
