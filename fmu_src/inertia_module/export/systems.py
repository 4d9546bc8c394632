"""A system in the files of other tools: SSP (System Structure and Parameterization 1.0), and OSP's structure.

Of SSP it uses what OMSimulator, libcosim, Ecos and FMPy all read: each component has its own values, nothing
is connected to the boundary of the system, and only wired inputs have connectors.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement, register_namespace

from .. import __version__
from ..contract.variable import UNITS, Variable
from ..fmu.archive import archive, generation_date, xml_text
from .plan import Part, Plan, typed

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
