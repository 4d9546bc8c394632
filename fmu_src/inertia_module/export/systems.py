"""Systems of FMUs: planned for a mechanism, and written in the files of SSP 1.0 and of OSP.

A plan is the module or, if its shaft is elastic, the rigid module and its shaft as two FMUs, wired, with the
values of a scene. Of SSP (System Structure and Parameterization) it uses what OMSimulator, libcosim, Ecos and
FMPy all read: each component has its own values, nothing is connected to the boundary of the system, and
only wired inputs have connectors.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, register_namespace

from .. import __version__
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..contract.variable import PARAMETER, UNITS, Variable
from ..fmu.archive import archive, generation_date, xml_text
from ..fmu.builder import MODULE_FMU, SHAFT_FMU
from ..fmu.native_fmu import NativeFmu
from ..harness.wires import Wire
from ..kernel.codes import DRIVE_TORQUE, ELASTIC, RIGID

MODULE, SHAFT = "module", "shaft"
# outputs worth a connector
SHOWN = {
    MODULE: (
        "input_speed",
        "omega2",
        "omega_out",
        "input_torque_mean",
        "output_torque_mean",
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


class Plan(NamedTuple):
    """A system of FMUs to export.

    Attributes:
        title: of the system. parts: its FMUs. wires: between them.
        inputs: inputs that no wire drives (part, variable). outputs: those that are shown, likewise.
        step: communication step, s. stop_time: s.
    """

    title: str
    parts: tuple[Part, ...]
    wires: tuple[Wire, ...]
    inputs: tuple[tuple[str, str], ...]
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
        title: of the system.
        values: parameters of the module that differ from their start values.
        inputs: omega1, load_torque and, of a module driven by torque, drive_torque at the start.
        step: communication step, s. stop_time: s.
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
    drive = "drive_torque" if values.get("drive") == DRIVE_TORQUE else "omega1"
    ends = ((MODULE, drive), (parts[-1].name, "load_torque"))
    shown = tuple((part.name, output) for part in parts for output in SHOWN[part.name])
    return Plan(title, parts, wires, ends, shown, step, stop_time)


def typed(variable: Variable, value: float) -> tuple[str, str]:
    """(kind, value as text) of a variable in files of other tools; an enumeration as an Integer.

    libcosim and Ecos know no enumerations, FMPy knows none by the names of their items.
    """
    if variable.kind == "Boolean":
        return "Boolean", "true" if value else "false"
    if variable.kind == "Real":
        return "Real", repr(float(value))
    return "Integer", str(int(value))


# --- SSP and OSP ---

_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
SSD, SSV, SSC = f"{_BASE}Description", f"{_BASE}ParameterValues", f"{_BASE}Common"
OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
# libcosim and Ecos know these prefixes, not their namespaces
for _prefix, _namespace in (("ssd", SSD), ("ssv", SSV), ("ssc", SSC), ("osp", OSP)):
    register_namespace(_prefix, _namespace)
# one name for all parts: Ecos applies the sets of the name it is given
VALUES = "initialValues"
OSP_STRUCTURE, OSP_NAMESPACE = (
    "OspSystemStructure.xml",
    "http://opensimulationplatform.com/MSMI/OSPSystemStructure",
)


def osp_structure(plan: Plan) -> bytes:
    """OspSystemStructure.xml of a plan, for libcosim; its FMUs describe enumerations as Integers."""
    root = Element("OspSystemStructure", xmlns=OSP_NAMESPACE, version="0.1")
    SubElement(root, "StartTime").text = "0.0"
    SubElement(root, "BaseStepSize").text = repr(plan.step)
    SubElement(root, "Algorithm").text = "fixedStep"
    simulators = SubElement(root, "Simulators")
    for part in plan.parts:
        simulator = SubElement(
            simulators, "Simulator", name=part.name, source=part.fmu.file_name, stepSize=repr(plan.step)
        )
        initial = SubElement(simulator, "InitialValues")
        for name, value in part.values.items():
            kind, text = typed(part.variable(name), value)
            entry = SubElement(initial, "InitialValue", variable=name)
            SubElement(entry, kind, value=text)
    connections = SubElement(root, "Connections")
    for wire in plan.wires:
        connection = SubElement(connections, "VariableConnection")
        SubElement(connection, "Variable", simulator=wire.source, name=wire.output)
        SubElement(connection, "Variable", simulator=wire.sink, name=wire.input)
    return xml_text(root)


def ssp_file(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """The content of the .ssp file; fmus: contents by file name, enumerations described as Integers."""
    files = {f"resources/{name}": content for name, content in fmus.items()}
    files |= {_values_file(part): _values(part) for part in plan.parts}
    return archive(files | {"SystemStructure.ssd": _structure(plan)})


def _structure(plan: Plan) -> bytes:
    """SystemStructure.ssd of a plan; its step is an annotation for libcosim."""
    root = _head("SystemStructureDescription", SSD, plan.title)
    system = SubElement(root, f"{{{SSD}}}System", name="system")
    elements = SubElement(system, f"{{{SSD}}}Elements")
    wired = [end for w in plan.wires for end in ((w.source, w.output), (w.sink, w.input))]
    # variables of a part that have a connector: those that are wired or shown
    ends = list(dict.fromkeys([*wired, *plan.outputs]))
    for part in plan.parts:
        connected = [part.variable(name) for owner, name in ends if owner == part.name]
        component = SubElement(
            elements,
            f"{{{SSD}}}Component",
            name=part.name,
            type="application/x-fmu-sharedlibrary",
            source=f"resources/{part.fmu.file_name}",
            implementation="CoSimulation",
        )
        connectors = SubElement(component, f"{{{SSD}}}Connectors")
        for variable in connected:
            kind = variable.causality
            connector = SubElement(connectors, f"{{{SSD}}}Connector", name=variable.name, kind=kind)
            SubElement(connector, f"{{{SSC}}}{variable.kind}", _unit(variable))
        bindings = SubElement(component, f"{{{SSD}}}ParameterBindings")
        binding = {"type": "application/x-ssp-parameter-set", "source": _values_file(part)}
        SubElement(bindings, f"{{{SSD}}}ParameterBinding", binding)
    if plan.wires:
        connections = SubElement(system, f"{{{SSD}}}Connections")
        for wire in plan.wires:
            start = {"startElement": wire.source, "startConnector": wire.output}
            end = {"endElement": wire.sink, "endConnector": wire.input}
            SubElement(connections, f"{{{SSD}}}Connection", start | end)
    _add_units(root, SSD, [plan.part(owner).variable(name) for owner, name in ends])
    times = {"startTime": "0.0", "stopTime": repr(plan.stop_time)}
    experiment = SubElement(root, f"{{{SSD}}}DefaultExperiment", times)
    annotations = SubElement(experiment, f"{{{SSD}}}Annotations")
    annotation = SubElement(annotations, f"{{{SSC}}}Annotation", type="com.opensimulationplatform")
    algorithm = SubElement(annotation, f"{{{OSP}}}Algorithm")
    SubElement(algorithm, f"{{{OSP}}}FixedStepAlgorithm", baseStepSize=repr(plan.step))
    return xml_text(root)


def _values_file(part: Part) -> str:
    return f"resources/{part.name}.ssv"


def _values(part: Part) -> bytes:
    """The values of a part (SSV)."""
    root = _head("ParameterSet", SSV, VALUES)
    parameters = SubElement(root, f"{{{SSV}}}Parameters")
    for name, value in part.values.items():
        kind, text = typed(part.variable(name), value)
        parameter = SubElement(parameters, f"{{{SSV}}}Parameter", name=name)
        unit = _unit(part.variable(name)) if kind == "Real" else {}
        SubElement(parameter, f"{{{SSV}}}{kind}", {"value": text, **unit})
    _add_units(root, SSV, map(part.variable, part.values))
    return xml_text(root)


def _head(kind: str, namespace: str, name: str) -> Element:
    return Element(
        f"{{{namespace}}}{kind}",
        version="1.0",
        name=name,
        generationTool=f"inertia-module {__version__}",
        generationDateAndTime=generation_date(),
    )


def _unit(variable: Variable) -> dict[str, str]:
    return {"unit": variable.unit} if variable.unit else {}


def _add_units(root: Element, namespace: str, variables: Iterable[Variable]) -> None:
    parent = SubElement(root, f"{{{namespace}}}Units")
    for name in sorted({variable.unit for variable in variables} - {""}):
        unit = SubElement(parent, f"{{{SSC}}}Unit", name=name)
        SubElement(unit, f"{{{SSC}}}BaseUnit", {base: str(power) for base, power in UNITS[name].items()})
