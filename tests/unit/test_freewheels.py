"""Test locking, slip, rest and motion at the freewheels (test_motions.py tests their signs)."""

from itertools import product

import pytest
from scenes import FREEWHEELS, advanced, motions, passed, started

AT_REST = {"omega1": 0.0, "drive_torque": 0.0, "max_step": 0.0}
HELD, FREE, DRIVING, HELD_DRIVING = range(4)
# Contact mode of a mechanism at rest under a pulling, zero and braking load.
MODES_AT_REST = {
    "both freewheels": (HELD, HELD_DRIVING, HELD_DRIVING),
    "no housing freewheel": (FREE, FREE, DRIVING),
    "no output freewheel": (DRIVING, HELD_DRIVING, HELD_DRIVING),
    "no freewheel": (DRIVING, DRIVING, DRIVING),
}
DEAD = ["input_speed", "omega2", "input_angle", "input_torque", "mesh_torque", "energy_in"]


LEVELS = ("rigid", "elastic")
ideal = motions(LEVELS, added=("ideal",), missing=())


@ideal
def test_standstill_stays_with_a_load_and_without(compiled, scene):
    for load, step in product((0.0, 10.0), (1e-9, 1e-3, 1.0, 1e3)):
        module = advanced(started(compiled, scene, AT_REST, load_torque=load), step, step)
        assert [module[name] for name in DEAD] == [0.0] * len(DEAD)
        assert module["contact_switches"] == 0
        if module["fidelity"] != 3:  # An elastic shaft carries the load.
            assert module["omega_out"] == module["energy_out"] == module["energy_stored"] == 0.0
            assert module["output_torque"] == module["housing_torque"] == load
            assert module["output_torque_mean"] == load
            assert module["contact_mode"] == HELD_DRIVING


@ideal
def test_mode_at_rest_is_the_same_by_all_methods_and_stays(compiled, scene):
    for freewheels, modes in MODES_AT_REST.items():
        for load, expected in zip((-5.0, 0.0, 5.0), modes, strict=True):
            module = started(compiled, scene, AT_REST, FREEWHEELS[freewheels], load_torque=load)
            assert module["contact_mode"] == expected, (freewheels, load)
            for _ in range(20):
                module.advance(1e-5)
                assert module["contact_mode"] == expected, (freewheels, load)
            assert module["contact_switches"] == 0


@ideal
def test_link_2_pushed_backwards_without_load_stays_held_with_the_shaft(compiled, scene):
    # Pulses of the bevel layout end at half a turn; pulses of the planar layout start there.
    angle = 3.13 if scene.get("layout") else 3.15
    module = started(compiled, scene, drive_angle_start=angle, load_torque=0.0, drive_torque=0.0)
    for _ in range(20):
        assert module["contact_mode"] == HELD_DRIVING
        module.advance(1e-6)
    assert module["contact_switches"] == 0


@motions(LEVELS, added=("ideal",), missing=(), drives=("speed",))
def test_link_2_stays_at_rest_when_the_input_stops_and_the_shaft_coasts(compiled, scene):
    module = advanced(started(compiled, scene), *[1e-3] * 300)
    advanced(module, *[1e-3] * 50, omega1=0.0, load_torque=1.0)
    switches = module["contact_switches"]
    for _ in range(100):
        module.advance(1e-3)
        assert module["contact_mode"] == HELD
    assert module["omega_out"] > 0.0
    assert module["contact_switches"] == switches


@motions(LEVELS, added=("ideal", "losses"), missing=(), drives=("speed",))
def test_ramp_with_rounding_errors_opens_no_freewheel(compiled, scene):
    names = ("contact_switches", "housing_engagements", "output_engagements")
    for rate in (333.3, -91.7):
        single, many = (started(compiled, scene, omega1=100.0, max_step=1e-4) for _ in range(2))
        single.set_rates(omega1=rate)
        single.advance(0.2)
        differ = 0
        for n in range(200):
            many.set(omega1=100.0 + rate * n * 1e-3)
            differ += many.inputs.omega1 != many.state.omega1
            many.set_rates(omega1=rate)
            many.advance(1e-3)
        assert differ > 20
        assert [many[name] for name in names] == [single[name] for name in names]
        assert abs(many["energy_residual"]) <= max(
            1e-6 * passed(single), 1.1 * abs(single["energy_residual"])
        )


@motions(LEVELS, added=("ideal", "losses", "wind-up"), missing=tuple(FREEWHEELS)[1:], drives=("speed",))
def test_duty_of_the_freewheels_agrees_with_short_steps(compiled, scene):
    whole = advanced(started(compiled, scene), 0.2, 0.1)
    module = advanced(started(compiled, scene), 0.2)
    there = {"housing": scene.get("housing_freewheel", True), "output": scene.get("output_freewheel", True)}
    before = module["contact_mode"]
    counts = {name: module[f"{name}_engagements"] for name in there}
    torque, housing_slip, output_slip = 0.0, 0.0, 0.0
    for _ in range(1000):
        module.advance(1e-4)
        mode = module["contact_mode"]
        for name, engaged in (("housing", (HELD, HELD_DRIVING)), ("output", (DRIVING, HELD_DRIVING))):
            counts[name] += mode in engaged and before not in engaged
        before = mode
        torque = max(torque, abs(module["housing_torque"]))
        housing_slip = max(housing_slip, module["omega2"])
        output_slip = max(output_slip, module["omega_hub"] - module["omega2"])
    for name, number in counts.items():
        # The record does not show two switches within one of its steps.
        assert number <= whole[f"{name}_engagements"] <= number + 2
    assert whole["housing_torque_peak"] == pytest.approx(torque, rel=0.02, abs=1e-9)
    assert whole["housing_slip_peak"] == pytest.approx(housing_slip * there["housing"], rel=0.01)
    assert whole["output_slip_peak"] == pytest.approx(output_slip * there["output"], rel=0.01, abs=1e-9)
