"""Statistics of a fit: profile likelihood, F-test, collinearity, identifiability."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import f, t

from inertia_module.common.examples import example
from inertia_module.fmi.results import Result
from inertia_module.scene import load_scene
from inertia_module.studies.axes import Free
from inertia_module.studies.candidates import collinearity, f_test, likelihood_ratio, released
from inertia_module.studies.least_squares import Problem
from inertia_module.studies.measurement import Measurement, autocorrelation, measurement
from inertia_module.studies.profile_likelihood import profile_end

ROWS = 400
TIME = np.linspace(0.0, 1.0, ROWS)


def noise(seed, correlation=0.0):
    random = np.random.default_rng(seed)
    values = random.normal(0.0, 1.0, ROWS)
    for n in range(1, ROWS):
        values[n] += correlation * values[n - 1]
    return values


def key(name, start, low=-np.inf, high=np.inf, size=1.0, physical=(-np.inf, np.inf)):
    return Free(
        name,
        "",
        low,
        high,
        start=start,
        nominal=start,
        size=size,
        has_range=np.isfinite(low),
        physical=physical,
    )


def problem(model, keys, values, estimated=False):
    """Problem of one column whose values a function of the keys computes."""
    table = Result.from_columns({"time": TIME, "one": values}, {"one": "1"})
    specified = {} if estimated else {"one": np.ones(ROWS)}
    data = Measurement(table, {"one": "1"}, specified, np.ones((ROWS, 1), dtype=bool))
    rig = SimpleNamespace(data=data, rejection="", computed=lambda point: model(**point)[:, None])
    return Problem(rig, tuple(keys), np.ones((ROWS, 1)), {})


def trend(mean, slope=0.0):
    return mean + slope * TIME


def decay(amplitude, rate):
    return amplitude * np.exp(-rate * TIME)


@pytest.mark.parametrize("estimated", [True, False])
def test_profile_of_a_linear_model_is_the_interval_of_students_t(estimated):
    keys = key("mean", 0.0), key("slope", 0.0)
    optimum = problem(trend, keys, 0.5 * noise(0) + trend(1.0, 2.0), estimated).minimise(np.zeros(2))
    optimum = optimum.with_estimated_noise()
    scatter = 0.5 if estimated else 1.0
    for number in (0, 1):
        half = t.isf(0.025, ROWS - 2) * optimum.deviations[number]
        for side in (-1, 1):
            end = profile_end(optimum, number, side)
            assert not end.open
            assert side * (end.value - optimum.point[number]) == pytest.approx(half, rel=0.04)
    assert optimum.deviations[1] == pytest.approx(scatter / np.sqrt(ROWS / 12.0), rel=0.1)


def test_profile_of_a_curved_model_is_its_likelihood():
    keys = key("amplitude", 5.0), key("rate", 3.0)
    optimum = problem(decay, keys, decay(3.0, 2.0) + noise(1)).minimise(np.array([5.0, 3.0]))
    limit = optimum.chi_squared + optimum.t_quantile**2

    def excess(rate):
        shape, values = decay(1.0, rate), optimum.problem.rig.data.values[:, 0]
        return np.sum((values - shape * (shape @ values) / (shape @ shape)) ** 2) - limit

    rate = optimum.point[1]
    expected = brentq(excess, 0.1 * rate, rate), brentq(excess, rate, 5.0 * rate)
    ends = [profile_end(optimum, 1, side).value for side in (-1, 1)]
    assert ends == pytest.approx(expected, rel=0.02)
    # A symmetric interval would be wrong.
    assert ends[1] - rate > 1.05 * (rate - ends[0])


def product(first, second):
    return first * second * TIME


@pytest.mark.parametrize("start", [0.6, 3.9])
def test_product_of_two_keys_is_not_identifiable_also_if_a_search_ends_at_a_bound(start):
    keys = key("first", start, 0.5, 4.0, 3.5), key("second", 20.0 / start, 1.0, 100.0, 99.0)
    optimum = problem(product, keys, 20.0 * TIME + 0.1 * noise(2)).minimise(np.array([start, 20.0 / start]))
    singular, directions = optimum.svd
    assert singular[-1] < optimum.t_quantile
    assert np.abs(directions[-1]).max() < 1.0
    assert all(profile_end(optimum, 0, side).open for side in (-1, 1))
    assert [profile_end(optimum, 0, side).value for side in (-1, 1)] == pytest.approx([0.5, 4.0])


def test_physical_limit_bounds_an_interval_but_a_range_does_not():
    for physical, is_open in (((0.0, np.inf), False), ((-1.0, np.inf), True)):
        keys = key("mean", 0.5), key("slope", 0.5, 0.0, 4.0, 4.0, physical)
        optimum = problem(trend, keys, trend(1.0) + noise(3)).minimise(np.array([0.5, 0.5]))
        end = profile_end(optimum, 1, -1)
        assert (end.value, end.open) == (0.0, is_open)


def test_f_test_is_the_change_of_chi_squared():
    values = trend(1.0, 0.5) + noise(4)
    mean = (
        problem(trend, [key("mean", 0.0)], values, estimated=True)
        .minimise(np.zeros(1))
        .with_estimated_noise()
    )
    both = released(mean, key("slope", 0.0, size=0.01))
    assert both is not None
    sums = [
        np.sum((values - np.polynomial.Polynomial.fit(TIME, values, degree)(TIME)) ** 2) for degree in (0, 1)
    ]
    assert likelihood_ratio(mean, both) == pytest.approx(ROWS * np.log(sums[0] / sums[1]), rel=0.1)
    expected = f.sf((sums[0] - sums[1]) / (sums[1] / (ROWS - 2)), 1, ROWS - 2)
    assert f_test(mean, both) == pytest.approx(expected, rel=0.5)


def test_likelihood_ratio_includes_the_change_of_the_prior():
    values = trend(1.0, 0.5) + 0.5 * noise(4)
    prior = dataclasses.replace(key("mean", 2.0), deviation=0.05)
    mean = dataclasses.replace(problem(trend, [prior], values), priors=(prior,)).minimise(np.ones(1))
    both = released(mean, key("slope", 0.0, size=0.01))
    # With a specified noise and independent residuals it is the decrease of chi-squared.
    assert abs(mean.residuals[-1] ** 2 - both.residuals[-1] ** 2) > 5.0
    assert likelihood_ratio(mean, both) == pytest.approx(mean.chi_squared - both.chi_squared, rel=0.1)


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_f_test_has_its_level_also_with_autocorrelated_noise(correlation):
    p_values = []
    for seed in range(200):
        values = trend(1.0) + noise(seed, correlation)
        mean = problem(trend, [key("mean", 0.0)], values, estimated=True).minimise(np.zeros(1))
        p_values.append(f_test(mean, released(mean.with_estimated_noise(), key("slope", 0.0, size=0.01))))
    assert np.mean(np.array(p_values) < 0.05) < 0.1


def test_collinearity_index_of_a_replaceable_key():
    def model(mean, slope=0.0, same=1.0):
        return mean * same + slope * TIME

    optimum = problem(model, [key("mean", 2.0)], model(2.0) + noise(6)).minimise(np.array([2.0]))
    assert collinearity(optimum, released(optimum, key("same", 1.0, size=0.01))) > 1e3
    # The index of a constant and a ramp is 2.
    assert collinearity(optimum, released(optimum, key("slope", 0.0, size=0.01))) == pytest.approx(
        2.0, rel=0.01
    )


def test_first_row_has_no_mean_of_a_step_before_it():
    time = np.array([0.0, 0.1, 0.2])
    table = Result.from_columns({"time": time, "output_torque_mean": time, "torque_peak": time})
    counted = measurement(table, load_scene(example("reference"))).counted
    assert counted.tolist() == [[False, True], [True, True], [True, True]]


def test_autocorrelation_from_row_to_row():
    assert autocorrelation(noise(3, 0.6)) == pytest.approx(0.6, abs=0.1)
    assert abs(autocorrelation(noise(3))) < 0.1
    assert autocorrelation(np.ones(5)) == 0.0


@pytest.mark.parametrize(
    "gain, heading, words",
    [
        (9.55, "rad/s", "its numbers are in rpm, not in rad/s"),
        (0.1047, "rpm", "its numbers are in rad/s, not in rpm"),
        (3.6, "m/s", "its numbers are in km/h, not in m/s"),
        (5.95, "rpm", "its numbers are in deg/s, not in rpm"),
        (1.0, "rad/s", ""),
        (8.0, "rad/s", ""),
        (9.55, "N.m", ""),
        (60.0, "1", ""),
    ],
)
def test_gain_of_a_wrong_unit_suggests_the_unit(gain, heading, words):
    si = {"rpm": "rad/s"}.get(heading, heading)
    table = Result.from_columns({"time": [0.0, 1.0], "one": [1.0, 2.0]}, {"one": si})
    data = Measurement(table, {"one": heading}, {}, np.ones((2, 1), dtype=bool))
    assert data.unit_hint("one", gain) == words
