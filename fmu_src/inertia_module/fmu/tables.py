"""The C tables of a model that the native shell works from (shell/model.h)."""

from __future__ import annotations

import math
from string import Formatter

from ..entries import ENTRIES
from ..model import Bound, Model
from ..variables import BOOLEAN, ENUMERATION, ENUMERATIONS, INPUT, OUTPUT, PARAMETER, REAL, Variable

_ARRAYS = {PARAMETER: "PARAMETERS", INPUT: "INPUTS"}


def quoted(text: str) -> str:
    """A C string."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def number(value: float) -> str:
    """A C constant of exactly this value."""
    return repr(float(value)) if math.isfinite(value) else ("HUGE_VAL" if value > 0.0 else "-HUGE_VAL")


def _kind(variable: Variable) -> str:
    return {REAL: "REAL", BOOLEAN: "BOOLEAN"}.get(variable.kind, "INTEGER")


def _range(variable: Variable) -> tuple[float, float]:
    if variable.kind == BOOLEAN:
        return 0.0, 1.0
    if variable.kind == ENUMERATION:
        values = [value for _, value, _ in ENUMERATIONS[variable.enumeration]]
        if values != list(range(values[0], values[-1] + 1)):
            raise ValueError(f"{variable.enumeration} has gaps: the shell knows ranges only")
        return float(values[0]), float(values[-1])
    low = -math.inf if variable.minimum is None else variable.minimum
    high = math.inf if variable.maximum is None else variable.maximum
    return low, high


def _variable(variable: Variable, model: Model) -> str:
    low, high = _range(variable)
    cells = (
        quoted(variable.name),
        _kind(variable),
        _ARRAYS.get(variable.causality, "OUTPUTS"),
        str(variable.slot),
        str(int(variable.name in model.late)),
        str(int(variable.causality == OUTPUT)),
        number(variable.start or 0.0),
        number(low),
        number(high),
        number(variable.nominal or 1.0),
        quoted(variable.allowed if variable.causality == PARAMETER else ""),
    )
    return f"    {{{', '.join(cells)}}},"


def _number_of(field: str | None, model: Model) -> tuple[str, int]:
    """Which number a field of a message stands for, and its slot."""
    if field is None:
        return "NO_NUMBER", 0
    if field == "step":
        return "STEP_NUMBER", 0
    variable = model.by_name.get(field)
    if variable is None:
        return "RATE_NUMBER", model.by_name[field.removesuffix("_rate")].slot
    return ("INPUT_NUMBER" if variable.causality == INPUT else "PARAMETER_NUMBER"), variable.slot


def _message(status: int, text: str, model: Model) -> list[str]:
    lines = [f"static const struct piece pieces_{status}[] = {{"]
    for before, field, _, _ in Formatter().parse(text):
        kind, slot = _number_of(field, model)
        lines.append(f"    {{{quoted(before)}, {kind}, {slot}}},")
    return [*lines, '    {"", LAST_PIECE, 0},', "};"]


def _bound(bound: Bound) -> str:
    array = {"d": "CONSTANTS", "x": "STATE"}[bound.array]
    return f"{{{array}, {bound.slot}, {number(bound.most)}, {number(bound.multiple)}}}"


def c_tables(model: Model, guid: str) -> str:
    """C source of the model's tables.

    Args:
        model: what they are of. guid: the one of modelDescription.xml.
    """
    n_p, n_d, n_u, n_x, n_y, n_w = ENTRIES[model.entry].sizes
    references = {variable.name: n for n, variable in enumerate(model.variables)}
    traced = ", ".join(str(references[name]) for name in model.traced)
    inputs = len(list(model.with_causality(INPUT)))
    tolerance = model.by_name["tolerance"].slot if "tolerance" in model.by_name else -1
    lines = [
        f"/* Tables of {model.name}, made from its table of variables. */",
        '#include "model.h"',
        "",
        "#include <math.h>",
        "",
        "static const struct variable variables[] = {",
        *(_variable(variable, model) for variable in model.variables),
        "};",
        "",
    ]
    for status, text in model.messages.items():
        lines += [*_message(status, text, model), ""]
    lines += [
        "static const struct message messages[] = {",
        *(f"    {{{status}, pieces_{status}}}," for status in model.messages),
        "};",
        "",
        f"static const size_t traced[] = {{{traced}}};",
        "",
        "static const struct bound bounds[] = {",
        *(f"    {_bound(bound)}," for bound in model.bounds or (Bound("d", 0, 0),)),
        "};",
        "",
        "const struct model model = {",
        f"    {quoted(model.name)}, {quoted(guid)}, variables, {len(references)}, {inputs}, {tolerance},",
        f"    {n_p}, {n_d}, {n_u}, {n_x}, {n_y}, {n_w},",
        f"    messages, {len(model.messages)}, traced, {len(model.traced)},",
        f"    bounds, {len(model.bounds)},",
        "};",
        "",
    ]
    return "\n".join(lines)
