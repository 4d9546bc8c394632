"""Systems of FMUs: planned for a mechanism, and written in the files of SSP 1.0, of OSP and as one FMU.

A plan is the module or, if its shaft is elastic, the rigid module and its shaft as two FMUs, wired, with the
values of a scene. What of SSP is used, and why, is told in docs/systems.md. The one FMU is FMPy's container.
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
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..contract.variables import PARAMETER, UNITS, Variable
from ..fmu.archive import DESCRIPTION, archive, filled, filled_xml, generation_date, guid_of
from ..fmu.builder import MODULE_FMU, SHAFT_FMU, content_of
from ..fmu.linking import Progress, join_for_mac
from ..fmu.native_fmu import Build, NativeFmu
from ..kernel.codes import ELASTIC, RIGID

MODULE, SHAFT = "module", "shaft"
TEMPLATES = Path(__file__).parent / "templates"
OSP_STRUCTURE = "OspSystemStructure.xml"
# outputs worth a connector
SHOWN = {
    MODULE: (
        *("input_speed", "omega2", "omega_out", "input_torque_mean", "output_torque_mean"),
        "imbalance_acceleration",
    ),
    SHAFT: ("omega_out", "shaft_torque_mean", "twist", "driven_acceleration"),
}


class Part(NamedTuple):
    """One FMU of a system: its values by name, those that differ from the start values."""

    name: str
    fmu: NativeFmu
    values: dict[str, float]

    def variable(self, name: str) -> Variable:
        """One of its variables."""
        return self.fmu.model.by_name[name]


class Wire(NamedTuple):
    """A connection: an output of one part drives an input of another.

    Attributes:
        source, output: name of the part and of its output. sink, input: likewise.
    """

    source: str
    output: str
    sink: str
    input: str


class Plan(NamedTuple):
    """A system of FMUs to export.

    Attributes:
        title: of the system. parts: its FMUs. wires: between them.
        outputs: those that are shown (part, variable). step: communication step, s. stop_time: s.
    """

    title: str
    parts: tuple[Part, ...]
    wires: tuple[Wire, ...]
    outputs: tuple[tuple[str, str], ...]
    step: float
    stop_time: float

    def part(self, name: str) -> Part:
        """A part by its name."""
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
        values: parameters of the module that differ from their start values.
        inputs: omega1, load_torque and, of a module driven by torque, drive_torque at the start.
        title, step, stop_time: as of Plan.
    """
    own, of_shaft = _parameters(INERTIA_MODULE, values), _parameters(DRIVEN_SHAFT, values)
    own.setdefault("tolerance", 1e-6)
    wires: tuple[Wire, ...] = ()
    if values.get("fidelity") == ELASTIC:
        rigid = {name: value for name, value in own.items() if name not in DRIVEN_SHAFT.by_name}
        rigid |= {name: own[name] for name in ("omega_out_start", "input_hold") if name in own}
        rigid |= {**inputs, "fidelity": float(RIGID), "load_torque": 0.0}
        start = {"hub_speed": own.get("omega_out_start", 0.0), "load_torque": inputs["load_torque"]}
        parts: tuple[Part, ...] = (
            Part(MODULE, MODULE_FMU, rigid),
            Part(SHAFT, SHAFT_FMU, of_shaft | start),
        )
        wires = (
            Wire(MODULE, "omega_out", SHAFT, "hub_speed"),
            Wire(SHAFT, "shaft_torque_mean", MODULE, "load_torque"),
        )
    else:
        parts = (Part(MODULE, MODULE_FMU, {**own, **inputs}),)
    shown = tuple((part.name, output) for part in parts for output in SHOWN[part.name])
    return Plan(title, parts, wires, shown, step, stop_time)


def typed(variable: Variable, value: float) -> tuple[str, str]:
    """(kind, value as text) of a variable in files of other tools; an enumeration as an Integer.

    libcosim and Ecos know no enumerations, FMPy does not accept item names.
    """
    if variable.kind == "Boolean":
        return "Boolean", "true" if value else "false"
    if variable.kind == "Real":
        return "Real", repr(float(value))
    return "Integer", str(int(value))


# --- SSP and OSP ---


def _filled(template: str, plan: Plan, **values: Any) -> bytes:
    """A file of a plan from its template."""
    origin = {
        "generationTool": f"inertia-module {__version__}",
        "generationDateAndTime": generation_date(),
    }
    return filled_xml(TEMPLATES / template, {"plan": plan, "typed": typed, "origin": origin, **values})


def _units(variables: Iterable[Variable]) -> dict[str, dict[str, int]]:
    """Units of variables, by their exponents of base units."""
    return {name: UNITS[name] for name in sorted({variable.unit for variable in variables} - {""})}


def osp_structure(plan: Plan) -> bytes:
    """OspSystemStructure.xml of a plan, for libcosim; its FMUs describe enumerations as Integers."""
    return _filled(OSP_STRUCTURE, plan)


def ssp_file(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """The content of the .ssp file; fmus: contents by file name, enumerations described as Integers."""
    wired = [end for w in plan.wires for end in ((w.source, w.output), (w.sink, w.input))]
    # variables that have a connector, by part and name: those that are wired or shown
    ends = list(dict.fromkeys([*wired, *plan.outputs]))
    shown = _units(plan.part(owner).variable(name) for owner, name in ends)
    files = {f"resources/{name}": content for name, content in fmus.items()}
    for part in plan.parts:
        units = _units(map(part.variable, part.values))
        files[f"resources/{part.name}.ssv"] = _filled("ParameterSet.ssv", plan, part=part, units=units)
    files["SystemStructure.ssd"] = _filled("SystemStructure.ssd", plan, ends=ends, units=shown)
    return archive(files)


# --- container ---

LIBRARY = "container_fmu"
# types in its configuration, which are those of FMI 3.0
CONTAINED = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}


def _texts(plan: Plan, guid: str, inside: Mapping[str, Mapping[str, bytes]]) -> dict[str, bytes]:
    """Description of the container, and what its library reads; inside: files of each FMU, by their names."""
    wired = {(wire.sink, wire.input) for wire in plan.wires}
    values = {(part.name, name): value for part in plan.parts for name, value in part.values.items()}
    # values that no wire drives, then outputs: name of the part, variable, type, start value
    shown: list[tuple[str, Variable, str, str | None]] = []
    for owner, name in [*(end for end in values if end not in wired), *plan.outputs]:
        variable, value = plan.part(owner).variable(name), values.get((owner, name))
        kind, start = typed(variable, value or 0.0)
        shown.append((owner, variable, kind, None if value is None else start))
    description = {"shown": shown, "units": _units(one[1] for one in shown), "guid": guid, "library": LIBRARY}

    def reference(owner: str, name: str) -> int:
        part = plan.part(owner)
        return part.fmu.model.variables.index(part.variable(name))

    roots = {p.name: ElementTree.fromstring(inside[p.fmu.file_name][DESCRIPTION]) for p in plan.parts}
    configuration = {
        **{"plan": plan, "shown": shown, "guid": guid, "version": fmpy.container_fmu.__version__},
        **{"types": CONTAINED, "reference": reference, "places": {name: n for n, name in enumerate(roots)}},
        "guids": {name: root.get("guid") for name, root in roots.items()},
    }
    return {
        DESCRIPTION: _filled("container.xml", plan, **description),
        "resources/container.json": filled(TEMPLATES / "container.json", configuration, json.dumps).encode(),
    }


def _libraries() -> dict[str, bytes]:
    """FMPy's libraries of the container, by their path in an FMU; for macOS one for both processors."""
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
    """The content of an FMU around the FMUs of a plan; fmus: contents by file name.

    Values of the parts are its start values, named part.variable; it steps its parts side by side (Jacobi)
    at the step of the plan.
    """
    inside = {file_name: _unpacked(content) for file_name, content in fmus.items()}
    guid = guid_of({**fmus, "structure": osp_structure(plan)})
    files = _texts(plan, guid, inside) | _libraries()
    for file_name, content in inside.items():
        folder = f"resources/{Path(file_name).stem}"
        files |= {f"{folder}/{name}": file for name, file in content.items()}
    return archive(files)


def _unpacked(fmu: bytes) -> dict[str, bytes]:
    """Files of an FMU by name."""
    with zipfile.ZipFile(io.BytesIO(fmu)) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def with_integers(fmu: bytes) -> bytes:
    """Copy the content of an FMU, its enumerations described as Integers: to the library inside the same.

    libcosim and Ecos leave variables out that are enumerations, so there no fidelity could be set.
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
        plan: the system. folder: made if it is not there. progress: called with each stage as it begins.

    Returns:
        Paths of the files.

    Raises:
        CompilationUnavailable: the native FMUs cannot be built here.
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
