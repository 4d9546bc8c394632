"""Test explicit pairs: orders of the tables, order of convergence of a step, dense output."""

import math

import numpy as np
import pytest
from scenes import make_step, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import tableau
from inertia_module.kernel.events import advance, stages
from inertia_module.kernel.fields import WORKSPACE

# Row of the first stage, last stage and order of each pair.
PAIRS = {
    "8(5,3)": (tableau.DOP853_ROW, tableau.DOP853_LAST_STAGE, 8),
    "5(4)": (tableau.DOPRI5_ROW, tableau.DOPRI5_LAST_STAGE, 5),
}
SIGMAS = [0.0, 0.17, 0.5, 0.83, 1.0]


def powers(nodes, power):
    """Return rates at the nodes whose integral is t^(power + 1)."""
    return [(power + 1) * node**power for node in nodes]


def nodes_of(pair):
    """Return the nodes of a pair, and the nodes of the dense output of the longer pair."""
    return (
        tableau.NODES[: tableau.N_STAGES]
        if pair == tableau.DOP853_ROW
        else tableau.NODES[tableau.DOPRI5_ROW :]
    )


@pytest.mark.parametrize(("pair", "end", "order"), PAIRS.values(), ids=PAIRS)
def test_explicit_pair_integrates_powers_up_to_its_order(pair, end, order):
    nodes = nodes_of(pair)
    for n in range(1, len(nodes)):
        for power in range(1 if n == 1 else 2):
            integral = tableau.weighted_sum(pair + n, n, powers(nodes, power))
            assert integral == pytest.approx(nodes[n] ** (power + 1), rel=1e-13)
    for power in range(order):
        assert tableau.weighted_sum(pair + end, end, powers(nodes, power)) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize(
    ("row", "pair", "end", "order"),
    [
        (tableau.DOP853_E5_ROW, tableau.DOP853_ROW, tableau.DOP853_LAST_STAGE, 5),
        (tableau.DOP853_E3_ROW, tableau.DOP853_ROW, tableau.DOP853_LAST_STAGE, 3),
        (tableau.DOPRI5_E_ROW, tableau.DOPRI5_ROW, tableau.DOPRI5_LAST_STAGE + 1, 4),
    ],
    ids=["fifth", "third", "fourth"],
)
def test_error_estimate_detects_powers_from_its_order_on(row, pair, end, order):
    errors = [
        abs(tableau.weighted_sum(row, end, powers(nodes_of(pair), power))) for power in range(order + 1)
    ]
    assert max(errors[:order]) < 1e-13
    assert errors[order] > 1e-5


@pytest.mark.parametrize("power", range(7))
@pytest.mark.parametrize("sigma", SIGMAS)
def test_dense_output_within_an_explicit_step(power, sigma):
    h, dense, weights = 0.3, [0.0] * 7, [0.0] * tableau.N_STAGES
    rates = powers(nodes_of(tableau.DOP853_ROW), power)
    tableau.fit_dense_output(h, rates, dense)
    tableau.write_dense_weights(sigma, weights)
    expected = h * sigma ** (power + 1)
    assert tableau.dense_change(dense, sigma) == pytest.approx(expected, abs=1e-12)
    assert h * np.dot(weights, rates) == pytest.approx(expected, abs=1e-12)
    assert tableau.dense_rate(dense, sigma) == pytest.approx(h * (power + 1) * sigma**power, abs=1e-11)


# A shaft between hub and driven mass without imbalances: a harmonic oscillation.
OSCILLATOR = {
    "fidelity": 3,
    "omega1": 0.0,
    "load_torque": 0.0,
    "imbalance_mass": 0.0,
    "output_freewheel": 1,
    "omega_out_start": 10.0,
    "output_inertia": 0.5,
    "driven_inertia": 2.0,
    "shaft_stiffness": 40.0,
    "shaft_damping": 0.0,
}
RATE = math.sqrt(40.0 * (1.0 / 0.5 + 1.0 / 2.0))
AMPLITUDE = 0.1


def oscillating_step(pair, h):
    """Return constants, state and workspace after one step h of the oscillator from the twist AMPLITUDE."""
    module = started("plain", OSCILLATOR)
    d, x, w = module.derived, module.state, record_type(WORKSPACE)()
    x.twist, x.rates_cached = AMPLITUDE, 0.0
    advance.begin_step(d, x, w)
    make_step(d, x, w, pair, h)
    return d, x, w


@pytest.mark.parametrize("pair, order", [(tableau.DOP853_ROW, 8), (tableau.DOPRI5_ROW, 5)], ids=PAIRS)
def test_error_of_a_step_falls_with_its_order(pair, order):
    """The error of one step is proportional to h^(order + 1)."""
    errors = []
    for h in (0.8 / RATE, 0.4 / RATE):
        _, _, w = oscillating_step(pair, h)
        errors.append(abs(AMPLITUDE * (math.cos(RATE * h) - 1.0) - w.change.twist))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order + 1, abs=1.2)
    assert errors[1] < (1e-9 if order == 8 else 1e-5) * AMPLITUDE


def test_dense_output_of_a_step_follows_the_motion():
    h = 0.5 / RATE
    d, x, w = oscillating_step(tableau.DOP853_ROW, h)
    stages.evaluate_stages(d, x, w, tableau.DOP853_LAST_STAGE + 1, tableau.N_STAGES - 1)
    for sigma in SIGMAS:
        stages.set_changes_inside(d, x, w, sigma, w.inside)
        exact = AMPLITUDE * (math.cos(RATE * sigma * h) - 1.0)
        assert w.inside.twist == pytest.approx(exact, abs=1e-8 * AMPLITUDE)
