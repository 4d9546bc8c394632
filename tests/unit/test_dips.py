"""A freewheel that closes for a moment inside a step is not stepped over."""

import pytest
from scenes import advanced, started

from inertia_module.kernel import search

# link 2 leaves the shaft at its own speed, so its slope over the shaft starts at zero, and dips to rest
DIP = {
    "omega1": 11.410121749714413,
    "z17": 36,
    "z6": 48,
    "shaft_angle": 1.4167520990887148,
    "a": 1.0,
    "b": 0.40330594364089606,
    "gamma": -1.261574699342242,
    "imbalance_mass": 0.8225726448583082,
    "satellites": 2,
    "link2_inertia": 0.00017444423393536806,
    "output_inertia": 1.1993859597651855,
}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_dip_with_zero_slope_at_its_beginning_is_found(compiled, tolerance):
    long_steps = advanced(started(compiled, DIP, tolerance=tolerance), 1.75)
    short_steps = advanced(started(compiled, DIP, tolerance=tolerance, max_step=1e-4), 1.75)
    assert long_steps["contact_switches"] == short_steps["contact_switches"]
    assert long_steps["omega_out"] == pytest.approx(short_steps["omega_out"], abs=20 * tolerance)


@pytest.mark.parametrize("place", [0.13, 0.4, 0.77])
@pytest.mark.parametrize("width", [1e-2, 1e-4])
@pytest.mark.parametrize("skew", [0.0, 1.0])
def test_narrow_dip_of_a_guard_is_found_where_it_begins(monkeypatch, place, width, skew):
    def guard(*arguments):
        """A parabola below zero by so much about its place, skewed by a factor 1 + skew t^3."""
        t = arguments[-1]
        parabola, factor = (t - place) ** 2 - width**2, 1.0 + skew * t**3
        return factor * parabola, 3.0 * skew * t**2 * parabola + factor * 2.0 * (t - place)

    monkeypatch.setattr(search, "guard_inside", guard)
    found = search.first_crossing(None, None, None, 0, 1e-15, 0.0, 1.0, 1)
    assert found == pytest.approx(place - width, abs=1e-9)
