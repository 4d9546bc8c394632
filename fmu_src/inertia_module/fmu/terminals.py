"""terminalsAndIcons.xml of FMI 3.0: the flanges of a model, and where its icon and they are drawn."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..contract.models import INFLOW, Model, Terminal
from .archive import xml_text

# square of the icon, and the millimetres it is drawn in
CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
MILLIMETRES = "0.1"
FLANGE = "flange"  # its icon
# in the icon that docs/make_icons.py draws: height of the central axis, half a flange, distance of two
AXIS, HALF, APART = -18, 8, 40


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
