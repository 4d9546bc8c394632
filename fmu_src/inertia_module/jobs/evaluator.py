"""Evaluating points of a task on workers: what is in the journal of the folder is not done again."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from ..common.extras import library
from ..harness.fmu import Closing
from ..harness.simulate import Progress
from ..scene import Scene, load_scene
from .axes import Point
from .store import Journal
from .task import Row, Task


def read(scene: Scene | Path | str) -> tuple[Scene, str]:
    """A scene, and what to call its results.

    Raises:
        SceneError: as load_scene.
    """
    return (scene, "scene") if isinstance(scene, Scene) else (load_scene(scene), Path(scene).stem)


class Evaluator(Closing):
    """Gives rows of points, as often as it is called; a context manager that ends its workers.

    Args:
        task: what is evaluated. folder: of its journal. scheduler, workers: as in workers.pool; they start
            when the first point is to be evaluated. progress: told the share done of the points of a call.

    Attributes:
        journal: of all results. new: how many of them were not there before.

    Raises:
        Refused: the folder holds results of another task. NotInstalled: the extra jobs is not.
    """

    def __init__(
        self,
        task: Task,
        folder: Path,
        scheduler: str | None = None,
        workers: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        for name in ("distributed", "pyarrow"):
            library(name, "jobs")
        self.task, self.journal, self.new = task, Journal(folder, task.identity), 0
        self.progress = progress or (lambda share: None)
        self._pool = (scheduler, workers)
        self._stack = ExitStack()
        self._client: Any = None

    def close(self) -> None:
        """End the workers."""
        self._stack.close()

    def __call__(self, points: Sequence[Point]) -> list[Row]:
        """Rows of points, in their order."""
        missing = self.journal.missing(points)
        if missing:
            self._evaluate(missing)
        return self.journal.of(points)

    def _evaluate(self, points: list[Point]) -> None:
        from .workers import evaluations, pool

        if self._client is None:
            self._client = self._stack.enter_context(pool(self.task, *self._pool))
        done = 0
        for batch in self.journal.keep(evaluations(self._client, self.task.identity, points)):
            done += len(batch.rows)
            self.progress(done / len(points))
        self.new += done
