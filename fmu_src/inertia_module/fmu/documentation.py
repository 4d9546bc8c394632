"""The tables of variables for people: docs/variables.md and documentation/index.html of an FMU."""

from __future__ import annotations

from html import escape

from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..contract.variable import (
    ENUMERATION,
    ENUMERATIONS,
    FIXED,
    INPUT,
    LOCAL,
    OUTPUT,
    PARAMETER,
    Variable,
)

HEADINGS = {
    INPUT: "Inputs",
    OUTPUT: "Outputs",
    LOCAL: "Locals",
    PARAMETER: "Parameters",
}
COLUMNS = ("name", "unit", "start", "allowed", "meaning")
# what goes without saying
USUAL = (FIXED, "continuous")

_REFUSALS = (
    "A parameter out of range, alone or together with others, is refused at the end of initialisation. A"
    " tunable one may change between steps; a bad value is then refused by fmi2Discard and the old one stays."
    " A bad input or step is refused by fmi2Discard, and the next good step works. Refusals are logged with"
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
    notes = [] if variable.variability in USUAL else [variable.variability]
    notes += [] if variable.nominal is None else [f"nominal {variable.nominal:g}"]
    meaning = variable.description + (f" ({', '.join(notes)})" if notes else "")
    return variable.name, variable.unit, start, listed, meaning


def _table(model: Model, causality: str) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of the variables of a causality, without columns in which there is nothing."""
    rows = [_cells(variable) for variable in model.with_causality(causality)]
    columns = [n for n in range(len(COLUMNS)) if any(row[n] for row in rows)]
    return [COLUMNS[n] for n in columns], [[row[n] for n in columns] for row in rows]


def _tables(model: Model) -> list[str]:
    """Markdown of the tables of one model."""
    lines = []
    for causality, heading in HEADINGS.items():
        columns, rows = _table(model, causality)
        lines += [f"### {heading}", "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
        for name, *rest in rows:
            lines.append("| " + " | ".join([f"`{name}`", *rest]) + " |")
        lines.append("")
    return lines


def variables_page() -> str:
    """docs/variables.md: the tables of variables of all models in Markdown."""
    lines = ["# Variables", "", _REFUSALS, ""]
    for model in (INERTIA_MODULE, DRIVEN_SHAFT):
        lines += [
            f"## {model.title}",
            "",
            model.description + ".",
            "",
            model.introduction,
            "",
            *_tables(model),
        ]
    return "\n".join(lines)


def index_page(model: Model, picture: str) -> str:
    """documentation/index.html of an FMU; picture: its path in the FMU."""
    parts = [
        "<!DOCTYPE html>",
        f'<html lang="en"><head><meta charset="utf-8"><title>{escape(model.title)}</title>',
        "<style>body{font-family:sans-serif;max-width:72em;margin:2em auto;padding:0 1em}"
        "table{border-collapse:collapse;font-size:90%}td,th{border:1px solid #ccc;padding:.2em .5em;"
        "text-align:left;vertical-align:top}code{white-space:nowrap}</style></head><body>",
        f"<h1>{escape(model.title)}</h1>",
        f'<p><img src="../{picture}" alt="{escape(model.title.lower())}" width="320"></p>',
        f"<p>{escape(model.description)}.</p><p>{escape(model.introduction)}</p><p>{escape(_REFUSALS)}</p>",
    ]
    for causality, heading in HEADINGS.items():
        columns, rows = _table(model, causality)
        head = "".join(f"<th>{column}</th>" for column in columns)
        parts.append(f"<h2>{heading}</h2><table><tr>{head}</tr>")
        for name, *rest in rows:
            cells = f"<td><code>{name}</code></td>" + "".join(f"<td>{escape(cell)}</td>" for cell in rest)
            parts.append(f"<tr>{cells}</tr>")
        parts.append("</table>")
    return "\n".join([*parts, "</body></html>", ""])
