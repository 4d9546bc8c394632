"""Test difficult crossings: two per step, dips, grazing, rounding at rest, thousands in one step."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import FOUND, SCENES, advanced, mechanism, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.events.error import error_norm, write_scales


def first_pulse(compiled, scene, speed, tolerance=1e-10):
    """Return a module after the first pulse of link 2, with an unloaded output at this initial speed."""
    quiet = {"load_torque": 0.0, "drive_angle_start": 0.5, "omega_out_start": speed}
    return advanced(started(compiled, scene, quiet, tolerance=tolerance), 0.045)


def test_pulse_tangent_to_the_shaft_speed_is_located(compiled, scene):
    # Bisection of the output speed that link 2 just reaches, to the last bit.
    touched, missed = 0.0, 1e3
    while touched < 0.5 * (touched + missed) < missed:
        speed = 0.5 * (touched + missed)
        if first_pulse(compiled, scene, speed)["omega_out"] > speed:
            touched = speed
        else:
            missed = speed
    assert 1.0 < missed < 900.0
    undisturbed = first_pulse(compiled, scene, 2.0 * missed)
    for deviation in (0.0, 1e-15, 1e-13, 1e-10, 1e-7, 1e-4):
        for speed in (touched * (1.0 - deviation), missed * (1.0 + deviation)):
            module = first_pulse(compiled, scene, speed)
            assert speed <= module["omega_out"] <= speed * (1.0 + deviation) * (1.0 + 1e-9)
            assert module["contact_switches"] <= 10
            assert module["omega2"] == pytest.approx(undisturbed["omega2"], abs=1e-6 + 1e3 * deviation)
            assert abs(module["energy_residual"]) < 1e-8 * module["energy_stored"]
            for tolerance in (1e-3, 1e-6, 1e-9, 1e-12) if deviation < 1e-12 else ():
                end = first_pulse(compiled, scene, speed, tolerance)["omega_out"]
                assert end == pytest.approx(speed, rel=10.0 * tolerance + 1e-9)


@pytest.mark.parametrize("tolerance", [1e-11, 1e-12])
@given(
    duration=st.floats(1e-5, 0.05),
    mass=st.floats(0.01, 1.0),
    load=st.floats(1.0, 40.0),
    inertia=st.sampled_from([0.5, 20.0]),
)
def test_smallest_tolerances_are_met_when_the_input_stops(
    compiled, scene, tolerance, duration, mass, load, inertia
):
    values = {"imbalance_mass": mass, "output_inertia": inertia, "satellites": 1, "tolerance": tolerance}
    module = advanced(started(compiled, scene, values, load_torque=-load), duration)
    advanced(module, 0.1, omega1=0.0, load_torque=load)
    assert module["omega_out"] >= module["omega2"] >= 0.0


@pytest.mark.parametrize("size", [1e100, 1e150, 1e200, math.inf, math.nan])
def test_step_outside_the_range_of_doubles_has_a_large_error(size):
    module = started("plain", SCENES["bevel"])
    w = record_type(fields.WORKSPACE)()
    w.step, w.tolerance = 0.1, module.derived.tolerance
    for n in range(8):
        w.rates[n].omega2 = size * (1.0 + 0.1 * n)
    write_scales(module.derived, module.state, w)
    assert not error_norm(w) <= 1.0


STILL, DIP, THREE_ZEROS = (mechanism(FOUND[name]) for name in ("still", "dip", "three_zeros"))


@pytest.mark.parametrize("load", [0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6])
@pytest.mark.parametrize("a", [0.0, 1e-12])
def test_torques_at_rounding_level_switch_no_freewheel_without_end(compiled, load, a):
    for sign, omega1, step in itertools.product((1.0, -1.0), (116.45, -116.45, 50.0, 0.0), (1e-3, 0.01, 1.0)):
        start = {"a": a, "omega1": omega1, "omega2_start": 50.0, "omega_out_start": 50.0}
        module = advanced(started(compiled, STILL, start, load_torque=sign * load), *[step] * 5)
        assert module["omega_out"] >= module["omega2"] >= 0.0
        assert module["omega_out"] == pytest.approx(50.0, abs=1e3 * load * step + 1e-7)


@pytest.mark.parametrize("a", [0.0, 1e-12])
@pytest.mark.parametrize("drive", [{}, {"drive": 1, "input_inertia": 0.1, "drive_torque": 1e-8}])
def test_housing_freewheel_transmits_tiny_torques(compiled, a, drive):
    for satellites, omega1, load in itertools.product((3, 4), (117.0, -117.0), (0.0, 1e-7, -1e-11)):
        values = {"a": a, "satellites": satellites, "omega1": omega1, "load_torque": load}
        module = started(compiled, STILL, drive, values)
        for step in (1e-3, 0.01, 0.0371, 0.1, 0.1):
            torque = advanced(module, step)["mesh_torque"]
            assert module["housing_torque"] >= -1e-9 * abs(torque)


@pytest.mark.parametrize("tolerance", [1e-12, 1e-9])
@pytest.mark.parametrize("load", [1e-15, 1e-11, 1e-8, -1e-15])
def test_load_at_rounding_level_on_an_elastic_shaft_at_rest_is_simulated(compiled, tolerance, load):
    shaft = {"fidelity": 3, "driven_inertia": 0.1, "shaft_stiffness": 100.0, "output_inertia": 0.793}
    light = {"imbalance_mass": 1e-9, "link2_inertia": 0.0066, "wheel_radius": 0.02}
    for satellites, step in itertools.product((1, 4), (2.4e-4, 5.3e-4, 0.27)):
        values = {"satellites": satellites, "omega1": 0.0, "load_torque": load, "tolerance": tolerance}
        module = advanced(started(compiled, STILL, shaft, light, values), step)
        assert abs(module["omega_out"]) < 20.0 * abs(load)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_dip_with_zero_initial_slope_is_located(compiled, tolerance):
    long_steps = advanced(started(compiled, DIP, tolerance=tolerance), 1.75)
    short_steps = advanced(started(compiled, DIP, tolerance=tolerance, max_step=1e-4), 1.75)
    assert long_steps["contact_switches"] == short_steps["contact_switches"]
    assert long_steps["omega_out"] == pytest.approx(short_steps["omega_out"], abs=20 * tolerance)


def test_release_near_close_zeros_agrees_with_short_steps(compiled):
    for start, b, c in itertools.product((0.0, 0.4, 3.6), (0.476, 0.48, 0.486), (1.005, 1.027, 1.045)):
        scene = (THREE_ZEROS, {"drive_angle_start": start, "b": b, "c": c})
        single = advanced(started(compiled, *scene), 0.1)
        many = advanced(started(compiled, *scene), *[1e-3] * 100)
        assert single["omega2"] == pytest.approx(many["omega2"], abs=1e-4)
