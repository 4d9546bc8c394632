"""modelDescription.xml of FMI 2.0 from a model and its table of variables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

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


def _number(value: float) -> str:
    return f"{value:.17g}" if value != int(value) or abs(value) > 1e15 else f"{value:.1f}"


def truth(value: bool) -> str:
    """A Boolean as XML has it."""
    return "true" if value else "false"


def add_units(root: Element, variables: Iterable[Variable]) -> None:
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


def add_types(root: Element, model: Model, new_type: Callable[[Element, str], Element]) -> None:
    """The enumerations that variables have; new_type: adds the element of one, by its name."""
    used = {variable.enumeration for variable in model.variables}
    definitions = SubElement(root, "TypeDefinitions")
    for name, items in ENUMERATIONS.items():
        if name in used:
            enumeration = new_type(definitions, name)
            for item, value, description in items:
                SubElement(enumeration, "Item", name=item, value=str(value), description=description)


def _new_type(definitions: Element, name: str) -> Element:
    return SubElement(SubElement(definitions, "SimpleType", name=name), "Enumeration")


def real_attributes(variable: Variable) -> dict[str, str]:
    """Attributes of a Real: units, range, nominal and start value."""
    attributes = {"unit": variable.unit}
    if variable.unit in DISPLAY_UNITS:
        attributes["displayUnit"] = DISPLAY_UNITS[variable.unit][0]
    numbers = {"min": variable.minimum, "max": variable.maximum, "nominal": variable.nominal}
    attributes |= {key: _number(value) for key, value in numbers.items() if value is not None}
    if variable.start is not None:
        attributes["start"] = _number(variable.start)
    return attributes


def discrete_attributes(variable: Variable) -> dict[str, str]:
    """Attributes of an Integer or an Enumeration: type, range and start value."""
    attributes = {"declaredType": variable.enumeration} if variable.kind == ENUMERATION else {}
    numbers = {"min": variable.minimum, "max": variable.maximum, "start": variable.start}
    return attributes | {key: str(int(value)) for key, value in numbers.items() if value is not None}


def variable_attributes(reference: int, variable: Variable) -> dict[str, str]:
    """Attributes of a variable of any type."""
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != INPUT:
        attributes["initial"] = "exact" if variable.causality == PARAMETER else "calculated"
    return attributes


def _add_variable(parent: Element, reference: int, variable: Variable) -> None:
    scalar = SubElement(parent, "ScalarVariable", variable_attributes(reference, variable))
    if variable.kind == REAL:
        SubElement(scalar, REAL, real_attributes(variable))
    elif variable.kind == BOOLEAN:
        SubElement(scalar, BOOLEAN, start=truth(bool(variable.start)))
    elif variable.kind in (INTEGER, ENUMERATION):
        SubElement(scalar, variable.kind, discrete_attributes(variable))


def outputs_of(model: Model, first: int) -> Iterator[tuple[str, str]]:
    """Number of each output, and those of what it depends on at initialisation, counted from first."""
    numbers = {variable.name: str(n) for n, variable in enumerate(model.variables, first)}
    for output in model.with_causality(OUTPUT):
        known = model.known_at_start(output.name)
        yield numbers[output.name], " ".join(number for name, number in numbers.items() if name in known)


def _add_structure(root: Element, model: Model) -> None:
    """Outputs hold the end of the last step: at a communication point none depends on an input."""
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    for index, dependencies in outputs_of(model, first=1):
        SubElement(outputs, "Unknown", index=index, dependencies="")
        SubElement(unknowns, "Unknown", index=index, dependencies=dependencies)


def origin(model: Model, date: str) -> dict[str, str]:
    """Attributes of the description that say what it is of, and where it is from; date: of the generation."""
    return {
        "description": model.description,
        "author": "The inertia module developers",
        "version": __version__,
        "license": "MIT",
        "generationTool": f"inertia-module {__version__}",
        "generationDateAndTime": date,
        "variableNamingConvention": "flat",
    }


def add_run(root: Element, model: Model, *, logs_steps: bool) -> None:
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
    model: Model, identifier: str, guid: str, date: str, capabilities: Mapping[str, str]
) -> bytes:
    """The XML of modelDescription.xml.

    Args:
        model: what it describes. identifier: model identifier, the name of the binaries.
        guid: hash of the content. date: generation date and time, UTC, ending in Z.
        capabilities: attributes of the element CoSimulation.
    """
    named = {"fmiVersion": "2.0", "modelName": identifier, "guid": guid}
    root = Element("fmiModelDescription", named | origin(model, date))
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **capabilities})
    add_units(root, model.variables)
    add_types(root, model, _new_type)
    add_run(root, model, logs_steps=capabilities is not PYTHON_CAPABILITIES)  # which pythonfmu does not know
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        _add_variable(variables, reference, variable)
    _add_structure(root, model)
    return xml_text(root)
