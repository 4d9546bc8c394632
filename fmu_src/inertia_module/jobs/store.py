"""Results as they come: a journal that survives a kill, and the tables made of it, Parquet and CSV."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ..common.errors import Refused
from ..common.extras import library
from ..common.files import writable_folder, write_atomically
from ..harness.results import heading, write_rows
from .axes import Point
from .task import Batch, Row

JOURNAL = "journal.jsonl"


def key(point: Point) -> str:
    """A point as text: the same for the same point."""
    return json.dumps(point, sort_keys=True)


class Journal:
    """The results of a task in a folder: a line for each batch, written as soon as it is there.

    Args:
        folder: where; made if it is not there. identity: of the task (Task.identity).

    Attributes:
        rows: by key. units: of the figures by name.

    Raises:
        Refused: the folder holds results of another task.
        OSError: it cannot be written to.
    """

    def __init__(self, folder: Path, identity: str) -> None:
        self.path = writable_folder(folder) / JOURNAL
        self.rows: dict[str, Row] = {}
        self.units: dict[str, str] = {}
        head = json.dumps({"task": identity})
        if self.path.is_file():
            found, *lines = self.path.read_text(encoding="utf-8").split("\n")
            if found != head:
                raise Refused(
                    f"{folder} must be another folder, or {JOURNAL} in it removed: it holds results of"
                    " another scene, or of another version"
                )
            *whole, cut = lines  # a kill may have cut the last line: what it held is done again
            for line in whole:
                self._take(Batch.of(line))
            if cut:
                write_atomically(self.path, "\n".join([head, *whole, ""]).encode())
        else:
            write_atomically(self.path, f"{head}\n".encode())

    def _take(self, batch: Batch) -> None:
        self.rows.update({key(row.point): row for row in batch.rows})
        self.units.update(batch.units)

    def missing(self, points: Iterable[Point]) -> list[Point]:
        """Points without a result, each once."""
        return list({key(point): point for point in points if key(point) not in self.rows}.values())

    def keep(self, batches: Iterable[Batch]) -> Iterator[Batch]:
        """Keep batches as they come, and pass them on."""
        with self.path.open("a", encoding="utf-8") as stream:
            for batch in batches:
                stream.write(batch.text() + "\n")
                stream.flush()
                self._take(batch)
                yield batch

    def of(self, points: Iterable[Point]) -> list[Row]:
        """Rows of points, all of which have been done."""
        return [self.rows[key(point)] for point in points]


def columns(rows: Sequence[Row]) -> dict[str, list[Any]]:
    """Rows as columns: the keys varied, the figures, cost, refused; None where there is none."""
    names = list(dict.fromkeys(name for row in rows for name in row.figures))
    keys = list(dict.fromkeys(name for row in rows for name in row.point))
    return {
        **{name: [row.point.get(name) for row in rows] for name in keys},
        **{name: [row.figures.get(name) for row in rows] for name in names},
        "cost": [row.cost for row in rows],
        "refused": [row.refused for row in rows],
    }


def _cell(value: Any, unit: str) -> Any:
    """A value in a CSV file: nothing for none, counts as whole numbers."""
    if isinstance(value, float) and value.is_integer() and not unit:
        return int(value)
    return "" if value is None else value


def write_tables(folder: Path, name: str, rows: Sequence[Row], units: dict[str, str]) -> dict[str, Path]:
    """Write rows as NAME.parquet (units in the metadata of its columns) and NAME.csv (units in headings).

    Raises:
        NotInstalled: pyarrow is not.
    """
    arrow = library("pyarrow", "jobs")
    parquet = library("pyarrow.parquet", "jobs")
    found = columns(rows)
    units = {**units, "cost": "s"}
    arrays = {title: arrow.array(values) for title, values in found.items()}
    schema = arrow.schema(
        [arrow.field(t, array.type, metadata={"unit": units.get(t, "")}) for t, array in arrays.items()]
    )
    buffer = arrow.BufferOutputStream()
    parquet.write_table(arrow.table(arrays, schema=schema), buffer)
    tables = {"parquet": folder / f"{name}.parquet", "csv": folder / f"{name}.csv"}
    write_atomically(tables["parquet"], buffer.getvalue().to_pybytes())
    headings = [heading(title, units.get(title, "")) for title in found]
    cells = zip(*([_cell(one, units.get(title, "")) for one in found[title]] for title in found), strict=True)
    write_rows(tables["csv"], headings, cells)
    return tables
