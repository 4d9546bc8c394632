"""The satellite gears' own inertia in motion: likeness, extremes, the mean motion.

Its motion is held to Lagrange's equations in test_reference.py, its equations to the multibody engine in
test_multibody.py, its loads in test_loads.py.
"""

import math

import pytest
from scenes import DRIVES, GEARS, LEVELS, SCENES, advanced, passed, started

# where torques given by the inertia of link 1 and drives come in
SHARED = (
    *("omega2", "omega_out", "input_speed", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("energy_in", "energy_out", "energy_stored", "torque_ripple", "drive_angle", "contact_switches"),
)


@pytest.fixture(params=DRIVES)
def drive(request):
    return request.param


@pytest.fixture(params=LEVELS)
def level(request, drive):
    if (drive, request.param) == ("torque", "kinematic"):
        pytest.skip("the motion is prescribed")
    return LEVELS[request.param]


def assert_alike(one, other):
    for step in (0.0, 0.004, 0.03, 0.05):
        for module in (one, other) if step else ():
            module.set_rates(omega1=0.0 if module["drive"] else 300.0)
            module.advance(step)
        expected = [one[name] for name in SHARED]
        assert [other[name] for name in SHARED] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_planar_gears_are_part_of_the_drives(compiled, drive, level):
    values = {**DRIVES[drive]["planar"], **level, "modules": 2}
    apart = started(compiled, values, drive_inertia=1e-3, **GEARS)
    assert_alike(started(compiled, values, drive_inertia=1e-3 + 2 * 3 * 0.004), apart)


def test_three_bevel_gears_weigh_on_link_1_and_the_drives_alone(compiled, drive, level):
    # of three evenly spread about the axis of the drive, in link 1 at rest and in drives at rest
    values = {**DRIVES[drive]["bevel"], **level, "satellites": 3, "shaft_angle": 1.1}
    own, across = GEARS.values()
    s, sine, cosine = 34 / 20, math.sin(1.1), math.cos(1.1)
    about_x = across + (own - across) * sine**2 / 2
    about_q = own * (s + cosine) ** 2 + across * sine**2
    inertias = {"input_inertia": values.get("input_inertia", 0.0) + 3 * about_x, "drive_inertia": 3 * about_q}
    assert_alike(started(compiled, {**values, **inertias}), started(compiled, values, **GEARS))


@pytest.mark.parametrize("satellites", [1, 2])
def test_mean_motion_is_that_of_the_rigid_module(compiled, drive, satellites):
    # with the same map for both the gears would not be in it: it has to be of these parameters
    heavy = {**DRIVES[drive]["bevel"], "satellites": satellites, "output_inertia": 20.0, "load_torque": 3.0}
    if drive == "torque":
        heavy |= {"input_inertia": 5.0}
    means = []
    for gear in ({}, {"satellite_inertia": 0.02, "satellite_transverse_inertia": 0.012}):
        mean, rigid = (started(compiled, heavy, gear, fidelity=fidelity) for fidelity in (1, 2))
        for module in (mean, rigid):
            advanced(module, *[4.0] * 10)
        assert mean["omega_out"] == pytest.approx(rigid["omega_out"], abs=0.01 * rigid["input_speed"])
        means.append(mean["omega_out"])
    assert abs(means[1] - means[0]) > 0.03 * means[0]


def test_gears_alone_keep_link_2_from_having_no_inertia(compiled):
    one = advanced(started(compiled, SCENES["bevel"], GEARS, link2_inertia=0.0, tolerance=1e-9), 0.1)
    assert one["contact_switches"] > 0.0
    assert abs(one["energy_residual"]) < 1e-6 * passed(one)


def test_transverse_inertia_means_nothing_where_the_axes_are_parallel(compiled):
    one, other = (
        advanced(started(compiled, SCENES["planar"], satellite_transverse_inertia=jt), 0.1)
        for jt in (0.0, 0.5)
    )
    assert bytes(one.state) == bytes(other.state)
