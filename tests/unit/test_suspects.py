"""Suspects of a fit: how much they explain, as far as residuals are linear, and what is chance."""

import numpy as np
import pytest
from scipy.stats import chi2

from inertia_module.jobs.suspects import Leftover, lag_one, wrong_unit

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
    changes, spread, rest = left.solved(slopes, (-10.0, 10.0))
    scatter = 0.5 if estimated else 1.0
    assert changes[1] == pytest.approx(2.0, abs=0.15)
    assert np.sqrt(spread[1, 1]) == pytest.approx(scatter / np.sqrt(ROWS / 3.0), rel=0.1)
    assert left.evidence(rest) > 300.0
    before, after = (left.chi_squared(values, left.scatter(rest)) for values in (left.values, rest))
    assert after == pytest.approx(ROWS if estimated else ROWS / 4.0, rel=0.1)
    assert before > 3.0 * after


def test_a_change_stays_within_its_limits_and_explains_nothing_at_them():
    left, slopes = straight(noise(0) - 2.0 * np.linspace(-1.0, 1.0, ROWS), True)
    changes, _, rest = left.solved(slopes, (-10.0, 0.0))
    assert changes[1] == 0.0
    assert left.evidence(rest) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("following", [0.0, 0.6])
def test_of_chance_evidence_is_chi_squared_also_where_noise_follows_itself(following):
    found = []
    for seed in range(300):
        left, slopes = straight(noise(seed, following), True)
        found.append(left.evidence(left.solved(slopes, (-np.inf, np.inf))[2]))
    # without the autocorrelation it would be four times as much at 0.6
    assert np.mean(found) == pytest.approx(1.0, abs=0.3)
    assert np.mean(np.array(found) > chi2.isf(0.05, 1)) < 0.09


def test_autocorrelation_from_row_to_row():
    assert lag_one(noise(3, 0.6)) == pytest.approx(0.6, abs=0.1)
    assert abs(lag_one(noise(3))) < 0.1
    assert lag_one(np.ones(5)) == 0.0


@pytest.mark.parametrize(
    "gain, unit, words",
    [
        (9.55, "rad/s", "its numbers are in rpm, not in rad/s"),
        (0.1047, "rad/s", "its numbers are in rad/s, not in rpm"),
        (3.6, "m/s", "its numbers are in km/h, not in m/s"),
        (5.95, "rad/s", "its numbers are in deg/s, not in rpm"),
        (1.0, "rad/s", ""),
        (8.0, "rad/s", ""),
        (9.55, "N.m", ""),
    ],
)
def test_a_gain_of_another_unit_is_told(gain, unit, words):
    assert wrong_unit(gain, unit) == words
