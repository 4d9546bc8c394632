"""Test order conditions, convergence and dense output of the Runge-Kutta pairs, and their flat tables."""

import dataclasses
import math
from functools import cache

import numpy as np
import pytest

from inertia_module.kernel import fields, tableau
from inertia_module.kernel.tableau import DOP853, DOPRI5

PAIRS = {pair.name: pair for pair in (DOP853, DOPRI5)}
ROWS = {"DOP853": tableau.DOP853_ROW, "DOPRI5": tableau.DOPRI5_ROW}
SIGMAS = [0.0, 0.17, 0.5, 0.83, 1.0]


def grafted(tree):
    """Return all trees with one more leaf than a rooted tree, which is the sorted tuple of its branches."""
    yield tuple(sorted((*tree, ())))
    for n, branch in enumerate(tree):
        for larger in grafted(branch):
            yield tuple(sorted((*tree[:n], larger, *tree[n + 1 :])))


@cache
def trees(order):
    """Return all rooted trees with this number of vertices."""
    return sorted({larger for tree in trees(order - 1) for larger in grafted(tree)}) if order > 1 else [()]


def size(tree):
    return 1 + sum(map(size, tree))


def density(tree):
    """Return gamma(t) of Hairer, Norsett and Wanner I, II.2."""
    return size(tree) * math.prod(map(density, tree))


def matrix(pair):
    a = np.zeros((len(pair.C), len(pair.C)))
    for i, row in enumerate(pair.A):
        a[i, : len(row)] = row
    return a


def elementary_weight(a, tree):
    """Return the vector of the elementary weights of a tree at all stages."""
    return math.prod((a @ elementary_weight(a, branch) for branch in tree), start=np.ones(len(a)))


def polynomial_rates(nodes, power):
    """Return rates at the nodes whose integral is t^(power + 1)."""
    return [(power + 1) * node**power for node in nodes]


def step_of_exponential(row, last, h, count):
    """Return the rates at the stages of one step of y' = y from 1, by the flat table."""
    rates = []
    for n in range(count):
        rates.append(1.0 + h * tableau.weighted_sum(row + n, n, rates))
    return 1.0 + h * tableau.weighted_sum(row + last, last, rates), rates


def test_there_are_as_many_rooted_trees_as_butcher_counted():
    assert [len(trees(order)) for order in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_result_fulfils_all_order_conditions(pair):
    a = matrix(pair)
    b = a[pair.last_stage]
    for order in range(1, pair.order + 1):
        for tree in trees(order):
            assert b @ elementary_weight(a, tree) == pytest.approx(1.0 / density(tree), abs=1e-13)


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_error_weights_vanish_up_to_their_order_and_not_beyond(pair):
    a = matrix(pair)
    for order, weights in pair.E.items():
        e = np.zeros(len(a))
        e[: len(weights)] = weights
        for lower in range(1, order + 1):
            assert all(abs(e @ elementary_weight(a, tree)) < 1e-13 for tree in trees(lower))
        assert max(abs(e @ elementary_weight(a, tree)) for tree in trees(order + 1)) > 1e-6


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_order_of_convergence_on_the_exponential(pair):
    errors = []
    for steps in (10, 20):
        y = 1.0
        for _ in range(steps):
            y *= step_of_exponential(ROWS[pair.name], pair.last_stage, 2.0 / steps, pair.last_stage + 1)[0]
        errors.append(abs(y - math.exp(2.0)))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(pair.order, abs=0.4)


def test_dense_output_is_of_order_7_on_the_exponential():
    errors = []
    for h in (0.8, 0.4):
        rates = step_of_exponential(tableau.DOP853_ROW, DOP853.last_stage, h, tableau.N_STAGES)[1]
        dense = [0.0] * 7
        tableau.fit_dense_output(h, rates, dense)
        errors.append(
            max(abs(1.0 + tableau.dense_change(dense, sigma) - math.exp(sigma * h)) for sigma in SIGMAS[1:4])
        )
    # The error of one step is of order 8.
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.5)


@pytest.mark.parametrize("power", range(7))
@pytest.mark.parametrize("sigma", SIGMAS)
def test_dense_output_is_exact_for_polynomials(power, sigma):
    h, dense, weights = 0.3, [0.0] * 7, [0.0] * tableau.N_STAGES
    rates = polynomial_rates(DOP853.C, power)
    tableau.fit_dense_output(h, rates, dense)
    tableau.write_dense_weights(sigma, weights)
    expected = h * sigma ** (power + 1)
    assert tableau.dense_change(dense, sigma) == pytest.approx(expected, abs=1e-12)
    assert h * np.dot(weights, rates) == pytest.approx(expected, abs=1e-12)
    assert tableau.dense_rate(dense, sigma) == pytest.approx(h * (power + 1) * sigma**power, abs=1e-11)


def changed(value, place):
    """Return a nested tuple or dict of numbers; the number at this place changes by 1e-9 of its size."""
    if not place:
        return value + 1e-9 * max(1.0, abs(value))
    key, *rest = place
    items = dict(value) if isinstance(value, dict) else dict(enumerate(value))
    items[key] = changed(items[key], rest)
    return items if isinstance(value, dict) else tuple(items.values())


def places(value):
    if isinstance(value, float):
        return [[]]
    items = value.items() if isinstance(value, dict) else enumerate(value)
    return [[key, *rest] for key, item in items for rest in places(item)]


@pytest.mark.parametrize("letter", "ACED")
@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_each_changed_coefficient_is_rejected_at_import(pair, letter):
    value = getattr(pair, letter)
    for place in places(value):
        with pytest.raises(ValueError, match=pair.name):
            dataclasses.replace(pair, **{letter: changed(value, place)})


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_flat_tables_have_the_rows_of_the_pairs(pair):
    first = ROWS[pair.name]
    for n, row in enumerate(pair.A):
        start = tableau.N_STAGES * (first + n)
        flat = tableau.WEIGHTS[start : start + tableau.N_STAGES]
        assert flat == (*row, *[0.0] * (tableau.N_STAGES - len(row)))
        assert all(weight == 0.0 for weight in flat[1 : tableau.FIRST_NONZERO_STAGE[first + n]])
    assert tableau.NODES[first : first + len(pair.C)] == pair.C
    assert tableau.last_stage(first) == pair.last_stage
    for order, row in (
        (5, tableau.DOP853_E5_ROW),
        (3, tableau.DOP853_E3_ROW),
        (4, tableau.DOPRI5_E_ROW),
    ):
        if order in pair.E:
            weights = pair.E[order]
            start = tableau.N_STAGES * row
            assert tableau.WEIGHTS[start : start + len(weights)] == weights


def test_records_have_room_for_all_stages_and_the_dense_output():
    assert fields.N_STAGES == tableau.N_STAGES
    assert 3 + len(DOP853.D) == fields.N_DENSE


def test_errors_of_the_long_pair_begin_at_their_first_stage():
    rows = (DOP853.A[DOP853.last_stage], DOP853.E[5], DOP853.E[3], *DOP853.D)
    assert all(weight == 0.0 for row in rows for weight in row[1 : tableau.FIRST_ERROR_STAGE])


@pytest.mark.parametrize("pair", [tableau.DOP853_ROW, tableau.DOPRI5_ROW])
def test_stages_by_time_have_rising_nodes_up_to_the_end(pair):
    first, count = tableau.stage_order_range(pair)
    nodes = [tableau.NODES[pair + n] for n in tableau.STAGES_BY_TIME[first : first + count]]
    assert nodes == sorted(set(nodes))
    assert (nodes[0], nodes[-1]) == (0.0, 1.0)


def parabola(t):
    return 1.04 - (t - 0.7) ** 2


@pytest.mark.parametrize(
    ("times", "end", "expected"),
    [
        ((0.1, 0.5, 0.9), 1.0, 1.04),
        ((0.1, 0.5, 0.9), 0.6, parabola(0.5)),
        ((0.0, 0.1, 0.2), 1.0, parabola(0.1)),
    ],
    ids=["between the points", "after the end", "beyond the points"],
)
def test_extremum_of_a_parabola(times, end, expected):
    assert tableau.parabola_extremum(*times, *map(parabola, times), end) == pytest.approx(expected)
