"""A system for the Open Simulation Platform: OspSystemStructure.xml beside its FMUs, as libcosim reads it."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..fmu.archive import xml_text
from .plan import Plan, typed

NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
STRUCTURE = "OspSystemStructure.xml"


def structure(plan: Plan) -> bytes:
    """OspSystemStructure.xml of a plan; its FMUs describe enumerations as Integers (see integers)."""
    root = Element("OspSystemStructure", xmlns=NAMESPACE, version="0.1")
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
