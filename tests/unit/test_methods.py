"""Internal steps: their error estimate, and when a short step is not accepted."""

import pytest
from scenes import SCENES, started

from inertia_module.contract.records import record_type
from inertia_module.kernel import tableau
from inertia_module.kernel.events import advance, error, stages
from inertia_module.kernel.fields import WORKSPACE
from inertia_module.memory import Module


@pytest.mark.parametrize("pair", [tableau.DOP853_ROW, tableau.DOPRI5_ROW])
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
