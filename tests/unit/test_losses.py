"""Test losses, drag, wind-up, friction and gravity: limiting cases, energies, rejected values.

test_reference.py compares the motion with the reference, and test_motions.py tests invariants.
"""

from itertools import product

import pytest
import scenes
from scenes import advanced, motions, passed, started

from inertia_module.interface.variables import BY_NAME
from inertia_module.kernel import codes
from inertia_module.kernel.equations import satellites
from inertia_module.model import Module

LOCKED_UP = {"drive_angle_start": 3.0, "omega2_start": 100.0, "omega_out_start": 100.0}


@pytest.mark.parametrize("drive", [0, 1], ids=["by-speed", "by-torque"])
def test_machine_with_friction_stays_locked_up(compiled, drive):
    """At a speed ratio of one, under a load that friction holds, slip and losses are zero."""
    engine = {"drive": drive, "input_inertia": 0.2, "drive_torque": 1.0, "load_torque": 1.0}
    locked = {**scenes.SCENES["bevel"], **LOCKED_UP, "journal_friction": 1.0}
    for angle, step in product((1.5, 3.0), (1e-4, 0.01, 1.0)):
        module = started(compiled, locked, engine, drive_angle_start=angle)
        for _ in range(5):
            module.advance(step)
            assert module["omega2"] == module["omega_out"] == module["input_speed"]
            assert module["input_speed"] == pytest.approx(100.0, rel=1e-12)
            assert module["drive_angle"] == angle
            assert module["energy_lost"] == 0.0
            assert module["contact_mode"] == 2
            assert module["energy_out"] == pytest.approx(module["energy_in"], rel=1e-12)


@pytest.mark.parametrize("ratio", [0.4, 1.3, -0.3])
def test_kinematic_motion_agrees_with_a_shaft_of_huge_inertia(compiled, scene, ratio):
    """Compare with the rigid module without freewheels behind a large output inertia."""
    # The friction of the shaft belongs to the load.
    more = {"windage": 1e-4, "satellites": 1, "output_friction": 0.0, **scenes.FREEWHEELS["no freewheel"]}
    values, speed = scene | scenes.ALL_LOSSES | scenes.GEARS | more, ratio * scene["omega1"]
    prescribed = started(compiled, values, fidelity=0, kinematic_ratio=ratio)
    heavy = {"omega2_start": speed, "omega_out_start": speed, "output_inertia": 1e5}
    rigid = started(compiled, values, heavy, tolerance=1e-10)
    for module in (prescribed, rigid):
        advanced(module, 0.02, 0.03)
    assert prescribed["energy_lost_windage"] > 0.0
    for name in (*scenes.ACCOUNTS, *scenes.MEANS[:3], "drive_angle", "energy_in", "satellite_force"):
        assert prescribed[name] == pytest.approx(rigid[name], rel=5e-6), name


@pytest.mark.parametrize("load", [5000.0, 0.01, -1.0])
@pytest.mark.parametrize("losses", ["mesh", "satellite_mesh", "journal", "all"])
def test_ramp_from_rest_breaks_friction_loose(compiled, losses, load):
    module = started(
        compiled,
        scenes.ALL_LOSSES if losses == "all" else scenes.LOSSES[losses],
        omega1=0.0,
        load_torque=load,
    )
    for omega1 in (0.0, 2.0):
        module.set(omega1=omega1)
        module.set_rates(omega1=400.0)
        module.advance(0.005)
        assert abs(module["energy_residual"]) < 1e-4 * passed(module)
    assert module["input_speed"] == pytest.approx(4.0, rel=1e-12)
    assert module["drive_angle"] + module["drive_turns"] > 0.0


@pytest.mark.parametrize("wheel", ["housing", "freewheel"])
def test_compliant_freewheel_never_pulls(compiled, scene, wheel):
    for stiffness, damping in product((1e3, 1e5, 1e7, 1e8), (0.0, 1.0, 1e2, 1e3)):
        spring, speeds = {f"{wheel}_stiffness": stiffness, f"{wheel}_damping": damping}, []
        for tolerance in (1e-3, 1e-6, 1e-9):
            module = started(compiled, scene, scenes.ELASTIC, spring, tolerance=tolerance)
            torques = []
            for _ in range(40):
                module.advance(1e-3)
                torques += [module["housing_torque"], module["output_torque"]]
            assert min(torques) >= -tolerance * max(torques), (stiffness, damping, tolerance)
            speeds.append(module["omega_out"])
        assert speeds[:2] == pytest.approx([speeds[2]] * 2, abs=2e-3 * scene["omega1"]), (stiffness, damping)


# Outputs without meaning if a freewheel is missing.
NOT_THERE = {
    "housing_freewheel": ("housing_drag", "housing_drag_viscous", "housing_stiffness", "housing_damping"),
    "output_freewheel": (
        *("output_drag", "output_drag_viscous"),
        *("freewheel_stiffness", "freewheel_damping"),
    ),
}


@motions(levels=("rigid", "elastic"), added=("ideal", "losses"))
@pytest.mark.parametrize("value", [1e-3, 1e6])
def test_outputs_without_meaning_are_not_modelled(compiled, scene, value):
    """Damping without a spring and parameters of a missing freewheel: at the start, tuned, restored."""
    names = ["housing_damping", "freewheel_damping"]
    for freewheel, others in NOT_THERE.items():
        names += () if scene.get(freewheel, True) else others
    if scene.get("fidelity") != codes.ELASTIC:
        names = [name for name in names if "stiffness" not in name]
    ends = []
    for size in (0.0, value):
        here, later = (
            {name: min(part * size, BY_NAME[name].maximum) for name in names} for part in (1.0, 0.5)
        )
        first = advanced(started(compiled, scene, here, scenes.LOSSES["mesh"]), *[5e-4] * 20)
        second = Module(compiled)
        second.restore(first.save())
        # The friction also changes, because a tuned parameter ends the step.
        tuned = {name: later[name] for name in names if BY_NAME[name].is_tunable}
        advanced(second, *[5e-4] * 20, output_friction=1e-3, **tuned)
        ends.append([*first.state.numbers, *second.state.numbers])
    assert ends[0] == ends[1]


def test_jump_after_many_short_steps_of_a_freewheel_at_its_limit(compiled):
    """In this random motion rounding moved omega2 below zero step by step before omega1 jumped."""
    output = {"output_inertia": 0.016992, "driven_inertia": 60.0, "shaft_stiffness": 10.0}
    scene = output | {"fidelity": 3, "imbalance_mass": 0.0, "link2_inertia": 9e-4, "shaft_damping": 0.02}

    def run(split):
        module = started(compiled, scene, freewheel_stiffness=400.0, omega1=100.0, load_torque=0.04)
        for _ in range(split):
            module.advance(0.0010221 / split)
        assert module["omega2"] >= 0.0
        return advanced(module, 0.0075385, omega1=30.945, load_torque=-0.14931)

    # This is 1e-4 of the tolerance.
    assert run(7)["omega_hub"] == pytest.approx(run(1)["omega_hub"], rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("drive", [0, 1], ids=["by speed", "by torque"])
@pytest.mark.parametrize("loss", ["mesh_efficiency", "satellite_mesh_efficiency"])
def test_jamming_is_searched_in_few_turns_of_many_teeth(monkeypatch, drive, loss):
    looks = []

    def look(*arguments):
        looks.append(True)
        assert len(looks) < 1e5
        return False

    monkeypatch.setattr(satellites, "is_self_locking_at", look)
    teeth = {"z2": 999, "z16": 1000, "z17": 997, "z6": 991}
    started("plain", teeth, {loss: 0.97}, drive=drive, input_inertia=0.01)
    assert bool(looks) == (drive == 1 or loss == "satellite_mesh_efficiency")


@pytest.mark.parametrize("drive", [0, 1], ids=["by speed", "by torque"])
@pytest.mark.parametrize("z6", [13, 41], ids=["all turns", "some turns"])
def test_meshes_jam_as_at_all_angles_of_the_period(drive, z6, monkeypatch):
    monkeypatch.setattr(satellites, "ANGLES_PER_CYCLE", 32)
    scene = {"a": 1.4, "b": 0.7, "z17": 31, "z6": z6, "satellite_mesh_efficiency": 0.3}
    d = started("plain", scene, drive=drive, input_inertia=10.0, link2_inertia=10.0).derived
    results = []
    for exponent in range(-12, 3):
        d.J1 = d.J2 = 10.0 ** (0.5 * exponent)
        whole = satellites.is_self_locking_within(
            d, d.period, satellites.ANGLES_PER_CYCLE * d.harmonic * d.period_turns
        )
        results.append(satellites.is_self_locking(d))
        assert results[-1] == whole
    assert {True, False} == set(results)
