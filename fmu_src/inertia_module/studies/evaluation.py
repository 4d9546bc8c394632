"""Evaluation of points: metrics with units, run time, or the message of a failed run.

A task is sent to the workers once, with its FMU as bytes. A journal stores results immediately, so that an
interrupted job can continue. The tables (Parquet and CSV) are made from the journal.
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
from ..common.errors import InertiaModuleError, ParameterError, must_be, sentence_of
from ..common.extras import library
from ..common.files import content_hash, naming, writable_folder, write_atomically
from ..common.terminal import Progress
from ..fmi.results import heading, write_rows
from ..scene import Scene
from ..scene.keys import validated
from ..scene.quantity import Quantity
from ..scene.reading import as_scene
from ..scene.run import SceneRunner
from .axes import Point

Metrics = dict[str, Quantity]
MetricsOf = Callable[[Point], Metrics]
# metrics of a summary that depend on the computer
TIMES = ("wall_time", "real_time_factor")
JOURNAL = "journal.jsonl"


class Row(NamedTuple):
    """Result of a point.

    Attributes:
        point: Values by key.
        metrics: Metrics by name.
        cost: Run time, s.
        refused: Message of a failed run; "" for a successful run.
    """

    point: Point
    metrics: dict[str, float]
    cost: float
    refused: str = ""


# function that returns the rows of points, in their order
Evaluate = Callable[[Sequence[Point]], list[Row]]


class Batch(NamedTuple):
    """Rows of several points.

    Attributes:
        rows: The rows.
        units: Units of their metrics, by name.
    """

    rows: list[Row]
    units: dict[str, str]


@dataclass(frozen=True, eq=False)
class Task(ByContent):
    """Computation of metrics at points, which can be pickled.

    Attributes:
        fmu: Content of the FMU file.
        settings: Everything that results depend on, except point and FMU.
        prepare: Function of settings and a runner of scenes. It returns a function from a point to metrics.
    """

    fmu: bytes
    settings: dict[str, Any]
    prepare: Callable[[dict[str, Any], SceneRunner], MetricsOf]

    @property
    def identity(self) -> str:
        """Return a hash of settings and FMU."""
        settings = json.dumps(self.settings, sort_keys=True)
        return content_hash({"scene": settings.encode(), "fmu": self.fmu})


def summaries(tables: dict[str, Any], runner: SceneRunner) -> MetricsOf:
    """Return a function from a point to the summary of a scene, as Task.prepare.

    Args:
        tables: Tables of the scene.
        runner: Runner of scenes.
    """
    scene = validated(Scene, tables)
    return lambda point: summary_of(runner, scene.with_keys(point))


def summary_of(runner: SceneRunner, scene: Scene) -> Metrics:
    """Run a scene and return the metrics of its summary, except TIMES.

    Args:
        runner: Runner of scenes.
        scene: The scene.
    """
    quantities = runner.run(scene).quantities
    return {name: quantity for name, quantity in quantities.items() if name not in TIMES}


def evaluate(metrics_of: MetricsOf, points: list[Point]) -> Batch:
    """Evaluate points sequentially; a failed run is a result.

    Args:
        metrics_of: Function from a point to metrics.
        points: The points.
    """
    batch = Batch([], {})
    for point in points:
        start = time.perf_counter()
        try:
            metrics, message = metrics_of(point), ""
        except InertiaModuleError as error:
            metrics, message = {}, sentence_of(error)
        cost = time.perf_counter() - start
        batch.units.update({name: quantity.unit for name, quantity in metrics.items()})
        values = {name: quantity.value for name, quantity in metrics.items()}
        batch.rows.append(Row(point, values, cost, message))
    return batch


class Evaluator(ExitStack):
    """Function that evaluates points on workers, with a journal; a context manager that ends the workers.

    Args:
        task: The task.
        folder: Folder of the journal.
        scheduler: Address of a running Dask scheduler; None for worker processes on this machine.
        workers: Number of these processes; None for one per core.
        progress: Function called with the completed fraction of a call, 0 to 1.

    Attributes:
        rows: All results, by point as text.
        units: Units of their metrics, by name.
        new: Number of results that were not in the journal.

    Raises:
        ParameterError: The folder contains results of another task, or workers is invalid.
        OSError: The folder cannot be written.
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
            raise ParameterError(must_be("workers", "at least 1", workers))
        self.path = writable_folder(folder) / JOURNAL
        self.rows, self.units = dict[str, Row](), dict[str, str]()
        header = json.dumps({"task": task.identity})
        exists = self.path.is_file()
        text = self.path.read_text(encoding="utf-8") if exists else f"{header}\n"
        first_line, _, results = text.partition("\n")
        if first_line != header:
            raise ParameterError(
                f"{folder} contains results of another scene or version; use another folder or delete"
                f" {JOURNAL} in it"
            )
        *lines, rest = results.split("\n")  # an interrupted job can leave an incomplete last line
        for line in map(json.loads, lines):
            self._add(Batch([Row(*row) for row in line["rows"]], line["units"]))
        if rest or not exists:
            write_atomically(self.path, "\n".join([header, *lines, ""]).encode())
        self.task, self.new = task, 0
        self.progress = progress or (lambda share: None)
        self._pool, self._client = (scheduler, workers), None

    def _add(self, batch: Batch) -> None:
        self.rows.update({_key(row.point): row for row in batch.rows})
        self.units.update(batch.units)

    def missing(self, points: Iterable[Point]) -> list[Point]:
        """Return the points without a result, without duplicates.

        Args:
            points: The points.
        """
        return list({_key(point): point for point in points if _key(point) not in self.rows}.values())

    def add_batch(self, batch: Batch) -> None:
        """Add a batch to the results and to the journal.

        Args:
            batch: The batch.
        """
        with naming(self.path), self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(batch._asdict()) + "\n")
        self._add(batch)

    def __call__(self, points: Sequence[Point]) -> list[Row]:
        """Return the rows of points, in their order; results in the journal are reused.

        Args:
            points: The points.
        """
        missing = self.missing(points)
        if missing:
            from .workers import evaluations, pool

            if self._client is None:
                self._client = self.enter_context(pool(self.task, *self._pool))
            completed = 0
            for batch in evaluations(self._client, self.task.identity, missing):
                self.add_batch(batch)
                completed += len(batch.rows)
                self.progress(completed / len(missing))
            self.new += completed
        return [self.rows[_key(point)] for point in points]


def _key(point: Point) -> str:
    return json.dumps(point, sort_keys=True)


def scene_and_name(scene: Scene | Path | str) -> tuple[Scene, str]:
    """Return a scene, read from its file if necessary, and the name of its results.

    Args:
        scene: Scene, or path of its file.

    Raises:
        SceneError: The file is invalid.
    """
    return as_scene(scene), "scene" if isinstance(scene, Scene) else Path(scene).stem


def write_tables(folder: Path, name: str, rows: Sequence[Row], units: dict[str, str]) -> dict[str, Path]:
    """Write rows to NAME.parquet (units in the metadata of columns) and NAME.csv (units in headings).

    Columns are keys, metrics, cost and refused. Missing values are empty.

    Args:
        folder: Output folder.
        name: Name of the files without ending.
        rows: The rows.
        units: Units of keys and metrics, by name.

    Returns:
        Paths of the files, by kind.
    """
    arrow, parquet = library("pyarrow", "studies"), library("pyarrow.parquet", "studies")
    records = [{**row.point, **row.metrics, "cost": row.cost, "refused": row.refused} for row in rows]
    keys = [name for row in rows for name in row.point]
    names = dict.fromkeys([*keys, *(name for row in rows for name in row.metrics), "cost", "refused"])
    columns = {name: [record.get(name) for record in records] for name in names}
    units = {**dict.fromkeys(columns, ""), **units, "cost": "s"}
    table, buffer = arrow.table(columns), arrow.BufferOutputStream()
    fields = [field.with_metadata({"unit": units[field.name]}) for field in table.schema]
    parquet.write_table(table.cast(arrow.schema(fields)), buffer)
    tables = {"parquet": folder / f"{name}.parquet", "csv": folder / f"{name}.csv"}
    write_atomically(tables["parquet"], buffer.getvalue().to_pybytes())

    def cell(value: Any, unit: str) -> Any:
        """Return the content of a cell: empty for None, counts as integers."""
        if isinstance(value, float) and value.is_integer() and not unit:
            return int(value)
        return "" if value is None else value

    cells = ([cell(value, units[title]) for value in values] for title, values in columns.items())
    write_rows(tables["csv"], [heading(title, units[title]) for title in columns], zip(*cells, strict=True))
    return tables
