"""Stages of a step of an embedded pair, and the changes of speeds, angles and sums over it.

w.rates[n] holds the rates at stage n (fields.INTEGRATED), w.change their integrals over the step.
"""

from ..accumulate import copy
from ..equations.losses import write_loss_powers
from ..equations.motion import equations_of_motion, evaluate
from ..equations.states import ENGAGED_COMPLIANT, IDEAL, LOCKED, LOSSY
from ..fields import N_CAUSES
from ..records import Constants, Doubles, Integrated, Machine, Records, State, Workspace
from ..tableau import (
    DOP853_LAST_STAGE,
    FIRST_ERROR_STAGE,
    FIRST_NONZERO_STAGE,
    N_STAGES,
    NODES,
    WEIGHTS,
    last_stage,
    write_dense_weights,
)
from .guards import SLIP, is_spring, n_indicators, value_and_rate

# Positions in fields.INTEGRATED
Q, OMEGA1, OMEGA2, OMEGA3 = 0, 1, 2, 3
THETA1, LOST = 8, 11
TWIST = LOST + N_CAUSES
N_IDEAL = 12  # Number of quantities of an ideal module with a rigid output, which come first


def solve_motion(d: Constants, x: State, w: Workspace) -> None:
    """Solve the equations of motion in d.machine with the mesh signs of the step; count the evaluation."""
    evaluate(d, x, w.prescribed, w.load, True)
    x.step_evaluations += 1.0


def store_rates(d: Constants, x: State, w: Workspace, n: int) -> None:
    """Store the rates of the integrated quantities at stage n, from d.machine after motion.evaluate."""
    m = d.machine
    rates = w.rates[n]
    slip = m.omega1 - m.omega2
    if x.slip_sign == 0.0:
        slip = 0.0
    rates.q = d.k * slip
    rates.omega1 = m.alpha1
    rates.omega2 = m.alpha2
    rates.omega3 = m.alpha3
    rates.theta1 = m.omega1
    rates.turned3 = m.omega3
    if d.elastic != 0.0:
        rates.turned3 -= m.relative
        rates.twist = m.relative
        rates.relative = m.rate_relative
    rates.work_in = m.drive * m.omega1
    rates.drive = m.drive
    rates.housing = m.housing
    rates.output = m.output
    rates.square = m.output * m.output
    write_loss_powers(d, x, m, rates)
    if d.losses != 0.0:
        turns = x.housing_state == ENGAGED_COMPLIANT or d.housing_engagement_angle > 0.0
        rates.wound_housing = -m.omega2 if turns else 0.0
        turns = x.output_state == ENGAGED_COMPLIANT or d.output_engagement_angle > 0.0
        rates.wound_output = m.omega2 - m.omega3 if turns else 0.0
    for which in range(SLIP):
        w.indicators[which].value[n], w.indicators[which].rate[n] = value_and_rate(d, x, m, which)
    for which in range(SLIP, n_indicators(d)):
        w.indicators[which].value[n], w.indicators[which].rate[n] = value_and_rate(d, x, m, which)


def turn_freewheels(x: State, m: Machine, housing: float, output: float) -> None:
    """Write wind-up and remaining engagement angles to m after the freewheels have turned back, rad."""
    m.wound_housing = x.wound_housing + housing
    m.wound_output = x.wound_output + output
    m.play_housing = x.play_housing - housing
    m.play_output = x.play_output - output


def weighted_rate(w: Workspace, row: int, count: int, which: int, first_nonzero: int) -> float:
    """Return the weighted sum of the rates of a quantity.

    Args:
        w: Workspace with the rates of the stages.
        row: Row of the tableau with the weights.
        count: Number of stages.
        which: Number of the quantity in fields.INTEGRATED.
        first_nonzero: First stage after stage 0 with a non-zero weight. An earlier stage is allowed.
    """
    total = WEIGHTS[N_STAGES * row] * w.rates[0].numbers[which]
    for n in range(first_nonzero, count):
        total += WEIGHTS[N_STAGES * row + n] * w.rates[n].numbers[which]
    return total


def four_weighted_sums(
    stages: Records[Integrated],
    weights: Doubles | tuple[float, ...],
    begin: int,
    first_nonzero: int,
    count: int,
    first: int,
) -> tuple[float, float, float, float]:
    """Return weighted sums of the rates of four quantities.

    Args:
        stages: Rates at the stages (w.rates).
        weights: Weights of the stages.
        begin: Position of the weight of stage 0.
        first_nonzero: First stage after stage 0 with a non-zero weight. An earlier stage is allowed.
        count: Number of stages.
        first: Number of the first quantity in fields.INTEGRATED.
    """
    weight, numbers = weights[begin], stages[0].numbers
    a, b = weight * numbers[first], weight * numbers[first + 1]
    c, d = weight * numbers[first + 2], weight * numbers[first + 3]
    for n in range(first_nonzero, count):
        weight = weights[begin + n]
        numbers = stages[n].numbers
        a += weight * numbers[first]
        b += weight * numbers[first + 1]
        c += weight * numbers[first + 2]
        d += weight * numbers[first + 3]
    return a, b, c, d


def write_weighted_sums(
    stages: Records[Integrated],
    weights: Doubles,
    first_nonzero: int,
    count: int,
    factor: float,
    sums: Doubles,
    end: int,
) -> None:
    """Write weighted sums of the rates of all quantities before the last one, four at a time.

    Args:
        stages: Rates at the stages (w.rates).
        weights: Weights of the stages.
        first_nonzero: First stage after stage 0 with a non-zero weight. An earlier stage is allowed.
        count: Number of stages.
        factor: Factor of all sums.
        sums: Sums, written.
        end: Number of quantities, at least 4.
    """
    for position in range(0, end, 4):
        which = min(position, end - 4)
        sum0, sum1, sum2, sum3 = four_weighted_sums(stages, weights, 0, first_nonzero, count, which)
        sums[which] = factor * sum0
        sums[which + 1] = factor * sum1
        sums[which + 2] = factor * sum2
        sums[which + 3] = factor * sum3


def evaluate_stages(d: Constants, x: State, w: Workspace, first: int, last: int) -> None:
    """Evaluate stages of the present step, each from the rates at the stages before.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State at the beginning of the step.
        w: Workspace with the pair, the step and the rates of the earlier stages; the rates are written.
        first: Number of the first stage.
        last: Number of the last stage.
    """
    h = w.step
    m = d.machine
    pair = int(w.pair)
    for n in range(first, last + 1):
        row = pair + n
        q, omega1, omega2, omega3 = four_weighted_sums(
            w.rates, WEIGHTS, N_STAGES * row, FIRST_NONZERO_STAGE[row], n, Q
        )
        m.q = x.q + h * q
        m.omega1 = x.omega1 + h * (omega1 if d.by_torque != 0.0 else NODES[row] * w.prescribed)
        m.omega2 = x.omega2 + h * omega2
        m.omega3 = m.omega2 if x.output_state == LOCKED else x.omega3 + h * omega3
        if d.weight != 0.0:
            mean = NODES[row] * (x.omega1 + 0.5 * NODES[row] * h * w.prescribed)
            m.theta1 = x.theta1 + h * (mean if d.by_torque == 0.0 else weighted_rate(w, row, n, THETA1, 1))
        if d.elastic + d.freewheel_angles != 0.0:
            twist, relative, housing, output = four_weighted_sums(
                w.rates, WEIGHTS, N_STAGES * row, FIRST_NONZERO_STAGE[row], n, TWIST
            )
            m.twist = x.twist + h * twist
            m.relative = x.relative + h * relative
            if d.freewheel_angles != 0.0:
                turn_freewheels(x, m, h * housing, h * output)
        # motion.evaluate, inlined
        if d.losses != 0.0:
            equations_of_motion(d, x, w.prescribed, w.load, True, LOSSY)
        else:
            equations_of_motion(d, x, w.prescribed, w.load, True, IDEAL)
        x.step_evaluations += 1.0
        store_rates(d, x, w, n)


def set_changes(
    d: Constants, x: State, w: Workspace, changes: Integrated, h: float, first_nonzero: int, count: int
) -> None:
    """Write the changes of the integrated quantities over a time, with the weights in w.weights.

    Args:
        d: Constants.
        x: State at the beginning of the step.
        w: Workspace with the step, its stages and their weights.
        changes: Record that is written.
        h: Time, s; the change of a prescribed speed of link 1 follows from it.
        first_nonzero: First stage after stage 0 with a non-zero weight. An earlier stage is allowed.
        count: Number of stages with weights.
    """
    numbers = N_IDEAL if d.elastic + d.losses == 0.0 else len(changes.numbers)
    write_weighted_sums(w.rates, w.weights, first_nonzero, count, w.step, changes.numbers, numbers)
    if d.by_torque == 0.0:
        changes.omega1 = h * w.prescribed
        changes.theta1 = h * (x.omega1 + 0.5 * h * w.prescribed)


def set_step_changes(d: Constants, x: State, w: Workspace) -> None:
    """Write the changes of the integrated quantities over the whole step, from its stages."""
    last = last_stage(int(w.pair))
    row = int(w.pair) + last
    for n in range(last):
        w.weights[n] = WEIGHTS[N_STAGES * row + n]
    set_changes(d, x, w, w.change, w.step, FIRST_NONZERO_STAGE[row], last)


def solve_changed(d: Constants, x: State, w: Workspace, changes: Integrated) -> None:
    """Solve the equations of motion after changes of the motion in ``x``; ``d.machine`` is written.

    Args:
        d: Constants; ``d.machine`` is written.
        x: State at the beginning of the step; the evaluation is counted.
        w: Workspace with the load and the prescribed quantity of link 1.
        changes: Changes of the integrated quantities (fields.INTEGRATED).
    """
    m = d.machine
    m.q = x.q + changes.q
    m.theta1 = x.theta1 + changes.theta1
    m.omega1 = x.omega1 + changes.omega1
    m.omega2 = x.omega2 + changes.omega2
    m.omega3 = m.omega2 if x.output_state == LOCKED else x.omega3 + changes.omega3
    if d.elastic != 0.0:
        m.twist = x.twist + changes.twist
        m.relative = x.relative + changes.relative
    if d.freewheel_angles != 0.0:
        turn_freewheels(x, m, changes.wound_housing, changes.wound_output)
    solve_motion(d, x, w)


def set_changes_inside(d: Constants, x: State, w: Workspace, sigma: float, changes: Integrated) -> None:
    """Write the changes over the fraction sigma of the step of the pair 8(5,3) by its dense output."""
    write_dense_weights(sigma, w.weights)
    set_changes(d, x, w, changes, sigma * w.step, FIRST_ERROR_STAGE, N_STAGES)


def exact_guard(d: Constants, x: State, w: Workspace, which: int, sigma: float) -> float:
    """Return an event indicator at the fraction sigma of the step by the equations of motion.

    A negative value at the beginning of the step is round-off and is subtracted, except for a spring.
    """
    values = w.indicators[which].value
    value = values[0]
    if sigma == 1.0:
        value = values[DOP853_LAST_STAGE]
    elif sigma > 0.0:
        set_changes_inside(d, x, w, sigma, w.inside)
        solve_changed(d, x, w, w.inside)
        value, _ = value_and_rate(d, x, d.machine, which)
    return value - (0.0 if is_spring(x, which) else min(values[0], 0.0))


def cut_step(d: Constants, x: State, w: Workspace, sigma: float) -> None:
    """Cut the present step to its fraction sigma by its dense output; d.machine then holds its end."""
    set_changes_inside(d, x, w, sigma, w.change)
    w.step *= sigma
    solve_changed(d, x, w, w.change)


def reuse_end(d: Constants, x: State, w: Workspace) -> None:
    """Store the rates at the end of the step as those of stage 0 of the next."""
    end = last_stage(int(w.pair))
    copy(w.rates[0].numbers, w.rates[end].numbers)
    for which in range(n_indicators(d)):
        w.indicators[which].value[0] = w.indicators[which].value[end]
        w.indicators[which].rate[0] = w.indicators[which].rate[end]
