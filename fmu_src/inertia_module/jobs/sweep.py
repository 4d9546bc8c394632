"""Sweep: the summary of a scene over values of its keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import Refused, did_you_mean
from ..common.files import OUTPUT_FOLDER
from ..harness.fmu import fmu_file
from ..harness.simulate import Progress
from ..scene import Scene
from ..scene.summary import time_to
from .axes import Axis, axes_of, grid, sampled, units_of
from .evaluator import Evaluator, read
from .sensitivity import Sensitivity, indices
from .store import write_tables
from .task import Row, SceneTask


@dataclass(frozen=True)
class SweepResult:
    """Result of a sweep.

    Attributes:
        axes: what was varied. rows: one for each point, in the order of the points.
        units: of keys and figures by name, where known. new: how many rows were not there before.
        unreached: by the time to a speed, how many runs do not come to it.
        sensitivity: Sobol indices, where they were asked for. files: written, by kind.
    """

    axes: list[Axis]
    rows: list[Row]
    units: dict[str, str]
    new: int
    unreached: dict[str, int]
    sensitivity: Sensitivity | None
    files: dict[str, Path]

    @property
    def refused(self) -> list[Row]:
        """The rows that were refused."""
        return [row for row in self.rows if row.refused]

    def figure(self, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Values of a figure, NaN where refused, shape (rows,).

        Raises:
            Refused: no row has it.
        """
        known = self.figures
        if name not in known:
            raise Refused(f"a figure must be one of the summary, is {name!r} {did_you_mean(name, known)}")
        return np.array([row.figures.get(name, np.nan) for row in self.rows])

    @property
    def figures(self) -> list[str]:
        """Names of the figures."""
        return list(dict.fromkeys(name for row in self.rows for name in row.figures))


def sweep(
    scene: Scene | Path | str,
    vary: Sequence[str] | Mapping[str, Any],
    *,
    sample: str | None = None,
    sensitivity: int | None = None,
    seed: int = 0,
    output: Path | str | None = None,
    fmu: Path | str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> SweepResult:
    """Run a scene at all combinations of values, or at sampled ones, and write a table of the summaries.

    Args:
        scene: a scene, or its file.
        vary: "NAME=FROM:TO:COUNT", "NAME=log:FROM:TO:COUNT" or "NAME=A,B,C" each, or such ranges by name;
            NAME is a key of the scene by dots, or a parameter of the mechanism.
        sample: "latin:COUNT" or "sobol:COUNT" instead of a grid.
        sensitivity: number n of Sobol indices, a power of 2: n (d + 2) runs over d ranges instead of a grid.
        seed: of the samples.
        output: folder, by default out/SCENE_sweep: what is done there is not done again.
        fmu: its file, by default that of the package (current_fmu).
        scheduler: address of a running Dask scheduler.
        workers: processes on this machine without one, by default one for each core.
        progress: told the share done.

    Raises:
        Refused: the scene, a range, a sample or the folder is not as above, in one sentence.
        NotInstalled: the extra jobs is not.
    """
    base, name = read(scene)
    axes = axes_of(vary, base)
    if sensitivity is None:
        points = grid(axes) if sample is None else sampled(axes, sample, seed)
    elif sample is not None:
        raise Refused("sample and sensitivity must not both be given")
    task = SceneTask(base.tables, fmu_file(fmu).read_bytes())
    folder = OUTPUT_FOLDER / f"{name}_sweep" if output is None else Path(output)
    found = None
    with Evaluator(task, folder, scheduler, workers, progress) as evaluator:
        if sensitivity is not None:
            found, points = indices(axes, sensitivity, seed, evaluator)
        rows = evaluator(points)
    units = {**units_of(axes, base), **evaluator.journal.units}
    files = write_tables(folder, "sweep", rows, units)
    if found is not None:
        files["sensitivity"] = found.save(folder / "sensitivity.csv")
    return SweepResult(axes, rows, units, evaluator.new, unreached(base, rows), found, files)


def unreached(scene: Scene, rows: Sequence[Row]) -> dict[str, int]:
    """By the time to a speed, in how many rows it is not reached; without those where it always is."""
    names = [time_to(speed) for speed in getattr(scene.load, "times_to", ())]
    counted = {name: sum(name not in row.figures for row in rows if not row.refused) for name in names}
    return {name: number for name, number in counted.items() if number}
