"""Suspects of a fit: how much they explain, as far as residuals are linear, and what is chance."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import chi2

from inertia_module.harness.results import Result
from inertia_module.jobs.axes import Free
from inertia_module.jobs.least_squares import End, Problem
from inertia_module.jobs.measurement import Measurement, lag_one
from inertia_module.jobs.suspects import beside

ROWS = 400
# of normal noise in standard errors: 95 %
WITHIN = 1.96


def noise(seed, following=0.0):
    rng = np.random.default_rng(seed)
    values = rng.normal(0.0, 1.0, ROWS)
    for n in range(1, ROWS):
        values[n] += following * values[n - 1]
    return values


def straight(values, estimated, last=(-np.inf, np.inf)):
    """Ends of a fit of a mean, and of that and a trend within limits, to values of one column."""
    time, unknown = np.arange(float(ROWS)), {"start": 0.0, "size": 1.0}
    table = Result.from_columns({"time": time, "one": values}, {"one": "1"})
    noise = {} if estimated else {"one": np.ones(ROWS)}
    rig = SimpleNamespace(data=Measurement(table, {"one": "1"}, noise, np.ones((ROWS, 1), dtype=bool)))
    keys = (Free("mean", "", -np.inf, np.inf, **unknown), Free("trend", "", *last, **unknown))
    slopes = np.column_stack([np.ones(ROWS), np.linspace(-0.5, 1.0, ROWS)])
    ends = []
    for free in (keys[:1], keys):
        part = slopes[:, : len(free)]
        point = lsq_linear(part, -values, np.transpose([(key.low, key.high) for key in free])).x
        ends.append(End(Problem(rig, free, np.ones((ROWS, 1))), point, values + part @ point, part, True))
    return ends


@pytest.mark.parametrize("estimated", [True, False])
def test_a_trend_has_its_error_its_range_and_its_evidence(estimated):
    mean, both = straight(0.5 * noise(0) - 2.0 * np.linspace(-0.5, 1.0, ROWS), estimated)
    suspect = beside(mean, both)
    (low, high), error = both.ranges["trend"], both.errors["trend"]
    scatter = 0.5 if estimated else 1.0
    assert error == pytest.approx(scatter / (1.5 * np.sqrt(ROWS / 12.0)), rel=0.1)
    assert np.array([suspect.value - low, high - suspect.value]) == pytest.approx(WITHIN * error, rel=5e-3)
    assert suspect.evidence > 300.0
    before, after = suspect.chi_squared
    assert after == pytest.approx(ROWS if estimated else ROWS / 4.0, rel=0.1)
    assert before > 2.0 * after


@pytest.mark.parametrize("limits", [(-np.inf, 0.0), (-0.02, 0.3), (-np.inf, np.inf)])
def test_ranges_are_what_chi_squared_allows_within_the_limits_of_a_suspect(limits):
    values = noise(5)
    _, both = straight(values, False, limits)
    slopes = both.slopes
    # by brute force: of all trends that the limits allow, the means that chi-squared allows
    trends = np.linspace(max(limits[0], -1.0), min(limits[1], 1.0), 20_001)
    means = -(np.outer(trends, slopes[:, 1]) + values).mean(axis=1)
    least = [np.sum((values + slopes @ pair) ** 2) for pair in zip(means, trends, strict=True)]
    spare = both.chi_squared + WITHIN**2 - np.array(least)
    means, width, trends = means[spare > 0.0], np.sqrt(spare[spare > 0.0] / ROWS), trends[spare > 0.0]
    expected = np.array([[np.min(means - width), np.max(means + width)], [trends[0], trends[-1]]])
    assert np.array(list(both.ranges.values())) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("following", [0.0, 0.6])
def test_of_chance_evidence_is_chi_squared_also_where_noise_follows_itself(following):
    found = [beside(*straight(noise(seed, following), True)).evidence for seed in range(300)]
    # without the autocorrelation it would be four times as much at 0.6
    assert np.mean(found) == pytest.approx(1.0, abs=0.3)
    assert np.mean(np.array(found) > chi2.isf(0.05, 1)) < 0.09


def test_autocorrelation_from_row_to_row():
    assert lag_one(noise(3, 0.6)) == pytest.approx(0.6, abs=0.1)
    assert abs(lag_one(noise(3))) < 0.1
    assert lag_one(np.ones(5)) == 0.0


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
def test_a_gain_of_another_unit_than_that_of_the_heading_is_told(gain, heading, words):
    si = {"rpm": "rad/s"}.get(heading, heading)
    table = Result.from_columns({"time": [0.0, 1.0], "one": [1.0, 2.0]}, {"one": si})
    data = Measurement(table, {"one": heading}, {}, np.ones((2, 1), dtype=bool))
    assert data.unit_by("one", gain) == words
