"""A system as an SSP file (System Structure and Parameterization 1.0): structure, FMUs, values."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, indent, register_namespace, tostring

from .. import __version__
from ..fmu.archive import archive, generation_date
from ..variables import ENUMERATION, ENUMERATIONS, UNITS, Variable
from .plan import Part, Plan, typed

_BASE = "http://ssp-standard.org/SSP1/SystemStructure"
SSD, SSV, SSC = f"{_BASE}Description", f"{_BASE}ParameterValues", f"{_BASE}Common"
VALUES = "resources/values.ssv"
FMU_TYPE = "application/x-fmu-sharedlibrary"
SSV_TYPE = "application/x-ssp-parameter-set"

for _prefix, _namespace in (("ssd", SSD), ("ssv", SSV), ("ssc", SSC)):
    register_namespace(_prefix, _namespace)


def _head(kind: str, namespace: str, name: str) -> Element:
    return Element(
        f"{{{namespace}}}{kind}",
        version="1.0",
        name=name,
        generationTool=f"inertia-module {__version__}",
        generationDateAndTime=generation_date(),
    )


def _text(root: Element) -> bytes:
    indent(root)
    found: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return found + b"\n"


def _connector(parent: Element, name: str, kind: str, variable: Variable) -> None:
    connector = SubElement(parent, f"{{{SSD}}}Connector", name=name, kind=kind)
    if variable.kind == ENUMERATION:
        SubElement(connector, f"{{{SSC}}}Enumeration", name=variable.enumeration)
    else:
        unit = {"unit": variable.unit} if variable.unit else {}
        SubElement(connector, f"{{{SSC}}}{variable.kind}", unit)


def _component(parent: Element, plan: Plan, part: Part) -> None:
    component = SubElement(
        parent,
        f"{{{SSD}}}Component",
        name=part.name,
        type=FMU_TYPE,
        source=f"resources/{part.fmu.file_name}",
        implementation="CoSimulation",
    )
    connectors = SubElement(component, f"{{{SSD}}}Connectors")
    used = {(name, output) for name, output in plan.outputs} | {(w.source, w.output) for w in plan.wires}
    for variable in part.model.with_causality("input", "output"):
        if variable.causality == "input" or (part.name, variable.name) in used:
            _connector(connectors, variable.name, variable.causality, variable)


def _names(plan: Plan, ends: tuple[tuple[str, str], ...]) -> dict[str, tuple[str, str]]:
    """Names of the system's connectors: plain where one part has it, else with the part in front."""
    plain = [name for _, name in ends]
    return {name if plain.count(name) == 1 else f"{part}_{name}": (part, name) for part, name in ends}


def structure(plan: Plan) -> bytes:
    """SystemStructure.ssd of a plan."""
    root = _head("SystemStructureDescription", SSD, plan.title)
    system = SubElement(root, f"{{{SSD}}}System", name="system")
    inputs, outputs = _names(plan, plan.inputs), _names(plan, plan.outputs)
    connectors = SubElement(system, f"{{{SSD}}}Connectors")
    for kind, names in (("input", inputs), ("output", outputs)):
        for name, (owner, variable) in names.items():
            _connector(connectors, name, kind, plan.part(owner).variable(variable))
    bindings = SubElement(system, f"{{{SSD}}}ParameterBindings")
    SubElement(bindings, f"{{{SSD}}}ParameterBinding", type=SSV_TYPE, source=VALUES)
    elements = SubElement(system, f"{{{SSD}}}Elements")
    for part in plan.parts:
        _component(elements, plan, part)
    connections = SubElement(system, f"{{{SSD}}}Connections")
    kind = f"{{{SSD}}}Connection"
    for name, (owner, variable) in inputs.items():
        SubElement(connections, kind, startConnector=name, endElement=owner, endConnector=variable)
    for wire in plan.wires:
        start = {"startElement": wire.source, "startConnector": wire.output}
        SubElement(connections, kind, {**start, "endElement": wire.sink, "endConnector": wire.input})
    for name, (owner, variable) in outputs.items():
        SubElement(connections, kind, startElement=owner, startConnector=variable, endConnector=name)
    _add_enumerations(root, plan)
    used = {v.unit for part in plan.parts for v in part.model.with_causality("input", "output")}
    _add_units(root, SSD, used)
    SubElement(root, f"{{{SSD}}}DefaultExperiment", startTime="0.0", stopTime=repr(plan.stop_time))
    return _text(root)


def _add_enumerations(root: Element, plan: Plan) -> None:
    """The enumerations of the connectors."""
    used = {
        variable.enumeration
        for part in plan.parts
        for variable in part.model.with_causality("input", "output")
        if variable.kind == ENUMERATION
    }
    if not used:
        return
    parent = SubElement(root, f"{{{SSD}}}Enumerations")
    for name in sorted(used):
        enumeration = SubElement(parent, f"{{{SSC}}}Enumeration", name=name)
        for item, value, _ in ENUMERATIONS[name]:
            SubElement(enumeration, f"{{{SSC}}}Item", name=item, value=str(value))


def values(plan: Plan) -> bytes:
    """The values of the parts (SSV), named part.variable."""
    root = _head("ParameterSet", SSV, f"values of {plan.title}")
    parameters = SubElement(root, f"{{{SSV}}}Parameters")
    for part in plan.parts:
        for name, value in part.values.items():
            variable = part.variable(name)
            kind, text = typed(variable, value)
            parameter = SubElement(parameters, f"{{{SSV}}}Parameter", name=f"{part.name}.{name}")
            unit = {"unit": variable.unit} if kind == "Real" and variable.unit else {}
            # an enumeration is set by its number: hosts that know no items know that
            kind = "Integer" if kind == ENUMERATION else kind
            SubElement(parameter, f"{{{SSV}}}{kind}", {"value": text, **unit})
    _add_units(root, SSV, {part.variable(name).unit for part in plan.parts for name in part.values})
    return _text(root)


def _add_units(root: Element, namespace: str, names: set[str]) -> None:
    parent = SubElement(root, f"{{{namespace}}}Units")
    for name in sorted(names - {""}):
        unit = SubElement(parent, f"{{{SSC}}}Unit", name=name)
        SubElement(unit, f"{{{SSC}}}BaseUnit", {base: str(power) for base, power in UNITS[name].items()})


def ssp_file(plan: Plan, fmus: dict[str, bytes]) -> bytes:
    """The content of the .ssp file; fmus: contents by file name."""
    files = {f"resources/{name}": content for name, content in fmus.items()}
    return archive(files | {"SystemStructure.ssd": structure(plan), VALUES: values(plan)})
