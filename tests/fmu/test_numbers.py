"""Numbers of the FMUs: check values, and in every scene at every level the bits of the model in memory.

What the model computes is told by the unit tests, of the model in memory.
"""

import math
import shutil
from functools import partial

import pytest
from fmpy import simulate_fmu
from scenes import MECHANISMS

from inertia_module.memory import DrivenShaft, Module

from .conftest import BY_TORQUE, ELASTIC, LEVELS, R1, TUNED

COLUMNS = (
    "contact_mode", "omega2", "omega_out", "input_torque", "mesh_torque", "output_torque", "housing_torque", "q",
    "output_torque_mean", "imbalance_acceleration",
)  # fmt: skip
CHECK_VALUES = {
    0.01: (2, 0.969128517, 0.969128517, 163.43277665, 22.45225325, 22.32896361, 0, 0.995538603, 58.4564258, 2931.116196),
    0.1: (0, 0, 3.447176379, -169.30697594, -95.49415258, 0, 95.49415258, 9.887230876, 27.2358819, 5285.153822),
    1.0: (2, 17.968063040, 17.968063040, 15.48585376, 50.41231783, 50.01219587, 0, 93.434013810, 18.98403152, 1063.437762),
}  # fmt: skip
SCENES = {
    "bevel": {},
    "planar": MECHANISMS["planar"],
    "two modules": {"modules": 2, "satellites": 2, "epsilon": 0.3, "gamma": 0.4},
    "no housing freewheel": {"housing_freewheel": False},
    "no freewheels": {"housing_freewheel": False, "output_freewheel": False},
    "linear hold": {"input_hold": 1},
    "gravity and friction": {"gravity": 9.81, "drive_friction": 0.01},
    "bodies": {"satellite_inertia": 0.002, "satellite_transverse_inertia": 0.0015},
    "heavy input": {"input_inertia": 0.1, "drive_inertia": 0.002, "a": 0.8, "b": 1.1, "c": 0.9},
}
OF_PULSES = ("no housing freewheel", "no freewheels", "gravity and friction")
SHAFTS = ({}, {"input_hold": 1, "balancer": 1.0, "driven_friction": 0.4})
# steps of a drive
COUNT = 12
SPRUNG = {"driven_friction": 0.2, "balancer": 0.3}


def angle(instance):
    return instance.get("drive_angle") + 2 * math.pi * instance.get("drive_turns")


@pytest.mark.parametrize("time", CHECK_VALUES)
def test_scene_r1_gives_the_check_values(instance, time):
    instance.start(tolerance=1e-9, **R1)
    instance.step(time)
    for name, expected in zip(COLUMNS, CHECK_VALUES[time], strict=True):
        found = angle(instance) if name == "q" else instance.get(name)
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-12), name


def test_planar_and_elastic_scenes_give_the_check_values(instances):
    planar = instances().start(tolerance=1e-9, omega1=120.0, load_torque=8.0, **MECHANISMS["planar"])
    planar.step(1.0)
    assert planar.get("omega2") == pytest.approx(51.243199463, rel=1e-6)
    assert planar.get("omega_out") == pytest.approx(51.243199463, rel=1e-6)
    assert angle(planar) == pytest.approx(175.782853305, rel=1e-6)
    elastic = instances().start(tolerance=1e-11, fidelity=3, **R1, **ELASTIC)
    elastic.step(1.0)
    assert elastic.get("omega_hub") == pytest.approx(3.908460340, rel=1e-8)
    assert elastic.get("omega_out") == pytest.approx(16.766411224, rel=1e-9)
    assert elastic.get("shaft_twist") == pytest.approx(-1.550114589e-3, rel=1e-6)


@pytest.mark.parametrize(
    "steps", [[1.0], [1 / 3] * 3, [0.01] * 100, [1e-4] * 10000, [1e-9, 0.25, 1e-4, 0.5 - 1e-4 - 1e-9, 0.25]]
)
def test_result_does_not_depend_on_the_communication_step(instance, steps):
    instance.start(tolerance=1e-9, **R1)
    for step in steps:
        instance.step(step)
    assert instance.get("omega_out") == pytest.approx(17.968063040, rel=3e-9)
    assert instance.get("contact_switches") == 125


def test_tolerance_of_the_experiment_wins_over_the_parameter(instances):
    loose, won = instances().start(**R1), instances().start(tolerance=1e-10, **R1)
    for one in (loose, won):
        one.step(1.0)
    assert won.get("tolerance") == 1e-10
    assert won.get("rhs_evaluations") > 1.5 * loose.get("rhs_evaluations")


def test_shaft_accepts_the_tolerance_of_the_experiment_which_changes_nothing(instances_of):
    ends = []
    for tolerance in (1e-3, None):
        shaft = instances_of("DrivenShaft").start(tolerance=tolerance, hub_speed=20.0, load_torque=3.0)
        shaft.step(0.1)
        ends.append(shaft.all_values())
    assert ends[0] == ends[1]


def driven(target, first=0):
    """Lengths of some uneven steps with inputs that change, and all values after each."""
    rows = []
    for n in range(first, first + COUNT):
        if "hub_speed" in target.snapshot():
            target.set(hub_speed=20.0 + 3.0 * (n % 4), load_torque=3.0 - 0.2 * n)
        else:
            torques = {"load_torque": 10.0 - 1.5 * n, "drive_torque": 30.0 - 25.0 * (n % 3)}
            target.set(omega1=100.0 + 6.0 * (n % 4), **torques)
        step = 0.004 + 0.007 * (n % 3)
        target.advance(step)
        rows.append((step, target.snapshot()))
    return rows


def check_bits_and_state(instances, memory, settings, tuned):
    """The FMU has the bits of the model in memory, and its state, tuned on the way, kept or serialised, runs on."""
    instance, other = instances(), instances()
    for one in (instance, memory):
        one.start(**settings)
    assert instance.snapshot() == memory.snapshot(), settings
    rows = driven(instance)
    assert rows == driven(memory), settings
    for one in (instance, memory):
        one.set(**tuned)
    assert instance.snapshot() == memory.snapshot() == rows[-1][1] | tuned, settings
    kept = instance.fmu.getFMUstate()
    other.restore(instance.fmu.serializeFMUstate(kept))
    onwards = driven(memory, COUNT)
    assert driven(instance, COUNT) == onwards, settings
    instance.fmu.setFMUstate(kept)
    assert driven(instance, COUNT) == onwards, settings
    assert driven(other, COUNT) == onwards, settings
    instance.fmu.freeFMUstate(kept)
    return rows + onwards


def check_balance(rows, share):
    """The energy audit is within a share of the turnover."""
    turnover = max(max(abs(row["energy_in"]), row["energy_stored"]) for _, row in rows)
    assert abs(rows[-1][1]["energy_residual"]) < share * turnover


def check_loads(rows):
    """Loads agree with torques, masses and energies."""
    lost = 0.0
    for step, row in rows:
        drive, mesh = row["input_torque"], row["mesh_torque"]
        own = row["input_inertia"] * row["input_acceleration"]
        scale = abs(drive) + abs(own) + abs(mesh)
        if not row["gravity"]:
            assert row["shaking_moment_x"] == pytest.approx(-(drive - own - mesh), abs=1e-11 * scale)
        force = row["imbalance_mass"] * row["imbalance_acceleration"]
        assert row["satellite_force"] == pytest.approx(force, rel=1e-15)
        assert row["satellite_force_peak"] >= row["satellite_force"]
        lost += step * row["loss_power_mean"]
    assert lost == pytest.approx(rows[-1][1]["energy_lost"], rel=1e-12, abs=1e-15)
    assert max(row["satellite_force_peak"] for _, row in rows) > rows[-1][1]["satellite_force"]


@pytest.mark.parametrize("level", LEVELS.items(), ids=lambda level: level[0])
@pytest.mark.parametrize("scene", SCENES)
def test_fmu_is_the_module_in_memory_and_so_is_its_state(instances, scene, level):
    name, settings = level
    if name.startswith("averaged") and scene in OF_PULSES:
        pytest.skip("averaged takes both freewheels, and by torque no losses")
    start = {"tolerance": 1e-8, **R1, "drive_torque": 30.0, **SCENES[scene], **settings}
    tuned = SPRUNG if name.startswith("averaged") else TUNED  # a map with losses takes seconds
    rows = check_bits_and_state(instances, Module(), start, tuned)
    check_balance(rows, 0.05 if settings.get("method") else 1e-5)
    if not name.startswith("averaged"):
        check_loads(rows[:COUNT])


@pytest.mark.parametrize("identifier", ["DrivenShaft", "DrivenShaft3"])
def test_fmu_is_the_shaft_in_memory_and_so_is_its_state(instances_of, identifier):
    for settings in SHAFTS:
        rows = check_bits_and_state(
            partial(instances_of, identifier), DrivenShaft(), settings, {"shaft_damping": 0.7, **SPRUNG}
        )
        check_balance(rows, 1e-9)


def test_drift_over_a_long_run_stays_within_what_is_promised(instance):
    memory = Module().start(tolerance=1e-9, **R1)
    instance.start(tolerance=1e-9, **R1)
    for one in (instance, memory):
        for _ in range(10):
            one.advance(1.0)
    assert instance.all_values() == memory.snapshot()


@pytest.mark.parametrize(
    "model, start, rates",
    [
        (Module, {"omega1": 50.0, "load_torque": 4.0}, {"omega1": 200.0, "load_torque": -30.0}),
        (Module, {"load_torque": 4.0, "drive_torque": 20.0, **BY_TORQUE}, {"drive_torque": 100.0}),
        (DrivenShaft, {"hub_speed": 10.0, "load_torque": 1.0}, {"hub_speed": 5.0, "load_torque": 2.0}),
    ],
)
def test_given_rates_of_inputs_are_followed_exactly(instances_of, model, start, rates):
    memory, instance = model().start(**start), instances_of(model.model.name).start(**start)
    for one in (memory, instance):
        for n in range(20):
            one.set(**{name: start[name] * (1.0 + 0.04 * n) for name in rates})
            one.set_rates(**rates)
            one.advance(0.01)
    assert instance.all_values() == memory.snapshot()
    assert instance.get("omega_out") != 0.0


def test_reset_is_a_new_start(instance):
    instance.start(**R1, link2_inertia=0.02)
    instance.step(0.5)
    instance.fmu.reset()
    assert instance.get("link2_inertia") == 0.005
    instance.time = 0.0
    instance.start(tolerance=1e-9, **R1)
    instance.step(1.0)
    assert instance.get("omega_out") == pytest.approx(17.968063040, rel=1e-6)


def test_instances_do_not_disturb_each_other(instances):
    def alone(speed):
        instance = instances().start(omega1=speed, load_torque=5.0)
        for _ in range(20):
            instance.step(0.01)
        return instance.all_values()

    speeds = [50.0 + 10.0 * n for n in range(12)]
    expected = [alone(speed) for speed in speeds]
    together = [instances().start(omega1=speed, load_torque=5.0) for speed in speeds]
    for _ in range(20):
        for instance in together:
            instance.step(0.01)
    assert [instance.all_values() for instance in together] == expected


def test_fmpy_simulates_it_from_any_path_and_its_start_values_are_scene_r1(fmu_path, tmp_path):
    folder = tmp_path / "Ordner mit Ümläuten"
    folder.mkdir()
    result = simulate_fmu(shutil.copy(fmu_path, folder), output_interval=0.01)
    assert result["time"][-1] == 1.0
    assert result["omega_out"][-1] == pytest.approx(17.968063040, rel=1e-6)
