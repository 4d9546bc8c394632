"""The C tables of a model for the FMI functions (shell/model.h)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from string import Formatter

from ..interface.models import Model
from ..interface.records import place
from ..interface.variables import INPUT, PARAMETER, Variable
from ..kernel import codes
from .archive import TEMPLATES, render

# fields of the state: length of the last step, and a flag for a stop at a switching event
SWITCH_FIELDS = ("length", "event_pending")
ARRAYS = {PARAMETER: "PARAMETERS", INPUT: "INPUTS"}
RECORDS = {"d": "CONSTANTS", "x": "STATE"}
# operations of the kernel (kernel.codes) that the FMI functions call
OPERATIONS = (
    *(
        "START",
        "CHECK",
        "STEP_ONLY",
        "OUTPUTS",
        "STEP_FOR_DIFFERENCING",
        "OUTPUT_DERIVATIVES",
        "WARN",
        "UPDATE_PARAMETERS",
    ),
    *("STEP_UNTIL_EVENT", "HANDLE_EVENT"),
)


def quoted(text: str) -> str:
    """Return a C string literal.

    Args:
        text: content of the string.
    """
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def number(value: float) -> str:
    """Return a C constant with exactly this value.

    Args:
        value: a number or an infinity.
    """
    return repr(float(value)) if math.isfinite(value) else ("HUGE_VAL" if value > 0.0 else "-HUGE_VAL")


def _small(variable: Variable) -> float:
    """Return the scale of a small change: a hundredth of a parameter's start value, or the nominal value."""
    if variable.causality == PARAMETER:
        return 0.01 * (abs(variable.start or 0.0) or 1.0)
    return variable.nominal or 1.0


def _pieces(text: str, model: Model) -> Iterator[tuple[str, str, int]]:
    """Yield the pieces of a message: text, kind of the number after the text, and place of the number."""
    for before, field, _, _ in Formatter().parse(text):
        if field in (None, "step"):
            yield before, "STEP_NUMBER" if field else "NO_NUMBER", 0
        else:
            variable = model.by_name.get(field)
            of_parameter = variable is not None and variable.causality == PARAMETER
            yield before, "PARAMETER_NUMBER" if of_parameter else "INPUT_NUMBER", model.place(field)


def rows_by_reference(model: Model, fmi: int) -> list[Variable | None]:
    """Return the variables of an FMU in the order of their value references; None for an unused reference.

    Args:
        model: the model.
        fmi: version of FMI, 2 or 3.
    """
    rows = {variable.reference: variable for variable in model.in_fmu(fmi)}
    return [rows.get(reference) for reference in range(max(rows) + 1)]


def generated(model: Model, guid: str, fmi: int) -> dict[str, str]:
    """Return the C files that are generated for a model, by name.

    Args:
        model: the model.
        guid: GUID in modelDescription.xml.
        fmi: version of FMI, 2 or 3.
    """
    numbers = ", ".join(f"OPERATION_{name} = {getattr(codes, name)}" for name in OPERATIONS)
    header = f"enum operation {{ {numbers} }};\n#define STATUS_OK {codes.OK}\n#define KERNEL {model.symbol}\n"
    values = {
        **{"model": model, "guid": guid, "arrays": ARRAYS, "records": RECORDS},
        "rows": rows_by_reference(model, fmi),
        **{"quoted": quoted, "number": number, "small": _small, "pieces": _pieces},
        # outputs that change only at switching events
        "discrete": [v.name for v in model.variables if v.variability == "discrete"],
        "switch": [place(model.records[3], name) if model.switches else -1 for name in SWITCH_FIELDS],
        "traced": [model.by_name[name].reference for name in model.traced],
        "tolerance": model.place("tolerance") if "tolerance" in model.by_name else -1,
    }
    return {
        "tables.c": render(TEMPLATES / "tables.c", values),
        "codes.h": f"/* Made from kernel/codes.py. */\n{header}",
    }
