"""FMUs as systems of python-control."""

from functools import partial

import control as ct
import numpy as np
import pytest
import speed_control
from averaged_module import averaged_response, averaged_system, operating_point, transient_inertia
from frequency_response import measured_response
from rejected import REJECTED, assert_rejected
from scenes import ELASTIC

from examples.coupling.study import URBAN_MODULE
from inertia_module import control
from inertia_module.control.fmu_system import pack_bytes, unpack_bytes
from inertia_module.fmi.instance import Fmu
from inertia_module.interface import variables

STEP = 0.01
START = {"omega1": 100.0, "load_torque": 10.0}
OUTPUTS = ("omega_out", "input_torque_mean", "output_torque_mean")
PLANAR = {**URBAN_MODULE, "output_inertia": 4.78}


SPEEDS, TORQUES, HUB = ((name, "load_torque") for name in ("omega1", "drive_torque", "hub_speed"))
BY_TORQUE = {"drive": "torque", "input_inertia": 0.3}
KEYWORDS = {"step": STEP, "start": START, "tolerance": 1e-9}


def run(system, inputs, start):
    time = STEP * np.arange(inputs.shape[1])
    return ct.input_output_response(system, time, inputs, start).outputs


# --- simulation, and independence of earlier calls ---


SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
# Parameters, maximum deviation with state = "motion", names of the states.
MOTIONS = [
    ({"fidelity": "averaged"}, 1e-7, ["omega_out", "omega1_held"]),
    ({}, 1e-6, ["drive_angle", "omega2", "omega_out", "omega1_held"]),
    (BY_TORQUE, 1e-6, ["drive_angle", "omega2", "omega_out", "input_speed"]),
]


@pytest.mark.parametrize(
    "name, parameters, share, motion",
    [
        *(("InertiaModule", *case) for case in MOTIONS),
        *(("InertiaModulePy", *case) for case in MOTIONS),
        ("InertiaModule", {"input_hold": "linear"}, None, None),
        ("InertiaModule", ELASTIC, None, None),
        ("DrivenShaft", SHAFT, 1e-9, ["omega_out", "twist", "hub_speed_held"]),
    ],
)
def test_system_equals_stepping_to_the_bit_or_within_the_tolerance_from_its_motion(
    built, name, parameters, share, motion
):
    path, is_native = built / f"{name}.fmu", name != "InertiaModulePy"
    steps = 100 if is_native else 40
    time = STEP * np.arange(steps)
    # One smooth input, one with a jump.
    inputs = np.stack([100.0 + 20.0 * np.sin(9.0 * time), 10.0 + 5.0 * (time > 0.5 * time[-1])])
    names, outputs, start = SPEEDS, OUTPUTS, START
    if "drive" in parameters:
        inputs, names, outputs = inputs * np.array([[0.3], [1.0]]), TORQUES, ("input_speed", *OUTPUTS)
    elif name == "DrivenShaft":
        inputs, names, start = inputs * np.array([[0.1], [1.0]]), HUB, {"load_torque": 10.0}
        outputs = ("omega_out", "shaft_torque_mean", "twist")
    rows = []
    with Fmu(path, parameters, start, 1e-9) as fmu:
        for values in inputs.T:
            rows.append(fmu.read(outputs))
            fmu.set(**dict(zip(names, values, strict=True)))
            fmu.advance(STEP)
    expected = np.array(rows).T
    keywords = {**KEYWORDS, "inputs": names, "outputs": outputs, "start": start}
    with control.fmu_system(path, parameters, state="whole", **keywords) as plant:
        assert (run(plant.system, inputs, plant.start) == expected).all()
        if is_native:
            assert (run(plant.system, inputs, 0.0) == expected).all()
    if motion:
        with control.fmu_system(path, parameters, **keywords) as plant:
            assert plant.system.state_labels[: len(motion)] == motion
            response = run(plant.system, inputs, plant.start)
        scale = np.abs(expected).max(axis=1, keepdims=True)
        assert (np.abs(response - expected) / scale).max() < share
        assert np.ptp(expected[0]) > 0.5


@pytest.mark.parametrize(
    "name, parameters, state",
    [
        ("InertiaModule", {}, "motion"),
        ("InertiaModule", {"fidelity": "averaged"}, "motion"),
        ("InertiaModule", {}, "whole"),
        ("InertiaModule", ELASTIC, "whole"),
        ("InertiaModulePy", {}, "whole"),
    ],
)
def test_result_depends_only_on_state_and_input(built, name, parameters, state):
    path = built / f"{name}.fmu"
    with (
        control.fmu_system(path, parameters, state=state, **KEYWORDS) as plant,
        control.fmu_system(path, parameters, state=state, **KEYWORDS) as other,
    ):
        x, u = plant.start, np.array([90.0, 12.0])
        for _ in range(30):
            x = plant.system.dynamics(0.0, x, u)
        first = plant.system.dynamics(0.0, x, u)
        outputs = plant.system.output(0.0, first, u)
        # Calls in between: another state, a read, a rejected step, another instance and a copy.
        plant.system.dynamics(0.0, plant.start, [120.0, 0.0])
        plant.system.output(0.0, plant.start, u)
        assert_rejected("omega1", plant.system.dynamics, 0.0, x, [np.nan, 0.0])
        assert (other.system.dynamics(5.0, x, u) == first).all()
        assert (plant.system.dynamics(7.0, x, u) == first).all()
        assert (plant.system.copy(name="copy").dynamics(0.0, x, u) == first).all()
        assert (plant.system.output(0.0, first, u) == outputs).all()
        assert (plant.system.output(0.0, first, [0.0, 99.0]) == outputs).all()  # no feedthrough


def test_bytes_are_packed_as_integers_and_a_modified_integer_is_an_error():
    for size in (0, 1, 5, 6, 7, 19088):
        data = np.random.default_rng(size).bytes(size)
        numbers = pack_bytes(data)
        assert (numbers == np.floor(numbers)).all()
        assert unpack_bytes(numbers) == data
    numbers[2] += 0.5
    with pytest.raises(ValueError, match=r"a whole state must be unchanged \(number 2 is "):
        unpack_bytes(numbers)


# --- functions of python-control ---


@pytest.mark.parametrize("state", ["motion", "whole"])
@pytest.mark.parametrize("place, name", [(0, "omega1"), (1, "load_torque")])
def test_rejected_input_is_reported_with_the_time_of_its_step(fmu, state, place, name):
    inputs = np.tile([[100.0], [10.0]], 200)
    inputs[place, 100] = 1e30
    start = {"omega1": 100.0, "load_torque": 10.0}
    with control.fmu_system(fmu, step=0.01, start=start, outputs="omega_out", state=state) as plant:
        respond = partial(ct.input_output_response, plant.system, 0.01 * np.arange(200), inputs, plant.start)
        assert_rejected(f"^at time 1 s: {name} must be between .* .got 1e\\+30.$", respond)


def test_averaged_fmu_has_operating_point_and_linearisation_of_the_averaged_system(fmu):
    continuous = averaged_system()
    speed = operating_point(continuous, 100.0, 10.0)
    exact = ct.sample_system(ct.linearize(continuous, [speed], [100.0, 10.0]), STEP, "zoh")
    with control.fmu_system(fmu, {"fidelity": "averaged"}, step=STEP, start=START, tolerance=1e-10) as plant:
        guess = [20.0, 100.0, *plant.start[2:]]
        point = ct.find_operating_point(plant.system, guess, [100.0, 10.0])
        linear = ct.linearize(plant.system, point.states, point.inputs, eps=1e-3)
    assert plant.system.state_labels == ["omega_out", "omega1_held", *OUTPUTS[1:]]
    assert point.states[0] == pytest.approx(speed, rel=1e-8)
    assert linear.A[0, 0] == pytest.approx(exact.A[0, 0], rel=1e-6)
    assert linear.B[0] == pytest.approx(exact.B[0], rel=1e-4)
    assert not linear.D.any()


# --- small signals ---

BOTH = ("omega_out", "output_torque_mean", "input_torque_mean")


@pytest.mark.parametrize("excited, amplitude", [("load_torque", 2.0), ("omega1", 1.0)])
def test_small_signal_response_of_the_rigid_fmu_equals_the_averaged_module(fmu, excited, amplitude):
    """Up to a tenth of the pulse rate the gain deviates by at most 5 %, the phase by 5 degrees."""
    omega1, load = 200.0, 100.0
    speed = operating_point(averaged_system(PLANAR), omega1, load, 60.0)
    point = {"omega1": omega1, "load_torque": load, "excited": excited, "frequencies": [0.2, 1.0, 4.4]}
    measured = measured_response(
        fmu, {**PLANAR, "omega_out_start": speed}, **point, amplitude=amplitude, outputs=BOTH,
        step=1e-3, settling=8.0, record=10.0,
    )  # fmt: skip
    assert measured.pulse_rate == pytest.approx(44.0, abs=1.0)
    transient = transient_inertia(PLANAR, omega1, speed)
    corrected = averaged_response(PLANAR, **point, outputs=BOTH, guess=60.0, transient=transient)
    gain, phase = measured.deviation_from(corrected)
    assert np.abs(gain).max() < 0.03
    assert np.abs(phase).max() < 1.5
    # With this inertia the output speed needs no correction.
    plain = averaged_response(PLANAR, **point, outputs=BOTH, guess=60.0)
    gain, phase = measured.deviation_from(plain)
    assert np.abs(gain[0]).max() < 0.05
    assert np.abs(phase[0]).max() < 5.0


# --- variables that depend on the motion only ---


def test_table_of_variables_contains_the_dependence_on_the_motion(fmu):
    """A restart from the motion keeps all but cumulative values and values that depend on link 1."""
    inputs = {"omega1": 100.0, "load_torque": 10.0}
    names = [variable.name for variable in variables.with_causality(variables.OUTPUT, variables.LOCAL)]
    with Fmu(fmu, {}, inputs, 1e-11) as module:
        for _ in range(123):
            module.advance(STEP)
        motion = {f"{name}_start": module[name] for name in ("drive_angle", "omega2", "omega_out")}
        module.advance(STEP)
        expected = dict(zip(names, module.read(names), strict=False))
    with Fmu(fmu, motion, inputs, 1e-11) as module:
        module.advance(STEP)
        restarted = dict(zip(names, module.read(names), strict=False))
    differ = {name for name in names if restarted[name] != pytest.approx(expected[name], rel=1e-5, abs=1e-7)}
    follows = {name: variables.BY_NAME[name].follows for name in names}
    changed = {name for name in names if follows[name] in (variables.SINCE_START, variables.LINK1_ANGLE)}
    # There are no losses, and the residual is at rounding level.
    zero = {name for name in variables.BY_NAME if name.startswith("energy_lost")} | {"energy_residual"}
    assert differ == changed - zero
    assert {name for name, of in follows.items() if of == variables.DRIVE_ANGLE} == {
        "drive_angle",
        "imbalance_x",
        "imbalance_velocity_x",
        "imbalance_acceleration",
        "imbalance_acceleration_x",
        *("satellite_force", "satellite_force_peak", "shaking_force_x", "shaking_moment_x"),
    }


# --- errors ---


def measured(path, **change):
    arguments = {"parameters": {}, "excited": "omega1", "amplitude": 1.0, "settling": 0.1, "frequencies": 1.0}
    return measured_response(path, **{**START, **arguments, **change})


@pytest.mark.parametrize(
    "make, arguments, message",
    [
        *((control.fmu_system, *case) for case in REJECTED["systems"]),
        *((measured, *case) for case in REJECTED["responses"]),
    ],
)
def test_invalid_arguments_are_errors_with_a_remedy(fmu, make, arguments, message):
    with pytest.raises(ValueError, match=message):
        make(fmu, **{"step": 1e-3, **arguments})


# --- example speed_control ---


def test_margins_of_the_speed_control_are_those_of_the_full_model(fmu):
    operating = 60.6858
    controllers = {"PI": speed_control.controllers_of(operating)["PI"]}
    rows = speed_control.margins(fmu, operating, controllers)
    assert [kind for _, kind, _, _ in rows] == ["averaged", "rigid", "elastic"]
    for _, _, predicted, measured in rows:
        assert measured.gain == pytest.approx(predicted.gain, rel=0.1)
        assert measured.delay == pytest.approx(predicted.delay, rel=0.05)
        assert measured.phase == pytest.approx(predicted.phase, abs=3.0)
