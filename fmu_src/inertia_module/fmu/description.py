"""XML of an FMU from the table of variables: modelDescription.xml, terminalsAndIcons.xml."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement

from .. import __version__
from ..contract.models import INFLOW, Model, Terminal
from ..contract.variable import (
    BOOLEAN,
    DISPLAY_UNITS,
    ENUMERATION,
    ENUMERATIONS,
    INPUT,
    INTEGER,
    LOCAL,
    OUTPUT,
    PARAMETER,
    REAL,
    UNITS,
    Variable,
)
from .archive import xml_text

LOG_CATEGORIES = {
    "logStatusWarning": "What the host should know but need not act on.",
    "logStatusDiscard": "A step that was refused: the state is as it was.",
    "logStatusError": "Parameters or calls that were refused.",
    "logSteps": "A line for every communication step.",
    "logAll": "All messages.",
}
NATIVE_CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "1",
    "canRunAsynchronuously": "false",  # spelt so in the standard
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "false",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}
# what pythonfmu passes on; Python is a library it needs, no tool: the model itself is in the FMU
PYTHON_CAPABILITIES = NATIVE_CAPABILITIES | {
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canNotUseMemoryManagementFunctions": "true",
    "providesDirectionalDerivative": "false",
}

NATIVE_CAPABILITIES_3 = {
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
    "providesAdjointDerivatives": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "maxOutputDerivativeOrder": "1",
    "providesIntermediateUpdate": "true",
}
# of a model whose steps can stop at a switch
OF_SWITCHES = {"mightReturnEarlyFromDoStep": "true", "hasEventMode": "true"}
# names of types in FMI 3.0, where they are others
TYPES_3 = {REAL: "Float64", INTEGER: "Int32"}
TIME = Variable(
    *("time", "", REAL, "independent", "continuous", "s", None, None, None),
    "time since the start of the run",
)
# icon of FMI 3.0: its square, the millimetres it is drawn in, the icon of a flange
CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
MILLIMETRES = "0.1"
FLANGE = "flange"
# in the icon that docs/make_icons.py draws: height of the central axis, half a flange, distance of two
AXIS, HALF, APART = -18, 8, 40


def _number(value: float) -> str:
    return f"{value:.17g}" if value != int(value) or abs(value) > 1e15 else f"{value:.1f}"


def _add_units(root: Element, variables: Iterable[Variable]) -> None:
    """The units that variables have, with their display units."""
    used = {variable.unit for variable in variables}
    definitions = SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        if name not in used:
            continue
        unit = SubElement(definitions, "Unit", name=name)
        SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})
        if name in DISPLAY_UNITS:
            display, factor = DISPLAY_UNITS[name]
            SubElement(unit, "DisplayUnit", name=display, factor=_number(factor))


def _add_types(root: Element, model: Model, fmi: int) -> None:
    """The enumerations that variables have."""
    used = {variable.enumeration for variable in model.variables}
    definitions = SubElement(root, "TypeDefinitions")
    for name, items in ENUMERATIONS.items():
        if name not in used:
            continue
        if fmi == 2:
            enumeration = SubElement(SubElement(definitions, "SimpleType", name=name), "Enumeration")
        else:
            enumeration = SubElement(definitions, "EnumerationType", name=name)
        for item, value, description in items:
            SubElement(enumeration, "Item", name=item, value=str(value), description=description)


def _value_attributes(variable: Variable) -> dict[str, str]:
    """Attributes of a variable by its kind: unit or declared type, range, nominal and start value."""
    if variable.kind == BOOLEAN:
        return {"start": "true" if variable.start else "false"}
    numbers = {"min": variable.minimum, "max": variable.maximum}
    if variable.kind == REAL:
        attributes = {"unit": variable.unit}
        if variable.unit in DISPLAY_UNITS:
            attributes["displayUnit"] = DISPLAY_UNITS[variable.unit][0]
        numbers["nominal"] = variable.nominal
    else:
        attributes = {"declaredType": variable.enumeration} if variable.kind == ENUMERATION else {}
    write = _number if variable.kind == REAL else lambda value: str(int(value))
    numbers["start"] = variable.start
    return attributes | {key: write(value) for key, value in numbers.items() if value is not None}


def _add_variable(parent: Element, reference: int, variable: Variable, fmi: int) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality not in (INPUT, TIME.causality):  # which the host gives
        attributes["initial"] = "exact" if variable.causality == PARAMETER else "calculated"
    if fmi == 2:
        scalar = SubElement(parent, "ScalarVariable", attributes)
        SubElement(scalar, variable.kind, _value_attributes(variable))
        return
    attributes |= _value_attributes(variable)
    calculated = variable.causality in (OUTPUT, LOCAL)
    if variable.kind == REAL and calculated and variable.variability == "continuous":
        attributes["intermediateUpdate"] = "true"  # which shows values and takes none
    SubElement(parent, TYPES_3.get(variable.kind, variable.kind), attributes)


def _add_structure(root: Element, model: Model, fmi: int) -> None:
    """Outputs hold the end of the last step: at a communication point none depends on an input."""
    structure = SubElement(root, "ModelStructure")
    # FMI 2.0 counts variables from 1, FMI 3.0 has their value references
    numbers = {variable.name: str(n) for n, variable in enumerate(model.variables, 3 - fmi)}
    outputs, unknowns, key = structure, structure, "valueReference"
    names = ("Output", "InitialUnknown")
    if fmi == 2:
        outputs, unknowns = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
        names, key = ("Unknown", "Unknown"), "index"
    for output in model.with_causality(OUTPUT):
        SubElement(outputs, names[0], {key: numbers[output.name], "dependencies": ""})
    for output in model.with_causality(OUTPUT):
        known = model.known_at_start(output.name)
        dependencies = " ".join(number for name, number in numbers.items() if name in known)
        SubElement(unknowns, names[1], {key: numbers[output.name], "dependencies": dependencies})


def _add_run(root: Element, model: Model, *, logs_steps: bool) -> None:
    """Categories of the log, with one of the steps or without, and the experiment to begin with."""
    categories = SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        if name != "logSteps" or logs_steps:
            SubElement(categories, "Category", name=name, description=description)
    experiment = {"startTime": "0.0", "stopTime": "1.0", "stepSize": "0.001"}
    if "tolerance" in model.by_name:
        experiment["tolerance"] = str(model.by_name["tolerance"].start)
    SubElement(root, "DefaultExperiment", experiment)


def model_description(
    model: Model,
    identifier: str,
    guid: str,
    date: str,
    fmi: int = 2,
    capabilities: Mapping[str, str] = NATIVE_CAPABILITIES,
) -> bytes:
    """The XML of modelDescription.xml.

    Args:
        model: what it describes. identifier: model identifier, the name of the binaries.
        guid: hash of the content. date: generation date and time, UTC, ending in Z.
        fmi: version of FMI, 2 or 3. capabilities: attributes of the element CoSimulation with FMI 2.0.
    """
    logs_steps = capabilities is not PYTHON_CAPABILITIES  # which pythonfmu does not know
    variables = model.variables
    named = {"fmiVersion": f"{fmi}.0", "modelName": identifier}
    if fmi == 2:
        named["guid"] = guid
    else:
        named["instantiationToken"] = guid
        capabilities = NATIVE_CAPABILITIES_3 | (OF_SWITCHES if model.switches else {})
        variables = (*variables, TIME)
    origin = {
        "description": model.description,
        "author": "The inertia module developers",
        "version": __version__,
        "license": "MIT",
        "generationTool": f"inertia-module {__version__}",
        "generationDateAndTime": date,
        "variableNamingConvention": "flat",
    }
    root = Element("fmiModelDescription", named | origin)
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **capabilities})
    _add_units(root, variables)
    _add_types(root, model, fmi)
    _add_run(root, model, logs_steps=logs_steps)
    described = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        _add_variable(described, reference, variable, fmi)
    _add_structure(root, model, fmi)
    return xml_text(root)


def _place(model: Model, flange: Terminal) -> dict[str, str]:
    """Corners of a flange: at the left end of the central axis if power comes in there, else at the right."""
    same_side = [other for other in model.terminals if other.flow == flange.flow]
    x, y = -100 if flange.flow == INFLOW else 100, AXIS - APART * same_side.index(flange)
    return {"x1": f"{x - HALF}", "y1": f"{y - HALF}", "x2": f"{x + HALF}", "y2": f"{y + HALF}"}


def terminals(model: Model) -> bytes:
    """The XML: members of a name belong together, a speed to a speed and a torque to a torque.

    An angle goes where there is one (matching rule bus). The kind of a torque says which way it is positive.
    """
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    drawing = SubElement(root, "GraphicalRepresentation")
    SubElement(drawing, "CoordinateSystem", CORNERS, suggestedScalingFactorTo_mm=MILLIMETRES)
    SubElement(drawing, "Icon", CORNERS)
    parent = SubElement(root, "Terminals")
    for flange in model.terminals:
        described = {"name": flange.name, "matchingRule": "bus", "description": flange.description}
        terminal = SubElement(parent, "Terminal", described)
        members = [("speed", flange.speed, "signal"), ("torque", flange.torque, flange.flow)]
        if flange.angle:
            members.append(("angle", flange.angle, "signal"))
        for member, variable, kind in members:
            attributes = {"variableName": variable, "variableKind": kind, "memberName": member}
            SubElement(terminal, "TerminalMemberVariable", attributes)
        SubElement(terminal, "TerminalGraphicalRepresentation", _place(model, flange), iconBaseName=FLANGE)
    return xml_text(root)
