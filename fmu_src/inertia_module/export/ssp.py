"""A system as an SSP file (System Structure and Parameterization 1.0): structure, FMUs, values.

Of the standard it uses what OMSimulator, libcosim, Ecos and FMPy all read: each component has its own
values, nothing is connected to the boundary of the system, and only wired inputs have connectors.
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
STRUCTURE = "SystemStructure.ssd"
FMU_TYPE = "application/x-fmu-sharedlibrary"
SSV_TYPE = "application/x-ssp-parameter-set"
# one name for all parts: Ecos applies the sets of the name it is given
VALUES = "initialValues"

# libcosim and Ecos know these prefixes, not their namespaces
for _prefix, _namespace in (("ssd", SSD), ("ssv", SSV), ("ssc", SSC), ("osp", OSP)):
    register_namespace(_prefix, _namespace)


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


def _values_file(part: Part) -> str:
    return f"resources/{part.name}.ssv"


def _connected(plan: Plan, part: Part) -> list[Variable]:
    """Variables of a part that have a connector: those that are wired or shown."""
    ends = [end for w in plan.wires for end in ((w.source, w.output), (w.sink, w.input))]
    names = dict.fromkeys(name for owner, name in [*ends, *plan.outputs] if owner == part.name)
    return [part.variable(name) for name in names]


def _add_component(parent: Element, plan: Plan, part: Part) -> None:
    component = SubElement(
        parent,
        f"{{{SSD}}}Component",
        name=part.name,
        type=FMU_TYPE,
        source=f"resources/{part.fmu.file_name}",
        implementation="CoSimulation",
    )
    connectors = SubElement(component, f"{{{SSD}}}Connectors")
    for variable in _connected(plan, part):
        kind = variable.causality
        connector = SubElement(connectors, f"{{{SSD}}}Connector", name=variable.name, kind=kind)
        SubElement(connector, f"{{{SSC}}}{variable.kind}", _unit(variable))
    bindings = SubElement(component, f"{{{SSD}}}ParameterBindings")
    SubElement(bindings, f"{{{SSD}}}ParameterBinding", type=SSV_TYPE, source=_values_file(part))


def structure(plan: Plan) -> bytes:
    """SystemStructure.ssd of a plan; its step is an annotation for libcosim."""
    root = _head("SystemStructureDescription", SSD, plan.title)
    system = SubElement(root, f"{{{SSD}}}System", name="system")
    elements = SubElement(system, f"{{{SSD}}}Elements")
    for part in plan.parts:
        _add_component(elements, plan, part)
    if plan.wires:
        connections = SubElement(system, f"{{{SSD}}}Connections")
        for wire in plan.wires:
            start = {"startElement": wire.source, "startConnector": wire.output}
            end = {"endElement": wire.sink, "endConnector": wire.input}
            SubElement(connections, f"{{{SSD}}}Connection", start | end)
    _add_units(root, SSD, [variable for part in plan.parts for variable in _connected(plan, part)])
    experiment = SubElement(
        root, f"{{{SSD}}}DefaultExperiment", startTime="0.0", stopTime=repr(plan.stop_time)
    )
    annotations = SubElement(experiment, f"{{{SSD}}}Annotations")
    annotation = SubElement(annotations, f"{{{SSC}}}Annotation", type="com.opensimulationplatform")
    algorithm = SubElement(annotation, f"{{{OSP}}}Algorithm")
    SubElement(algorithm, f"{{{OSP}}}FixedStepAlgorithm", baseStepSize=repr(plan.step))
    return xml_text(root)


def values(part: Part) -> bytes:
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


def ssp_file(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """The content of the .ssp file; fmus: contents by file name, enumerations described as Integers."""
    files = {f"resources/{name}": content for name, content in fmus.items()}
    files |= {_values_file(part): values(part) for part in plan.parts}
    return archive(files | {STRUCTURE: structure(plan)})
