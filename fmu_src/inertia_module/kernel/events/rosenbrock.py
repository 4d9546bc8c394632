"""A step of Rosenbrock's method where shaft or springs are stiff: L-stable, no iteration (docs/mechanics.md).

Rodas5P, eight stages, orders 5(4): G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P, BIT
Numerical Mathematics 63 (2023) 27. Each stage U_i of the change over the step h solves

    (1 / (GAMMA h) - J) U_i = f(y + sum_j A_ij U_j) + sum_j C_ij U_j / h

with J the derivatives of all rates by the motion at the beginning. The step changes y by the last stage's
argument and U_8, which is the error as well. What moves alone is solved for: of sums, on which nothing
depends, change and error are weighed sums of f + J U over the stages.
"""

from ..accumulate import clear
from ..equations.losses import FREEWHEEL, SHAFT
from ..equations.motion import take_state
from ..equations.states import LOCKED, WOUND, is_open
from ..tableau import PARTS, THIRDS
from .stages import MOTION, keep_rates, prescribe_link1, solve_changed, solve_motion, weigh, weigh_motion

STAGES = 8
GAMMA = 0.21193756319429014
# what moves: places in MACHINE of MOTION and of theta1, which counts where there are weights
PLACES = (0, 2, 3, 4, 5, 6, 7, 8, 1)
MOVING = 9
MOVE_Q, MOVE_1, MOVE_2, MOVE_3, MOVE_TWIST, MOVE_RELATIVE, MOVE_HOUSING, MOVE_OUTPUT, MOVE_THETA = range(9)
# share of its scale by which a speed, an angle or a torque is changed for a difference
APART = 1e-7
# fmt: off
A = (
    *(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(2.849394379747939, 0.45842242204463923, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(-6.954028509809101, 2.489845061869568, -10.358996098473584, 0.0, 0.0, 0.0, 0.0),
    *(2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641, 0.0, 0.0, 0.0),
    *(-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
      0.030198172008377946, 0.0, 0.0),
    *(-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
      0.030198172008377946, 1.0, 0.0),
    *(-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
      0.030198172008377946, 1.0, 1.0),
)
C = (
    *(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(-14.155112264123755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(-17.97296035885952, -2.859693295451294, 0.0, 0.0, 0.0, 0.0, 0.0),
    *(147.12150275711716, -1.41221402718213, 71.68940251302358, 0.0, 0.0, 0.0, 0.0),
    *(165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306, 0.0, 0.0, 0.0),
    *(24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125,
      -0.6610691825249471, 0.0, 0.0),
    *(30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783,
      -19.097331116725623, -28.087943162872662, 0.0),
    *(37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
      -40.06618937091002, -54.66780262877968, -9.48861652309627),
)
DENSE = (
    *(25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
      0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493),
    *(-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
      20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372),
    *(11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
      -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722),
)
# weights of the rates in change and error of a sum, by A, C and GAMMA: of stage n they are kept at PARTS + n,
# those that no one needs any more behind them
KEPT = PARTS + STAGES
SUMS = (
    *(0.12236007991300805, 0.0, 0.0, 0.0, 0.050238881884186654, 1.3238392208663683, 1.2643883758622312,
      -0.7904031855871827, -0.9680932754194287, -0.21426766071346695, 0.21193756319429014),
    *(0.12584733011227395, 0.0, 0.0, 0.0, 0.18020585308983128, -0.2021025399399098, 0.11477428094984221,
      -0.08606747399894103, 0.0816102105003744, -0.4262052239077571, 0.21193756319429014),
)
# fmt: on


def differentiate_by(d, x, w, n, apart):
    """Derivatives of all rates by one of what moves, by a difference; it is one more that is solved for."""
    w.moves[int(w.moving)] = n
    w.moving += 1.0
    m = d.machine
    take_state(d, x)
    before = m.numbers[PLACES[n]]
    m.numbers[PLACES[n]] = before + apart
    apart = m.numbers[PLACES[n]] - before
    if x.output_state == LOCKED:
        m.omega3 = m.omega2
    solve_motion(d, x, w)
    keep_rates(d, x, w, KEPT)
    slopes, rates, start = w.slopes[n].numbers, w.rates[KEPT].numbers, w.rates[0].numbers
    per_apart = 1.0 / apart
    for which in range(len(start)):
        slopes[which] = (rates[which] - start[which]) * per_apart
    # where a speed is hardly any, a difference of its square has far too much: that of the difference
    by = w.slopes[n]
    lost = d.shaft_damping * by.twist * by.twist + d.driven_friction * by.turned3 * by.turned3
    by.lost[SHAFT] -= apart * (lost + d.balancer * d.J4 * by.omega3 * by.twist)
    if x.housing_state == WOUND:
        by.lost[FREEWHEEL] -= apart * d.housing_damping * by.wound_housing * by.wound_housing
    if x.output_state == WOUND:
        by.lost[FREEWHEEL] -= apart * d.freewheel_damping * by.wound_output * by.wound_output


def differentiate(d, x, w):
    """Derivatives of all rates by what moves at the beginning of the step, and what that is.

    What is held, or goes with another, does not: the stages leave it as it is.
    """
    start = w.rates[0]
    speed = APART * max(abs(x.omega1), abs(x.omega2), abs(x.omega3))
    torque = abs(start.drive) + abs(start.output) + abs(start.housing) + abs(w.load)
    torque = APART * (torque + abs(d.shaft_stiffness * x.twist) + abs(d.shaft_damping * x.relative))
    if speed == 0.0:
        speed = APART
    if torque == 0.0:
        torque = APART
    w.moving = 0.0
    differentiate_by(d, x, w, MOVE_Q, APART)
    if d.by_torque != 0.0 or w.prescribed != 0.0:
        differentiate_by(d, x, w, MOVE_1, speed)
    if x.housing_state != LOCKED:
        differentiate_by(d, x, w, MOVE_2, speed)
    if x.output_state != LOCKED:
        differentiate_by(d, x, w, MOVE_3, speed)
    differentiate_by(d, x, w, MOVE_TWIST, torque / d.shaft_stiffness)
    # (of the driven mass alone at first, where the hub hardly moves)
    swing = max(speed, APART * abs(x.relative))
    slow = min(swing, torque / d.shaft_damping) if d.shaft_damping > 0.0 else swing
    differentiate_by(d, x, w, MOVE_RELATIVE, slow)
    if x.housing_state == WOUND:
        differentiate_by(d, x, w, MOVE_HOUSING, torque / d.housing_stiffness)
    elif is_open(x.housing_state) and d.housing_engagement_angle > 0.0:
        differentiate_by(d, x, w, MOVE_HOUSING, APART)
    if x.output_state == WOUND:
        differentiate_by(d, x, w, MOVE_OUTPUT, torque / d.freewheel_stiffness)
    elif is_open(x.output_state) and d.output_engagement_angle > 0.0:
        differentiate_by(d, x, w, MOVE_OUTPUT, APART)
    if d.weight != 0.0:
        differentiate_by(d, x, w, MOVE_THETA, APART)


def place_of(w, i):
    """Place in FOLLOWED of the quantity that moves as number i of this step."""
    return MOTION[int(w.moves[i])]


def invert(w, count):
    """Inverse of 1 / (GAMMA h) - J into w.matrix, by Gauss and Jordan with row pivots."""
    own = 1.0 / (GAMMA * w.step)
    a = w.matrix
    for j in range(count):
        slopes = w.slopes[int(w.moves[j])].numbers
        for i in range(count):
            a[MOVING * i + j] = -slopes[place_of(w, i)]
        a[MOVING * j + j] += own
    for i in range(count):
        pivot = i
        for n in range(i + 1, count):
            if abs(a[MOVING * n + i]) > abs(a[MOVING * pivot + i]):
                pivot = n
        w.pivots[i] = pivot
        scale = 1.0 / a[MOVING * pivot + i]
        a[MOVING * pivot + i] = 1.0
        for j in range(count):
            scaled = scale * a[MOVING * pivot + j]
            a[MOVING * pivot + j] = a[MOVING * i + j]
            a[MOVING * i + j] = scaled
        for n in range(count):
            factor = a[MOVING * n + i]
            if n != i and factor != 0.0:
                a[MOVING * n + i] = 0.0
                for j in range(count):
                    a[MOVING * n + j] -= factor * a[MOVING * i + j]
    for back in range(count):
        i = count - 1 - back
        pivot = int(w.pivots[i])
        for n in range(count):
            swapped = a[MOVING * n + i]
            a[MOVING * n + i] = a[MOVING * n + pivot]
            a[MOVING * n + pivot] = swapped


def solve_stage(d, w, stage, kept, count):
    """Changes of what moves at a stage, from the rates kept."""
    rates, changes, b = w.rates[kept].numbers, w.stages[stage].numbers, w.right_side
    weigh_motion(d, w.stages, C, (STAGES - 1) * stage, 1, stage, 1.0 / w.step, changes)
    for i in range(count):
        b[i] = changes[place_of(w, i)] + rates[place_of(w, i)]
    for i in range(count):
        change = 0.0
        for j in range(count):
            change += w.matrix[MOVING * i + j] * b[j]
        changes[place_of(w, i)] = change


def weigh_sums(w, begin, sums, count):
    """Write changes over the step of all but what moves, or their errors, into sums (what moves: in vain)."""
    weigh(w.rates, SUMS, begin, PARTS + 1, KEPT, w.step, sums, 0, len(sums))
    for i in range(count):
        slopes, place = w.slopes[int(w.moves[i])].numbers, place_of(w, i)
        known = SUMS[begin] * w.stages[0].numbers[place]
        for n in range(1, STAGES):
            known += SUMS[begin + PARTS + n] * w.stages[n].numbers[place]
        for which in range(len(sums)):
            sums[which] += w.step * known * slopes[which]


def make_stiff_step(d, x, w, h):
    """All stages of the step h, and the changes of all that is followed; errors of sums are in w.inside."""
    w.step = h
    w.pair = THIRDS
    count = int(w.moving)
    invert(w, count)
    clear(w.stages[0].numbers)
    solve_stage(d, w, 0, 0, count)
    for stage in range(1, STAGES):
        weigh_motion(d, w.stages, A, (STAGES - 1) * stage, 1, stage, 1.0, w.change.numbers)
        solve_changed(d, x, w, w.change)
        keep_rates(d, x, w, PARTS + stage)
        solve_stage(d, w, stage, PARTS + stage, count)
    weigh_sums(w, 0, w.change.numbers, count)
    if d.losses != 0.0 or w.prescribed != 0.0:
        weigh_sums(w, KEPT, w.inside.numbers, count)
    set_part(d, x, w, 1.0)


def set_part(d, x, w, sigma):
    """Changes of what moves over the part sigma of the step in hand (order 4 within it)."""
    for n in range(STAGES):
        whole = A[(STAGES - 1) * (STAGES - 1) + n] if n < STAGES - 1 else 1.0
        inside = DENSE[n] + sigma * (DENSE[STAGES + n] + sigma * DENSE[2 * STAGES + n])
        w.weights[n] = sigma * (whole + (1.0 - sigma) * inside)
    weigh_motion(d, w.stages, w.weights, 0, 1, STAGES, 1.0, w.change.numbers)
    if x.output_state == LOCKED:
        w.change.omega3 = w.change.omega2
    prescribe_link1(d, x, w, w.change, sigma * w.step)


def look_inside(d, x, w, part):
    """Keep the rates at one of the thirds of the step in hand."""
    set_part(d, x, w, part / PARTS)
    solve_changed(d, x, w, w.change)
    keep_rates(d, x, w, part)
