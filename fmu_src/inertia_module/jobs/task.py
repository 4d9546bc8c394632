"""One evaluation: a point of a task to figures with their units, the cost, or the sentence of a refusal.

A task travels to the workers once, with its FMU as bytes.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from ..common.errors import Refused
from ..common.files import content_hash
from ..scene.keys import validated
from ..scene.run import SceneRunner
from ..scene.schema import Scene
from ..scene.summary import Quantity
from .axes import Point

Figures = dict[str, Quantity]
# figures of a summary that tell of the computer
TIMES = ("wall_time", "real_time_factor")


class Row(NamedTuple):
    """Result of the evaluation of a point.

    Attributes:
        point: keys of the scene by name. figures: numbers by name, none if it was refused.
        cost: s of computing. refused: why, in a sentence, or "".
    """

    point: Point
    figures: dict[str, float]
    cost: float
    refused: str = ""


@dataclass
class Batch:
    """Rows, and the units of their figures by name."""

    rows: list[Row] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """As a line of JSON."""
        return json.dumps({"rows": self.rows, "units": self.units})

    @classmethod
    def of(cls, text: str) -> Batch:
        """Read the outcome that text has written."""
        data = json.loads(text)
        return cls([Row(*row) for row in data["rows"]], data["units"])


class Task(Protocol):
    """Task to evaluate at points; it is pickled."""

    @property
    def fmu(self) -> bytes:
        """Content of the FMU's file."""

    @property
    def identity(self) -> str:
        """Changes with anything that results depend on, other than the point."""

    def opened(self, fmu: Path, closing: ExitStack) -> Callable[[Point], Figures]:
        """Function that gives the figures of a point, of one thread alone; it may raise Refused.

        Args:
            fmu: the FMU as a file. closing: what is to be closed in the end.
        """


@dataclass(frozen=True)
class SceneTask:
    """The summary of a scene at points.

    Attributes:
        tables: of the scene (Scene.tables). fmu: content of the FMU's file.
    """

    tables: dict[str, Any]
    fmu: bytes

    @property
    def identity(self) -> str:
        """See Task."""
        return identity(self.tables, self.fmu)

    def opened(self, fmu: Path, closing: ExitStack) -> Callable[[Point], Figures]:
        """See Task."""
        scene, runner = validated(Scene, self.tables), closing.enter_context(SceneRunner(fmu))
        return lambda point: summary_of(runner, scene.with_keys(point))


def summary_of(runner: SceneRunner, scene: Scene) -> Figures:
    """The figures of a run's summary but TIMES."""
    found = runner.run(scene).quantities
    return {name: quantity for name, quantity in found.items() if name not in TIMES}


def identity(tables: dict[str, Any], fmu: bytes) -> str:
    """Hash of what a scene simulates, whatever it is called, and of the FMU."""
    told = {name: table for name, table in tables.items() if name not in ("title", "description")}
    return content_hash({"scene": json.dumps(told, sort_keys=True).encode(), "fmu": fmu})


def evaluate(figures_of: Callable[[Point], Figures], points: list[Point]) -> Batch:
    """Evaluate points one after the other; a refusal is a result."""
    batch = Batch()
    for point in points:
        began = time.perf_counter()
        figures: Figures = {}
        refused = ""
        try:
            figures = figures_of(point)
        except Refused as error:
            refused = " ".join(str(error).split())
        cost = time.perf_counter() - began
        batch.units.update({name: quantity.unit for name, quantity in figures.items()})
        values = {name: quantity.value for name, quantity in figures.items()}
        batch.rows.append(Row(point, values, cost, refused))
    return batch
