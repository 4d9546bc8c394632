"""What has to hold whatever the numbers: scaling, mirror image, likeness, period."""

import math
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import FREEWHEELS, GEARS, TWO_PI, advanced, drive_angle, motions, started

TOLERANCE = 1e-10
SPEEDS = ["omega1", "omega2", "omega_out"]
TORQUES = [
    *("input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("input_torque_mean", "output_torque_mean", "torque_ripple"),
]
ENERGIES = ["energy_in", "energy_out", "energy_stored"]
# where torques given by the inertia of link 1 and drives come in
SHARED = (
    *("omega2", "omega_out", "input_speed", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("energy_in", "energy_out", "energy_stored", "torque_ripple", "drive_angle", "contact_switches"),
)
ACCELERATIONS = ["imbalance_acceleration", *(f"imbalance_acceleration_{axis}" for axis in "xyz")]


def assert_times(other, one, names, factor, rel=1e-7):
    """The values of other are those of one times the factor."""
    values = {name: factor * one[name] for name in names}
    scale = max(abs(value) for value in values.values())
    assert {name: other[name] for name in names} == pytest.approx(values, rel=rel, abs=rel * scale)


def after(kernel, duration, *scenes):
    """A module after a while."""
    return advanced(started(kernel, *scenes, tolerance=TOLERANCE), duration)


@given(mass=st.floats(1e-3, 1e3), length=st.floats(0.1, 10.0), duration=st.floats(1e-3, 0.3))
def test_heavier_and_longer_parts_need_only_more_torque(compiled, scene, mass, length, duration):
    inertia = mass * length**2
    base = {"link2_inertia": 0.005, "output_inertia": 0.5, "imbalance_mass": 1.0}
    sizes = {"wheel_radius": 0.08, "sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": 0.02}
    larger = {name: inertia * base[name] for name in ("link2_inertia", "output_inertia")}
    larger |= {name: length * size for name, size in sizes.items()}
    larger |= {"imbalance_mass": mass, "load_torque": inertia * scene["load_torque"]}
    one = after(compiled, duration, scene, base, sizes)
    other = after(compiled, duration, scene, larger)
    assert other["contact_mode"] == one["contact_mode"]
    assert_times(other, one, SPEEDS, 1.0)
    assert_times(other, one, ACCELERATIONS, length)
    for names in (TORQUES, ENERGIES):
        assert_times(other, one, names, inertia)


@pytest.mark.parametrize("satellites", [1, 2, 3])
@given(omega1=st.floats(1.0, 200.0), load=st.floats(-20.0, 20.0), duration=st.floats(1e-3, 0.1))
def test_mechanism_without_freewheels_has_a_mirror_image(compiled, scene, satellites, omega1, load, duration):
    values = {**scene, **FREEWHEELS["no freewheel"], "satellites": satellites}
    one, other = (
        advanced(
            after(compiled, duration, values, {"omega1": sign * omega1, "load_torque": sign * load}), duration
        )
        for sign in (1.0, -1.0)
    )
    assert_times(other, one, SPEEDS, -1.0, rel=1e-9)
    assert_times(other, one, [name for name in TORQUES if name != "torque_ripple"], -1.0, rel=1e-8)
    assert drive_angle(other) == pytest.approx(-drive_angle(one), rel=1e-9)
    assert_times(other, one, [*ENERGIES, "torque_ripple", "imbalance_acceleration"], 1.0)


def equal_modules(mass, count):
    """Equal modules and one with imbalances of all their mass."""
    drive = {"drive_inertia": 0.001}
    return {**drive, "modules": count}, {**drive, "imbalance_mass": count * mass}


def many_satellites(mass, count):
    """Three satellites and more of the same mass in all."""
    return (
        {"satellites": 3, "imbalance_mass": mass},
        {"satellites": count + 1, "imbalance_mass": 3.0 * mass / (count + 1)},
    )


@pytest.mark.parametrize("alike", [equal_modules, many_satellites])
@given(count=st.integers(2, 20), duration=st.floats(1e-3, 0.3))
def test_imbalances_of_one_mass_in_all_act_alike(compiled, scene, alike, count, duration):
    one, other = (
        after(compiled, duration, scene, values) for values in alike(scene.get("imbalance_mass", 1.0), count)
    )
    assert_times(other, one, [*SPEEDS, *TORQUES, *ENERGIES, *ACCELERATIONS], 1.0, rel=1e-9)
    assert drive_angle(other) == pytest.approx(drive_angle(one), rel=1e-9)
    # of several modules what is across the axis balances
    for on_mount, axis in product(("force", "moment"), "x" if alike is equal_modules else "xyz"):
        name = f"shaking_{on_mount}_{axis}"
        assert other[name] == pytest.approx(one[name], abs=1e-9 * one["satellite_force"]), name


@motions(added=("ideal",), missing=())
def test_gears_weigh_on_link_1_and_the_drives_alone(compiled, scene):
    """Planar ones turn with the drives; three bevel ones stand evenly about the axis of the drive."""
    own, across = GEARS.values()
    s, sine, cosine = 34 / 20, math.sin(1.1), math.cos(1.1)
    about_x = across + (own - across) * sine**2 / 2
    about_q = own * (s + cosine) ** 2 + across * sine**2
    values = scene | {"satellites": 3, "shaft_angle": 1.1, "modules": 2}
    if scene.get("layout"):
        about_x, about_q = 0.0, own
    input_inertia = values.get("input_inertia", 0.0) + 6 * about_x
    one = started(compiled, values, drive_inertia=1e-3, **GEARS)
    other = started(compiled, values, drive_inertia=1e-3 + 6 * about_q, input_inertia=input_inertia)
    for step in (0.0, 0.004, 0.03, 0.05):
        for module in (one, other) if step else ():
            module.set_rates(omega1=0.0 if module["drive"] else 300.0)
            module.advance(step)
        expected = [one[name] for name in SHARED]
        assert [other[name] for name in SHARED] == pytest.approx(expected, rel=1e-9, abs=1e-9)


@given(turns=st.integers(-100, 100), duration=st.floats(1e-3, 0.2))
def test_motion_repeats_with_its_period_in_the_drive_angle(compiled, scene, turns, duration):
    period = TWO_PI * (1 if scene.get("layout") else 10)
    one = after(compiled, duration, scene)
    other = after(compiled, duration, scene, {"drive_angle_start": turns * period})
    assert_times(other, one, [*SPEEDS, *TORQUES, *ENERGIES, *ACCELERATIONS, "drive_angle"], 1.0)
    gone = drive_angle(other) - turns * period
    assert gone == pytest.approx(drive_angle(one), rel=1e-9, abs=1e-9 * abs(turns))
