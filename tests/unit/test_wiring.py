"""Bad wiring is refused before anything runs, naming the signals and what is allowed."""

import re

import pytest
from fmpy import read_model_description
from refused import REFUSED, assert_refused

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.fmu.description import model_description
from inertia_module.harness.system import Node, Wire, WiringError, check_wiring

SPEED = Wire("module", "omega_out", "shaft", "hub_speed")
TORQUE = Wire("shaft", "shaft_torque_mean", "module", "load_torque")
BOTH = [SPEED, TORQUE]
GIVEN = {"module": ["omega1"], "shaft": ["load_torque"]}


def check(descriptions, wires=BOTH, given=GIVEN, step=1e-3, drive=None):
    parameters = {} if drive is None else {"drive": drive}
    nodes = {name: Node("", parameters, dict.fromkeys(given.get(name, ()), 1.0)) for name in descriptions}
    check_wiring(nodes, descriptions, wires, step)


def described(model, folder, *changes):
    text = model_description(model, model.name, "{}", "2026-01-01T00:00:00Z")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    folder.mkdir()
    (folder / "modelDescription.xml").write_bytes(text)
    return read_model_description(str(folder), validate=False)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    folder = tmp_path_factory.mktemp("described")
    return {
        "module": described(INERTIA_MODULE, folder / "module"),
        "shaft": described(DRIVEN_SHAFT, folder / "shaft"),
    }


@pytest.mark.parametrize("drive", [1.0, 1, "torque"])
def test_module_and_shaft_wired_as_they_are_meant_to_be_are_accepted(both, drive):
    check(both)
    # what a wire drives may have a start value
    check(both, given={**GIVEN, "module": ["omega1", "load_torque"]})
    for names in (["drive_torque"], ["drive_torque", "omega1"]):
        check(both, given={**GIVEN, "module": names}, drive=drive)
    assert_refused(r"module\.drive_torque must be driven by a wire", check, both, drive=drive)
    idle = Wire("module", "omega_out", "module", "omega1")
    with pytest.raises(WiringError, match="the input must be drive_torque, omega1 has no effect"):
        check(both, [*BOTH, idle], {**GIVEN, "module": ["drive_torque"]}, drive=drive)


@pytest.mark.parametrize("asked, words", REFUSED["wiring"])
def test_wires_that_cannot_work_are_named(both, asked, words):
    if "wires" in asked:
        asked = {"wires": [Wire(*re.split("[. ]", ends)) for ends in asked["wires"]]}
    with pytest.raises(WiringError) as caught:
        check(both, **asked)
    assert words in str(caught.value)


def test_a_loop_of_signals_that_follow_from_each_other_at_once_is_refused(both, tmp_path):
    """Both say that an output depends on its input at once: who is first?"""
    through = (b'dependencies=""', b"")
    direct = {
        "module": described(INERTIA_MODULE, tmp_path / "one", through),
        "shaft": described(DRIVEN_SHAFT, tmp_path / "two", through),
    }
    check(both | {"shaft": direct["shaft"]})
    with pytest.raises(WiringError, match="an algebraic loop must hold an output") as caught:
        check(direct)
    assert "module.omega_out" in str(caught.value)
    assert "shaft.shaft_torque_mean" in str(caught.value)


def test_kinds_have_to_match(both, tmp_path):
    real = (
        b'<Real unit="rad/s" displayUnit="rpm" min="-1000000.0" max="1000000.0" nominal="100.0"'
        b' start="0.0" />'
    )
    other = described(DRIVEN_SHAFT, tmp_path / "other", (real, b'<Integer start="0" />'))
    assert_refused("both ends must be of one kind, are Real and Integer", check, both | {"shaft": other})
