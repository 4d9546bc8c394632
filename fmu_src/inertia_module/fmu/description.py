"""XML files of an FMU, made from templates: modelDescription.xml and terminalsAndIcons.xml."""

from __future__ import annotations

from collections.abc import Sequence

from .. import __version__
from ..interface import variables as table
from ..interface.models import Model
from .archive import TEMPLATES, render_xml

# names of types in FMI 3.0, if they differ from FMI 2.0
TYPES_3 = {table.REAL: "Float64", table.INTEGER: "Int32"}
# FMI attribute initial by causality; the importer sets the initial values of inputs and of the time
INITIAL = {table.PARAMETER: "exact", table.OUTPUT: "calculated", table.LOCAL: "calculated"}
# name of the icon of a flange (FMI 3.0)
FLANGE = "flange"
# coordinates in the icon of docs/make_icons.py: height of the central axis, half the size of a flange,
# distance between two flanges
AXIS, HALF, SPACING = -18, 8, 40


def _number(value: float) -> str:
    return f"{value:.17g}" if value != int(value) or abs(value) > 1e15 else f"{value:.1f}"


def _values(variable: table.Variable) -> dict[str, str | None]:
    """Return the XML attributes of a variable: unit or declared type, range, nominal and start value."""
    if variable.kind == table.BOOLEAN:
        return {"start": "true" if variable.start else "false"}
    numbers = {"min": variable.minimum, "max": variable.maximum}
    display, _ = table.DISPLAY_UNITS.get(variable.unit, (None, 1.0))
    kind: dict[str, str | None] = {"declaredType": variable.enumeration or None}
    if variable.kind == table.REAL:
        kind = {"unit": variable.unit, "displayUnit": display}
        numbers["nominal"] = variable.nominal
    numbers["start"] = variable.start
    write = _number if variable.kind == table.REAL else lambda value: str(int(value))
    return kind | {key: None if value is None else write(value) for key, value in numbers.items()}


def model_description(
    model: Model,
    identifier: str,
    guid: str,
    date: str,
    fmi: int = 2,
    python: bool = False,
    sources: Sequence[str] = (),
) -> bytes:
    """Return the content of modelDescription.xml.

    Args:
        model: the model.
        identifier: model identifier, the name of the binaries.
        guid: GUID, the hash of the content.
        date: generation date and time, UTC, with Z at its end.
        fmi: version of FMI, 2 or 3.
        python: True for the Python FMU, which has the capabilities of pythonfmu.
        sources: names of the C files in FMI 2.0; FMI 3.0 lists them in buildDescription.xml.
    """
    variables = model.in_fmu(fmi)
    # the model structure contains places in the list, from 1, in FMI 2.0 and value references in FMI 3.0
    places = {variable.name: n for n, variable in enumerate(variables, 1)}
    numbers = places if fmi == 2 else {variable.name: variable.reference for variable in variables}
    relevant_names = [v.name for v in model.with_causality(table.INPUT, table.PARAMETER) if not v.idle]
    at_start = {}
    for output in model.with_causality(table.OUTPUT):
        names = relevant_names if output.at_start is None else output.at_start
        at_start[output.name] = " ".join(str(number) for name, number in numbers.items() if name in names)
    units, types = ({getattr(v, name) for v in variables} for name in ("unit", "enumeration"))
    tolerance = model.by_name["tolerance"].start if "tolerance" in model.by_name else None
    values = {
        **{"model": model, "identifier": identifier, "guid": guid, "date": date, "version": __version__},
        **{"fmi": fmi, "python": str(python).lower(), "native": str(not python).lower()},
        **{"sources": () if fmi == 3 else sources},
        **{"variables": variables, "values": _values, "initial": INITIAL, "tolerance": tolerance},
        **{"numbers": numbers, "at_start": at_start, "number": _number, "types_3": TYPES_3},
        "units": {name: exponents for name, exponents in table.UNITS.items() if name in units},
        "types": {name: items for name, items in table.ENUMERATIONS.items() if name in types},
        "display_units": table.DISPLAY_UNITS,
    }
    return render_xml(TEMPLATES / "modelDescription.xml", values)


def terminals(model: Model) -> bytes:
    """Return the content of terminalsAndIcons.xml.

    Two terminals connect by the names of their members: speed with speed, torque with torque. The angle is
    connected if both terminals have one (matching rule bus). The kind of a torque defines its positive
    direction.

    Args:
        model: the model.
    """
    values = {"axis": AXIS, "half": HALF, "spacing": SPACING, "icon": FLANGE, "terminals": model.terminals}
    return render_xml(TEMPLATES / "terminalsAndIcons.xml", values)
