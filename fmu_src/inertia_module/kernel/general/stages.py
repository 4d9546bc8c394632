"""A step of the embedded pair over all that the general equations of motion follow: speeds, angles, sums.

w.followed holds for each quantity its rates at the stages and its change over the step.
"""

from ..codes import SHAFT
from ..links import friction_power
from ..solvers.dormand_prince import (
    END,
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
from ..solvers.interpolant import inside_weights
from .guards import watch
from .motion import evaluate
from .states import LOCKED, OPEN, WOUND

# what is followed; the motion first: with a rigid output the first five of it, without wind-up seven
Q, THETA, OMEGA1, OMEGA2, OMEGA3, TWIST, RELATIVE, WOUND_HOUSING, WOUND_OUTPUT = range(9)
MOVING = 9
RIGID_OUTPUT = 5
WITHOUT_WIND_UP = 7
# ... sums: works, losses by cause, impulses of M1, M2, Th and Tc, square of Tc, angle of the output
WORK_IN, WORK_OUT, LOST, OF_DRIVE, OF_MESH, OF_HOUSING, OF_OUTPUT, SQUARE, TURNED = (
    9,
    10,
    11,
    16,
    17,
    18,
    19,
    20,
    21,
)
FOLLOWED = 22


def how_many_move(d):
    """How many of the followed quantities are the motion."""
    if d.elastic == 0.0:
        return RIGID_OUTPUT
    return MOVING if d.housing_stiffness + d.freewheel_stiffness > 0.0 else WITHOUT_WIND_UP


def is_followed(d, n, moving):
    """Whether this quantity is one of the motion or of the sums that there are."""
    return n < moving or (n >= MOVING and (n != LOST + SHAFT or d.elastic != 0.0))


def weighed(n, rates):
    """Sum of the rates at the stages before stage n, weighed for it."""
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
    """What drag and damping of both freewheels take, W: never less than nothing."""
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


def keep_rates(d, x, w, n):
    """Rates of all that is followed at stage n, from d.machine after motion.evaluate."""
    m = d.machine
    f = w.followed
    slip = 0.0 if x.slip_sign == 0.0 else m.omega1 - m.omega2
    rate_q = d.k * slip
    # of one sign up to the event, and smooth beyond it
    turned = x.slip_sign * rate_q
    turning = m.omega3 - m.relative
    f[Q].rate[n] = rate_q
    f[THETA].rate[n] = m.omega1
    f[OMEGA1].rate[n] = m.alpha1
    f[OMEGA2].rate[n] = m.alpha2
    f[OMEGA3].rate[n] = m.alpha3
    f[TWIST].rate[n] = m.relative
    f[RELATIVE].rate[n] = m.rate_relative
    f[WOUND_HOUSING].rate[n] = -m.omega2 if x.housing_state == WOUND else 0.0
    f[WOUND_OUTPUT].rate[n] = m.omega2 - m.omega3 if x.output_state == WOUND else 0.0
    f[WORK_IN].rate[n] = m.drive * m.omega1
    f[WORK_OUT].rate[n] = w.load * turning
    f[LOST].rate[n] = friction_power(d, m.omega1, m.omega2, d.b2) + d.b3 * m.omega3 * m.omega3
    if d.elastic != 0.0:
        shaft = d.damping * m.relative * m.relative + d.friction * turning * turning
        f[LOST + 1].rate[n] = shaft - d.balancer * d.J4 * m.alpha3 * turning
    f[LOST + 2].rate[n] = d.mesh_loss * x.flow_sign * m.mesh * slip + x.spin_sign * m.spun * turned
    f[LOST + 3].rate[n] = m.journals * turned
    f[LOST + 4].rate[n] = power_of_freewheels(d, x, m)
    f[OF_DRIVE].rate[n] = m.drive
    f[OF_MESH].rate[n] = m.mesh
    f[OF_HOUSING].rate[n] = m.housing
    f[OF_OUTPUT].rate[n] = m.output
    f[SQUARE].rate[n] = m.output * m.output
    f[TURNED].rate[n] = turning
    watch(d, x, w, n)


def evaluate_stage(d, x, w, n, moving):
    """Rates at stage n, from those at the stages before."""
    h = w.step
    f = w.followed
    m = d.machine
    m.q = x.q + h * weighed(n, f[Q].rate)
    m.theta1 = x.theta1 + h * weighed(n, f[THETA].rate)
    m.omega2 = x.omega2 + h * weighed(n, f[OMEGA2].rate)
    m.omega3 = x.omega3 + h * weighed(n, f[OMEGA3].rate)
    if d.by_torque != 0.0:
        m.omega1 = x.omega1 + h * weighed(n, f[OMEGA1].rate)
    else:
        m.omega1 = x.omega1 + h * NODES[n] * w.given
    if x.output_state == LOCKED:
        m.omega3 = m.omega2
    if moving > RIGID_OUTPUT:
        m.twist = x.twist + h * weighed(n, f[TWIST].rate)
        m.relative = x.relative + h * weighed(n, f[RELATIVE].rate)
    if moving > WITHOUT_WIND_UP:
        m.wound_housing = x.wound_housing + h * weighed(n, f[WOUND_HOUSING].rate)
        m.wound_output = x.wound_output + h * weighed(n, f[WOUND_OUTPUT].rate)
    evaluate(d, x, w.given, w.load, True)
    keep_rates(d, x, w, n)
    x.step_evaluations += 1.0


def make_step(d, x, w, h):
    """All stages of the step h, and the changes of all that is followed."""
    w.step = h
    moving = how_many_move(d)
    for n in range(1, END + 1):
        evaluate_stage(d, x, w, n, moving)
    for n in range(FOLLOWED):
        if is_followed(d, n, moving):
            w.followed[n].change = h * sum_12(w.followed[n].rate)
    if d.by_torque == 0.0:
        w.followed[OMEGA1].change = h * w.given


def cut_step(d, w, sigma):
    """Make the step in hand, its inside known, one of its part sigma."""
    moving = how_many_move(d)
    inside_weights(sigma, w.weights)
    for n in range(FOLLOWED):
        if is_followed(d, n, moving):
            change = 0.0
            for stage in range(STAGES):
                change += w.weights[stage] * w.followed[n].rate[stage]
            w.followed[n].change = w.step * change
    w.step *= sigma
    if d.by_torque == 0.0:
        w.followed[OMEGA1].change = w.step * w.given


def make_inside(d, x, w):
    """The stages for the inside of the step in hand."""
    moving = how_many_move(d)
    for n in range(END + 1, STAGES):
        evaluate_stage(d, x, w, n, moving)
