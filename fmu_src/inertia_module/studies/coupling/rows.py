"""Measured rows, each a flat dataclass, to and from CSV."""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from ...results import write_text

Row = TypeVar("Row")
_READERS: dict[str, Any] = {"float": float, "int": int, "str": str, "bool": lambda word: word == "True"}
# digits that are kept: more would tell of the machine
_DIGITS = 6


def _cell(value: object) -> str:
    return f"{value:.{_DIGITS}g}" if isinstance(value, float) else str(value)


def write_rows(path: Path, rows: Sequence[Any]) -> Path:
    """Write rows of one kind, at least one; whole or not at all."""
    names = [field.name for field in dataclasses.fields(rows[0])]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([_cell(getattr(row, name)) for name in names] for row in rows)
    return write_text(path, stream.getvalue())


def read_rows(path: Path, kind: type[Row]) -> list[Row]:
    """Read what write_rows has written."""
    readers = {field.name: _READERS[str(field.type)] for field in dataclasses.fields(kind)}  # type: ignore[arg-type]
    with path.open(encoding="utf-8", newline="") as file:
        return [
            kind(**{name: readers[name](cell) for name, cell in row.items()}) for row in csv.DictReader(file)
        ]
