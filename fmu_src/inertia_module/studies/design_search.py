"""Design: values of free keys that satisfy the limits of a specification and are best for its goals.

A cheap fidelity level searches the designs, and a better one verifies the finalists.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..analysis.converter_chart import NOMINAL_SPEED
from ..common.errors import ParameterError, SceneError, unknown
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..fmi.instance import fmu_content
from ..scene import Scene
from ..scene.keys import validated
from ..scene.quantity import Quantity
from ..scene.reading import scene_text
from ..scene.run import SceneRunner
from ..scene.vehicle_metrics import TIME_TO
from .axes import Point, points_at
from .design_judge import Judge
from .design_result import DesignResult, Finalist, caveats_of
from .design_specification import Spec, read_spec, text_of
from .evaluation import Evaluator, Metrics, MetricsOf, Row, Task, summary_of, write_tables
from .search import DesignSearch, population
from .steady_metrics import STEADY_METRICS, SteadyMechanism

# additional key of a point: fidelity of the run
LEVEL = "fidelity"


def metrics_of_designs(settings: dict[str, Any], runner: SceneRunner) -> MetricsOf:
    """Return a function from a point with a LEVEL to the metrics of a specification, as Task.prepare.

    Args:
        settings: "tables" of the scene, "steady_demands" as in Spec, and "runs", True if metrics require
            a run.
        runner: Runner of scenes.
    """
    # A deprecated method would add a warning, which here means a mechanism that cannot be built.
    base = validated(Scene, settings["tables"]).replaced(mechanism={"method": None})

    def metrics(point: Point) -> Metrics:
        keys = {name: value for name, value in point.items() if name != LEVEL}
        scene = base.with_keys(keys).with_fidelity(str(point[LEVEL]))
        mechanism = SteadyMechanism(scene.parameters())
        if warnings := mechanism.module.warnings():
            raise ParameterError("; ".join(warnings))
        metrics = {
            name: Quantity(float(STEADY_METRICS[name].value(mechanism, *at)), STEADY_METRICS[name].unit)
            for name, at in settings["steady_demands"].items()
        }
        return metrics | summary_of(runner, scene) if settings["runs"] else metrics

    return metrics


def design(
    spec: Path | str | Spec,
    *,
    output: Path | str | None = None,
    fmu: Path | str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> DesignResult:
    """Search designs at a cheap fidelity, verify finalists, and write tables and scenes.

    Methods and sources: studies/search.py.

    Args:
        spec: Specification, or path of its file.
        output: Output folder; None for out/SPEC_design. Completed runs in its journal are reused.
        fmu: FMU file; None for current_fmu().
        scheduler: Address of a running Dask scheduler; None for worker processes on this machine.
        workers: Number of these processes; None for one per core.
        progress: Function called with the completed fraction of the search, 0 to 1.

    Raises:
        SceneError: The specification is invalid, or none of the first designs can be computed.
        ParameterError: The folder contains results of another specification.
        MissingDependencyError: The extra ``studies`` is not installed.
    """
    for name in ("distributed", "pyarrow", "pymoo", "tomli_w"):
        library(name, "studies")
    specification, name = (spec, "spec") if isinstance(spec, Spec) else (read_spec(spec), Path(spec).stem)
    base, levels = specification.with_keys({}), (specification.search.fidelity, specification.search.check)
    runs = len(specification.steady_demands) < len(specification.metrics)
    settings = {"tables": base.tables, "steady_demands": specification.steady_demands, "runs": runs}
    task = Task(fmu_content(fmu), settings, metrics_of_designs)
    folder = OUTPUT_FOLDER / f"{name}_design" if output is None else Path(output)
    with Evaluator(task, folder, scheduler, workers) as evaluator:

        def evaluate(points: Sequence[Point], level: str = levels[0]) -> list[Row]:
            rows = evaluator([{**point, LEVEL: level} for point in points])
            return [row._replace(point=point) for row, point in zip(rows, points, strict=True)]

        rows = evaluate(points_at(specification.axes, population(specification, specification.search.seed)))
        units = {axis.name: axis.unit for axis in specification.axes} | evaluator.units
        names = [*(name for row in rows for name in row.metrics), *STEADY_METRICS]
        if all(row.refused for row in rows):
            raise SceneError(f"none of the first {len(rows)} designs can be computed: {rows[0].refused}")
        for metric in specification.metrics:
            if metric not in names and not metric.startswith(TIME_TO):
                raise SceneError(f"metrics: {unknown('metric', metric, names)}")
        judge = Judge(specification, units)
        searched = DesignSearch(specification, judge, evaluate, progress).run()
        rows = searched.rows
        valid_rows = [row for row in rows if not row.refused]
        fronts = judge.fronts([row for row in valid_rows if judge.meets(row, specification.search.margin)])
        selected = _finalists(fronts, specification.search.finalists) or [
            min(valid_rows, key=judge.total_violation)
        ]
        checked = evaluate([row.point for row in selected], levels[1])
        # verified designs of searches with other seeds in the journal
        own_points = [{**row.point, LEVEL: levels[1]} for row in rows]
        in_journal = [row for row in evaluator.rows.values() if row.point[LEVEL] == levels[1]]
        others = [row for row in in_journal if row.point not in own_points]
    finalists, speed = [], max(demand.speed for demand in specification.metrics.values()) or NOMINAL_SPEED
    for number, (row, verified) in enumerate(zip(selected, checked, strict=True), 1):
        if not verified.refused:
            title = f"{specification.title}: design {number}"
            scene = base.with_keys({**row.point, "title": title}).with_fidelity(levels[1])
            file = write_text(folder / f"design_{number}.toml", scene_text(scene))
            doubts = caveats_of(scene, verified.metrics, speed)
            if better := judge.dominating_row(verified, others):
                goals = [
                    f"{goal} {text_of(better.metrics[goal], judge.unit(goal))}"
                    for goal in specification.goals
                ]
                doubts["dominated by another search"] = f"a better design has {', '.join(goals)}"
            finalists.append(Finalist(row, verified, scene, file, doubts))
    files = {f"pareto {k}": v for k, v in write_tables(folder, "pareto", fronts[0], units).items()}
    files |= {f"checked {k}": v for k, v in write_tables(folder, "checked", checked, units).items()}
    return DesignResult(judge, rows, fronts[0], finalists, evaluator.new, files, searched)


def _finalists(fronts: Sequence[Sequence[Row]], number: int) -> list[Row]:
    """Select a number of rows: equally spaced on the first front, or all of it and rows of the next ones."""
    first, rest = fronts[0], [row for front in fronts[1:] for row in front]
    if len(first) <= number:
        return [*first, *rest[: number - len(first)]]
    places = {round(n * (len(first) - 1) / max(number - 1, 1)) for n in range(number)}
    return [first[place] for place in sorted(places)]
