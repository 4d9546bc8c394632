"""Sweep: the summary of a scene over values of its keys, and what varies it the most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.equality import ByContent
from ..common.errors import Refused, must_be, unknown
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER
from ..common.terminal import Progress
from ..harness.fmu import fmu_content
from ..harness.results import write_rows
from ..scene import Scene
from ..scene.run import time_to
from .axes import Axis, axes_of, grid, of_shares, shares_sampled
from .evaluation import Evaluate, Evaluator, Row, Task, read, summaries, write_tables

# a figure that varies less than this, relative to its magnitude, does not vary
CONSTANT = 1e-9


class Share(NamedTuple):
    """Sobol indices of a figure and a key: shares of its variance, alone, and with what it does with others.

    Source: Saltelli et al. (2010), Variance based sensitivity analysis of model output, table 2.
    """

    figure: str
    key: str
    first_order: float
    total: float


@dataclass(frozen=True, eq=False)
class SweepResult(ByContent):
    """Result of a sweep.

    Attributes:
        axes: what was varied. rows: one for each point, in the order of the points.
        units: of keys and figures by name, where known. new: how many rows were not there before.
        unreached: by the time to a speed, how many runs do not come to it.
        sensitivity: Sobol indices, where they were asked for, of figures that vary. files: written, by kind.
    """

    axes: list[Axis]
    rows: list[Row]
    units: dict[str, str]
    new: int
    unreached: dict[str, int]
    sensitivity: list[Share]
    files: dict[str, Path]

    @property
    def refused(self) -> list[Row]:
        """The rows that were refused."""
        return [row for row in self.rows if row.refused]

    def figure(self, name: str) -> NDArray[np.float64]:
        """Values of a figure, NaN where refused, shape (rows,); one that no row has is refused."""
        known = self.figures
        if name not in known:
            raise Refused(unknown("metric", name, known))
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
    for library_name in ("distributed", "pyarrow"):
        library(library_name, "jobs")
    base, name = read(scene)
    axes = axes_of(vary, base)
    if seed < 0:
        raise Refused(must_be("seed", "at least 0", seed))
    if sensitivity is not None and (sensitivity < 2 or sensitivity & (sensitivity - 1)):
        raise Refused(must_be("sensitivity", "a power of 2, such as 256", sensitivity))
    if sensitivity is None:
        points = grid(axes) if sample is None else of_shares(axes, shares_sampled(len(axes), sample, seed))
    elif sample is not None:
        raise Refused("only one of sample and sensitivity is allowed (got both)")
    tables = {key: table for key, table in base.tables.items() if key not in ("title", "description")}
    task = Task(fmu_content(fmu), tables, summaries)
    folder = OUTPUT_FOLDER / f"{name}_sweep" if output is None else Path(output)
    shares = list[Share]()
    with Evaluator(task, folder, scheduler, workers, progress) as evaluator:
        if sensitivity is not None:
            shares, rows = indices(axes, sensitivity, seed, evaluator)
        else:
            rows = evaluator(points)
    units = {axis.name: axis.unit for axis in axes} | evaluator.units
    files = write_tables(folder, "sweep", rows, units)
    if sensitivity is not None:
        files["sensitivity"] = write_rows(folder / "sensitivity.csv", Share._fields, shares)
    return SweepResult(axes, rows, units, evaluator.new, unreached(base, rows), shares, files)


def varies(values: NDArray[np.float64]) -> bool:
    """Tell whether values of a figure differ by more than rounding, NaN left out."""
    known = values[np.isfinite(values)]
    return known.size > 1 and bool(np.ptp(known) > CONSTANT * np.abs(known).max())


def unreached(scene: Scene, rows: Sequence[Row]) -> dict[str, int]:
    """Count, by the time to a speed, the rows that do not reach it; without those where all do."""
    names = [time_to(speed) for speed in getattr(scene.load, "times_to", ())]
    counted = {name: sum(name not in row.figures for row in rows if not row.refused) for name in names}
    return {name: number for name, number in counted.items() if number}


def indices(
    axes: Sequence[Axis], number: int, seed: int, evaluate: Evaluate
) -> tuple[list[Share], list[Row]]:
    """Compute Sobol indices of all figures that vary over d independent, uniform ranges; with n (d + 2) rows.

    Args:
        axes: ranges.
        number: n, a power of 2.
        seed: of the samples.
        evaluate: returns the rows of points.

    Raises:
        Refused: a point is refused: indices take whole ranges.
    """
    from scipy.stats import sobol_indices, uniform

    every, names = list[Row](), list[str]()

    def figures_at(shares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Figures, shape (m, points), at shares of the ranges, shape (axes, points)."""
        rows = evaluate(of_shares(axes, shares.T))
        for row in rows:
            if row.refused:
                raise Refused(
                    f"Sobol indices require a run at every point; {row.point} is rejected: {row.refused}"
                )
        every.extend(rows)
        names[:] = names or sorted(set.intersection(*(set(row.figures) for row in rows)))
        return np.array([[row.figures[name] for row in rows] for name in names])

    with np.errstate(divide="ignore", invalid="ignore"):
        found = sobol_indices(func=figures_at, n=number, dists=[uniform()] * len(axes), rng=seed)
    shape = len(names), len(axes)  # SciPy leaves out the axis of a single range
    first, total = (np.reshape(part, shape).tolist() for part in (found.first_order, found.total_order))
    shares = []
    for name, *of_axes in zip(names, first, total, strict=True):
        if varies(np.array([row.figures[name] for row in every])):
            shares += [Share(name, *one) for one in zip([axis.name for axis in axes], *of_axes, strict=True)]
    return shares, every
