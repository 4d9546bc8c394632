"""Systems of FMUs, planned for a mechanism and exported as SSP 1.0, as OSP and as one container FMU.

A plan contains the module and the values of a scene. With an elastic shaft it contains two connected FMUs:
the rigid module and the driven shaft. export.md describes the used part of SSP. The container is from
FMPy.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import fmpy.container_fmu

from .. import __version__
from ..common.files import write_atomically
from ..fmu.archive import DESCRIPTION, archive, generation_date, guid_of, render, render_xml
from ..fmu.builder import MODULE_FMU, SHAFT_FMU, content_of
from ..fmu.linking import Progress, join_for_mac
from ..fmu.native_fmu import Build, NativeFmu
from ..interface.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..interface.variables import PARAMETER, UNITS, Variable
from ..kernel.codes import ELASTIC, RIGID

MODULE, SHAFT = "module", "shaft"
TEMPLATES = Path(__file__).parent / "templates"
OSP_STRUCTURE = "OspSystemStructure.xml"
# names of the outputs with a connector, by part
CONNECTED_OUTPUTS = {
    MODULE: (
        *("input_speed", "omega2", "omega_out", "input_torque_mean", "output_torque_mean"),
        "imbalance_acceleration",
    ),
    SHAFT: ("omega_out", "shaft_torque_mean", "twist", "driven_acceleration"),
}


class Part(NamedTuple):
    """One FMU of a system.

    Attributes:
        name: name of the part.
        fmu: the FMU.
        values: values by name that differ from the start values.
    """

    name: str
    fmu: NativeFmu
    values: dict[str, float]

    def variable(self, name: str) -> Variable:
        """Return a variable of the FMU.

        Args:
            name: name of the variable.
        """
        return self.fmu.model.by_name[name]


class Wire(NamedTuple):
    """Connection of an output of one part to an input of another part.

    Attributes:
        source: name of the part with the output.
        output: name of the output.
        sink: name of the part with the input.
        input: name of the input.
    """

    source: str
    output: str
    sink: str
    input: str


class Plan(NamedTuple):
    """A system of FMUs to export.

    Attributes:
        title: title of the system.
        parts: the FMUs.
        wires: connections between the FMUs.
        outputs: outputs of the system as pairs of part and variable.
        step: communication step, s.
        stop_time: stop time, s.
    """

    title: str
    parts: tuple[Part, ...]
    wires: tuple[Wire, ...]
    outputs: tuple[tuple[str, str], ...]
    step: float
    stop_time: float

    def part(self, name: str) -> Part:
        """Return a part.

        Args:
            name: name of the part.
        """
        return next(part for part in self.parts if part.name == name)


def _parameters(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    names = {variable.name for variable in model.with_causality(PARAMETER)}
    return {name: float(value) for name, value in values.items() if name in names}


def make_plan(
    title: str,
    values: Mapping[str, float],
    inputs: Mapping[str, float],
    step: float,
    stop_time: float,
) -> Plan:
    """Plan the system for a mechanism: the module alone or, if it is elastic, the rigid module and its shaft.

    Args:
        title: title of the system.
        values: parameters of the module that differ from their start values.
        inputs: omega1, load_torque and, for a torque-driven module, drive_torque at the start.
        step: communication step, s.
        stop_time: stop time, s.
    """
    module_values, shaft_values = _parameters(INERTIA_MODULE, values), _parameters(DRIVEN_SHAFT, values)
    module_values.setdefault("tolerance", 1e-6)
    wires: tuple[Wire, ...] = ()
    if values.get("fidelity") == ELASTIC:
        rigid = {name: value for name, value in module_values.items() if name not in DRIVEN_SHAFT.by_name}
        rigid |= {
            name: module_values[name] for name in ("omega_out_start", "input_hold") if name in module_values
        }
        rigid |= {**inputs, "fidelity": float(RIGID), "load_torque": 0.0}
        start = {"hub_speed": module_values.get("omega_out_start", 0.0), "load_torque": inputs["load_torque"]}
        parts: tuple[Part, ...] = (
            Part(MODULE, MODULE_FMU, rigid),
            Part(SHAFT, SHAFT_FMU, shaft_values | start),
        )
        wires = (
            Wire(MODULE, "omega_out", SHAFT, "hub_speed"),
            Wire(SHAFT, "shaft_torque_mean", MODULE, "load_torque"),
        )
    else:
        parts = (Part(MODULE, MODULE_FMU, {**module_values, **inputs}),)
    outputs = tuple((part.name, output) for part in parts for output in CONNECTED_OUTPUTS[part.name])
    return Plan(title, parts, wires, outputs, step, stop_time)


def type_and_value(variable: Variable, value: float) -> tuple[str, str]:
    """Return the type and the value of a variable as texts for files of other tools.

    An enumeration becomes an Integer, because libcosim and Ecos do not support enumerations and FMPy does not
    accept item names.

    Args:
        variable: the variable.
        value: its value.
    """
    if variable.kind == "Boolean":
        return "Boolean", "true" if value else "false"
    if variable.kind == "Real":
        return "Real", repr(float(value))
    return "Integer", str(int(value))


# --- SSP and OSP ---


def _render(template: str, plan: Plan, **values: Any) -> bytes:
    """Return a file of a plan, rendered from its template."""
    origin = {
        "generationTool": f"inertia-module {__version__}",
        "generationDateAndTime": generation_date(),
    }
    return render_xml(
        TEMPLATES / template, {"plan": plan, "type_and_value": type_and_value, "origin": origin, **values}
    )


def _units(variables: Iterable[Variable]) -> dict[str, dict[str, int]]:
    """Return the exponents of base units for the units of variables."""
    return {name: UNITS[name] for name in sorted({variable.unit for variable in variables} - {""})}


def osp_structure(plan: Plan) -> bytes:
    """Return OspSystemStructure.xml of a plan for libcosim; the FMUs describe enumerations as Integers.

    Args:
        plan: the system.
    """
    return _render(OSP_STRUCTURE, plan)


def ssp_file(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """Return the content of the .ssp file.

    Args:
        plan: the system.
        fmus: contents of the FMUs by file name, with enumerations described as Integers.
    """
    wired = [end for w in plan.wires for end in ((w.source, w.output), (w.sink, w.input))]
    # part and name of the variables with a connector: connected variables and outputs of the system
    connectors = list(dict.fromkeys([*wired, *plan.outputs]))
    connector_units = _units(plan.part(owner).variable(name) for owner, name in connectors)
    files = {f"resources/{name}": content for name, content in fmus.items()}
    for part in plan.parts:
        units = _units(map(part.variable, part.values))
        files[f"resources/{part.name}.ssv"] = _render("ParameterSet.ssv", plan, part=part, units=units)
    files["SystemStructure.ssd"] = _render(
        "SystemStructure.ssd", plan, connectors=connectors, units=connector_units
    )
    return archive(files)


# --- container ---

LIBRARY = "container_fmu"
# names of types in the configuration of the container, as in FMI 3.0
CONTAINED = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}


def _texts(plan: Plan, guid: str, fmu_files: Mapping[str, Mapping[str, bytes]]) -> dict[str, bytes]:
    """Return the model description and the configuration of the container.

    Args:
        plan: the system.
        guid: GUID of the container.
        fmu_files: files of each FMU by name of the FMU.
    """
    wired = {(wire.sink, wire.input) for wire in plan.wires}
    values = {(part.name, name): value for part in plan.parts for name, value in part.values.items()}
    # part, variable, type and start value of the unconnected values, then of the outputs
    rows: list[tuple[str, Variable, str, str | None]] = []
    for owner, name in [*(end for end in values if end not in wired), *plan.outputs]:
        variable, value = plan.part(owner).variable(name), values.get((owner, name))
        kind, start = type_and_value(variable, value or 0.0)
        rows.append((owner, variable, kind, None if value is None else start))
    description = {"values": rows, "units": _units(row[1] for row in rows), "guid": guid, "library": LIBRARY}

    def reference(owner: str, name: str) -> int:
        part = plan.part(owner)
        return part.fmu.model.variables.index(part.variable(name))

    roots = {p.name: ElementTree.fromstring(fmu_files[p.fmu.file_name][DESCRIPTION]) for p in plan.parts}
    configuration = {
        **{"plan": plan, "values": rows, "guid": guid, "version": fmpy.container_fmu.__version__},
        **{"types": CONTAINED, "reference": reference, "places": {name: n for n, name in enumerate(roots)}},
        "guids": {name: root.get("guid") for name, root in roots.items()},
    }
    return {
        DESCRIPTION: _render("container.xml", plan, **description),
        "resources/container.json": render(TEMPLATES / "container.json", configuration, json.dumps).encode(),
    }


def _libraries() -> dict[str, bytes]:
    """Return FMPy's libraries of the container by path in an FMU; macOS has one for both processors."""
    folder = Path(fmpy.container_fmu.__file__).parent / "binaries"
    mac = [
        (triple, (folder / name / f"{LIBRARY}.dylib").read_bytes())
        for triple, name in (("x86_64", "x86_64-darwin"), ("aarch64", "aarch64-darwin"))
    ]
    return {
        f"binaries/linux64/{LIBRARY}.so": (folder / "x86_64-linux" / f"{LIBRARY}.so").read_bytes(),
        f"binaries/win64/{LIBRARY}.dll": (folder / "x86_64-windows" / f"{LIBRARY}.dll").read_bytes(),
        f"binaries/darwin64/{LIBRARY}.dylib": join_for_mac(mac),
    }


def container(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """Return the content of a container FMU with the FMUs of a plan.

    The start values of the container are the values of the parts, with names part.variable. It steps the
    parts in parallel (Jacobi scheme) with the step of the plan.

    Args:
        plan: the system.
        fmus: contents of the FMUs by file name.
    """
    fmu_files = {file_name: _unpacked(content) for file_name, content in fmus.items()}
    guid = guid_of({**fmus, "structure": osp_structure(plan)})
    files = _texts(plan, guid, fmu_files) | _libraries()
    for file_name, content in fmu_files.items():
        folder = f"resources/{Path(file_name).stem}"
        files |= {f"{folder}/{name}": file for name, file in content.items()}
    return archive(files)


def _unpacked(fmu: bytes) -> dict[str, bytes]:
    """Return the files of an FMU by name."""
    with zipfile.ZipFile(io.BytesIO(fmu)) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def with_integers(fmu: bytes) -> bytes:
    """Return a copy of an FMU that describes enumerations as Integers; its libraries are unchanged.

    libcosim and Ecos ignore enumerations, so without this change they could not set the fidelity.

    Args:
        fmu: content of the FMU.
    """
    content = _unpacked(fmu)
    root = ElementTree.fromstring(content[DESCRIPTION])
    for element in root.iterfind("ModelVariables/ScalarVariable/Enumeration"):
        element.tag = "Integer"
        del element.attrib["declaredType"]
    content[DESCRIPTION] = ElementTree.tostring(root, xml_declaration=True, encoding="UTF-8")
    return archive(content)


def export(plan: Plan, folder: Path, progress: Progress = lambda stage: None) -> list[Path]:
    """Write system.ssp, osp/ (structure and FMUs) and container.fmu into a folder.

    Args:
        plan: the system.
        folder: output folder (created if missing).
        progress: function that is called at the beginning of each stage, with its description.

    Returns:
        Paths of the files.

    Raises:
        CompilationError: the native FMUs cannot be built on this machine.
    """
    fmus = {}
    for part in plan.parts:
        progress(f"building {part.fmu.file_name}")
        fmus[part.fmu.file_name] = with_integers(content_of(part.fmu, Build(progress)))
    progress("packing the system")
    files = {"system.ssp": ssp_file(plan, fmus), f"osp/{OSP_STRUCTURE}": osp_structure(plan)}
    files |= {f"osp/{name}": content for name, content in fmus.items()}
    files["container.fmu"] = container(plan, fmus)
    for name, content in files.items():
        write_atomically(folder / name, content)
    return [folder / name for name in files]
