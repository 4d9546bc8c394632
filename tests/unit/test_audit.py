"""Test the energy audit: a step succeeds only if input energy equals output, losses and stored energy."""

import pytest
from rejected import assert_rejected
from scenes import PLANAR, started

from inertia_module.kernel import step
from inertia_module.kernel.codes import NOT_BALANCED, OK

BEFORE = {"energy_in": 1.0, "energy_out": 2.0, "energy_stored": 10.0}
AFTER = {"energy_in": 9.0, "energy_out": 6.0, "step_lost": 1.0, "energy_stored": 13.0}
# Energies: input, output and losses in the step, and stored energy at its ends.
ENERGIES = 8.0 + 4.0 + 1.0 + 13.0 + 10.0


@pytest.fixture
def spoil(monkeypatch):
    """Make each step gain 100 J without a source."""
    write_means = step.write_means

    def write_means_with_more(d, x, h):
        write_means(d, x, h)
        x.energy_in += 100.0

    return lambda: monkeypatch.setattr(step, "write_means", write_means_with_more)


def audited(tolerance, **energies):
    """Return the status of a step with the energies above, some of them replaced."""
    module = started("plain", omega1=0.0)
    d, x, before = module.derived, module.state, type(module.state)()
    for name, value in BEFORE.items():
        setattr(before, name, value)
    for name, value in AFTER.items():
        setattr(x, name, energies.get(name, value))
    return step.audit(d, x, before, x.energy_stored, tolerance)


@pytest.mark.parametrize("name", AFTER)
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("tolerance, share", [(1e-3, 0.1), (1e-6, 1e-3), (1e-12, 1e-6)])
def test_energy_defect_may_be_a_thousand_tolerances_of_the_energies(name, sign, tolerance, share):
    for part, expected in ((0.0, OK), (0.8, OK), (1.25, NOT_BALANCED)):
        spoiled = {name: AFTER[name] + sign * part * share * ENERGIES}
        assert audited(tolerance, **spoiled) == expected


@pytest.mark.parametrize("values", [{"fidelity": 2}, {"fidelity": 3}])
def test_step_without_energy_balance_is_rejected(spoil, values):
    module = started("plain", PLANAR, values)
    before = bytes(module.state)
    spoil()
    assert_rejected("the energy balance check failed with tolerance = 1e-06", module.advance, 0.01)
    assert bytes(module.state) == before


@pytest.mark.parametrize("values", [{"fidelity": 0}, {"fidelity": 1}], ids=str)
def test_steps_with_physical_losses_are_accepted(spoil, values):
    module = started("plain", PLANAR, values)
    spoil()
    module.advance(0.01)
    assert module["energy_residual"] > 50.0
