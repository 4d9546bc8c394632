"""Measured rows as a table on the screen, as CSV and for machines."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..results import write_text
from .trajectory import Row


def error_names(rows: Sequence[Row]) -> list[str]:
    """Names of all errors in the rows."""
    return list(dict.fromkeys(name for row in rows for name in row.errors))


def as_dict(row: Row) -> dict[str, Any]:
    """A row for machines: what is not known is None."""

    def known(value: float | None) -> float | None:
        return None if value is None or not math.isfinite(value) else value

    return {
        "rung": row.rung,
        "method": row.method,
        "setting": row.setting,
        "communication_step": row.communication_step,
        "errors": {name: known(value) for name, value in row.errors.items()},
        "wall_time_per_second": known(row.wall_time),
        "loop_time_per_second": known(row.loop_time),
        "rhs_evaluations": known(row.evaluations),
        "contact_switches": known(row.switches),
        "failure": row.failure,
    }


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write all rows as CSV, failures too; whole or not at all."""
    names = error_names(rows)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    heads = ("rung", "method", "setting", "communication_step [s]")
    costs = ("wall_time_per_second [s]", "loop_time_per_second [s]", "rhs_evaluations", "contact_switches")
    writer.writerow([*heads, *(f"error {name}" for name in names), *costs, "failure"])
    for row in rows:
        values = (row.wall_time, row.loop_time, row.evaluations, row.switches)
        numbers = [row.errors.get(name, math.nan) for name in names]
        writer.writerow(
            [row.rung, row.method, row.setting, repr(row.communication_step)]
            + ["" if value is None or math.isnan(value) else repr(value) for value in (*numbers, *values)]
            + [row.failure]
        )
    return write_text(path, stream.getvalue())


def cells(row: Row, names: Sequence[str]) -> list[str]:
    """A row as text: what it is, its errors, its cost."""

    def number(value: float | None, form: str) -> str:
        return "-" if value is None or math.isnan(value) else format(value, form)

    return [
        row.label,
        f"{row.communication_step:g}",
        *(number(row.errors.get(name, math.nan), ".1e") for name in names),
        number(1e3 * row.wall_time, ".3g"),
        number(row.evaluations, ".0f"),
        number(row.switches, ".0f"),
    ]


def headings(names: Sequence[str]) -> list[str]:
    """Headings of cells."""
    return ["run", "step, s", *names, "ms per s", "right-hand sides", "switches"]


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """One line for each kind of run that failed, with its reason."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if row.failure:
            labels = reasons.setdefault(row.failure, [])
            if row.label not in labels:
                labels.append(row.label)
    return [f"failed: {'; '.join(labels)}: {reason}" for reason, labels in reasons.items()]


def markdown_table(rows: Sequence[Row], names: Sequence[str]) -> list[str]:
    """Lines of a table for a page."""
    heads = headings(names)
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    return lines + [f"| {' | '.join(cells(row, names))} |" for row in rows]
