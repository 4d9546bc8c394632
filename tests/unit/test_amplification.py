"""The added-mass limit in theory: known limits, and the polynomials against the recurrence itself."""

import math

import numpy as np
import pytest

from inertia_module.cosimulation import SCHEMES, ErrorControl, Scheme, amplification, inertia_limit
from inertia_module.cosimulation.shaft import SHAFT_SCHEMES, ShaftScheme, growth

LIMITS = {
    "mean jacobi held": 1.0,
    "mean engine first held": 1.0,
    "mean engine first ramp": 1.0,
    "mean module first held": 1.0,
    "mean module first ramp": 1.0 / 3.0,
    "mean jacobi ramp": math.sqrt(2.0) - 1.0,
    "mean engine first average": 2.0,
    "instantaneous module first ramp": 2.0,
    "inertia engine first ramp": math.inf,
    "implicit ramp": math.inf,
}


@pytest.mark.parametrize("name", LIMITS)
def test_limits_of_the_inertia_ratio(name):
    scheme = SCHEMES[name]
    share = 1.0 if scheme.correction == "inertia" else 0.0
    assert inertia_limit(scheme, share) == pytest.approx(LIMITS[name], rel=1e-6)


def test_half_the_interface_inertia_is_enough_for_every_engine():
    scheme = SCHEMES["inertia engine first ramp"]
    assert math.isinf(inertia_limit(scheme, 0.5))
    assert inertia_limit(scheme, 0.4) == pytest.approx(5.0, rel=1e-6)  # r - 0.4 r = 1 + 0.4 r


def test_growth_is_minus_the_ratio_whatever_the_step():
    assert amplification(SCHEMES["mean module first held"], 0.7) == pytest.approx(0.7)
    assert amplification(SCHEMES["mean jacobi held"], 0.49) == pytest.approx(0.7)


@pytest.mark.parametrize(
    "values, words",
    [
        ({"order": "both"}, "order = 'both' is refused: allowed is jacobi, engine first, module first"),
        ({"torque": "instantaneous", "correction": "inertia"}, "instantaneous torque"),
        ({"order": "jacobi", "speed": "average"}, "allowed is engine first"),
        ({"order": "jacobi", "correction": "implicit"}, "implicit correction is refused"),
        ({"correction": "implicit", "iterations": 0}, "iterations = 0 is refused"),
    ],
)
def test_schemes_that_make_no_sense_are_refused(values, words):
    with pytest.raises(ValueError, match=words):
        Scheme(**values)


@pytest.mark.parametrize("name", ["mean, jacobi", "mean, module first", "mean, shaft first"])
def test_mean_torque_of_an_undamped_shaft_makes_it_grow_at_any_step(name):
    assert growth(SHAFT_SCHEMES[name], 0.01) > 1.0 + 1e-4


def test_mean_torque_needs_damping_of_half_the_stiffness_times_the_step():
    scheme = SHAFT_SCHEMES["mean, shaft first"]
    z = 0.1
    assert growth(scheme, z, 0.49 * z) > 1.0
    assert growth(scheme, z, 0.51 * z) < 1.0


@pytest.mark.parametrize(
    "scheme, limit",
    [(ShaftScheme(), 4.0), (ShaftScheme(derivatives=True), 4.0), (SHAFT_SCHEMES["implicit"], 12.0)],
)
def test_instantaneous_torque_module_first_neither_grows_nor_shrinks_up_to_its_limit(scheme, limit):
    for z in np.linspace(0.01, 0.99, 9) * limit:
        assert growth(scheme, float(z)) == pytest.approx(1.0, abs=1e-9)
    assert growth(scheme, 1.01 * limit) > 1.05


def test_step_shrinks_with_the_error_and_keeps_within_its_limits():
    control = ErrorControl(1e-4, shortest=1e-4, longest=1e-2)
    assert control.next_step(1e-3, 1.0, 1.0) == pytest.approx(0.9e-3)
    assert control.next_step(1e-3, 100.0, 1.0) < control.next_step(1e-3, 2.0, 1.0) < 1e-3
    assert control.next_step(1e-3, 1e-9, 1e-9) == pytest.approx(1.5e-3)
    assert control.next_step(1e-4, 1e9, 1e9) == 1e-4
    assert control.next_step(1e-2, 0.0, 0.0) == 1e-2
    with pytest.raises(ValueError, match=r"tolerance = 0\.0 is refused"):
        ErrorControl(0.0)
    with pytest.raises(ValueError, match=r"shortest = 1 s is refused"):
        ErrorControl(1e-3, shortest=1.0)
