"""Several FMUs as one system: wires are checked before anything starts, and steps are the plainest."""

import pytest

from inertia_module.harness.fmu import Fmu, FmuError
from inertia_module.harness.simulate import drive
from inertia_module.harness.system import GAUSS_SEIDEL, JACOBI, Node, WiredFmus
from inertia_module.harness.wires import Wire, WiringError

HUB = {"output_inertia": 0.02}
DRIVEN = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
SPEED = Wire("module", "omega_out", "shaft", "hub_speed")
TORQUE = Wire("shaft", "shaft_torque_mean", "module", "load_torque")
ENDS = (("module", "omega_out"), ("shaft", "omega_out"))


@pytest.fixture(scope="module")
def nodes(built):
    return {
        "module": Node(built / "InertiaModule.fmu", HUB, {"omega1": 100.0}, 1e-8),
        "shaft": Node(built / "DrivenShaft.fmu", DRIVEN, {"load_torque": 10.0}),
    }


def test_a_run_gives_a_table_with_units_and_goes_on_where_the_last_one_ended(nodes):
    with WiredFmus(nodes, (SPEED, TORQUE), 1e-3) as system:
        table = system.run(0.06, ENDS)
        assert system.time == pytest.approx(0.06)
        more = system.run(0.1, ENDS)
        assert system.time == pytest.approx(0.1)
    assert table.names == ["time", "module.omega_out", "shaft.omega_out"]
    assert table.units["shaft.omega_out"] == "rad/s"
    assert (len(table), len(more)) == (61, 41)
    assert more.time[[0, -1]] == pytest.approx([0.06, 0.1])
    assert more["shaft.omega_out"][0] == table["shaft.omega_out"][-1]
    assert more["shaft.omega_out"][-1] > 1.0


def test_a_run_from_a_table_gives_each_step_the_inputs_of_its_beginning(nodes):
    path, ends = nodes["module"].path, {"omega1": [100.0, 120.0], "load_torque": 4.0}
    table = drive(path, {"time": [0.0, 0.05], **ends}, 0.05, 0.01)
    assert table["omega1"] == pytest.approx([100.0, 104.0, 108.0, 112.0, 116.0, 120.0])
    with Fmu(path, inputs={"omega1": 100.0, "load_torque": 4.0}) as fmu:
        for speed, expected in zip(table["omega1"], table["omega_out"][1:], strict=False):
            fmu.set(omega1=speed)
            fmu.advance(0.01)
            assert fmu["omega_out"] == pytest.approx(expected, rel=1e-9)


def test_jacobi_does_not_depend_on_the_order_of_the_fmus_and_gauss_seidel_does(nodes):
    def ends(order, names):
        chosen = {name: nodes[name] for name in names}
        with WiredFmus(chosen, (SPEED, TORQUE), 1e-3, order) as system:
            table = system.run(0.05, ENDS)
        return [table[f"{name}.{output}"][-1] for name, output in ENDS]

    forward, backward = ("module", "shaft"), ("shaft", "module")
    assert ends(JACOBI, forward) == ends(JACOBI, backward)
    assert ends(GAUSS_SEIDEL, forward) != ends(GAUSS_SEIDEL, backward)


def test_bad_wires_are_refused_before_an_fmu_is_loaded(nodes, monkeypatch):
    def loaded(*_, **__):
        raise AssertionError("an FMU was loaded")

    monkeypatch.setattr("inertia_module.harness.system.Fmu", loaded)
    with pytest.raises(WiringError, match=r"module\.load_torque must be driven by"):
        WiredFmus(nodes, (SPEED,), 1e-3)
    with pytest.raises(WiringError, match="order must be Jacobi or Gauss-Seidel, is 'implicit'"):
        WiredFmus(nodes, (SPEED, TORQUE), 1e-3, "implicit")
    with pytest.raises(FmuError, match="no such file"):
        WiredFmus(nodes | {"shaft": Node("nothing.fmu")}, (SPEED, TORQUE), 1e-3)


def test_what_a_system_cannot_do_is_said_in_a_sentence(nodes):
    with WiredFmus(nodes, (SPEED, TORQUE), 1e-3) as system:
        system.set("shaft", load_torque=3.0)
        for refused, words in (
            (
                lambda: system.set("module", load_torque=3.0),
                r"module\.load_torque must be an input that no wire drives: shaft",
            ),
            (
                lambda: system.set("engine", omega1=1.0),
                "of the system, is 'engine' .there are module, shaft",
            ),
            (lambda: system.run(0.01, [("engine", "omega1")]), "is 'engine'"),
            (lambda: system.run(0.0105, ENDS), "whole number of steps of 0.001 s after 0 s, is 0.0105 s"),
            (lambda: system.run(-1.0, ENDS), "is -1 s"),
        ):
            with pytest.raises(WiringError, match=words):
                refused()
        assert system.time == 0.0
        system.advance()
        system.set("module", omega1=1e9)
        with pytest.raises(FmuError, match=r"module: .*omega1 must be .*, is 1000000000"):
            system.advance()
    for refused in (lambda: system.run(0.01, ENDS), system.advance, lambda: system.set("module", omega1=1.0)):
        with pytest.raises(WiringError, match="an FMU must be of a system that is open, is 'module'"):
            refused()


@pytest.mark.parametrize("drive", ["torque", 1, 1.0, "much"])
def test_the_drive_of_a_module_may_be_named(nodes, drive):
    module = nodes["module"]._replace(parameters=HUB | {"drive": drive, "input_inertia": "0.2 kg.m2"})
    wanted = (
        (FmuError, "drive must be one of speed, torque") if drive == "much" else (WiringError, "no effect")
    )
    idle = Wire("shaft", "omega_out", "module", "omega1")
    with pytest.raises(wanted[0], match=wanted[1]):
        WiredFmus(
            nodes | {"module": module._replace(inputs={"drive_torque": 9.0, "omega1": 1.0})},
            (SPEED, TORQUE, idle) if drive != "much" else (SPEED, TORQUE),
            1e-3,
        )
