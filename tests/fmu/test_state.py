import shutil
import zipfile

import pytest
from fmpy import extract, read_model_description, simulate_fmu

from inertia_module.fmu import builder, python_fmu

from .conftest import Instance

SCENES = {
    "rigid": {"omega1": 100.0, "load_torque": 10.0},
    "ramp": {"omega1": 100.0, "load_torque": 10.0, "input_hold": 1},
    "planar": {"layout": 1, "omega1": 120.0, "load_torque": 8.0, "satellites": 3},
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4, "omega1": 90.0},
    "by torque": {"drive": 1, "input_inertia": 0.3, "omega1": 100.0, "drive_torque": 30.0},
    "averaged by torque": {"fidelity": 1, "drive": 1, "input_inertia": 0.3, "omega1": 100.0},
    "elastic by torque": {"fidelity": 3, "drive": 1, "input_inertia": 0.3, "omega1": 100.0},
    "timestepping by torque": {"method": 1, "drive": 1, "input_inertia": 0.3, "omega1": 100.0},
    "no freewheels": {"housing_freewheel": False, "output_freewheel": False, "omega1": 60.0},
}


def run(instance, n, h=0.013):
    for i in range(n):
        instance.set(omega1=100.0 + 7.0 * (i % 3), drive_torque=30.0 - 20.0 * (i % 3))
        instance.step(h)


@pytest.fixture(params=SCENES)
def scene(request):
    return SCENES[request.param]


def test_restored_state_runs_on_with_the_same_bits(instance, scene):
    instance.start(**scene)
    run(instance, 20)
    saved = instance.fmu.getFMUstate()
    run(instance, 20)
    first = instance.all_values()
    instance.fmu.setFMUstate(saved)
    run(instance, 20)
    assert instance.all_values() == first
    instance.fmu.freeFMUstate(saved)


def test_serialised_state_runs_on_in_a_new_instance_with_the_same_bits(instances, scene):
    first = instances().start(**scene)
    run(first, 20)
    saved = first.fmu.getFMUstate()
    serialised = first.fmu.serializeFMUstate(saved)
    run(first, 20)
    second = instances()
    second.fmu.setFMUstate(second.fmu.deSerializeFMUstate(serialised))
    run(second, 20)
    assert second.all_values() == first.all_values()


def test_state_of_something_else_is_refused(instance):
    instance.start(omega1=100.0)
    saved = instance.fmu.getFMUstate()
    serialised = instance.fmu.serializeFMUstate(saved)

    def take_over():
        instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(bytes(len(serialised))))

    assert "state" in instance.refusal(take_over)
    instance.fmu.setFMUstate(saved)
    assert not instance.is_discarded(0.01)


def test_reset_is_a_new_start(instance):
    instance.start(omega1=100.0, load_torque=10.0, link2_inertia=0.02)
    instance.step(0.5)
    instance.fmu.reset()
    assert instance.get("link2_inertia") == 0.005
    instance.time = 0.0
    instance.start(tolerance=1e-9, omega1=100.0, load_torque=10.0)
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


def test_many_instances_one_after_the_other(instances):
    for _ in range(50):
        assert not instances().start(omega1=10.0).is_discarded(0.01)


def test_two_different_builds_live_in_one_process(monkeypatch, tmp_path, instances):
    files = python_fmu.bundled_files()
    source = files["contract/variables.py"].decode()
    assert '"link2_inertia", "kg.m2", 0.005' in source.replace("\n", " ").replace("  ", "")
    files["contract/variables.py"] = source.replace("0.005", "0.0075", 1).encode()
    monkeypatch.setattr(python_fmu, "bundled_files", lambda: files)
    path = tmp_path / "InertiaModulePy.fmu"
    path.write_bytes(builder.content_of(builder.PYTHON_FMU)[0])
    ours = instances().start(omega1=100.0, load_torque=10.0)
    other = Instance(read_model_description(str(path)), extract(str(path), unzipdir=str(tmp_path / "x")))
    other.start(omega1=100.0, load_torque=10.0)
    for instance in (ours, other):
        instance.step(0.1)
    assert ours.get("link2_inertia") == 0.005
    assert other.get("link2_inertia") == 0.0075
    assert ours.get("omega_out") != other.get("omega_out")
    other.close()


def test_fmpy_simulates_it_with_one_call_and_its_start_values_are_scene_r1(fmu_path):
    result = simulate_fmu(str(fmu_path), output_interval=0.01)
    assert result["time"][-1] == 1.0
    assert result["omega_out"][-1] == pytest.approx(17.968063040, rel=1e-6)


def test_it_runs_from_a_path_with_spaces_and_umlauts(fmu_path, tmp_path, description):
    folder = tmp_path / "Ordner mit Ümläuten"
    folder.mkdir()
    copy = shutil.copy(fmu_path, folder)
    assert zipfile.is_zipfile(copy)
    result = simulate_fmu(str(copy), stop_time=0.1, start_values={"omega1": 100.0})
    assert len(result) > 10
