"""Stages of a step of the embedded pair in (q, omega1, omega2), and the inside of the step."""

from ..contact import is_held
from ..links import accelerations
from .dormand_prince import (
    NODES,
    sum_1,
    sum_2,
    sum_3,
    sum_4,
    sum_5,
    sum_6,
    sum_7,
    sum_8,
    sum_9,
    sum_10,
    sum_11,
    sum_13,
    sum_14,
    sum_15,
)
from .dormand_prince_5 import NODES as SHORT_NODES
from .dormand_prince_5 import sum_1 as short_sum_1
from .dormand_prince_5 import sum_2 as short_sum_2
from .dormand_prince_5 import sum_3 as short_sum_3
from .dormand_prince_5 import sum_4 as short_sum_4
from .dormand_prince_5 import sum_5 as short_sum_5
from .interpolant import fit_dense


def keep_stage(d, w, n, omega1, omega2, alpha1, alpha2, momentum):
    """Keep the rates at stage n; the integrand is omega1 or, with the speed of link 1 given, P."""
    w.rate_q[n] = d.k * (omega1 - omega2)
    w.rate_omega1[n] = alpha1
    w.rate_omega2[n] = alpha2
    w.integrand[n] = omega1 if d.by_torque != 0.0 else momentum


def evaluate(d, x, w, n, node, mean_q, mean1, mean2):
    """Rates at stage n, at this fraction of the step in hand, from weighted rates of the stages before."""
    h = w.step
    omega1 = x.omega1 + h * (mean1 if d.by_torque != 0.0 else node * w.prescribed)
    omega2 = x.omega2 + h * mean2
    alpha1, alpha2, momentum = accelerations(
        d,
        x.q + h * mean_q,
        omega1,
        omega2,
        w.prescribed,
        is_held(x),
        w.carried,
        w.carried_friction,
        w.carried_torque,
    )
    keep_stage(d, w, n, omega1, omega2, alpha1, alpha2, momentum)


def evaluate_stages(d, x, w):
    """The stages of the step in hand, but for its beginning."""
    q, o1, o2 = w.rate_q, w.rate_omega1, w.rate_omega2
    evaluate(d, x, w, 1, NODES[1], sum_1(q), sum_1(o1), sum_1(o2))
    evaluate(d, x, w, 2, NODES[2], sum_2(q), sum_2(o1), sum_2(o2))
    evaluate(d, x, w, 3, NODES[3], sum_3(q), sum_3(o1), sum_3(o2))
    evaluate(d, x, w, 4, NODES[4], sum_4(q), sum_4(o1), sum_4(o2))
    evaluate(d, x, w, 5, NODES[5], sum_5(q), sum_5(o1), sum_5(o2))
    evaluate(d, x, w, 6, NODES[6], sum_6(q), sum_6(o1), sum_6(o2))
    evaluate(d, x, w, 7, NODES[7], sum_7(q), sum_7(o1), sum_7(o2))
    evaluate(d, x, w, 8, NODES[8], sum_8(q), sum_8(o1), sum_8(o2))
    evaluate(d, x, w, 9, NODES[9], sum_9(q), sum_9(o1), sum_9(o2))
    evaluate(d, x, w, 10, NODES[10], sum_10(q), sum_10(o1), sum_10(o2))
    evaluate(d, x, w, 11, NODES[11], sum_11(q), sum_11(o1), sum_11(o2))
    x.step_evaluations += 11.0


def evaluate_short_stages(d, x, w):
    """Make the stages of the pair of order 5."""
    q, o1, o2 = w.rate_q, w.rate_omega1, w.rate_omega2
    evaluate(d, x, w, 1, SHORT_NODES[1], short_sum_1(q), short_sum_1(o1), short_sum_1(o2))
    evaluate(d, x, w, 2, SHORT_NODES[2], short_sum_2(q), short_sum_2(o1), short_sum_2(o2))
    evaluate(d, x, w, 3, SHORT_NODES[3], short_sum_3(q), short_sum_3(o1), short_sum_3(o2))
    evaluate(d, x, w, 4, SHORT_NODES[4], short_sum_4(q), short_sum_4(o1), short_sum_4(o2))
    evaluate(d, x, w, 5, SHORT_NODES[5], short_sum_5(q), short_sum_5(o1), short_sum_5(o2))
    x.step_evaluations += 5.0


def fit_inside(d, x, w):
    """The extra stages and the interpolants of q and both speeds: the inside of the step in hand."""
    q, o1, o2 = w.rate_q, w.rate_omega1, w.rate_omega2
    evaluate(d, x, w, 13, NODES[13], sum_13(q), sum_13(o1), sum_13(o2))
    evaluate(d, x, w, 14, NODES[14], sum_14(q), sum_14(o1), sum_14(o2))
    evaluate(d, x, w, 15, NODES[15], sum_15(q), sum_15(o1), sum_15(o2))
    x.step_evaluations += 3.0
    fit_dense(w.step, w.rate_q, w.dense_q)
    fit_dense(w.step, w.rate_omega2, w.dense_omega2)
    if d.by_torque != 0.0:
        fit_dense(w.step, w.rate_omega1, w.dense_omega1)
