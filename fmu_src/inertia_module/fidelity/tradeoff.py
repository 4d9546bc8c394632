"""The trade of speed for accuracy of a scene as a study: rows, and the files they are left in."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..harness.results import write_figure
from ..harness.simulate import Progress, whole_steps
from ..scene import Scene
from .choice import Choice
from .levels import all_levels
from .plots import all_errors, work_precision
from .rows import Row, as_dict, failure_lines, write_rows
from .trials import has_elastic_output, measure_scene, trial_rows

# communication steps of a scene over its own
_LONGER = (1, 10, 100)
WORST = "worst"


@dataclass(frozen=True)
class Study:
    """Measured rows of a scene, and how they are shown.

    Attributes:
        title: of table and plots. rows: all of them. names: errors to show. plotted: the one to plot.
    """

    title: str
    rows: list[Row]
    names: tuple[str, ...]
    plotted: str

    def as_dict(self) -> dict[str, Any]:
        """Give the study for machines."""
        return {"title": self.title, "rows": [as_dict(row) for row in self.rows]}

    def write(self, folder: Path, stem: str = "tradeoff") -> dict[str, Path]:
        """Leave all rows as CSV and plots as PNG and SVG in a folder. Returns the files by name."""
        files = {"rows": write_rows(folder / f"{stem}.csv", self.rows)}
        figures = {
            stem: work_precision(self.rows, self.plotted, self.title),
            f"{stem}_errors": all_errors(self.rows, self.names, self.title),
        }
        for name, figure in figures.items():
            for kind in ("png", "svg"):
                files[f"{name}_{kind}"] = write_figure(folder / f"{name}.{kind}", figure)
        return files

    def closing_lines(self, choice: Choice | None) -> list[str]:
        """Say what failed and what is recommended."""
        return failure_lines(self.rows) + ([] if choice is None else choice.lines())


def _of_scene(scene: Scene, rows: Sequence[Row]) -> Study:
    """A study of the errors of the wanted outputs alone, and the worst of them."""
    wanted, kept = scene.run.outputs, []
    for row in rows:
        errors = {name: row.errors[name] for name in wanted if name in row.errors}
        kept.append(dataclasses.replace(row, errors={**errors, WORST: row.worst(wanted)} if errors else {}))
    return Study(scene.title, kept, (*wanted, WORST), WORST)


def scene_study(scene: Scene, progress: Progress | None = None) -> Study:
    """Measure a scene at all levels, in its own communication step and in longer ones.

    Raises:
        Refused: the module refuses the scene.
    """
    duration = scene.run.stop_time
    longer = (factor * scene.run.communication_step for factor in _LONGER)
    steps = [step for step in longer if whole_steps(duration, step)]
    levels = list(all_levels(has_elastic_output(scene), kinematic=False))
    return _of_scene(scene, measure_scene(scene, levels, steps, progress))


def scene_trials(scene: Scene, progress: Progress | None = None) -> Study:
    """The trials that `fidelity = "auto"` chooses from, measured or from the last time."""
    return _of_scene(scene, trial_rows(scene, progress))
