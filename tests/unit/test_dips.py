"""A freewheel that closes for a moment inside a step is not stepped over."""

import pytest
from scenes import advanced, started

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
