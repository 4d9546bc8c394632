"""Tables and sums of the solvers: powers of time are integrated exactly up to the order."""

import numpy as np
import pytest
from scenes import SCENES, started

from inertia_module.contract.records import record_type
from inertia_module.kernel import tableau
from inertia_module.kernel.events import advance, error, stages
from inertia_module.kernel.fields import WORKSPACE
from inertia_module.memory import Module

# row of the first stage, last stage and order of each pair
PAIRS = {"8(5,3)": (tableau.LONG, tableau.END, 8), "5(4)": (tableau.SHORT, tableau.SHORT_END, 5)}
SIGMAS = [0.0, 0.17, 0.5, 0.83, 1.0]


def powers(nodes, power):
    """Rates at the nodes whose integral is t^(power + 1)."""
    return [(power + 1) * node**power for node in nodes]


def nodes_of(pair):
    """Nodes of a pair, and those for the inside of the longer one."""
    return (
        tableau.NODES[: tableau.STAGES]
        if pair == tableau.LONG
        else tableau.NODES[tableau.SHORT : tableau.THIRDS]
    )


@pytest.mark.parametrize(("pair", "end", "order"), PAIRS.values(), ids=PAIRS)
def test_explicit_pair_integrates_powers_up_to_its_order(pair, end, order):
    nodes = nodes_of(pair)
    for n in range(1, len(nodes)):
        for power in range(1 if n == 1 else 2):
            found = tableau.weighed(pair + n, n, powers(nodes, power))
            assert found == pytest.approx(nodes[n] ** (power + 1), rel=1e-13)
    for power in range(order):
        assert tableau.weighed(pair + end, end, powers(nodes, power)) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize(
    ("row", "pair", "end", "order"),
    [
        (tableau.FIFTH, tableau.LONG, tableau.END, 5),
        (tableau.THIRD, tableau.LONG, tableau.END, 3),
        (tableau.FOURTH, tableau.SHORT, tableau.SHORT_END + 1, 4),
    ],
    ids=["fifth", "third", "fourth"],
)
def test_error_sees_powers_from_its_order_on(row, pair, end, order):
    found = [abs(tableau.weighed(row, end, powers(nodes_of(pair), power))) for power in range(order + 1)]
    assert max(found[:order]) < 1e-13
    assert found[order] > 1e-5


@pytest.mark.parametrize("power", range(7))
@pytest.mark.parametrize("sigma", SIGMAS)
def test_inside_of_an_explicit_step(power, sigma):
    h, dense, weights = 0.3, [0.0] * 7, [0.0] * tableau.STAGES
    rates = powers(nodes_of(tableau.LONG), power)
    tableau.fit(h, rates, dense)
    tableau.write_inside_weights(sigma, weights)
    expected = h * sigma ** (power + 1)
    assert tableau.dense_change(dense, sigma) == pytest.approx(expected, abs=1e-12)
    assert h * np.dot(weights, rates) == pytest.approx(expected, abs=1e-12)
    assert tableau.dense_rate(dense, sigma) == pytest.approx(h * (power + 1) * sigma**power, abs=1e-11)


@pytest.mark.parametrize("pair", [tableau.LONG, tableau.SHORT])
def test_error_grows_with_each_error_and_shrinks_with_what_is_allowed(pair):
    module = started("plain", SCENES["bevel"], omega_out_start=30.0, omega2_start=20.0)
    d, x, w = module.derived, module.state, record_type(WORKSPACE)()
    advance.begin_step(d, x, w)
    w.tolerance, h = d.tolerance, 1e-3
    stages.make_step(d, x, w, pair, h)
    whole = error.step_error(d, x, w, 100.0)
    assert 0.0 < whole < 1e300
    w.tolerance *= 10.0
    assert error.step_error(d, x, w, 100.0) == pytest.approx(0.1 * whole)
    for name in ("q", "omega2"):
        kept = getattr(w.rates[5], name)
        setattr(w.rates[5], name, kept + 1e3)
        assert error.step_error(d, x, w, 100.0) > 10.0 * whole
        setattr(w.rates[5], name, kept)


def test_the_few_stages_of_a_short_step_are_not_trusted_over_many_radians():
    works = []
    for tolerance, steps in ((1e-3, 6), (1e-9, 36)):
        module = Module("plain").start(
            tolerance=tolerance, imbalance_mass=0.01, output_inertia=50.0, omega1=100.0, load_torque=1e-3
        )
        for _ in range(steps):
            module.advance(36.0 / (steps * module.derived.harmonic * module.derived.k * module["omega1"]))
        works.append(module["energy_in"])
    assert works[0] == pytest.approx(works[1], rel=3e-4)
