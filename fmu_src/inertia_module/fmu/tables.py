"""The C tables of a model that the native shell works from (shell/model.h)."""

from __future__ import annotations

import math
from string import Formatter

from ..contract.models import Model
from ..contract.records import place
from ..contract.variables import INPUT, OUTPUT, PARAMETER, Variable
from ..kernel import codes
from .archive import TEMPLATES, filled

# of the state: how long the last step was, and whether it has stopped at a switch
SWITCH_FIELDS = ("length", "switching")
_ARRAYS = {PARAMETER: "PARAMETERS", INPUT: "INPUTS"}
_RECORDS = {"d": "CONSTANTS", "x": "STATE"}
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


def _discrete(model: Model) -> list[str]:
    """Names of outputs that change at switches only."""
    return [variable.name for variable in model.variables if variable.variability == "discrete"]


def _small(variable: Variable) -> float:
    """Scale of a small change of a variable; of a parameter well below its start value, or 1."""
    if variable.causality == PARAMETER:
        return 0.01 * (abs(variable.start or 0.0) or 1.0)
    return variable.nominal or 1.0


def _variable(variable: Variable, model: Model) -> str:
    low, high = variable.ends
    discrete = _discrete(model)
    rate, given = "-1", "-1"
    if variable.causality == INPUT:
        rate, given = (str(model.place(variable.name + ending)) for ending in ("_rate", "_rate_given"))
    cells = (
        quoted(variable.name),
        variable.kind.upper(),
        _ARRAYS.get(variable.causality, "OUTPUTS"),
        str(model.place(variable.name)),
        *(rate, given),
        str(discrete.index(variable.name) if variable.name in discrete else -1),
        str(int(variable.late)),
        str(int(variable.causality == OUTPUT)),
        str(int(variable.is_tunable)),
        number(variable.start or 0.0),
        number(low),
        number(high),
        number(_small(variable)),
        quoted(variable.allowed if variable.causality == PARAMETER else ""),
    )
    return f"{{{', '.join(cells)}}}"


def _number_of(field: str | None, model: Model) -> tuple[str, int]:
    """Which number a field of a message stands for, and its slot."""
    if field is None:
        return "NO_NUMBER", 0
    if field == "step":
        return "STEP_NUMBER", 0
    variable = model.by_name.get(field)
    if variable is None:
        return "INPUT_NUMBER", model.place(field)
    return ("INPUT_NUMBER" if variable.causality == INPUT else "PARAMETER_NUMBER"), model.place(field)


def _pieces(text: str, model: Model) -> list[str]:
    """A sentence in pieces of text, each with the number that follows it."""
    pieces = Formatter().parse(text)
    numbers = [(before, *_number_of(field, model)) for before, field, _, _ in pieces]
    return [f"{{{quoted(before)}, {kind}, {slot}}}" for before, kind, slot in numbers]


def generated(model: Model, guid: str, fmi: int) -> dict[str, str]:
    """The C files of the shell that are made for a model, by name; with FMI 3.0 time is the last variable.

    Args:
        model: what they are of. guid: the one of modelDescription.xml. fmi: version of FMI, 2 or 3.
    """
    numbers = ", ".join(f"OPERATION_{name} = {getattr(codes, name)}" for name in OPERATIONS)
    header = f"enum operation {{ {numbers} }};\n#define STATUS_OK {codes.OK}\n#define KERNEL {model.symbol}\n"
    references = {variable.name: n for n, variable in enumerate(model.variables)}
    switch = [place(model.records[3], name) if model.switches else -1 for name in SWITCH_FIELDS]
    values = {
        **{"model": model, "guid": guid, "fmi": fmi, "row": _variable, "pieces": _pieces, "quoted": quoted},
        **{"number": number, "records": _RECORDS, "bounds": model.bounds, "switch": switch},
        "discrete": [model.place(name) for name in _discrete(model)],
        "traced": [references[name] for name in model.traced],
        "tolerance": model.place("tolerance") if "tolerance" in model.by_name else -1,
    }
    return {
        "tables.c": filled(TEMPLATES / "tables.c", values),
        "codes.h": f"/* Made from kernel/codes.py. */\n{header}",
    }
