"""The C tables of a model that the native shell works from (shell/model.h)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from string import Formatter

from ..contract.models import Model
from ..contract.records import place
from ..contract.variables import INPUT, PARAMETER, Variable
from ..kernel import codes
from .archive import TEMPLATES, filled

# of the state: how long the last step was, and whether it has stopped at a switch
SWITCH_FIELDS = ("length", "switching")
ARRAYS = {PARAMETER: "PARAMETERS", INPUT: "INPUTS"}
RECORDS = {"d": "CONSTANTS", "x": "STATE"}
# operations of the kernel (kernel.codes) that the shell calls
OPERATIONS = (
    *("START", "CHECK", "STEP_ONLY", "OUTPUTS", "STEP_PRECISELY", "RATES", "WARN", "TUNE"),
    *("STEP_TO_SWITCH", "SWITCH"),
)


def quoted(text: str) -> str:
    """A C string."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def number(value: float) -> str:
    """A C constant of exactly this value."""
    return repr(float(value)) if math.isfinite(value) else ("HUGE_VAL" if value > 0.0 else "-HUGE_VAL")


def _small(variable: Variable) -> float:
    """Scale of a small change of a variable; of a parameter well below its start value, or 1."""
    if variable.causality == PARAMETER:
        return 0.01 * (abs(variable.start or 0.0) or 1.0)
    return variable.nominal or 1.0


def _pieces(text: str, model: Model) -> Iterator[tuple[str, str, int]]:
    """A sentence in pieces of text, each with which number follows it, and its slot."""
    for before, field, _, _ in Formatter().parse(text):
        if field in (None, "step"):
            yield before, "STEP_NUMBER" if field else "NO_NUMBER", 0
        else:
            variable = model.by_name.get(field)
            of_parameter = variable is not None and variable.causality == PARAMETER
            yield before, "PARAMETER_NUMBER" if of_parameter else "INPUT_NUMBER", model.place(field)


def rows_by_reference(model: Model, fmi: int) -> list[Variable | None]:
    """Variables of an FMU at the places of their value references; None if no variable has a number."""
    known = {variable.reference: variable for variable in model.in_fmu(fmi)}
    return [known.get(reference) for reference in range(max(known) + 1)]


def generated(model: Model, guid: str, fmi: int) -> dict[str, str]:
    """The C files of the shell that are made for a model, by name.

    Args:
        model: what they are of. guid: the one of modelDescription.xml. fmi: version of FMI, 2 or 3.
    """
    numbers = ", ".join(f"OPERATION_{name} = {getattr(codes, name)}" for name in OPERATIONS)
    header = f"enum operation {{ {numbers} }};\n#define STATUS_OK {codes.OK}\n#define KERNEL {model.symbol}\n"
    values = {
        **{"model": model, "guid": guid, "arrays": ARRAYS, "records": RECORDS},
        "rows": rows_by_reference(model, fmi),
        **{"quoted": quoted, "number": number, "small": _small, "pieces": _pieces},
        # of outputs that change at switches only
        "discrete": [v.name for v in model.variables if v.variability == "discrete"],
        "switch": [place(model.records[3], name) if model.switches else -1 for name in SWITCH_FIELDS],
        "traced": [model.by_name[name].reference for name in model.traced],
        "tolerance": model.place("tolerance") if "tolerance" in model.by_name else -1,
    }
    return {
        "tables.c": filled(TEMPLATES / "tables.c", values),
        "codes.h": f"/* Made from kernel/codes.py. */\n{header}",
    }
