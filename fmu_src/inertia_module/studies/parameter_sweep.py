"""Sweep: the summary of a scene over values of its keys, and Sobol indices of the keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.deprecated import renamed_attributes
from ..common.equality import ByContent
from ..common.errors import ParameterError, listed, must_be, unknown
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER
from ..common.terminal import Progress
from ..fmi.instance import fmu_content
from ..fmi.results import write_rows
from ..scene import Scene
from ..scene.vehicle_metrics import time_to_name
from .axes import Axis, axes_of, grid, points_at, sample_shares
from .evaluation import Evaluate, Evaluator, Row, Task, scene_and_name, summaries, write_tables

# maximum relative variation of a constant metric
CONSTANT_RTOL = 1e-9


class Share(NamedTuple):
    """Sobol indices of a metric and a key.

    Source: Saltelli et al. (2010), Variance based sensitivity analysis of model output, table 2.

    Attributes:
        metric: Name of the metric.
        key: Dotted key.
        first_order: Fraction of the variance that the key alone causes.
        total: Fraction of the variance that the key causes, including interactions with other keys.
    """

    metric: str
    key: str
    first_order: float
    total: float


@dataclass(frozen=True, eq=False, repr=False)
class SweepResult(ByContent):
    """Result of a sweep.

    Attributes:
        axes: Varied keys.
        rows: Rows, one per point, in the order of the points.
        units: Units of keys and metrics, by name.
        new: Number of rows that were not in the journal.
        unreached: Number of runs that do not reach a speed, by the name of the acceleration time.
        sensitivity: Sobol indices of metrics that vary; empty unless requested.
        files: Paths of the written files, by kind.
    """

    axes: list[Axis]
    rows: list[Row]
    units: dict[str, str]
    new: int
    unreached: dict[str, int]
    sensitivity: list[Share]
    files: dict[str, Path]

    def __repr__(self) -> str:
        keys = listed(axis.name for axis in self.axes)
        runs = f"{len(self.rows)} runs, {len(self.refused)} failed"
        return f"SweepResult({runs}: {len(self.metrics)} metrics over {keys})"

    __getattr__ = renamed_attributes(figure="metric", figures="metrics")

    @property
    def refused(self) -> list[Row]:
        """Return the rows of failed runs."""
        return [row for row in self.rows if row.refused]

    def metric(self, name: str) -> NDArray[np.float64]:
        """Return the values of a metric, NaN for failed runs, shape (rows,).

        Args:
            name: Name of the metric.

        Raises:
            ParameterError: No row has the metric.
        """
        names = self.metrics
        if name not in names:
            raise ParameterError(unknown("metric", name, names))
        return np.array([row.metrics.get(name, np.nan) for row in self.rows])

    @property
    def metrics(self) -> list[str]:
        """Return the names of the metrics."""
        return list(dict.fromkeys(name for row in self.rows for name in row.metrics))


def sweep(
    scene: Scene | Path | str,
    vary: Mapping[str, str | Sequence[float | str]],
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
    """Run a scene at a grid of values or at samples, and write a table of the summaries.

    Args:
        scene: Scene, or path of its file.
        vary: Ranges "FROM:TO:COUNT", "log:FROM:TO:COUNT" or "A,B,C" with optional units, or lists of values,
            by dotted key of the scene or by parameter of the mechanism.
        sample: "latin:COUNT" or "sobol:COUNT" for samples; None for a grid.
        sensitivity: Number n of base samples for Sobol indices, a power of 2. The sweep then has n (d + 2)
            runs over d ranges instead of a grid.
        seed: Random seed of the samples.
        output: Output folder; None for out/SCENE_sweep. Completed runs in its journal are reused.
        fmu: FMU file; None for current_fmu().
        scheduler: Address of a running Dask scheduler; None for worker processes on this machine.
        workers: Number of these processes; None for one per core.
        progress: Function called with the completed fraction, 0 to 1.

    Raises:
        ParameterError: The scene, a range or a sample is invalid, or the folder contains another sweep.
        MissingDependencyError: The extra ``studies`` is not installed.
    """
    for library_name in ("distributed", "pyarrow"):
        library(library_name, "studies")
    base, name = scene_and_name(scene)
    axes = axes_of(vary, base)
    if seed < 0:
        raise ParameterError(must_be("seed", "at least 0", seed))
    if sensitivity is not None and (sensitivity < 2 or sensitivity & (sensitivity - 1)):
        raise ParameterError(must_be("sensitivity", "a power of 2, such as 256", sensitivity))
    if sensitivity is None:
        points = grid(axes) if sample is None else points_at(axes, sample_shares(len(axes), sample, seed))
    elif sample is not None:
        raise ParameterError("only one of sample and sensitivity is allowed (got both)")
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
    """Return True if values of a metric differ by more than round-off; NaN is ignored.

    Args:
        values: The values, shape (n,).
    """
    finite = values[np.isfinite(values)]
    return finite.size > 1 and bool(np.ptp(finite) > CONSTANT_RTOL * np.abs(finite).max())


def unreached(scene: Scene, rows: Sequence[Row]) -> dict[str, int]:
    """Count the runs that do not reach a speed, by the name of the acceleration time; zeros are omitted.

    Args:
        scene: The scene.
        rows: Rows of the sweep.
    """
    names = [time_to_name(speed) for speed in getattr(scene.load, "times_to", ())]
    counts = {name: sum(name not in row.metrics for row in rows if not row.refused) for name in names}
    return {name: number for name, number in counts.items() if number}


def indices(
    axes: Sequence[Axis], number: int, seed: int, evaluate: Evaluate
) -> tuple[list[Share], list[Row]]:
    """Compute Sobol indices of all metrics that vary over d independent, uniform ranges.

    Args:
        axes: The ranges.
        number: Number n of base samples, a power of 2.
        seed: Random seed of the samples.
        evaluate: Function that returns the rows of points.

    Returns:
        Sobol indices, and the n (d + 2) rows.

    Raises:
        ParameterError: A run fails; the indices require a run at every point.
    """
    from scipy.stats import sobol_indices, uniform

    all_rows, names = list[Row](), list[str]()

    def metrics_at(shares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return metrics, shape (m, points), at fractions of the ranges, shape (axes, points)."""
        rows = evaluate(points_at(axes, shares.T))
        for row in rows:
            if row.refused:
                raise ParameterError(
                    f"Sobol indices require a run at every point; {row.point} is rejected: {row.refused}"
                )
        all_rows.extend(rows)
        names[:] = names or sorted(set.intersection(*(set(row.metrics) for row in rows)))
        return np.array([[row.metrics[name] for row in rows] for name in names])

    with np.errstate(divide="ignore", invalid="ignore"):
        sobol = sobol_indices(func=metrics_at, n=number, dists=[uniform()] * len(axes), rng=seed)
    shape = len(names), len(axes)  # SciPy omits the axis of a single range
    first, total = (np.reshape(part, shape).tolist() for part in (sobol.first_order, sobol.total_order))
    shares = []
    for name, *of_axes in zip(names, first, total, strict=True):
        if varies(np.array([row.metrics[name] for row in all_rows])):
            keys = [axis.name for axis in axes]
            shares += [Share(name, *values) for values in zip(keys, *of_axes, strict=True)]
    return shares, all_rows
