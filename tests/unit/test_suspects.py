"""Suspects of a fit: how much they explain, as far as residuals are linear, and what is chance."""

import numpy as np
import pytest
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


def straight(values, estimated):
    """A fit of a mean, left over, its slope, and that of a trend."""
    left = Leftover(values - values.mean(), np.zeros(ROWS, dtype=np.int64), [estimated])
    return left, np.column_stack([np.ones(ROWS), np.linspace(-1.0, 1.0, ROWS)])


@pytest.mark.parametrize("estimated", [True, False])
def test_a_trend_is_found_with_its_error_and_its_evidence(estimated):
    left, slopes = straight(0.5 * noise(0) - 2.0 * np.linspace(-1.0, 1.0, ROWS), estimated)
    changes, rest = left.solved(slopes, (-10.0, 10.0))
    (low, high), error = left.ranges(rest, slopes, (-np.inf, np.inf))
    scatter = 0.5 if estimated else 1.0
    assert changes[1] == pytest.approx(2.0, abs=0.15)
    assert error == pytest.approx(scatter / np.sqrt(ROWS / 3.0), rel=0.1)
    assert -low[1] == pytest.approx(WITHIN * error)
    assert high == pytest.approx(WITHIN * scatter * np.sqrt([1.0 / ROWS, 3.0 / ROWS]), rel=0.1)
    assert left.evidence(rest) > 300.0
    before, after = (np.sum((values * left.weights(rest)) ** 2) for values in (left.values, rest))
    assert after == pytest.approx(ROWS if estimated else ROWS / 4.0, rel=0.1)
    assert before > 3.0 * after


def test_a_change_stays_within_its_limits_and_explains_nothing_at_them():
    left, slopes = straight(noise(0) - 2.0 * np.linspace(-1.0, 1.0, ROWS), True)
    changes, rest = left.solved(slopes, (-10.0, 0.0))
    assert changes[1] == 0.0
    assert left.evidence(rest) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("limits", [(-np.inf, 0.0), (-0.02, 0.3), (-np.inf, np.inf)])
def test_ranges_are_what_chi_squared_allows_within_the_limits_of_a_suspect(limits):
    slopes = np.column_stack([np.ones(ROWS), np.linspace(-0.5, 1.0, ROWS)])
    left = Leftover(noise(5), np.zeros(ROWS, dtype=np.int64), [False])
    changes, rest = left.solved(slopes, limits)
    ranges, _ = left.ranges(rest, slopes, (limits[0] - changes[1], limits[1] - changes[1]))
    # by brute force: of all lasts that the limits allow, the first that chi-squared allows
    lasts = np.linspace(max(limits[0], -1.0), min(limits[1], 1.0), 20_001)
    middle = np.mean(-left.values - np.outer(lasts, slopes[:, 1]), axis=1)
    least = [np.sum((left.values + slopes @ [a, b]) ** 2) for a, b in zip(middle, lasts, strict=True)]
    spare = np.sum(rest**2) + WITHIN**2 - np.array(least)
    width = np.sqrt(np.maximum(spare, 0.0) / ROWS)
    firsts = np.array([np.min((middle - width)[spare > 0.0]), np.max((middle + width)[spare > 0.0])])
    assert ranges[:, 0] + changes[0] == pytest.approx(firsts, abs=2e-3)
    assert ranges[:, 1] + changes[1] == pytest.approx(
        [lasts[spare > 0.0][0], lasts[spare > 0.0][-1]], abs=2e-3
    )


@pytest.mark.parametrize("following", [0.0, 0.6])
def test_of_chance_evidence_is_chi_squared_also_where_noise_follows_itself(following):
    found = []
    for seed in range(300):
        left, slopes = straight(noise(seed, following), True)
        found.append(left.evidence(left.solved(slopes, (-np.inf, np.inf))[1]))
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
    ],
)
def test_a_gain_of_another_unit_than_that_of_the_heading_is_told(gain, heading, words):
    si = {"rpm": "rad/s"}.get(heading, heading)
    table = Result.from_columns({"time": [0.0, 1.0], "one": [1.0, 2.0]}, {"one": si})
    data = Measurement(table, {"one": heading}, {}, np.ones((2, 1), dtype=bool))
    assert data.unit_by("one", gain) == words
