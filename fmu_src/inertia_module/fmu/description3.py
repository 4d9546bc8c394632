"""modelDescription.xml of FMI 3.0 from a model and its table of variables."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..contract.models import Model
from ..contract.variable import BOOLEAN, ENUMERATION, LOCAL, OUTPUT, REAL, Variable
from .archive import xml_text
from .description import (
    add_run,
    add_types,
    add_units,
    discrete_attributes,
    origin,
    outputs_of,
    real_attributes,
    truth,
    variable_attributes,
)

CAPABILITIES = {
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
# names of the types by those of FMI 2.0, where they are others
TYPES = {REAL: "Float64", "Integer": "Int32"}
TIME = Variable(
    "time", REAL, "independent", "continuous", "s", None, None, None, None, "time since the start of the run"
)


def _new_type(definitions: Element, name: str) -> Element:
    return SubElement(definitions, "EnumerationType", name=name)


def _add_variable(parent: Element, reference: int, variable: Variable) -> None:
    attributes = variable_attributes(reference, variable)
    if variable.kind == REAL:
        attributes |= real_attributes(variable)
        if variable.causality in (OUTPUT, LOCAL) and variable.variability == "continuous":
            attributes["intermediateUpdate"] = "true"  # which shows values and takes none
    elif variable.kind == BOOLEAN:
        attributes["start"] = truth(bool(variable.start))
    else:
        attributes |= discrete_attributes(variable)
    SubElement(parent, TYPES.get(variable.kind, variable.kind), attributes)


def _add_time(parent: Element, reference: int) -> None:
    attributes = variable_attributes(reference, TIME) | real_attributes(TIME)
    del attributes["initial"]  # the host gives it
    SubElement(parent, TYPES[REAL], attributes)


def _add_structure(root: Element, model: Model) -> None:
    """Outputs hold the end of the last step: at a communication point none depends on an input."""
    structure = SubElement(root, "ModelStructure")
    outputs = list(outputs_of(model, first=0))
    for reference, _ in outputs:
        SubElement(structure, "Output", valueReference=reference, dependencies="")
    for reference, dependencies in outputs:
        SubElement(structure, "InitialUnknown", valueReference=reference, dependencies=dependencies)


def model_description(model: Model, identifier: str, token: str, date: str) -> bytes:
    """The XML of modelDescription.xml.

    Args:
        model: what it describes. identifier: model identifier, the name of the binaries.
        token: hash of the content. date: generation date and time, UTC, ending in Z.
    """
    named = {"fmiVersion": "3.0", "modelName": identifier, "instantiationToken": token}
    root = Element("fmiModelDescription", named | origin(model, date))
    capabilities = CAPABILITIES | (OF_SWITCHES if model.switches else {})
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **capabilities})
    add_units(root, (*model.variables, TIME))
    if any(variable.kind == ENUMERATION for variable in model.variables):
        add_types(root, model, _new_type)
    add_run(root, model, logs_steps=True)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        _add_variable(variables, reference, variable)
    _add_time(variables, len(model.variables))
    _add_structure(root, model)
    return xml_text(root)
