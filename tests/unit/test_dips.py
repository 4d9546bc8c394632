"""A freewheel that opens or closes for a moment inside a step is not stepped over."""

import itertools

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


# held, the torque that would release link 2 falls through zero three times within a radian of its phase
THREE_ZEROS = {
    "z2": 19,
    "z16": 31,
    "z17": 22,
    "z6": 22,
    "wheel_radius": 0.27916,
    "b": 0.48044,
    "c": 1.02694,
    "epsilon": -4.81607,
    "gamma": -3.69265,
    "imbalance_mass": 1.11706,
    "satellites": 3,
    "link2_inertia": 0.000115186,
    "output_inertia": 0.0193366,
    "omega_out_start": 5.713833,
    "drive_angle_start": 6.491726,
    "omega1": -51.10686,
    "load_torque": 0.0,
}


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_first_of_three_zeros_releases_link_2(compiled, tolerance):
    one = advanced(started(compiled, THREE_ZEROS, tolerance=tolerance), 0.10453)
    many = advanced(started(compiled, THREE_ZEROS, tolerance=tolerance), *[1.0453e-4] * 1000)
    for name in ("drive_angle", "omega2", "omega_out"):
        assert one[name] == pytest.approx(many[name], rel=tolerance)


def test_release_among_close_zeros_is_found_as_by_short_steps(compiled):
    for start, b, c in itertools.product((0.0, 0.4, 3.6), (0.476, 0.48, 0.486), (1.005, 1.027, 1.045)):
        scene = (THREE_ZEROS, {"drive_angle_start": start, "b": b, "c": c})
        one = advanced(started(compiled, *scene), 0.1)
        many = advanced(started(compiled, *scene), *[1e-3] * 100)
        assert one["omega2"] == pytest.approx(many["omega2"], abs=1e-4)
