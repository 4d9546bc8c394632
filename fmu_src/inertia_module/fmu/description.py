"""modelDescription.xml of FMI 2.0 from a model and its table of variables."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from .. import __version__
from ..contract.models import Model
from ..contract.variable import (
    BOOLEAN,
    DISPLAY_UNITS,
    ENUMERATION,
    ENUMERATIONS,
    INPUT,
    INTEGER,
    OUTPUT,
    PARAMETER,
    REAL,
    UNITS,
    Variable,
)

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


def _number(value: float) -> str:
    return f"{value:.17g}" if value != int(value) or abs(value) > 1e15 else f"{value:.1f}"


def _bool(value: bool) -> str:
    return "true" if value else "false"


def initial_dependencies(model: Model, output: str) -> list[int]:
    """Indices (from 1) of the inputs and parameters an output depends on at initialisation."""
    known = model.known_at_start(output)
    return [index for index, variable in enumerate(model.variables, 1) if variable.name in known]


def _add_units(root: Element, model: Model) -> None:
    used = {variable.unit for variable in model.variables}
    definitions = SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        if name not in used:
            continue
        unit = SubElement(definitions, "Unit", name=name)
        SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})
        if name in DISPLAY_UNITS:
            display, factor = DISPLAY_UNITS[name]
            SubElement(unit, "DisplayUnit", name=display, factor=_number(factor))


def _add_types(root: Element, model: Model) -> None:
    used = {variable.enumeration for variable in model.variables}
    definitions = SubElement(root, "TypeDefinitions")
    for name, items in ENUMERATIONS.items():
        if name not in used:
            continue
        enumeration = SubElement(SubElement(definitions, "SimpleType", name=name), "Enumeration")
        for item, value, description in items:
            SubElement(enumeration, "Item", name=item, value=str(value), description=description)


def _real_attributes(variable: Variable) -> dict[str, str]:
    attributes = {"unit": variable.unit}
    numbers = {"min": variable.minimum, "max": variable.maximum, "nominal": variable.nominal}
    attributes |= {key: _number(value) for key, value in numbers.items() if value is not None}
    if variable.start is not None:
        attributes["start"] = _number(variable.start)
    return attributes


def _discrete_attributes(variable: Variable) -> dict[str, str]:
    attributes = {"declaredType": variable.enumeration} if variable.kind == ENUMERATION else {}
    numbers = {"min": variable.minimum, "max": variable.maximum, "start": variable.start}
    return attributes | {key: str(int(value)) for key, value in numbers.items() if value is not None}


def _add_variable(parent: Element, reference: int, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != INPUT:
        attributes["initial"] = "exact" if variable.causality == PARAMETER else "calculated"
    scalar = SubElement(parent, "ScalarVariable", attributes)
    if variable.kind == REAL:
        SubElement(scalar, REAL, _real_attributes(variable))
    elif variable.kind == BOOLEAN:
        SubElement(scalar, BOOLEAN, start=_bool(bool(variable.start)))
    elif variable.kind in (INTEGER, ENUMERATION):
        SubElement(scalar, variable.kind, _discrete_attributes(variable))


def _add_structure(root: Element, model: Model) -> None:
    """Outputs hold the end of the last step: at a communication point none depends on an input."""
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    for index, variable in enumerate(model.variables, 1):
        if variable.causality == OUTPUT:
            SubElement(outputs, "Unknown", index=str(index), dependencies="")
            known = " ".join(map(str, initial_dependencies(model, variable.name)))
            SubElement(unknowns, "Unknown", index=str(index), dependencies=known)


def model_description(
    model: Model, identifier: str, guid: str, date: str, capabilities: Mapping[str, str]
) -> bytes:
    """The XML of modelDescription.xml.

    Args:
        model: what it describes. identifier: model identifier, the name of the binaries.
        guid: hash of the content. date: generation date and time, UTC, ending in Z.
        capabilities: attributes of the element CoSimulation.
    """
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=identifier,
        guid=guid,
        description=model.description,
        author="The inertia module developers",
        version=__version__,
        license="MIT",
        generationTool=f"inertia-module {__version__}",
        generationDateAndTime=date,
        variableNamingConvention="flat",
    )
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **capabilities})
    _add_units(root, model)
    _add_types(root, model)
    categories = SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        if name == "logSteps" and capabilities is PYTHON_CAPABILITIES:
            continue  # pythonfmu knows the others only
        SubElement(categories, "Category", name=name, description=description)
    SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime="1.0", tolerance="1e-06", stepSize="0.001"
    )
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        _add_variable(variables, reference, variable)
    _add_structure(root, model)
    indent(root)
    text: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"
