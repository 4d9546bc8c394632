"""Evaluation of points: each to figures with their units, its cost, or the sentence of a refusal.

A task travels to the workers once, with its FMU as bytes. Results are kept as they come in a journal that
survives a kill; the tables are made of it, Parquet and CSV.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from ..common.equality import ByContent
from ..common.errors import Refused, must_be
from ..common.extras import library
from ..common.files import content_hash, naming, writable_folder, write_atomically
from ..common.terminal import Progress
from ..harness.results import heading, write_rows
from ..scene import Scene, load_scene
from ..scene.keys import validated
from ..scene.run import Quantity, SceneRunner
from .axes import Point

Figures = dict[str, Quantity]
FiguresOf = Callable[[Point], Figures]
# figures of a summary that tell of the computer
TIMES = ("wall_time", "real_time_factor")
JOURNAL = "journal.jsonl"


class Row(NamedTuple):
    """Result of a point: figures by name, s of computing, and why it was refused, in a sentence, or ""."""

    point: Point
    figures: dict[str, float]
    cost: float
    refused: str = ""


# rows of points, in their order
Evaluate = Callable[[Sequence[Point]], list[Row]]


class Batch(NamedTuple):
    """Rows, and the units of their figures by name."""

    rows: list[Row]
    units: dict[str, str]


@dataclass(frozen=True, eq=False)
class Task(ByContent):
    """Figures of a scene at points; it is pickled.

    Attributes:
        fmu: content of its file. settings: all that results depend on other than point and FMU.
        prepare: makes, of these and of what runs scenes, a function that gives the figures of a point.
    """

    fmu: bytes
    settings: dict[str, Any]
    prepare: Callable[[dict[str, Any], SceneRunner], FiguresOf]

    @property
    def identity(self) -> str:
        """Hash of settings and FMU."""
        settings = json.dumps(self.settings, sort_keys=True)
        return content_hash({"scene": settings.encode(), "fmu": self.fmu})


def summaries(tables: dict[str, Any], runner: SceneRunner) -> FiguresOf:
    """Prepare for the summary of a scene at points; see Task."""
    scene = validated(Scene, tables)
    return lambda point: summary_of(runner, scene.with_keys(point))


def summary_of(runner: SceneRunner, scene: Scene) -> Figures:
    """Run a scene; the figures of its summary but TIMES."""
    found = runner.run(scene).quantities
    return {name: quantity for name, quantity in found.items() if name not in TIMES}


def evaluate(figures_of: FiguresOf, points: list[Point]) -> Batch:
    """Evaluate points one after the other; a refusal is a result."""
    batch = Batch([], {})
    for point in points:
        began = time.perf_counter()
        try:
            figures, refused = figures_of(point), ""
        except Refused as error:
            figures, refused = {}, " ".join(str(error).split())
        cost = time.perf_counter() - began
        batch.units.update({name: quantity.unit for name, quantity in figures.items()})
        values = {name: quantity.value for name, quantity in figures.items()}
        batch.rows.append(Row(point, values, cost, refused))
    return batch


class Evaluator(ExitStack):
    """Evaluator of points, as often as it is called, with a journal; a context manager that ends its workers.

    Attributes:
        rows: all results, by key. units: of their figures by name. new: how many were not there before.

    Raises:
        Refused: the folder holds results of another task. OSError: it cannot be written to.
    """

    def __init__(
        self,
        task: Task,
        folder: Path,
        scheduler: str | None = None,
        workers: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        super().__init__()
        if workers is not None and workers < 1:
            raise Refused(must_be("workers", "at least 1", workers))
        self.path = writable_folder(folder) / JOURNAL
        self.rows, self.units = dict[str, Row](), dict[str, str]()
        head = json.dumps({"task": task.identity})
        there = self.path.is_file()
        text = self.path.read_text(encoding="utf-8") if there else f"{head}\n"
        found, _, results = text.partition("\n")
        if found != head:
            raise Refused(
                f"{folder} contains results of another scene or version; use another folder or delete"
                f" {JOURNAL} in it"
            )
        *whole, cut = results.split("\n")  # a kill may have cut the last line: what it held is done again
        for line in map(json.loads, whole):
            self._take(Batch([Row(*row) for row in line["rows"]], line["units"]))
        if cut or not there:
            write_atomically(self.path, "\n".join([head, *whole, ""]).encode())
        self.task, self.new = task, 0
        self.progress = progress or (lambda share: None)
        self._pool, self._client = (scheduler, workers), None

    def _take(self, batch: Batch) -> None:
        self.rows.update({_key(row.point): row for row in batch.rows})
        self.units.update(batch.units)

    def missing(self, points: Iterable[Point]) -> list[Point]:
        """Points without a result, each once."""
        return list({_key(point): point for point in points if _key(point) not in self.rows}.values())

    def keep(self, batch: Batch) -> None:
        """Keep a batch, from now on through kills."""
        with naming(self.path), self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(batch._asdict()) + "\n")
        self._take(batch)

    def __call__(self, points: Sequence[Point]) -> list[Row]:
        """Rows of points, in their order; what is in the journal is not done again."""
        missing = self.missing(points)
        if missing:
            from .workers import evaluations, pool

            if self._client is None:
                self._client = self.enter_context(pool(self.task, *self._pool))
            done = 0
            for batch in evaluations(self._client, self.task.identity, missing):
                self.keep(batch)
                done += len(batch.rows)
                self.progress(done / len(missing))
            self.new += done
        return [self.rows[_key(point)] for point in points]


def _key(point: Point) -> str:
    return json.dumps(point, sort_keys=True)


def read(scene: Scene | Path | str) -> tuple[Scene, str]:
    """Read a scene, as load_scene; with what to call its results."""
    return (scene, "scene") if isinstance(scene, Scene) else (load_scene(scene), Path(scene).stem)


def write_tables(folder: Path, name: str, rows: Sequence[Row], units: dict[str, str]) -> dict[str, Path]:
    """Write rows as NAME.parquet (units in the metadata of its columns) and NAME.csv (units in headings).

    Columns are the keys varied, the figures, cost and refused; empty where there is none.
    """
    arrow, parquet = library("pyarrow", "jobs"), library("pyarrow.parquet", "jobs")
    own = [{**row.point, **row.figures, "cost": row.cost, "refused": row.refused} for row in rows]
    keys = [name for row in rows for name in row.point]
    names = dict.fromkeys([*keys, *(name for row in rows for name in row.figures), "cost", "refused"])
    columns = {name: [one.get(name) for one in own] for name in names}
    units = {**dict.fromkeys(columns, ""), **units, "cost": "s"}
    table, buffer = arrow.table(columns), arrow.BufferOutputStream()
    fields = [field.with_metadata({"unit": units[field.name]}) for field in table.schema]
    parquet.write_table(table.cast(arrow.schema(fields)), buffer)
    tables = {"parquet": folder / f"{name}.parquet", "csv": folder / f"{name}.csv"}
    write_atomically(tables["parquet"], buffer.getvalue().to_pybytes())

    def cell(value: Any, unit: str) -> Any:
        """Leave a cell empty for None; write counts as whole numbers."""
        if isinstance(value, float) and value.is_integer() and not unit:
            return int(value)
        return "" if value is None else value

    cells = ([cell(value, units[title]) for value in values] for title, values in columns.items())
    write_rows(tables["csv"], [heading(title, units[title]) for title in columns], zip(*cells, strict=True))
    return tables
