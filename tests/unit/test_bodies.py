"""The satellite gears' own inertia in motion: Lagrange's equations, likeness, extremes, every fidelity.

Its equations against the multibody engine are in test_multibody.py, its loads in test_loads.py too.
"""

import math

import pytest
from scenes import DRIVEN, ELASTIC, SCENES, advanced, reference, started

from studies.reference.cases import OMEGA1, OMEGA2, OMEGA3

GEAR = {"satellite_inertia": 0.004, "satellite_transverse_inertia": 0.003}
DRIVES = {"speed": SCENES, "torque": DRIVEN}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4},
    "averaged": {"fidelity": 1},
    "rigid": {},
    "elastic": ELASTIC,
    "timestepping": {"method": 1, "max_step": 1e-4},
    "elastic timestepping": {**ELASTIC, "method": 1, "max_step": 1e-4},
}
# where torques given by the inertia of link 1 and drives come in
SHARED = (
    *("omega2", "omega_out", "input_speed", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("energy_in", "energy_out", "energy_stored", "torque_ripple", "drive_angle", "contact_switches"),
)


def largest_energy(one):
    return max(abs(one[name]) for name in ("energy_in", "energy_out", "energy_stored"))


@pytest.fixture(params=SCENES)
def layout(request):
    return request.param


@pytest.fixture(params=DRIVES)
def drive(request):
    return request.param


@pytest.fixture(params=LEVELS)
def level(request, drive):
    if (drive, request.param) == ("torque", "kinematic"):
        pytest.skip("the motion is prescribed")
    return LEVELS[request.param]


@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
@pytest.mark.parametrize(
    "gears",
    [
        {"satellites": 1, **GEAR},
        {"satellites": 2, **GEAR},
        {"satellites": 3, **GEAR},
        {"satellites": 1, "satellite_inertia": 1e-9, "satellite_transverse_inertia": 1e-9},
        {"satellites": 1, "satellite_inertia": 0.3, "satellite_transverse_inertia": 0.2},
        {"satellites": 2, "satellite_inertia": 0.02, "imbalance_mass": 0.0},
        {"satellites": 1, "satellite_transverse_inertia": 0.02},
    ],
    ids=["1", "2", "3", "tiny", "dominant", "without an imbalance", "long"],
)
def test_motion_is_that_of_lagranges_equations(compiled, layout, drive, output, gears):
    values = {**DRIVES[drive][layout], **output, **gears, "drive_angle_start": 0.7}
    found = started(compiled, values, tolerance=1e-10)
    for time in (0.02, 0.05):
        advanced(found, time - 0.02 * (time > 0.02))
        exact = reference(values, time)
        speeds = [found[name] for name in ("input_speed", "omega2", "omega_hub")]
        assert speeds == pytest.approx(exact.state[[OMEGA1, OMEGA2, OMEGA3]], abs=1e-7 * found["input_speed"])
        assert found["energy_stored"] == pytest.approx(exact.energy(), rel=1e-7)
        assert abs(found["energy_residual"]) < 1e-8 * largest_energy(found)


def assert_alike(one, other):
    for step in (0.0, 0.004, 0.03, 0.05):
        for module in (one, other) if step else ():
            module.set_rates(omega1=0.0 if module["drive"] else 300.0)
            module.advance(step)
        expected = [one[name] for name in SHARED]
        assert [other[name] for name in SHARED] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_planar_gears_are_part_of_the_drives(compiled, drive, level):
    values = {**DRIVES[drive]["planar"], **level, "modules": 2}
    apart = started(compiled, values, drive_inertia=1e-3, **GEAR)
    assert_alike(started(compiled, values, drive_inertia=1e-3 + 2 * 3 * 0.004), apart)


def test_three_bevel_gears_weigh_on_link_1_and_the_drives_alone(compiled, drive, level):
    # of three evenly spread about the axis of the drive, in link 1 at rest and in drives at rest
    values = {**DRIVES[drive]["bevel"], **level, "satellites": 3, "shaft_angle": 1.1}
    own, across = GEAR.values()
    s, sine, cosine = 34 / 20, math.sin(1.1), math.cos(1.1)
    about_x = across + (own - across) * sine**2 / 2
    about_q = own * (s + cosine) ** 2 + across * sine**2
    inertias = {"input_inertia": values.get("input_inertia", 0.0) + 3 * about_x, "drive_inertia": 3 * about_q}
    assert_alike(started(compiled, {**values, **inertias}), started(compiled, values, **GEAR))


@pytest.mark.parametrize("satellites", [1, 2, 3])
def test_audit_closes_at_every_level(compiled, layout, drive, level, satellites):
    scene = {**DRIVES[drive][layout], "satellites": satellites}
    one = started(compiled, scene, level, GEAR, input_hold=1, tolerance=1e-8)
    bound = 2e-2 if one["method"] else 1e-5 if one["fidelity"] == 1 else 1e-6
    for n in range(20):
        advanced(one, 0.01, omega1=scene["omega1"] - 2.0 * n, load_torque=10.0 if n % 10 < 5 else -3.0)
        assert abs(one["energy_residual"]) < bound * largest_energy(one)
        if one["method"]:
            assert one["energy_residual"] > -1e-12 * largest_energy(one)


def test_fixed_steps_converge(compiled, layout, drive):
    values = {**DRIVES[drive][layout], **GEAR, "satellites": 2}
    exact = advanced(started(compiled, values, tolerance=1e-10), 0.05)
    errors = []
    for step in (8e-4, 5e-5):
        coarse = advanced(started(compiled, values, method=1, max_step=step), 0.05)
        off = (abs(coarse[name] - exact[name]) for name in ("input_speed", "omega2", "omega_out"))
        errors.append(max(off) / exact["input_speed"])
    assert errors[1] < max(errors[0] / 50.0, 1e-6)


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
    one = advanced(started(compiled, SCENES["bevel"], GEAR, link2_inertia=0.0, tolerance=1e-9), 0.1)
    assert one["contact_switches"] > 0.0
    assert abs(one["energy_residual"]) < 1e-6 * largest_energy(one)


def test_transverse_inertia_means_nothing_where_the_axes_are_parallel(compiled):
    one, other = (
        advanced(started(compiled, SCENES["planar"], satellite_transverse_inertia=jt), 0.1)
        for jt in (0.0, 0.5)
    )
    assert bytes(one.state) == bytes(other.state)
