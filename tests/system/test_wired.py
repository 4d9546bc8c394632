"""Module and shaft as two models: wired, checked before anything starts, against the elastic module."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest
from refused import assert_refused

from inertia_module.harness.fmu import Fmu
from inertia_module.harness.simulate import drive
from inertia_module.harness.system import GAUSS_SEIDEL, JACOBI, Node, WiredFmus

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "two_fmus.py"))
SHAFT, (SPEED, TORQUE) = EXAMPLE["SHAFT"], EXAMPLE["WIRES"]
HUB = {"output_inertia": 0.02}
ENDS = (("module", "omega_out"), ("shaft", "omega_out"))
WINDOW, WINDOWS = 0.01, 30
WITH_DERIVATIVES = "with derivatives"


@pytest.fixture(scope="module")
def nodes(built):
    return {
        "module": Node(built / "InertiaModule.fmu", HUB, {"omega1": 100.0}, 1e-8),
        "shaft": Node(built / "DrivenShaft.fmu", SHAFT, {"load_torque": 10.0}),
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
    monkeypatch.setattr("inertia_module.harness.system.Fmu", lambda *_: pytest.fail("an FMU was loaded"))
    assert_refused(r"module\.load_torque must be driven by", WiredFmus, nodes, (SPEED,), 1e-3)
    assert_refused("order must be .*, is 'implicit'", WiredFmus, nodes, (SPEED, TORQUE), 1e-3, "implicit")
    assert_refused("no such file", WiredFmus, nodes | {"shaft": Node("nothing.fmu")}, (SPEED, TORQUE), 1e-3)


def test_what_a_system_cannot_do_is_said_in_a_sentence(nodes):
    driven = Node(nodes["module"].path, HUB | {"drive": "much"}, {"drive_torque": 9.0, "omega1": 1.0})
    driven = nodes | {"module": driven}
    assert_refused("drive must be one of speed, torque", WiredFmus, driven, (SPEED, TORQUE), 1e-3)
    with WiredFmus(nodes, (SPEED, TORQUE), 1e-3) as system:
        system.set("shaft", load_torque=3.0)
        for refused, words in (
            (lambda: system.set("module", load_torque=3.0), r"module\.load_torque must be .* no wire drives"),
            (lambda: system.set("engine", omega1=1.0), "engine must be an FMU of .*there are module, shaft"),
            (lambda: system.run(0.01, [("engine", "omega1")]), "engine must be an FMU"),
            (lambda: system.run(0.0105, ENDS), "whole number of steps of 0.001 s after 0 s, is 0.0105 s"),
            (lambda: system.run(-1.0, ENDS), "is -1 s"),
        ):
            assert_refused(words, refused)
        assert system.time == 0.0
        system.advance()
        system.set("module", omega1=1e9)
        assert_refused(r"module: .*omega1 must be .*, is 1000000000", system.advance)
    for refused in (lambda: system.run(0.01, ENDS), system.advance, lambda: system.set("module", omega1=1.0)):
        assert_refused("module must be an FMU of a system that is open", refused)


# --- in each of the ways, against the elastic module in one piece ---


@pytest.fixture(scope="module")
def elastic(built):
    """Speeds of hub and driven mass at the end of each window, shape (windows, 2), in one piece."""
    parameters = {"fidelity": "elastic", **HUB, **SHAFT}
    with Fmu(built / "InertiaModule.fmu", parameters, {"omega1": 100.0, "load_torque": 10.0}, 1e-10) as fmu:
        rows = []
        for _ in range(WINDOWS):
            fmu.advance(WINDOW)
            rows.append(fmu.read(("omega_hub", "omega_out")))
    return np.array(rows)


def stepped(nodes, way, step, steps, look):
    """Results of `look` at the two FMUs after each step, and the energies they passed each other."""
    found = []
    with WiredFmus(nodes, (SPEED, TORQUE), step, JACOBI if way == WITH_DERIVATIVES else way) as system:
        both = system.fmus["module"], system.fmus["shaft"]
        for _ in range(steps):
            EXAMPLE["advance"](*both, step) if way == WITH_DERIVATIVES else system.advance()
            found.append(look(*both))
        return np.array(found), both[0]["energy_out"], both[1]["energy_in"]


def coupled(nodes, way, step):
    """(speeds as above of two FMUs, share of the energy out of the module that is lost on the way)."""
    every = round(WINDOW / step)
    speeds, left, arrived = stepped(
        nodes, way, step, WINDOWS * every, lambda *both: [fmu["omega_out"] for fmu in both]
    )
    return speeds[every - 1 :: every], (left - arrived) / abs(left)


def error(found, expected):
    return math.sqrt(np.mean((found[:, 1] - expected[:, 1]) ** 2)) / np.abs(expected[:, 1]).max()


@pytest.mark.parametrize("way, order", [(JACOBI, 1.0), (GAUSS_SEIDEL, 1.0), (WITH_DERIVATIVES, 2.0)])
def test_two_fmus_tend_to_the_elastic_module_with_the_order_of_the_coupling(nodes, elastic, way, order):
    errors = [error(coupled(nodes, way, step)[0], elastic) for step in (5e-4, 1e-4)]
    assert math.log(errors[0] / errors[1]) / math.log(5.0) > 0.8 * order


def test_example_couples_as_this_does(built, nodes):
    for way, name in ((JACOBI, "simulate"), (WITH_DERIVATIVES, "simulate_with_derivatives")):
        ends = EXAMPLE[name](1e-3, stop=WINDOW * WINDOWS, folder=built)
        assert ends == pytest.approx(coupled(nodes, way, 1e-3)[0][-1], rel=1e-4)


def test_recommended_coupling_loses_no_energy_where_the_mean_torque_makes_some(nodes, elastic):
    _, made = coupled(nodes, JACOBI, 1e-3)
    assert made < -0.1
    found, lost = coupled(nodes, WITH_DERIVATIVES, 1e-3)
    assert abs(lost) < 1e-3
    assert error(found, elastic) < 2e-3


def swing(built, way, z, steps):
    """Growth of the swing of a free hub on an undamped shaft with a heavy mass; z = h^2 c/J3."""
    step, speed = 1e-4, 50.0
    free = {**HUB, "imbalance_mass": 1e-9, "omega_out_start": speed}
    shaft = {
        "shaft_stiffness": z * HUB["output_inertia"] / step**2,
        "shaft_damping": 0.0,
        "driven_inertia": 1e6,
    }
    shaft |= {"twist_start": 1e-7, "omega_out_start": speed}
    nodes = {
        "module": Node(built / "InertiaModule.fmu", free, {"omega1": 100.0}, 1e-9),
        "shaft": Node(built / "DrivenShaft.fmu", shaft, {"load_torque": 0.0, "hub_speed": speed}),
    }
    twists, _, _ = stepped(nodes, way, step, steps, lambda _, driven: abs(driven["twist"]))
    third = steps // 3
    return max(twists[-third:]) / max(twists[:third])


@pytest.mark.parametrize(
    "way, z, steps, least, most",
    [
        # up to two steps to a radian it neither swings up nor dies down
        *((WITH_DERIVATIVES, z, 120, 0.98, 1.02) for z in (0.04, 1.0, 3.0, 3.9)),
        (WITH_DERIVATIVES, 4.1, 15, 10.0, math.inf),
        # a mean torque makes it swing up at any step
        (JACOBI, 0.04, 120, 1.2, math.inf),
        (GAUSS_SEIDEL, 0.04, 120, 1.2, math.inf),
    ],
)
def test_undamped_hub_swings_up_beyond_its_limit_and_not_before(built, way, z, steps, least, most):
    assert least < swing(built, way, z, steps) < most
