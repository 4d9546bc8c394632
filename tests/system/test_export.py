"""Test exported systems: the SSP file in four readers, the OSP structure in libcosim, the FMPy container."""

import contextlib
import functools
import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.ssd import read_ssd
from fmpy.validation import validate_fmu
from scenes import ELASTIC, MECHANISMS
from scenes import REFERENCE as INPUTS

from inertia_module.common.errors import SceneError
from inertia_module.export import systems
from inertia_module.export.systems import Plan, container, export, make_plan
from inertia_module.fmi.instance import Fmu
from inertia_module.fmu.builder import FMUS
from inertia_module.fmu.native_fmu import Build
from inertia_module.interface.variables import REAL
from inertia_module.scene import load_scene
from inertia_module.scene.export_plan import scene_plan
from tests.packed import files_of
from tests.ready import HERE
from tests.system.programs import needs, printed, process, programs

ROOT = Path(__file__).parents[2]
BY_TORQUE = {"drive": 1.0, "input_inertia": 0.3}
# Mechanism and inputs include a choice, a number, a Boolean that is false, and connections.
SYSTEMS = {
    "module alone": (MECHANISMS["planar"] | {"housing_freewheel": 0.0}, INPUTS),
    "driven by torque": (ELASTIC | BY_TORQUE, INPUTS | {"drive_torque": 25.0, "load_torque": 7.0}),
    "turning at the start": (ELASTIC | {"omega_out_start": 20.0}, INPUTS),
}
STEP, STOP = 1e-3, 1.0  # The programs in export.md use these times.
RUN = {"stop_time": STOP, "output_interval": STEP}
# Python module of each SSP reader, and the tolerance that it sets in the FMUs.
READERS = {"OMSimulator": 1e-4, "libcosimpy": None, "ecospy": None, "fmpy": None}
OSP_FILE = {'from_ssp_file("system.ssp")': 'from_osp_config_file("osp")'}


class Exported(NamedTuple):
    """A plan, its export folder, and the final outputs of a plain loop over its FMUs, by tolerance."""

    name: str
    plan: Plan
    folder: Path
    looped: Callable[[float | None], dict[str, float]]


@pytest.fixture(scope="module")
def host_target():
    """Limit the exports to libraries for this platform."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(systems, "Build", functools.partial(Build, targets=HERE))
        yield


@pytest.fixture(scope="module", params=SYSTEMS)
def exported(request, host_target, tmp_path_factory):
    plan = make_plan(request.param, *SYSTEMS[request.param], STEP, STOP)
    folder = tmp_path_factory.mktemp("export")
    export(plan, folder)
    return Exported(request.param, plan, folder, functools.cache(functools.partial(looped, plan, folder)))


def looped(plan, folder, tolerance=None):
    """Return the outputs at the end of a plain loop over the FMUs, by 'part.output'."""
    with contextlib.ExitStack() as stack:
        fmus = {}
        for part in plan.parts:
            kinds = {"parameter": {}, "input": {}}
            for name, value in part.values.items():
                kinds[part.variable(name).causality][name] = value
            path = folder / "osp" / part.fmu.file_name
            fmus[part.name] = stack.enter_context(Fmu(path, *kinds.values(), tolerance))
        for _ in range(round(STOP / STEP)):
            passed = [(wire, fmus[wire.source][wire.output]) for wire in plan.wires]
            for wire, value in passed:
                fmus[wire.sink].set(**{wire.input: value})
            for fmu in fmus.values():
                fmu.advance(STEP)
        return {f"{part}.{output}": fmus[part][output] for part, output in plan.outputs}


def program(reader):
    """Return the program for a reader from the documentation."""
    return next(block for block in programs("how_to/export.md") if block.startswith(f"from {reader}"))


@pytest.mark.parametrize("reader", READERS)
def test_documented_program_runs_the_ssp_file_to_the_numbers_of_a_plain_loop(reader, exported):
    needs(reader)
    (result,) = printed(program(reader), exported.folder)
    expected = exported.looped(READERS[reader])["module.omega_out"]
    assert abs(expected) > 1.0  # At rest all readers would agree.
    if reader == "fmpy" and exported.name == "turning at the start":
        assert result != pytest.approx(expected, rel=1e-3)  # FMPy sets the inputs of its first step to 0.
    else:
        assert result == pytest.approx(expected, rel=1e-9)
    if reader == "libcosimpy":
        source = program(reader)
        for theirs, ours in OSP_FILE.items():
            assert theirs in source
            source = source.replace(theirs, ours)
        assert printed(source, exported.folder) == pytest.approx([expected], rel=1e-9)


def test_container_runs_to_the_numbers_of_a_plain_loop(exported):
    last = simulate_fmu(str(exported.folder / "container.fmu"), **RUN)[-1]
    assert last["time"] == pytest.approx(STOP)
    expected = exported.looped(None)
    assert {name: last[name] for name in expected} == pytest.approx(expected, rel=1e-9)


def test_ssp_file_is_valid_and_portable(exported):
    path = exported.folder / "system.ssp"
    packed = files_of(path)
    system = read_ssd(str(path)).system  # validates against the schemas of SSP 1.0
    assert b'startTime="0.0" stopTime="1.0"' in packed["SystemStructure.ssd"]
    assert system.connectors == []  # libcosim and Ecos reject connections to system connectors.
    assert {
        (c.startElement, c.startConnector, c.endElement, c.endConnector) for c in system.connections
    } == set(exported.plan.wires)
    wired = {(wire.sink, wire.input) for wire in exported.plan.wires}
    for part, component in zip(exported.plan.parts, system.elements, strict=True):
        # OMSimulator and FMPy set unconnected inputs to zero.
        assert {(part.name, c.name) for c in component.connectors if c.kind == "input"} == wired & {
            (part.name, c.name) for c in component.connectors
        }
        description = read_model_description(io.BytesIO(packed[component.source]))
        described = {variable.name: variable for variable in description.modelVariables}
        [values] = component.parameterBindings[0].parameterValues
        assert values.name == "initialValues"
        assert {p.name for p in values.parameters} == part.values.keys()
        for parameter in values.parameters:
            assert parameter.type == described[parameter.name].type  # No parameter is an Enumeration.
            assert parameter.unit == described[parameter.name].unit


def test_container_has_the_description_that_fmi_2_requires(exported):
    """FMPy alone gives all containers one GUID, duplicate settable variables, and no units."""
    description = read_model_description(str(exported.folder / "container.fmu"))
    variables = {variable.name: variable for variable in description.modelVariables}
    assert re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", description.guid)
    assert "time" not in variables
    assert [unknown.variable.name for unknown in description.outputs] == [
        f"{part}.{output}" for part, output in exported.plan.outputs
    ]
    assert variables["module.omega_out"].unit == "rad/s"
    packed = files_of(exported.folder / "container.fmu")
    assert b"canHandleMultipleSetPerTimeInstant" not in packed["modelDescription.xml"]
    assert packed["binaries/darwin64/container_fmu.dylib"][:8] == bytes.fromhex("cafebabe00000002")


@pytest.mark.parametrize("exported", ["driven by torque"], indirect=True)
def test_files_are_valid_fmus_of_their_own_with_the_same_bytes_each_time(exported, tmp_path):
    for path in export(exported.plan, tmp_path):
        assert path.read_bytes() == (exported.folder / path.relative_to(tmp_path)).read_bytes()
        if path.suffix == ".fmu":
            assert validate_fmu(str(path)) == []
    fmus = {path.name: path.read_bytes() for path in (exported.folder / "osp").glob("*.fmu")}
    other = io.BytesIO(container(exported.plan._replace(step=2 * STEP), fmus))
    path = str(exported.folder / "container.fmu")
    assert read_model_description(other).guid != read_model_description(path).guid
    # The values of the container can be set.
    heavier = simulate_fmu(path, start_values={"shaft.driven_inertia": 1.0}, **RUN)
    assert heavier["shaft.omega_out"][-1] < exported.looped(None)["shaft.omega_out"]


@pytest.mark.parametrize("exported", ["module alone"], indirect=True)
def test_mechanism_without_a_shaft_is_a_single_fmu(exported):
    paths = (path for path in exported.folder.rglob("*") if path.suffix in {".ssp", ".xml", ".fmu"})
    assert {path.relative_to(exported.folder).as_posix() for path in paths} == {
        "system.ssp",
        "osp/OspSystemStructure.xml",
        "osp/InertiaModule.fmu",
        "container.fmu",
    }


def test_an_export_has_libraries_for_all_platforms(built_for_all, tmp_path, monkeypatch):
    monkeypatch.setattr(systems, "Build", Build)  # Undo the limit of other tests to one platform.
    export(make_plan("planar", *SYSTEMS["module alone"], STEP, STOP), tmp_path)
    ours, theirs = (files_of(folder / "InertiaModule.fmu") for folder in (tmp_path / "osp", built_for_all))
    assert list(ours) == list(theirs)


def test_scenes_are_exported_with_their_mechanism_drive_and_start():
    plan = scene_plan(load_scene(ROOT / "examples" / "engine.toml"))
    values = plan.part("module").values
    assert (values["drive"], values["omega1"], values["drive_torque"]) == (1.0, 200.0, 0.0)
    assert (values["load_torque"], plan.wires) == (5.0, ())
    scene = load_scene(ROOT / "examples" / "planar.toml")
    plan = scene_plan(scene)
    values = plan.part("module").values
    assert (values["layout"], values["omega1"], plan.step) == (1.0, 120.0, 5e-4)
    with pytest.raises(
        SceneError,
        match=r"fidelity must be a named level \(got 'auto'\)\. Choose one ",
    ):
        scene_plan(scene.with_fidelity("auto", 0.01))


# --- FMU Manipulation Toolbox: its checker, and its container, a host of FMI 2.0 and 3.0 ---

TOOLBOX = "fmu_manipulation_toolbox"


def tool(name, *arguments, folder):
    """Run one of the tools and return its output."""
    done = process("-m", f"{TOOLBOX}.cli.{name}", *arguments, folder=folder)
    return done.stdout + done.stderr


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_checker_reports_no_problems(fmu, built, tmp_path):
    needs(TOOLBOX)
    report = tool("fmutool", "-input", built / fmu.file_name, "-check", folder=tmp_path)
    assert "seems to be compliant with FMI-" in report
    assert "No semantic error" in report
    assert not [line for line in report.splitlines() if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


@pytest.mark.parametrize(
    "fmi, module, shaft",
    [
        (2, "InertiaModule", "DrivenShaft"),
        (3, "InertiaModule3", "DrivenShaft3"),
        (3, "InertiaModule", "DrivenShaft3"),
    ],
)
def test_container_gives_the_bits_of_module_and_shaft_side_by_side(built, tmp_path, fmi, module, shaft):
    needs(TOOLBOX)
    plan = make_plan("elastic", ELASTIC, INPUTS, STEP, STOP)
    files = {part.name: part.fmu.file_name for part in plan.parts}
    (tmp_path / "osp").mkdir()
    for file, name in zip(files.values(), (module, shaft), strict=True):
        (tmp_path / "osp" / file).symlink_to(built / f"{name}.fmu")
    container = {
        "name": "container.fmu",
        "fmu": list(files.values()),
        "link": [[files[a], output, files[b], given] for a, output, b, given in plan.wires],
        "output": [[files[part], name, f"{part}.{name}"] for part, name in plan.outputs],
        "start": [
            [files[part.name], name, value if part.variable(name).kind == REAL else int(value)]
            for part in plan.parts
            for name, value in part.values.items()
        ],
        "input": [],
        "step_size": STEP,
        **dict.fromkeys(("auto_link", "auto_input", "auto_output"), False),
    }
    (tmp_path / "osp" / "container.json").write_text(json.dumps(container))
    options = ("-container", "container.json", "-fmu-directory", ".", "-fmi", fmi)
    tool("fmucontainer", *options, folder=tmp_path / "osp")
    end_values = simulate_fmu(str(tmp_path / "osp" / "container.fmu"), **RUN)[-1]
    expected = looped(plan, tmp_path)
    assert {name: end_values[name] for name in expected} == expected
