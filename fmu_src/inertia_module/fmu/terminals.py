"""terminalsAndIcons.xml of FMI 3.0: the flanges of a model, and where its icon and they are drawn."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..contract.models import Model

# square of the icon, and the millimetres it is drawn in
CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
MILLIMETRES = "0.1"


def terminals(model: Model) -> bytes:
    """The XML: a plug for each flange, so that a speed goes to a speed and a torque to a torque."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    drawing = SubElement(root, "GraphicalRepresentation")
    SubElement(drawing, "CoordinateSystem", CORNERS, suggestedScalingFactorTo_mm=MILLIMETRES)
    SubElement(drawing, "Icon", CORNERS)
    parent = SubElement(root, "Terminals")
    for flange in model.terminals:
        terminal = SubElement(
            parent, "Terminal", name=flange.name, matchingRule="plug", description=flange.description
        )
        for member, variable in (("speed", flange.speed), ("torque", flange.torque)):
            SubElement(
                terminal,
                "TerminalMemberVariable",
                variableName=variable,
                memberName=member,
                variableKind="signal",
            )
    indent(root)
    text: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"
