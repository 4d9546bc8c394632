"""The tables of variables for people: rows by groups, and docs/variables.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..contract.variable import ENUMERATION, ENUMERATIONS, FIXED, INPUT, PARAMETER, Variable
from .groups import grouped
from .guide import COMPUTES, REFUSALS, guide

COLUMNS = ("name", "unit", "start", "allowed", "meaning")
# what goes without saying
USUAL = (FIXED, "continuous")


class Table(NamedTuple):
    """Variables of one group, or flanges: heading, names of the columns, rows that begin with a name."""

    heading: str
    columns: list[str]
    rows: list[list[str]]


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


def _table(heading: str, variables: Iterable[Variable]) -> Table:
    """The table of a group, without columns in which there is nothing."""
    rows = [_cells(variable) for variable in variables]
    columns = [n for n in range(len(COLUMNS)) if any(row[n] for row in rows)]
    return Table(heading, [COLUMNS[n] for n in columns], [[row[n] for n in columns] for row in rows])


def tables(model: Model) -> Iterator[tuple[str, list[Table]]]:
    """Tables of the groups of a model by the heading of their causality."""
    for heading, groups in grouped(model).items():
        yield heading, [_table(group, variables) for group, variables in groups.items()]


def flanges(model: Model) -> Table:
    """The flanges of a model, names of variables in backticks."""
    rows = []
    for end in model.terminals:
        names = [f"`{name}`" if name else "" for name in (end.speed, end.torque, end.angle)]
        rows.append([end.name, *names, end.description])
    return Table("Flanges", ["flange", "speed", "torque", "angle", "meaning"], rows)


def _markdown(table: Table) -> Iterator[str]:
    yield "| " + " | ".join(table.columns) + " |"
    yield "|" + "---|" * len(table.columns)
    yield from ("| " + " | ".join([f"`{name}`", *rest]) + " |" for name, *rest in table.rows)
    yield ""


def _model(model: Model) -> Iterator[str]:
    yield from (f"## {model.title}", "", f"{model.description}.", "", guide(model.name)[COMPUTES], "")
    for causality, found in tables(model):
        yield from (f"### {causality}", "")
        for table in found:
            yield from (f"**{table.heading}**", "", *_markdown(table))
    ends = flanges(model)
    yield from (f"### {ends.heading}", "", *_markdown(ends))


def variables_page() -> str:
    """docs/variables.md: the tables of variables of all models in Markdown."""
    lines = ["# Variables", "", guide("all")[REFUSALS], ""]
    for model in (INERTIA_MODULE, DRIVEN_SHAFT):
        lines += _model(model)
    return "\n".join(lines)
