"""terminalsAndIcons.xml of FMI 3.0: the flanges of a model, and where its icon and they are drawn."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..contract.models import Model

# square of the icon, and the millimetres it is drawn in
CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
MILLIMETRES = "0.1"


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
    indent(root)
    text: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"
