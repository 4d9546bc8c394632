"""The table of variables for people: docs/variables.md and documentation/index.html of the FMU."""

from __future__ import annotations

from html import escape

from ..variables import (
    ENUMERATION,
    ENUMERATIONS,
    INPUT,
    LOCAL,
    OUTPUT,
    PARAMETER,
    Variable,
    with_causality,
)
from .description import DESCRIPTION

HEADINGS = {
    INPUT: "Inputs",
    OUTPUT: "Outputs",
    LOCAL: "Locals",
    PARAMETER: "Parameters",
}
COLUMNS = ("name", "unit", "start", "allowed", "nominal", "meaning")

_INTRODUCTION = (
    "Outputs hold the values at the end of the last communication step. Pulses are usually shorter than a"
    " step, so couple through the step means input_torque_mean and output_torque_mean, not through"
    " instantaneous torques. Torques act so: M1 = input_torque drives link 1, M2 = mesh_torque link 2,"
    " Tc = output_torque the output shaft, Th = housing_torque holds link 2."
    " A parameter out of range, alone or together with others, is refused at the end of initialisation;"
    " a bad input or step is refused by fmi2Discard, and the next good step works. Refusals are logged with"
    " the name, the value and what is allowed: instantiate with loggingOn."
)


def _cells(variable: Variable) -> tuple[str, ...]:
    settable = variable.causality in (INPUT, PARAMETER)
    start = "" if variable.start is None else f"{variable.start:.10g}"
    if variable.kind == "Boolean":
        start = "true" if variable.start else "false"
    if variable.kind == ENUMERATION:
        listed = ", ".join(f"{number} {name}" for name, number, _ in ENUMERATIONS[variable.enumeration])
    else:
        listed = variable.allowed if settable else ""
    nominal = "" if variable.nominal is None else f"{variable.nominal:g}"
    return variable.name, variable.unit, start, listed, nominal, variable.description


def variables_page() -> str:
    """docs/variables.md: the table of variables in Markdown."""
    lines = ["# Variables", "", DESCRIPTION + ".", "", _INTRODUCTION, ""]
    for causality, heading in HEADINGS.items():
        lines += [f"## {heading}", "", "| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
        for variable in with_causality(causality):
            name, *rest = _cells(variable)
            lines.append("| " + " | ".join([f"`{name}`", *rest]) + " |")
        lines.append("")
    return "\n".join(lines)


def index_page() -> str:
    """documentation/index.html of the FMU."""
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8"><title>Inertia module</title>',
        "<style>body{font-family:sans-serif;max-width:72em;margin:2em auto;padding:0 1em}"
        "table{border-collapse:collapse;font-size:90%}td,th{border:1px solid #ccc;padding:.2em .5em;"
        "text-align:left;vertical-align:top}code{white-space:nowrap}</style></head><body>",
        "<h1>Inertia module</h1>",
        '<p><img src="../model.png" alt="bevel inertia module" width="320"></p>',
        f"<p>{escape(DESCRIPTION)}.</p><p>{escape(_INTRODUCTION)}</p>",
    ]
    for causality, heading in HEADINGS.items():
        head = "".join(f"<th>{column}</th>" for column in COLUMNS)
        parts.append(f"<h2>{heading}</h2><table><tr>{head}</tr>")
        for variable in with_causality(causality):
            name, *rest = _cells(variable)
            cells = f"<td><code>{name}</code></td>" + "".join(f"<td>{escape(cell)}</td>" for cell in rest)
            parts.append(f"<tr>{cells}</tr>")
        parts.append("</table>")
    return "\n".join([*parts, "</body></html>", ""])
