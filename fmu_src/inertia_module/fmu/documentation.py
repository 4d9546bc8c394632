"""Documentation of an FMU (documentation/index.html): guides (guides/*.md) and tables of variables.

variables.md contains the same tables.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from html import escape
from pathlib import Path
from typing import NamedTuple

from .. import __version__
from ..interface import variables as table
from ..interface.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from .archive import TEMPLATES, render

# sections of the guides
PICTURE, WORKING, COUPLING = "Picture", "How it works", "Coupling"
ORDER, INVALID_INPUT, LIMITS = "Order of calls", "Invalid input", "Limits of the model"
_ITEM = re.compile(r"^(?:-|\d+\.) ", re.M)
# name of the picture in the folder of the page
MECHANISM = "mechanism.png"
GUIDES = Path(__file__).parent / "guides"
COLUMNS = ("name", "unit", "start", "allowed", "description")
HEADINGS = {
    table.INPUT: "Inputs",
    table.OUTPUT: "Outputs",
    table.LOCAL: "Local variables",
    table.PARAMETER: "Parameters",
}
# variabilities that the tables do not print
USUAL = (table.FIXED, "continuous")


class Table(NamedTuple):
    """Variables of one group, or flanges.

    Attributes:
        heading: heading.
        columns: names of the columns.
        rows: cells of each row; the first cell is a name.
    """

    heading: str
    columns: list[str]
    rows: list[list[str]]


def guide(name: str) -> dict[str, str]:
    """Return the Markdown sections of a guide by heading.

    Args:
        name: name of a model, or "all" for the common sections.
    """
    text = (GUIDES / f"{name}.md").read_text(encoding="utf-8")
    parts = re.split(r"^## (.*)\n", text, flags=re.M)
    return {heading: section.strip() for heading, section in zip(parts[1::2], parts[2::2], strict=True)}


def inline(text: str) -> str:
    """Convert a text with names in `backticks` and bold text in **stars** to HTML.

    Args:
        text: text in Markdown.
    """
    code = re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text, quote=False))
    return re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", code)


def blocks(section: str) -> str:
    """Convert the paragraphs and lists of a section to HTML; the guides use no other Markdown.

    Args:
        section: section in Markdown.
    """
    lines = []
    for block in section.split("\n\n"):
        kind = "ul" if block.startswith("-") else "ol"
        items = [f"<li>{inline(item.strip())}</li>" for item in _ITEM.split(block)[1:]]
        lines += [f"<{kind}>", *items, f"</{kind}>"] if items else [f"<p>{inline(block)}</p>"]
    return "\n".join(lines)


def _cells(variable: table.Variable) -> tuple[str, ...]:
    settable = variable.causality in (table.INPUT, table.PARAMETER)
    start = "" if variable.start is None else f"{variable.start:.10g}"
    if variable.kind == "Boolean":
        start = "true" if variable.start else "false"
    if variable.kind == table.ENUMERATION:
        allowed = ", ".join(
            f"{number} {name}" for name, number, _ in table.ENUMERATIONS[variable.enumeration]
        )
    else:
        allowed = variable.allowed if settable else ""
    notes = [] if variable.variability in USUAL else [variable.variability]
    notes += [] if variable.nominal is None else [f"nominal {variable.nominal:g}"]
    meaning = variable.description + (f" ({', '.join(notes)})" if notes else "")
    return variable.name, variable.unit, start, allowed, meaning


def _table(heading: str, variables: Iterable[table.Variable]) -> Table:
    """Return the table of a group without its empty columns."""
    rows = [_cells(variable) for variable in variables]
    columns = [n for n in range(len(COLUMNS)) if any(row[n] for row in rows)]
    return Table(heading, [COLUMNS[n] for n in columns], [[row[n] for n in columns] for row in rows])


def tables(model: Model) -> Iterator[tuple[str, list[Table]]]:
    """Yield the heading of each causality and the tables of its groups.

    Args:
        model: the model.
    """
    for causality, heading in HEADINGS.items():
        of_causality = list(model.with_causality(causality))
        by_group = {group: [v for v in of_causality if v.group == group] for group in table.Group}
        yield heading, [_table(group, variables) for group, variables in by_group.items() if variables]


def flanges(model: Model) -> Table:
    """Return the table of the flanges of a model, with variable names in backticks.

    Args:
        model: the model.
    """
    rows = []
    for end in model.terminals:
        names = [f"`{name}`" if name else "" for name in (end.speed, end.torque, end.angle)]
        rows.append([end.name, *names, end.description])
    return Table("Flanges", ["flange", "speed", "torque", "angle", "description"], rows)


def variables_page() -> str:
    """Return variables.md: the tables of variables of all models in Markdown."""

    def chapters(model: Model) -> list[tuple[str, list[Table]]]:
        return [*tables(model), ("Flanges", [flanges(model)])]

    values = {"models": (INERTIA_MODULE, DRIVEN_SHAFT), "chapters": chapters, "guide": guide}
    values |= {"invalid_input": guide("all")[INVALID_INPUT], "WORKING": WORKING}
    return render(TEMPLATES / "variables.md", values).rstrip("\n") + "\n"


def index_page(model: Model, licences: Iterable[str]) -> str:
    """Return the HTML page of an FMU; it refers only to the picture and the licences in its folder.

    Args:
        model: the model.
        licences: names of the licences.
    """
    specific, common = guide(model.name), guide("all")
    sections = [(heading, specific[heading]) for heading in (WORKING, COUPLING)]
    sections += [(heading, common[heading]) for heading in (ORDER, INVALID_INPUT)]
    values = {
        **{"model": model, "caption": specific[PICTURE], "picture": MECHANISM, "version": __version__},
        **{"blocks": blocks, "inline": inline, "licences": list(licences)},
        "sections": [*sections, (LIMITS, specific[LIMITS])],
        "chapters": [("Flanges", [flanges(model)]), *tables(model)],
    }
    return render(TEMPLATES / "index.html", values)
