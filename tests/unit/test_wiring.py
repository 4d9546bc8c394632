"""Bad wiring is refused before anything runs, naming the signals and what is allowed."""

import pytest
from fmpy import read_model_description

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.fmu.description import NATIVE_CAPABILITIES, model_description
from inertia_module.harness.wires import Wire, WiringError, check_wiring

SPEED = Wire("module", "omega_out", "shaft", "hub_speed")
TORQUE = Wire("shaft", "shaft_torque_mean", "module", "load_torque")
GIVEN = {"module": ["omega1"], "shaft": ["load_torque"]}


def described(model, folder, *changes):
    text = model_description(model, model.name, "{}", "2026-01-01T00:00:00Z", NATIVE_CAPABILITIES)
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
    check_wiring(both, [SPEED, TORQUE], GIVEN, 1e-3, {"shaft": 1e-4})


@pytest.mark.parametrize(
    "wires, given, words",
    [
        (
            [Wire("module", "output_torque_mean", "shaft", "hub_speed"), TORQUE],
            GIVEN,
            ("output_torque_mean is in N.m, hub_speed in rad/s", "allowed is the same unit"),
        ),
        ([SPEED], GIVEN, ("module.load_torque is missing", "allowed is a wire or a given value")),
        ([SPEED, TORQUE], {"shaft": ["load_torque"]}, ("module.omega1 is missing",)),
        (
            [SPEED, TORQUE],
            {**GIVEN, "module": ["omega1", "load_torque"]},
            ("module.load_torque is driven by shaft.shaft_torque_mean and by a given value",),
        ),
        ([SPEED, TORQUE._replace(source="axle")], GIVEN, ("there is no axle", "allowed are module, shaft")),
        ([SPEED._replace(output="omega_3"), TORQUE], GIVEN, ("module has no output omega_3", "omega_out")),
        ([SPEED._replace(input="omega1"), TORQUE], GIVEN, ("shaft has no input omega1", "hub_speed")),
        ([SPEED._replace(output="omega1"), TORQUE], GIVEN, ("module has no output omega1",)),
        ([SPEED, TORQUE], {**GIVEN, "shaft": ["torque"]}, ("shaft has no input torque",)),
    ],
)
def test_wires_that_cannot_work_are_named(both, wires, given, words):
    with pytest.raises(WiringError) as caught:
        check_wiring(both, wires, given, 1e-3)
    assert all(word in str(caught.value) for word in words)


@pytest.mark.parametrize("drive", [1.0, 1, "torque"])
def test_a_module_driven_by_torque_needs_its_torque_and_not_its_speed(both, drive):
    by_torque = {"parameters": {"module": {"drive": drive, "input_inertia": 0.1}}}
    given = {**GIVEN, "module": ["drive_torque"]}
    check_wiring(both, [SPEED, TORQUE], given, 1e-3, **by_torque)
    check_wiring(both, [SPEED, TORQUE], {**given, "module": ["drive_torque", "omega1"]}, 1e-3, **by_torque)
    with pytest.raises(WiringError, match=r"module\.drive_torque is missing"):
        check_wiring(both, [SPEED, TORQUE], GIVEN, 1e-3, **by_torque)
    idle = Wire("module", "omega_out", "module", "omega1")
    with pytest.raises(WiringError, match=r"omega1 is refused: it has no effect .* allowed is drive_torque"):
        check_wiring(both, [SPEED, TORQUE, idle], given, 1e-3, **by_torque)


def test_a_wire_to_the_torque_of_a_module_driven_by_speed_is_refused(both):
    idle = Wire("shaft", "shaft_torque_mean", "module", "drive_torque")
    with pytest.raises(WiringError, match=r"drive_torque is refused: it has no effect .* allowed is omega1"):
        check_wiring(both, [SPEED, TORQUE, idle], GIVEN, 1e-3)


@pytest.mark.parametrize("own", [3e-4, 2e-3, 0.0, -1e-3, float("nan"), float("inf")])
def test_steps_that_do_not_fit_are_refused(both, own):
    with pytest.raises(WiringError, match=r"of shaft is refused: allowed is 0\.001 s"):
        check_wiring(both, [SPEED, TORQUE], GIVEN, 1e-3, {"shaft": own})


@pytest.mark.parametrize("step", [0.0, -1.0, float("nan")])
def test_a_step_that_is_none_is_refused(both, step):
    with pytest.raises(WiringError, match="allowed is a positive number"):
        check_wiring(both, [SPEED, TORQUE], GIVEN, step)


def test_a_loop_of_signals_that_follow_from_each_other_at_once_is_refused(both, tmp_path):
    """Both say that an output depends on its input at once: who is first?"""
    through = (b'dependencies=""', b"")
    direct = {
        "module": described(INERTIA_MODULE, tmp_path / "one", through),
        "shaft": described(DRIVEN_SHAFT, tmp_path / "two", through),
    }
    check_wiring(both | {"shaft": direct["shaft"]}, [SPEED, TORQUE], GIVEN, 1e-3)
    with pytest.raises(WiringError, match="an algebraic loop is refused") as caught:
        check_wiring(direct, [SPEED, TORQUE], GIVEN, 1e-3)
    assert "module.omega_out" in str(caught.value)
    assert "shaft.shaft_torque_mean" in str(caught.value)


def test_kinds_have_to_match(both, tmp_path):
    other = described(
        DRIVEN_SHAFT,
        tmp_path / "other",
        (
            b'<Real unit="rad/s" min="-1000000.0" max="1000000.0" nominal="100.0" start="0.0" />',
            b'<Integer start="0" />',
        ),
    )
    with pytest.raises(WiringError, match="Real drives Integer; allowed is the same kind"):
        check_wiring(both | {"shaft": other}, [SPEED, TORQUE], GIVEN, 1e-3)
