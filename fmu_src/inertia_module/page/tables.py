"""The tables of a model as a page reads them: variables, sizes of the records, sentences of refusals."""

from __future__ import annotations

from typing import Any

from ..common.units import BOOLEANS
from ..contract.models import Model
from ..contract.variable import BOOLEAN, ENUMERATIONS, INPUT, Variable
from ..kernel import codes

OPERATIONS = ("START", "STEP", "WARN")


def page_tables(model: Model) -> dict[str, Any]:
    """Tables of a model for the page (the interface Tables of page/src/kernel/tables.ts), ready for JSON."""
    return {
        "symbol": model.symbol,
        "sizes": list(model.sizes),
        "operations": {name: getattr(codes, name) for name in OPERATIONS},
        "ok": codes.OK,
        "variables": [_variable(variable, model) for variable in model.variables],
        "messages": dict(model.messages),
        "warnings": dict(model.warnings),
    }


def _variable(variable: Variable, model: Model) -> dict[str, Any]:
    is_input = variable.causality == INPUT
    return {
        "name": variable.name,
        "group": variable.group,
        "kind": variable.kind,
        "causality": variable.causality,
        "tunable": variable.is_tunable,
        "unit": variable.unit,
        "description": variable.description,
        "start": variable.start,
        "min": variable.minimum,
        "max": variable.maximum,
        "allowed": variable.allowed,
        "items": _items(variable),
        "place": model.place(variable.name),
        "ratePlace": model.place(f"{variable.name}_rate") if is_input else -1,
        "rateGivenPlace": model.place(f"{variable.name}_rate_given") if is_input else -1,
    }


def _items(variable: Variable) -> list[dict[str, Any]]:
    """The values that an enumeration or a Boolean may have."""
    items = ENUMERATIONS.get(variable.enumeration, ())
    if variable.kind == BOOLEAN:
        items = tuple((name, int(number), "") for name, number in BOOLEANS.items())
    return [{"name": name, "number": number, "description": text} for name, number, text in items]
