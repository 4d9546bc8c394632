"""Tables and sums of the solvers: powers of time are integrated exactly up to the order."""

import random

import numpy as np
import pytest

from inertia_module.contract.records import record_type
from inertia_module.kernel.driven_shaft import propagator
from inertia_module.kernel.fields import WORKSPACE
from inertia_module.kernel.solvers import collocation, dormand_prince, dormand_prince_5, radau
from inertia_module.kernel.solvers.interpolant import (
    dense_change,
    error_norm,
    fit_dense,
    integral,
    short_error_norm,
)

# order of the result and of the stages' own sums
PAIRS = {"8(5,3)": (dormand_prince, 8), "5(4)": (dormand_prince_5, 5)}
SIGMAS = [0.0, 0.17, 0.5, 0.83, 1.0]


def powers(nodes, power):
    """Rates at the nodes whose integral is t^(power + 1)."""
    return [(power + 1) * node**power for node in nodes]


@pytest.mark.parametrize(("pair", "order"), PAIRS.values(), ids=PAIRS)
def test_explicit_pair_integrates_powers_up_to_its_order(pair, order):
    stages = [n for n in range(1, 16) if hasattr(pair, f"sum_{n}") and n != pair.END]
    for n in stages:
        node, weighted = pair.NODES[n], getattr(pair, f"sum_{n}")
        assert weighted(powers(pair.NODES, 0)) == pytest.approx(node, rel=1e-13)
        if n > 1:
            assert weighted(powers(pair.NODES, 1)) == pytest.approx(node**2, rel=1e-13)
    for power in range(order):
        result = getattr(pair, f"sum_{pair.END}")
        assert result(powers(pair.NODES, power)) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize(
    ("error", "order"),
    [(dormand_prince.fifth, 5), (dormand_prince.third, 3), (dormand_prince_5.fourth, 4)],
    ids=["fifth", "third", "fourth"],
)
def test_error_sees_powers_from_its_order_on(error, order):
    nodes = dormand_prince_5.NODES if error is dormand_prince_5.fourth else dormand_prince.NODES
    found = [abs(error(powers(nodes, power))) for power in range(order + 1)]
    assert max(found[:order]) < 1e-13
    assert found[order] > 1e-5


@pytest.mark.parametrize("power", range(7))
@pytest.mark.parametrize("sigma", SIGMAS)
def test_inside_of_an_explicit_step(power, sigma):
    w = record_type(WORKSPACE)()
    w.step = 0.3
    rates = powers(dormand_prince.NODES, power)
    fit_dense(w.step, rates, w.dense_q)
    expected = w.step * sigma ** (power + 1)
    assert dense_change(w.dense_q, sigma) == pytest.approx(expected, abs=1e-12)
    assert integral(w, rates, sigma) == pytest.approx(expected, abs=1e-12)


def test_error_grows_with_each_error_and_shrinks_with_what_is_allowed():
    w = record_type(WORKSPACE)()
    w.step = 0.3
    chance = random.Random(1)
    blocks = w.rate_q, w.rate_omega2, w.rate_omega1
    for block in blocks:
        block[:] = [chance.uniform(-1.0, 1.0) for _ in range(len(block))]
    for norm in (error_norm, short_error_norm):
        whole = norm(w, 1.0, 1.0, w.rate_omega1, 1.0)
        assert norm(w, 10.0, 10.0, w.rate_omega1, 10.0) == pytest.approx(0.1 * whole)
        # each alone is one of those that the norm is made of
        alone = [norm(w, *scales, w.rate_omega1, other) for *scales, other in np.where(np.eye(3), 1.0, 1e9)]
        assert whole**2 == pytest.approx(sum(part**2 for part in alone), rel=0.5)
        assert whole >= 0.8 * max(alone)


@pytest.mark.parametrize("power", range(9))
def test_collocation_integrates_powers_up_to_its_order(power):
    rates = powers(radau.NODES, power)
    assert collocation.mean(rates) == pytest.approx(1.0, abs=1e-14)
    if power < radau.STAGES:
        for i, node in enumerate(radau.NODES):
            assert collocation.row(radau.MATRIX, i, rates) == pytest.approx(node ** (power + 1), abs=1e-14)
            if power == radau.STAGES - 1:
                continue
            twice = node ** (power + 2) / (power + 2)
            assert collocation.row(radau.SQUARE, i, rates) == pytest.approx(twice, abs=1e-14)
        assert collocation.embedded_error(float(power == 0), rates) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("power", range(10))
def test_gauss_rule_integrates_powers_up_to_its_order(power):
    rates = np.array(powers(propagator.NODES, power))
    assert rates @ np.array(propagator.WEIGHTS) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_inside_of_a_collocation_step(sigma):
    true = np.polynomial.Polynomial([0.3, -1.0, 0.7, 0.4, -0.9])
    rates = true(np.array(radau.NODES))
    target = [0.0] * (radau.STAGES + 1)
    collocation.fit(rates, target)
    found = collocation.polynomial(target, radau.STAGES, sigma)
    assert found == pytest.approx((true(sigma), true.deriv()(sigma)), abs=1e-12)
    collocation.fit_integral(rates, 2.0, 0.3, target)
    found = collocation.polynomial(target, radau.STAGES + 1, sigma)
    assert found == pytest.approx((2.0 + 0.3 * true.integ()(sigma), 0.3 * true(sigma)), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_elimination_solves_with_several_right_sides(seed):
    chance = np.random.default_rng(seed)
    matrix, right = chance.normal(size=(5, 5)), chance.normal(size=(5, 3))
    matrix[0, 0] = 0.0  # a pivot is needed
    target = list(right.flat)
    collocation.eliminate(list(matrix.flat), 3, target)
    assert np.reshape(target, (5, 3)) == pytest.approx(np.linalg.solve(matrix, right), rel=1e-9)
