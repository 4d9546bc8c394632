"""Systems for other tools: SSP as fmpy reads it, OSP as libcosim runs it, FMPy's container."""

import importlib.util
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from fmpy.validation import validate_fmu

from inertia_module.export.plan import make_plan
from inertia_module.export.writing import export
from inertia_module.instance import Fmu
from inertia_module.scene import load_scene
from inertia_module.scene.errors import SceneError
from inertia_module.scene.export import scene_plan

ELASTIC = {
    "fidelity": 3.0,
    "output_inertia": 0.02,
    "driven_inertia": 0.5,
    "shaft_stiffness": 400.0,
    "shaft_damping": 0.05,
}
INPUTS = {"omega1": 100.0, "load_torque": 10.0}
STEP, STOP = 1e-3, 0.3
LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
log_output_level(CosimLogLevel.WARNING)
folder, steps = sys.argv[1], int(sys.argv[2])
execution = CosimExecution.from_osp_config_file(folder)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.step(steps)
found = {}
for name in ("module", "shaft"):
    index = execution.slave_index_from_instance_name(name)
    references = {v.name.decode() if isinstance(v.name, bytes) else v.name: v.reference
                  for v in execution.slave_variables(index)}
    found[name] = observer.last_real_values(index, [references["omega_out"]])[0]
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def plan():
    return make_plan("module and shaft", ELASTIC, INPUTS, STEP, STOP)


@pytest.fixture(scope="module")
def folder(plan, tmp_path_factory):
    folder = tmp_path_factory.mktemp("export")
    export(plan, folder)
    return folder


@pytest.fixture(scope="module")
def stepped(folder):
    """Speeds of hub and driven mass after a plain loop over both FMUs."""
    module_values = {"fidelity": 2, "output_inertia": 0.02, "tolerance": 1e-6}
    shaft_values = {name: ELASTIC[name] for name in ("driven_inertia", "shaft_stiffness", "shaft_damping")}
    with (
        Fmu(folder / "osp" / "InertiaModule.fmu", module_values, {"omega1": 100.0}) as module,
        Fmu(folder / "osp" / "DrivenShaft.fmu", shaft_values, {"load_torque": 10.0}) as shaft,
    ):
        for _ in range(round(STOP / STEP)):
            torque, speed = shaft["shaft_torque_mean"], module["omega_out"]
            module.set(load_torque=torque)
            shaft.set(hub_speed=speed)
            module.advance(STEP)
            shaft.advance(STEP)
        return module["omega_out"], shaft["omega_out"]


def in_libcosim(folder):
    """Speeds of hub and driven mass after the OSP structure has run."""
    command = [sys.executable, "-c", LIBCOSIM, str(folder / "osp"), str(round(STOP / STEP))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    return found["module"], found["shaft"]


def test_osp_structure_runs_in_libcosim_to_the_numbers_of_a_plain_loop(folder, stepped):
    if importlib.util.find_spec("libcosimpy") is None:
        pytest.skip("libcosimpy is not installed; it comes with the extra inertia-module[hosts]")
    assert in_libcosim(folder) == pytest.approx(stepped, rel=1e-9)


def test_container_runs_to_the_numbers_of_a_plain_loop(folder, stepped):
    path = str(folder / "container.fmu")
    assert validate_fmu(path) == []
    result = simulate_fmu(path, stop_time=STOP, output_interval=STEP)
    last = result[-1]
    assert last["time"] == pytest.approx(STOP)
    assert (last["module.omega_out"], last["shaft.omega_out"]) == pytest.approx(stepped, rel=1e-9)


def test_values_of_the_container_can_be_set(folder):
    path = str(folder / "container.fmu")
    run = {"stop_time": STOP, "output_interval": STEP}
    heavier = simulate_fmu(path, start_values={"shaft.driven_inertia": 1.0}, **run)
    plain = simulate_fmu(path, **run)
    assert heavier["shaft.omega_out"][-1] < plain["shaft.omega_out"][-1]


def test_ssp_file_is_valid_and_holds_structure_fmus_and_values(folder, plan):
    path = str(folder / "system.ssp")
    description = read_ssd(path)  # validates against the schema
    assert [element.name for element in description.system.elements] == ["module", "shaft"]
    between = {
        (c.startElement, c.startConnector, c.endElement, c.endConnector)
        for c in description.system.connections
        if c.startElement and c.endElement
    }
    assert between == {tuple(wire) for wire in plan.wires}
    values = {p.name: p for p in read_ssv(path, "resources/values.ssv").parameters}
    assert float(values["shaft.shaft_stiffness"].value) == 400.0
    assert values["shaft.shaft_stiffness"].unit == "N.m/rad"
    assert values["module.fidelity"].value == "2"
    with zipfile.ZipFile(path) as packed:
        for element in description.system.elements:
            assert element.source in packed.namelist()


def test_fmpy_simulates_the_ssp_file(folder):
    """FMPy's SSP host starts the inputs at zero, so the first step is a jump: the motion is its own."""
    path = str(folder / "system.ssp")
    result = simulate_ssp(
        path,
        stop_time=STOP,
        step_size=STEP,
        parameter_set=read_ssv(path, "resources/values.ssv"),
        input={name: lambda time, value=value: value for name, value in INPUTS.items()},
    )
    assert result["shaft.omega_out"][-1] > 5.0
    assert result["omega1"][-1] == 100.0


def test_a_mechanism_without_a_shaft_is_one_fmu(tmp_path):
    plan = make_plan("module", {"fidelity": 2.0}, INPUTS, STEP, STOP)
    paths = export(plan, tmp_path / "new")
    assert {path.relative_to(tmp_path / "new").as_posix() for path in paths} == {
        "system.ssp",
        "osp/OspSystemStructure.xml",
        "osp/InertiaModule.fmu",
        "container.fmu",
    }
    result = simulate_fmu(str(tmp_path / "new" / "container.fmu"), stop_time=0.1, output_interval=0.01)
    with Fmu(tmp_path / "new" / "osp" / "InertiaModule.fmu", {"tolerance": 1e-6}, INPUTS) as module:
        for _ in range(100):
            module.advance(STEP)
        assert result["module.omega_out"][-1] == pytest.approx(module["omega_out"], rel=1e-9)


# --- driven by torque ---

BY_TORQUE = {"drive": 1.0, "input_inertia": 0.3}
TORQUE_START = {"omega1": 100.0, "drive_torque": 25.0, "load_torque": 10.0}


@pytest.fixture(scope="module")
def by_torque(tmp_path_factory):
    plan = make_plan("by torque", {**ELASTIC, **BY_TORQUE}, TORQUE_START, STEP, STOP)
    folder = tmp_path_factory.mktemp("torque")
    export(plan, folder)
    return plan, folder


def test_a_system_driven_by_torque_has_the_torque_for_its_input(by_torque):
    plan, folder = by_torque
    assert plan.inputs == (("module", "drive_torque"), ("shaft", "load_torque"))
    path = str(folder / "system.ssp")
    system = read_ssd(path).system
    assert {c.name for c in system.connectors if c.kind == "input"} == {"drive_torque", "load_torque"}
    into = {
        (c.startConnector, c.endElement, c.endConnector) for c in system.connections if not c.startElement
    }
    assert into == {("drive_torque", "module", "drive_torque"), ("load_torque", "shaft", "load_torque")}
    values = {p.name: p for p in read_ssv(path, "resources/values.ssv").parameters}
    assert float(values["module.drive_torque"].value) == 25.0
    assert values["module.drive_torque"].unit == "N.m"
    assert float(values["module.omega1"].value) == 100.0
    assert values["module.drive"].value == "1"


def test_its_container_and_its_osp_structure_run_to_the_numbers_of_a_plain_loop(by_torque):
    _, folder = by_torque
    module_values = {"fidelity": 2, "output_inertia": 0.02, "tolerance": 1e-6, **BY_TORQUE}
    module_start = {"omega1": 100.0, "drive_torque": 25.0}
    shaft_values = {name: ELASTIC[name] for name in ("driven_inertia", "shaft_stiffness", "shaft_damping")}
    with (
        Fmu(folder / "osp" / "InertiaModule.fmu", module_values, module_start) as module,
        Fmu(folder / "osp" / "DrivenShaft.fmu", shaft_values, {"load_torque": 10.0}) as shaft,
    ):
        for _ in range(round(STOP / STEP)):
            torque, speed = shaft["shaft_torque_mean"], module["omega_out"]
            module.set(load_torque=torque)
            shaft.set(hub_speed=speed)
            module.advance(STEP)
            shaft.advance(STEP)
        expected = module["omega_out"], shaft["omega_out"]
        speed = module["input_speed"]
    last = simulate_fmu(str(folder / "container.fmu"), stop_time=STOP, output_interval=STEP)[-1]
    assert (last["module.omega_out"], last["shaft.omega_out"]) == pytest.approx(expected, rel=1e-9)
    assert last["module.input_speed"] == pytest.approx(speed, rel=1e-9)
    assert abs(speed - 100.0) > 1.0
    if importlib.util.find_spec("libcosimpy") is not None:
        assert in_libcosim(folder) == pytest.approx(expected, rel=1e-9)


def test_a_scene_driven_by_torque_is_exported_with_its_torque():
    plan = scene_plan(load_scene(Path(__file__).parents[2] / "examples" / "engine.toml"))
    values = plan.part("module").values
    assert (values["drive"], values["omega1"], values["drive_torque"]) == (1.0, 200.0, 0.0)
    assert plan.inputs == (("module", "drive_torque"), ("module", "load_torque"))


def test_the_copies_for_osp_describe_choices_as_integers(folder):
    description = read_model_description(str(folder / "osp" / "InertiaModule.fmu"))
    kinds = {variable.name: variable.type for variable in description.modelVariables}
    assert kinds["fidelity"] == kinds["layout"] == "Integer"


def test_scenes_are_exported_with_their_mechanism_and_start(tmp_path):
    scene = load_scene(Path(__file__).parents[2] / "examples" / "planar.toml")
    plan = scene_plan(scene)
    values = plan.part("module").values
    assert values["layout"] == 1.0
    assert values["omega1"] == 120.0
    assert plan.step == 5e-4
    with pytest.raises(SceneError, match="fidelity = 'auto' is refused"):
        scene_plan(scene.with_fidelity("auto", 0.01))
