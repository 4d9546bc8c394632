"""Suspects of a fit: how much they explain, as far as residuals are linear, and what is chance."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import chi2

from inertia_module.harness.results import Result
from inertia_module.jobs.measurement import Measurement
from inertia_module.jobs.suspects import WITHIN, Leftover, lag_one

ROWS = 400


def noise(seed, following=0.0):
    rng = np.random.default_rng(seed)
    values = rng.normal(0.0, 1.0, ROWS)
    for n in range(1, ROWS):
        values[n] += following * values[n - 1]
    return values


def straight(values, estimated, last=(-np.inf, np.inf)):
    """A fit of a mean, left over; the slopes of it and of a trend, and how far both go within limits."""
    left = Leftover(values - values.mean(), np.zeros(ROWS, dtype=np.int64), [estimated])
    slopes = np.column_stack([np.ones(ROWS), np.linspace(-0.5, 1.0, ROWS)])
    limits = (-np.inf, last[0]), (np.inf, last[1])
    return left, slopes, lsq_linear(slopes, -left.values, limits).x


@pytest.mark.parametrize("estimated", [True, False])
def test_a_trend_has_its_error_its_range_and_its_evidence(estimated):
    left, slopes, changes = straight(0.5 * noise(0) - 2.0 * np.linspace(-0.5, 1.0, ROWS), estimated)
    rest = left.values + slopes @ changes
    (low, high), error = left.ranges(rest, slopes, (-np.inf, np.inf))
    scatter = 0.5 if estimated else 1.0
    assert error == pytest.approx(scatter / (1.5 * np.sqrt(ROWS / 12.0)), rel=0.1)
    assert (-low[1], high[1]) == pytest.approx((WITHIN * error, WITHIN * error))
    assert left.evidence(rest) > 300.0
    before, after = (np.sum((values * left.weights(rest)) ** 2) for values in (left.values, rest))
    assert after == pytest.approx(ROWS if estimated else ROWS / 4.0, rel=0.1)
    assert before > 2.0 * after


@pytest.mark.parametrize("limits", [(-np.inf, 0.0), (-0.02, 0.3), (-np.inf, np.inf)])
def test_ranges_are_what_chi_squared_allows_within_the_limits_of_a_suspect(limits):
    left, slopes, changes = straight(noise(5), False, limits)
    rest = left.values + slopes @ changes
    ranges, _ = left.ranges(rest, slopes, (limits[0] - changes[1], limits[1] - changes[1]))
    # by brute force: of all trends that the limits allow, the means that chi-squared allows
    trends = np.linspace(max(limits[0], -1.0), min(limits[1], 1.0), 20_001)
    means = -np.outer(trends, slopes[:, 1]).mean(axis=1)
    least = [np.sum((left.values + slopes @ pair) ** 2) for pair in zip(means, trends, strict=True)]
    spare = np.sum(rest**2) + WITHIN**2 - np.array(least)
    means, width, trends = means[spare > 0.0], np.sqrt(spare[spare > 0.0] / ROWS), trends[spare > 0.0]
    expected = np.array([[np.min(means - width), trends[0]], [np.max(means + width), trends[-1]]])
    assert ranges + changes == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("following", [0.0, 0.6])
def test_of_chance_evidence_is_chi_squared_also_where_noise_follows_itself(following):
    found = []
    for seed in range(300):
        left, slopes, changes = straight(noise(seed, following), True)
        found.append(left.evidence(left.values + slopes @ changes))
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
