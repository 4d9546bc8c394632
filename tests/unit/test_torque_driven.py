"""A torque drives link 1: what a host can rely on, limits known in closed form, refusals.

Its motion is held to Lagrange's equations in test_reference.py, its invariants in test_motions.py.
"""

import math
import re

import numpy as np
import pytest
from scenes import DRIVEN, ENGINE, LEVELS, SCENES, advanced, input_angle, motions, started

from inertia_module.contract.variables import BY_NAME
from inertia_module.memory import Module, Refused

FOLLOWED = [level for level in LEVELS if level != "kinematic"]


@pytest.fixture(params=SCENES)
def scene(request):
    return DRIVEN[request.param]


@motions(levels=FOLLOWED, added=("ideal",))
def test_one_input_alone_counts_and_its_work_is_torque_times_angle(compiled, scene):
    """The torque given to link 1, where the drive is by torque, not its speed; else the other way round."""
    one, other = (advanced(started(compiled, scene), 0.01) for _ in range(2))
    if scene.get("drive"):
        other.set(omega1=-3.0)
        other.set_rates(omega1=1e4)
    else:
        other.set(drive_torque=-1e6)
        other.set_rates(drive_torque=1e5)
    for module in (one, other):
        advanced(module, 0.02)
    assert bytes(one.outputs) == bytes(other.outputs)
    if scene.get("drive"):
        assert bytes(one.state) == bytes(other.state)
        for step in (1e-3, 0.01, 0.03):
            one.advance(step)
            assert one["input_torque_mean"] == pytest.approx(one["drive_torque"], rel=1e-14)
        assert one["energy_in"] == pytest.approx(one["drive_torque"] * input_angle(one), rel=1e-12)
    else:
        assert one["input_speed"] == one["omega1"]


@motions(levels=FOLLOWED, added=("ideal",))
def test_torque_starts_and_turns_round_the_engine(compiled, scene):
    scene = scene | ENGINE
    module = advanced(started(compiled, scene, omega1=0.0, drive_torque=5.0), *[0.02] * 10)
    assert module["input_speed"] > 1.0
    advanced(module, *[0.02] * 25, drive_torque=-7.0)
    assert module["input_speed"] < -1.0


def test_torque_with_a_rate_counts_by_its_mean_over_the_step(compiled, scene):
    ramp, mean = (started(compiled, scene, drive_torque=10.0) for _ in range(2))
    ramp.set_rates(drive_torque=400.0, load_torque=-100.0)
    advanced(ramp, 0.05)
    advanced(mean, 0.05, drive_torque=20.0, load_torque=mean["load_torque"] - 2.5)
    assert bytes(ramp.state) == bytes(mean.state)
    assert bytes(ramp.outputs) == bytes(mean.outputs)


def test_speed_at_the_start_is_that_given(compiled, scene):
    module = started(compiled, scene, omega1=-37.0)
    assert module["input_speed"] == -37.0
    assert module["energy_in"] == module["energy_residual"] == 0.0
    assert started(compiled, scene, ENGINE, omega1=0.0)["input_speed"] == 0.0


def test_shaft_comes_to_rest_and_the_engine_turns_on(compiled, scene):
    module = advanced(started(compiled, scene), 0.3)
    assert module["omega_out"] > 0.0
    advanced(module, 3.0, load_torque=1e3)
    assert module["omega2"] == module["omega_out"] == 0.0
    assert module["input_speed"] > 0.0
    assert module["contact_mode"] == 3


def test_drive_torque_or_rate_past_the_checks_is_refused_and_the_next_good_step_works(compiled, scene):
    module = advanced(started(compiled, scene), 0.01)
    saved, good, allowed = module.save(), module["drive_torque"], BY_NAME["drive_torque"].allowed
    undisturbed = advanced(module, 0.01).save()
    torques = [(value, 0.0) for value in (math.nan, math.inf, -math.inf, 1e13, -1e300)]
    for torque, rate in (*torques, (good, math.nan), (good, math.inf), (good, 1e16)):
        module.restore(saved)
        module.inputs.drive_torque = torque
        sentence = f"drive_torque must be {allowed}, is {torque:.16g}"
        if torque == good:
            module.set_rates(drive_torque=rate)
            kept = f"the rate of drive_torque must keep it {allowed} over 0.01 s"
            sentence = f"{kept}, is {rate:.16g} N.m/s from drive_torque = {good:g}"
        before = module.save()
        with pytest.raises(Refused, match=f"^{re.escape(sentence)}$"):
            module.advance(0.01)
        assert module.save() == before, sentence
    module.restore(saved)
    assert advanced(module, 0.01).save() == undisturbed


@pytest.mark.parametrize(
    ("name", "value"), [("input_inertia", 0.0), ("input_inertia", 1e-20), ("fidelity", 0)]
)
def test_drive_by_torque_needs_an_inertia_and_equations_of_motion(compiled, scene, name, value):
    module = Module(compiled)
    with pytest.raises(
        Refused, match=rf"^with drive = 1 \(torque\) {name}.* must be .*, is {value:.16g}\b.*: "
    ):
        module.start(**{**scene, name: value})
    assert not module.started
    assert module.start(**{**scene, name: started(compiled, scene)[name]}).started
    # by speed it does without
    assert np.isfinite(advanced(started(compiled, scene, {name: 0}, drive=0), 0.01)["energy_in"])
