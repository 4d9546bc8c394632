"""XML of an FMU: modelDescription.xml, terminalsAndIcons.xml, and what it is made from (see templates)."""

from __future__ import annotations

from collections.abc import Sequence

from .. import __version__
from ..contract import variables as table
from ..contract.models import Model
from .archive import TEMPLATES, filled_xml

# names of types in FMI 3.0, where they are others
TYPES_3 = {table.REAL: "Float64", table.INTEGER: "Int32"}
# who gives the value at the start; that of inputs and of the time the host
INITIAL = {table.PARAMETER: "exact", table.OUTPUT: "calculated", table.LOCAL: "calculated"}
# icon of a flange of FMI 3.0; in the icon that docs/make_icons.py draws: height of the central axis, half a
# flange, distance of two
FLANGE = "flange"
AXIS, HALF, APART = -18, 8, 40


def _number(value: float) -> str:
    return f"{value:.17g}" if value != int(value) or abs(value) > 1e15 else f"{value:.1f}"


def _values(variable: table.Variable) -> dict[str, str | None]:
    """Attributes of a variable by its kind: unit or declared type, range, nominal and start value."""
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
    """The XML of modelDescription.xml.

    Args:
        model: what it describes. identifier: model identifier, the name of the binaries.
        guid: hash of the content. date: generation date and time, UTC, ending in Z.
        fmi: version of FMI, 2 or 3. python: whether pythonfmu passes the calls on, and what it can.
        sources: names of C files that FMI 2.0 lists; FMI 3.0 has buildDescription.xml.
    """
    variables = model.in_fmu(fmi)
    # the structure of FMI 2.0 has places in the list, from 1; FMI 3.0 has value references
    places = {variable.name: n for n, variable in enumerate(variables, 1)}
    numbers = places if fmi == 2 else {variable.name: variable.reference for variable in variables}
    at_start, given = {}, list(model.with_causality(table.INPUT, table.PARAMETER))
    for output in model.with_causality(table.OUTPUT):
        known = [one.name for one in given if not one.idle] if output.at_start is None else output.at_start
        at_start[output.name] = " ".join(str(number) for name, number in numbers.items() if name in known)
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
    return filled_xml(TEMPLATES / "modelDescription.xml", values)


def terminals(model: Model) -> bytes:
    """The XML: members of a name belong together, a speed to a speed and a torque to a torque.

    An angle goes where there is one (matching rule bus). The kind of a torque says which way it is positive.
    """
    values = {"axis": AXIS, "half": HALF, "apart": APART, "icon": FLANGE, "terminals": model.terminals}
    return filled_xml(TEMPLATES / "terminalsAndIcons.xml", values)
