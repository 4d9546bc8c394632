"""Test step-size control: the error norm, the next size, and the energy check of each internal step."""

import math

import pytest
from scenes import PLANAR, SCENES, advanced, make_step, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import tableau
from inertia_module.kernel.events import advance, energy, error, step_size
from inertia_module.kernel.fields import WORKSPACE
from inertia_module.model import Module

# Link 2 overtakes the output within its engagement angle; the error estimate of one step is far too small.
OVERTAKING = {
    **{
        "z2": 16,
        "z16": 35,
        "z17": 31,
        "z6": 49,
        "shaft_angle": 2.2718384,
        "wheel_radius": 0.180265,
        "c": 1.09712,
    },
    **{"imbalance_mass": 2.93734, "modules": 3, "satellites": 4, "drive_inertia": 0.636862},
    **{"link2_inertia": 0.00289248, "output_inertia": 0.139596, "drive_angle_start": 2.57763},
    **{"housing_engagement_angle": 0.0150126, "output_engagement_angle": 0.109698},
    **{"omega1": -55.4516, "load_torque": 0.0},
}


def single_step(pair, h=1e-3, **values):
    """Return constants, state and workspace after one step of the bevel module by a pair."""
    module = started("plain", SCENES["bevel"], omega_out_start=30.0, omega2_start=20.0, **values)
    d, x, w = module.derived, module.state, record_type(WORKSPACE)()
    w.load, w.tolerance = x.load_torque, d.tolerance
    advance.begin_step(d, x, w)
    make_step(d, x, w, pair, h)
    error.write_scales(d, x, w)
    return d, x, w


@pytest.mark.parametrize("pair", [tableau.DOP853_ROW, tableau.DOPRI5_ROW])
def test_error_norm_is_inverse_to_the_tolerance_and_grows_with_each_error(pair):
    _, _, w = single_step(pair)
    norm = error.error_norm(w)
    assert 0.0 < norm < 1e300
    w.tolerance *= 10.0
    assert error.error_norm(w) == pytest.approx(0.1 * norm)
    for name in ("q", "omega2"):
        rate = getattr(w.rates[5], name)
        setattr(w.rates[5], name, rate + 1e3)
        assert error.error_norm(w) > 10.0 * norm
        setattr(w.rates[5], name, rate)


def test_error_norm_is_the_root_mean_square_of_errors_over_scales():
    _, _, w = single_step(tableau.DOPRI5_ROW)
    row, count = tableau.DOPRI5_E_ROW, tableau.DOPRI5_LAST_STAGE + 1
    errors = []
    for n, scale in enumerate(w.scale.numbers):
        if scale > 0.0:
            rates = [w.rates[stage].numbers[n] for stage in range(count)]
            errors.append(w.step * tableau.weighted_sum(row, count, rates) / (w.tolerance * scale))
    assert len(errors) == 3  # q, omega2, omega3
    mean = sum(ratio * ratio for ratio in errors) / len(errors)
    assert error.error_norm(w) == pytest.approx(math.sqrt(mean), rel=1e-12)


def test_scale_of_link_2_includes_its_load_inertia():
    d, x, w = single_step(tableau.DOP853_ROW)
    free = w.scale.omega2
    x.output_state = 1.0
    error.write_scales(d, x, w)
    own = d.F_by_alpha1
    assert w.scale.omega2 / free == pytest.approx((own + d.J2) / (own + d.J2 + d.J3), rel=1e-12)


def test_scales_of_losses_are_those_of_work_and_impulse():
    _, _, w = single_step(tableau.DOP853_ROW, mesh_efficiency=0.95)
    assert w.scale.drive == w.scale.housing > 0.0
    assert w.scale.lost[error.MESH] == w.scale.lost[error.JOURNAL] == w.scale.work_in > 0.0


@pytest.mark.parametrize("order", [5.0, 8.0])
def test_next_step_has_the_error_of_the_safety_factor(order):
    for ratio in (0.3, 1.0, 2.5):
        factor = step_size.next_factor(ratio, order, 0.9)
        assert ratio * factor**order == pytest.approx(0.9**order)
    assert step_size.next_factor(0.0, order, 0.9) == step_size.MAX_FACTOR
    assert step_size.next_factor(math.nan, order, 0.9) == step_size.MIN_FACTOR


def test_pulses_limit_the_step():
    module = started("plain", PLANAR)
    d, x = module.derived, module.state
    step = step_size.longest_step(d, x, 1e3)
    assert step * d.harmonic * d.k * x.omega1 <= step_size.STEP_PHASE * (1.0 + 1e-12)


def test_step_over_many_radians_is_made_by_the_pair_of_order_8():
    energies = []
    for tolerance, steps in ((1e-3, 6), (1e-9, 36)):
        module = Module("plain").start(
            tolerance=tolerance, imbalance_mass=0.01, output_inertia=50.0, omega1=100.0, load_torque=1e-3
        )
        for _ in range(steps):
            module.advance(36.0 / (steps * module.derived.harmonic * module.derived.k * module["omega1"]))
        energies.append(module["energy_in"])
    assert energies[0] == pytest.approx(energies[1], rel=3e-4)


@pytest.mark.parametrize("phase, is_accepted", [(1.9, True), (2.1, False), (5.0, False)])
def test_pair_of_order_5_makes_a_step_of_two_radians_at_most(phase, is_accepted):
    d, x, w = single_step(tableau.DOPRI5_ROW, imbalance_mass=1e-4)
    w.tolerance = 1.0
    remaining = phase / (d.harmonic * d.k * (x.omega1 - x.omega2))
    assert step_size.try_short_step(d, x, w, remaining) == is_accepted


def test_step_with_an_energy_gain_is_repeated():
    """The error estimate of the step at 1.02 s passes by chance; the energy check finds it."""
    module = advanced(started("plain", OVERTAKING, tolerance=1e-5), 1.9)
    assert module["omega2"] == pytest.approx(195.6, rel=0.05)
    assert abs(module["energy_residual"]) < 1e-4 * module["energy_stored"]
    assert advanced(started("plain", OVERTAKING, tolerance=1e-8), 1.9)["omega2"] == pytest.approx(
        195.6097, rel=1e-5
    )


def test_energy_check_measures_the_gain_in_tolerances():
    d, x, w = single_step(tableau.DOP853_ROW, 1e-4)
    advance.copy_accelerations(x.now, d.machine)
    advance.finish_changes(d, x, w, 1.0, False)
    assert energy.energy_made(d, x, w) < 0.1
    gain = 20.0 * energy.MAX_ENERGY_MADE * w.tolerance * w.energy
    w.change.omega2 += gain / (d.J2 * x.omega2)
    assert energy.energy_made(d, x, w) > 1.0


def test_rounding_of_the_potential_energy_repeats_no_step(compiled):
    module = started(compiled, SCENES["bevel"], gravity=1e3, omega1=1e-3, load_torque=0.0)
    module.advance(0.5)
    assert module["rhs_evaluations"] < 5000
