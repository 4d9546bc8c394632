"""Bad wiring is refused before anything runs, naming the signals and what is allowed."""

import pytest
from fmpy import read_model_description

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.fmu.description import model_description
from inertia_module.harness.wires import Wire, WiringError, check_wiring

SPEED = Wire("module", "omega_out", "shaft", "hub_speed")
TORQUE = Wire("shaft", "shaft_torque_mean", "module", "load_torque")
GIVEN = {"module": ["omega1"], "shaft": ["load_torque"]}


def described(model, folder, *changes):
    text = model_description(model, model.name, "{}", "2026-01-01T00:00:00Z")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    folder.mkdir()
    (folder / "modelDescription.xml").write_bytes(text)
    return read_model_description(str(folder), validate=False)


@pytest.fixture
def both(tmp_path):
    return {
        "module": described(INERTIA_MODULE, tmp_path / "module"),
        "shaft": described(DRIVEN_SHAFT, tmp_path / "shaft"),
    }


def test_module_and_shaft_wired_as_they_are_meant_to_be_are_accepted(both):
    check_wiring(both, [SPEED, TORQUE], GIVEN, 1e-3)


@pytest.mark.parametrize(
    "wires, given, words",
    [
        (
            [Wire("module", "output_torque_mean", "shaft", "hub_speed"), TORQUE],
            GIVEN,
            (
                "module.output_torque_mean -> shaft.hub_speed: both ends must be in one unit",
                "are in N.m and rad/s",
            ),
        ),
        ([SPEED], GIVEN, ("module.load_torque must be driven by a wire or a given value, nothing",)),
        (
            [SPEED, TORQUE],
            {"shaft": ["load_torque"]},
            ("module.omega1 must be driven by a wire or a given value, nothing",),
        ),
        (
            [SPEED, TORQUE],
            {**GIVEN, "module": ["omega1", "load_torque"]},
            (
                "module.load_torque must be driven by one",
                "is driven by shaft.shaft_torque_mean and by a given value",
            ),
        ),
        (
            [SPEED, TORQUE._replace(source="axle")],
            GIVEN,
            ("axle must be an FMU of the system (there",),
        ),
        (
            [SPEED._replace(output="omega_3"), TORQUE],
            GIVEN,
            ("omega_3 must be an output of module (did you mean omega2?)",),
        ),
        (
            [SPEED._replace(input="omega1"), TORQUE],
            GIVEN,
            ("omega1 must be an input of shaft (there",),
        ),
        ([SPEED._replace(output="omega1"), TORQUE], GIVEN, ("omega1 must be an output of module (",)),
        ([SPEED, TORQUE], {**GIVEN, "shaft": ["torque"]}, ("torque must be an input of shaft (",)),
    ],
)
def test_wires_that_cannot_work_are_named(both, wires, given, words):
    with pytest.raises(WiringError) as caught:
        check_wiring(both, wires, given, 1e-3)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("drive", [1.0, 1, "torque"])
def test_a_module_driven_by_torque_needs_its_torque_and_not_its_speed(both, drive):
    by_torque = {"parameters": {"module": {"drive": drive, "input_inertia": 0.1}}}
    given = {**GIVEN, "module": ["drive_torque"]}
    check_wiring(both, [SPEED, TORQUE], given, 1e-3, **by_torque)
    check_wiring(both, [SPEED, TORQUE], {**given, "module": ["drive_torque", "omega1"]}, 1e-3, **by_torque)
    with pytest.raises(WiringError, match=r"module\.drive_torque must be driven by a wire"):
        check_wiring(both, [SPEED, TORQUE], GIVEN, 1e-3, **by_torque)
    idle = Wire("module", "omega_out", "module", "omega1")
    with pytest.raises(WiringError, match="the input must be drive_torque, omega1 has no effect"):
        check_wiring(both, [SPEED, TORQUE, idle], given, 1e-3, **by_torque)


def test_a_wire_to_the_torque_of_a_module_driven_by_speed_is_refused(both):
    idle = Wire("shaft", "shaft_torque_mean", "module", "drive_torque")
    with pytest.raises(WiringError, match="the input must be omega1, drive_torque has no effect"):
        check_wiring(both, [SPEED, TORQUE, idle], GIVEN, 1e-3)


@pytest.mark.parametrize("step", [0.0, -1.0, float("nan")])
def test_a_step_that_is_none_is_refused(both, step):
    with pytest.raises(WiringError, match=f"^step must be a positive number of seconds, is {step:g}$"):
        check_wiring(both, [SPEED, TORQUE], GIVEN, step)


def test_a_loop_of_signals_that_follow_from_each_other_at_once_is_refused(both, tmp_path):
    """Both say that an output depends on its input at once: who is first?"""
    through = (b'dependencies=""', b"")
    direct = {
        "module": described(INERTIA_MODULE, tmp_path / "one", through),
        "shaft": described(DRIVEN_SHAFT, tmp_path / "two", through),
    }
    check_wiring(both | {"shaft": direct["shaft"]}, [SPEED, TORQUE], GIVEN, 1e-3)
    with pytest.raises(WiringError, match="an algebraic loop must hold an output") as caught:
        check_wiring(direct, [SPEED, TORQUE], GIVEN, 1e-3)
    assert "module.omega_out" in str(caught.value)
    assert "shaft.shaft_torque_mean" in str(caught.value)


def test_kinds_have_to_match(both, tmp_path):
    other = described(
        DRIVEN_SHAFT,
        tmp_path / "other",
        (
            b'<Real unit="rad/s" displayUnit="rpm" min="-1000000.0" max="1000000.0" nominal="100.0"'
            b' start="0.0" />',
            b'<Integer start="0" />',
        ),
    )
    with pytest.raises(WiringError, match="both ends must be of one kind, are Real and Integer"):
        check_wiring(both | {"shaft": other}, [SPEED, TORQUE], GIVEN, 1e-3)
