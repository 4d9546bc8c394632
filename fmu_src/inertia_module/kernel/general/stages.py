"""A step of the embedded pair over all that the general equations of motion follow: speeds, angles, sums.

w.followed holds for each quantity its rates at the stages and its change over the step.
"""

from ..codes import FREEWHEEL, JOURNAL, MESH, SHAFT, VISCOUS
from ..links import friction_power
from ..solvers.dormand_prince import (
    NODES,
    STAGES,
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
    sum_12,
    sum_13,
    sum_14,
    sum_15,
)
from ..solvers.dormand_prince_5 import NODES as SHORT_NODES
from ..solvers.dormand_prince_5 import sum_1 as short_sum_1
from ..solvers.dormand_prince_5 import sum_2 as short_sum_2
from ..solvers.dormand_prince_5 import sum_3 as short_sum_3
from ..solvers.dormand_prince_5 import sum_4 as short_sum_4
from ..solvers.dormand_prince_5 import sum_5 as short_sum_5
from ..solvers.dormand_prince_5 import sum_6 as short_sum_6
from ..solvers.interpolant import inside_weights
from .guards import watch
from .motion import evaluate
from .states import LOCKED, OPEN, WOUND

# what is followed; the motion first: with a rigid output the first five of it, without wind-up seven
Q, THETA, OMEGA1, OMEGA2, OMEGA3, TWIST, RELATIVE, WOUND_HOUSING, WOUND_OUTPUT = range(9)
MOVING = 9
RIGID_OUTPUT = 5
WITHOUT_WIND_UP = 7
# ... sums: works, losses by cause, impulses of M1, Th and Tc, square of Tc, angle of the output
WORK_IN, LOST, OF_DRIVE, OF_HOUSING, OF_OUTPUT, SQUARE, TURNED = 9, 10, 15, 16, 17, 18, 19
FOLLOWED = 20


def how_many_move(d):
    """How many of the followed quantities are the motion."""
    if d.elastic == 0.0:
        return RIGID_OUTPUT
    return MOVING if d.housing_stiffness + d.freewheel_stiffness > 0.0 else WITHOUT_WIND_UP


def is_followed(d, n, moving):
    """Tell whether this quantity is one of the motion or of the sums that there are."""
    if n < MOVING:
        return n < moving and (n not in (OMEGA1, THETA) or d.by_torque != 0.0)
    if n in (WORK_IN, OF_DRIVE):
        return d.by_torque == 0.0
    if n == LOST + SHAFT:
        return d.elastic != 0.0
    if n == LOST + VISCOUS:
        return d.viscous != 0.0
    return d.losses != 0.0 or n < LOST or n >= OF_DRIVE


def weighed_shortly(n, rates):
    """Sum of the rates at the stages before stage n of the pair of order 5, weighed for it."""
    if n == 1:
        return short_sum_1(rates)
    if n == 2:
        return short_sum_2(rates)
    if n == 3:
        return short_sum_3(rates)
    if n == 4:
        return short_sum_4(rates)
    return short_sum_5(rates) if n == 5 else short_sum_6(rates)


def weighed(w, n, rates):
    """Sum of the rates at the stages before stage n, weighed for it."""
    if w.short != 0.0:
        return weighed_shortly(n, rates)
    if n == 1:
        return sum_1(rates)
    if n == 2:
        return sum_2(rates)
    if n == 3:
        return sum_3(rates)
    if n == 4:
        return sum_4(rates)
    if n == 5:
        return sum_5(rates)
    if n == 6:
        return sum_6(rates)
    if n == 7:
        return sum_7(rates)
    if n == 8:
        return sum_8(rates)
    if n == 9:
        return sum_9(rates)
    if n == 10:
        return sum_10(rates)
    if n == 11:
        return sum_11(rates)
    if n == 12:
        return sum_12(rates)
    if n == 13:
        return sum_13(rates)
    return sum_14(rates) if n == 14 else sum_15(rates)


def power_of_freewheels(d, x, m):
    """Power that drag and damping of both freewheels take, W, never below 0."""
    slip = m.omega3 - m.omega2
    lost = 0.0
    if x.housing_state == OPEN:
        lost = -m.housing * m.omega2
    elif x.housing_state == WOUND:
        lost = d.housing_damping * m.omega2 * m.omega2
    if x.output_state == OPEN:
        lost -= m.output * slip
    elif x.output_state == WOUND:
        lost += d.freewheel_damping * slip * slip
    return lost


def keep_rates(d, x, w, n, lossy):
    """Rates of all that is followed at stage n, from d.machine after motion.evaluate."""
    m = d.machine
    f = w.followed
    slip = m.omega1 - m.omega2
    if lossy and x.slip_sign == 0.0:
        slip = 0.0
    rate_q = d.k * slip
    turning = m.omega3
    f[Q].rate[n] = rate_q
    f[THETA].rate[n] = m.omega1
    f[OMEGA1].rate[n] = m.alpha1
    f[OMEGA2].rate[n] = m.alpha2
    f[OMEGA3].rate[n] = m.alpha3
    if d.elastic != 0.0:
        turning -= m.relative
        f[TWIST].rate[n] = m.relative
        f[RELATIVE].rate[n] = m.rate_relative
        shaft = d.damping * m.relative * m.relative + d.friction * turning * turning
        f[LOST + SHAFT].rate[n] = shaft - d.balancer * d.J4 * m.alpha3 * turning
    if d.by_torque == 0.0:
        f[WORK_IN].rate[n] = m.drive * m.omega1
        f[OF_DRIVE].rate[n] = m.drive
    if d.viscous != 0.0:
        viscous = friction_power(d, m.omega1, m.omega2, d.b2)
        f[LOST + VISCOUS].rate[n] = viscous + d.b3 * m.omega3 * m.omega3
    f[OF_HOUSING].rate[n] = m.housing
    f[OF_OUTPUT].rate[n] = m.output
    f[SQUARE].rate[n] = m.output * m.output
    f[TURNED].rate[n] = turning
    if lossy:
        # of one sign up to the event, and smooth beyond it
        turned = x.slip_sign * rate_q
        f[WOUND_HOUSING].rate[n] = -m.omega2 if x.housing_state == WOUND else 0.0
        f[WOUND_OUTPUT].rate[n] = m.omega2 - m.omega3 if x.output_state == WOUND else 0.0
        f[LOST + MESH].rate[n] = d.mesh_loss * x.flow_sign * m.mesh * slip + m.spun * turned
        f[LOST + JOURNAL].rate[n] = m.journals * turned
        f[LOST + FREEWHEEL].rate[n] = power_of_freewheels(d, x, m)
    watch(d, x, w, n, lossy)


def evaluate_stage(d, x, w, n, node, rate_q, mean1, mean2, mean3, lossy):
    """Rates at stage n, from weighed rates of q and of the speeds at the stages before."""
    h = w.step
    f = w.followed
    m = d.machine
    m.q = x.q + h * rate_q
    m.omega2 = x.omega2 + h * mean2
    m.omega3 = m.omega2 if x.output_state == LOCKED else x.omega3 + h * mean3
    m.omega1 = x.omega1 + h * (mean1 if d.by_torque != 0.0 else node * w.prescribed)
    if lossy and d.weight != 0.0:
        m.theta1 = x.theta1 + h * weighed(w, n, f[THETA].rate)
    if d.elastic != 0.0:
        m.twist = x.twist + h * weighed(w, n, f[TWIST].rate)
        m.relative = x.relative + h * weighed(w, n, f[RELATIVE].rate)
        if lossy:
            m.wound_housing = x.wound_housing + h * weighed(w, n, f[WOUND_HOUSING].rate)
            m.wound_output = x.wound_output + h * weighed(w, n, f[WOUND_OUTPUT].rate)
    evaluate(d, x, w.prescribed, w.load, True)
    keep_rates(d, x, w, n, lossy)
    x.step_evaluations += 1.0


def make_step(d, x, w, h):
    """All stages of the step h, and the changes of all that is followed."""
    w.step = h
    if w.short != 0.0:
        make_short_stages(d, x, w, d.losses != 0.0)
    elif d.losses != 0.0:
        make_stages(d, x, w, True)
    else:
        make_stages(d, x, w, False)
    moving = how_many_move(d)
    for n in range(FOLLOWED):
        if is_followed(d, n, moving):
            rates = w.followed[n].rate
            w.followed[n].change = h * (short_sum_6(rates) if w.short != 0.0 else sum_12(rates))
    if d.by_torque == 0.0:
        w.followed[OMEGA1].change = h * w.prescribed
        w.followed[THETA].change = h * (x.omega1 + 0.5 * h * w.prescribed)


def make_short_stages(d, x, w, lossy):
    """Evaluate all stages of the step in hand by the pair of order 5."""
    f = w.followed
    q, o1, o2, o3 = f[Q].rate, f[OMEGA1].rate, f[OMEGA2].rate, f[OMEGA3].rate
    evaluate_stage(d, x, w, 1, SHORT_NODES[1], short_sum_1(q), short_sum_1(o1), short_sum_1(o2), short_sum_1(o3), lossy)
    evaluate_stage(d, x, w, 2, SHORT_NODES[2], short_sum_2(q), short_sum_2(o1), short_sum_2(o2), short_sum_2(o3), lossy)
    evaluate_stage(d, x, w, 3, SHORT_NODES[3], short_sum_3(q), short_sum_3(o1), short_sum_3(o2), short_sum_3(o3), lossy)
    evaluate_stage(d, x, w, 4, SHORT_NODES[4], short_sum_4(q), short_sum_4(o1), short_sum_4(o2), short_sum_4(o3), lossy)
    evaluate_stage(d, x, w, 5, SHORT_NODES[5], short_sum_5(q), short_sum_5(o1), short_sum_5(o2), short_sum_5(o3), lossy)
    evaluate_stage(d, x, w, 6, SHORT_NODES[6], short_sum_6(q), short_sum_6(o1), short_sum_6(o2), short_sum_6(o3), lossy)


def make_stages(d, x, w, lossy):
    """Evaluate all stages of the step in hand after the first."""
    f = w.followed
    q, o1, o2, o3 = f[Q].rate, f[OMEGA1].rate, f[OMEGA2].rate, f[OMEGA3].rate
    evaluate_stage(d, x, w, 1, NODES[1], sum_1(q), sum_1(o1), sum_1(o2), sum_1(o3), lossy)
    evaluate_stage(d, x, w, 2, NODES[2], sum_2(q), sum_2(o1), sum_2(o2), sum_2(o3), lossy)
    evaluate_stage(d, x, w, 3, NODES[3], sum_3(q), sum_3(o1), sum_3(o2), sum_3(o3), lossy)
    evaluate_stage(d, x, w, 4, NODES[4], sum_4(q), sum_4(o1), sum_4(o2), sum_4(o3), lossy)
    evaluate_stage(d, x, w, 5, NODES[5], sum_5(q), sum_5(o1), sum_5(o2), sum_5(o3), lossy)
    evaluate_stage(d, x, w, 6, NODES[6], sum_6(q), sum_6(o1), sum_6(o2), sum_6(o3), lossy)
    evaluate_stage(d, x, w, 7, NODES[7], sum_7(q), sum_7(o1), sum_7(o2), sum_7(o3), lossy)
    evaluate_stage(d, x, w, 8, NODES[8], sum_8(q), sum_8(o1), sum_8(o2), sum_8(o3), lossy)
    evaluate_stage(d, x, w, 9, NODES[9], sum_9(q), sum_9(o1), sum_9(o2), sum_9(o3), lossy)
    evaluate_stage(d, x, w, 10, NODES[10], sum_10(q), sum_10(o1), sum_10(o2), sum_10(o3), lossy)
    evaluate_stage(d, x, w, 11, NODES[11], sum_11(q), sum_11(o1), sum_11(o2), sum_11(o3), lossy)
    evaluate_stage(d, x, w, 12, NODES[12], sum_12(q), sum_12(o1), sum_12(o2), sum_12(o3), lossy)


def change_inside(d, x, w, sigma, count):
    """Changes of the first of the followed quantities up to the part sigma of the step in hand."""
    moving = how_many_move(d)
    inside_weights(sigma, w.weights)
    for n in range(count):
        if is_followed(d, n, moving):
            change = 0.0
            for stage in range(STAGES):
                change += w.weights[stage] * w.followed[n].rate[stage]
            w.followed[n].change = w.step * change
    if d.by_torque == 0.0:
        h = sigma * w.step
        w.followed[OMEGA1].change = h * w.prescribed
        w.followed[THETA].change = h * (x.omega1 + 0.5 * h * w.prescribed)


def cut_step(d, x, w, sigma):
    """Make the step in hand, its inside known, one of its part sigma."""
    change_inside(d, x, w, sigma, FOLLOWED)
    w.step *= sigma


def evaluate_inside(d, x, w, sigma):
    """The general equations at the part sigma of the step in hand, its inside known, into d.machine."""
    change_inside(d, x, w, sigma, MOVING)
    f = w.followed
    m = d.machine
    m.q = x.q + f[Q].change
    m.theta1 = x.theta1 + f[THETA].change
    m.omega1 = x.omega1 + f[OMEGA1].change
    m.omega2 = x.omega2 + f[OMEGA2].change
    m.omega3 = m.omega2 if x.output_state == LOCKED else x.omega3 + f[OMEGA3].change
    if d.elastic != 0.0:
        m.twist = x.twist + f[TWIST].change
        m.relative = x.relative + f[RELATIVE].change
        m.wound_housing = x.wound_housing + f[WOUND_HOUSING].change
        m.wound_output = x.wound_output + f[WOUND_OUTPUT].change
    evaluate(d, x, w.prescribed, w.load, True)
    x.step_evaluations += 1.0


def make_inside(d, x, w):
    """The stages for the inside of the step in hand."""
    f = w.followed
    q, o1, o2, o3 = f[Q].rate, f[OMEGA1].rate, f[OMEGA2].rate, f[OMEGA3].rate
    lossy = d.losses != 0.0
    evaluate_stage(d, x, w, 13, NODES[13], sum_13(q), sum_13(o1), sum_13(o2), sum_13(o3), lossy)
    evaluate_stage(d, x, w, 14, NODES[14], sum_14(q), sum_14(o1), sum_14(o2), sum_14(o3), lossy)
    evaluate_stage(d, x, w, 15, NODES[15], sum_15(q), sum_15(o1), sum_15(o2), sum_15(o3), lossy)
