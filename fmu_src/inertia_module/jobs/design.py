"""Design: values of the free keys that meet the limits of a specification and are best for its goals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import did_you_mean
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..harness.fmu import fmu_file
from ..scene import SceneError
from ..scene.keys import validated
from ..scene.reading import scene_text
from ..scene.run import TIME_TO, Quantity, SceneRunner
from ..scene.schema import Scene
from .axes import Point, of_shares, shares_sampled, unit_of_key
from .evaluation import Evaluator, Figures, FiguresOf, Row, Task, summary_of, write_tables
from .spec import LEVELS, NAMED, Judge, Mechanism, Spec, absent, read_spec

# key of a point that is none of the scene: the fidelity it is run at
LEVEL = "fidelity"


def figures_wanted(settings: dict[str, Any], runner: SceneRunner) -> FiguresOf:
    """Prepare for the figures of a specification at points with a LEVEL; see Task.

    Args:
        settings: tables of the scene by fidelity; "named": as of Spec; "runs": whether the scene is run.
    """
    scenes = {level: validated(Scene, settings[level]) for level in settings if level in LEVELS}

    def figures(point: Point) -> Figures:
        keys = {name: value for name, value in point.items() if name != LEVEL}
        scene = scenes[str(point[LEVEL])].with_keys(keys)
        mechanism = Mechanism(scene.parameters())
        mechanism.check_room()
        found = {
            name: Quantity(NAMED[name].value(mechanism, *at), NAMED[name].unit)
            for name, at in settings["named"].items()
        }
        return found | summary_of(runner, scene) if settings["runs"] else found

    return figures


@dataclass(frozen=True)
class Finalist:
    """A design that was run at both levels of fidelity.

    Attributes:
        searched, checked: its rows at the fidelity of the search and at that of the check.
        scene: with its values. file: the scene.
    """

    searched: Row
    checked: Row
    scene: Scene
    file: Path


@dataclass(frozen=True)
class DesignResult:
    """Result of a design.

    Attributes:
        spec: the specification. judge: its limits. rows: all designs of the search, in order.
        front: those of them that meet all limits and that no other is better than.
        finalists: those that were checked. new: how many rows were not there before. files: by kind.
    """

    spec: Spec
    judge: Judge
    rows: list[Row]
    front: list[Row]
    finalists: list[Finalist]
    new: int
    files: dict[str, Path]

    @property
    def chosen(self) -> list[Finalist]:
        """Finalists that meet all limits at the fidelity of the check."""
        return [one for one in self.finalists if self.judge.meets(one.checked)]

    def lines(self, one: Finalist) -> dict[str, str]:
        """The values of a finalist and its figures, searched and checked, as text by name."""

        def text(value: float | str, unit: str = "") -> str:
            return value if isinstance(value, str) else f"{value:.4g} {unit}".removesuffix(" 1").rstrip()

        keys = {name: text(value, self.judge.unit(name)) for name, value in one.searched.point.items()}
        figures = {}
        for name in self.spec.demands:
            searched, checked = (
                row.figures.get(name, absent(name, row)) for row in (one.searched, one.checked)
            )
            figures[name] = f"{text(searched)} → {text(checked, self.judge.unit(name))}"
        missed = [limit.figure for limit in self.judge.limits if limit.violation(one.checked) > 0.0]
        return {**keys, **figures, "limits": f"missed by {', '.join(missed)}" if missed else "met"}

    def verdict(self) -> str:
        """Say in a sentence how many meet the limits and which limit binds, or what stops them all."""
        checked, chosen = ([one.checked for one in some] for some in (self.finalists, self.chosen))
        # where none meets them the one that is the least beyond the limits: of those checked, if any was
        row = chosen[0] if chosen else min(checked or self.rows, key=self.judge.beyond)
        limit = self.judge.tightest(row)
        where = "" if limit is None else limit.text(row, self.judge.unit(limit.figure))
        if chosen:
            binds = f"; nearest to its limit in the first: {where}" if where else ""
            return f"{len(chosen)} of {len(self.finalists)} checked designs meet all limits{binds}"
        if row.refused:
            return f"no design of {len(self.rows)} could be computed: {row.refused}"
        return f"no design of {len(self.rows)} meets all limits; the nearest one: {where}"


def design(
    spec: Path | str | Spec,
    *,
    output: Path | str | None = None,
    fmu: Path | str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> DesignResult:
    """Search designs by NSGA-II at a cheap fidelity, check finalists, and write tables and scenes.

    Source: Deb et al. (2002), A fast and elitist multiobjective genetic algorithm: NSGA-II.

    Args:
        spec: a specification, or its file.
        output: folder, by default out/SPEC_design: what is computed there is not computed again.
        fmu: its file, by default that of the package (current_fmu).
        scheduler: address of a running Dask scheduler.
        workers: processes on this machine without one, by default one for each core.
        progress: told the share done.

    Raises:
        SceneError: the specification is not as it must be, in one sentence.
        Refused: the folder holds results of another one. NotInstalled: the extra jobs is not.
    """
    for name in ("pymoo", "tomli_w"):
        library(name, "jobs", name.replace("_", "-"))
    read, name = (spec, "spec") if isinstance(spec, Spec) else (read_spec(spec), Path(spec).stem)
    levels = (read.search.fidelity, read.search.check)
    scenes = {level: read.scene.with_fidelity(level) for level in levels}
    settings: dict[str, Any] = {level: scene.tables for level, scene in scenes.items()}
    settings |= {"named": read.named, "runs": len(read.named) < len(read.demands)}
    task = Task(fmu_file(fmu).read_bytes(), settings, figures_wanted)
    folder = OUTPUT_FOLDER / f"{name}_design" if output is None else Path(output)
    with Evaluator(task, folder, scheduler, workers) as evaluator:

        def evaluate(points: Sequence[Point], level: str = levels[0]) -> list[Row]:
            rows = evaluator([{**point, LEVEL: level} for point in points])
            return [row._replace(point=point) for row, point in zip(rows, points, strict=True)]

        start = shares_sampled(len(read.axes), f"latin:{read.search.population}", read.search.seed)
        rows = evaluate(of_shares(read.axes, start))
        keys = {axis.name: unit_of_key(axis.name, read.scene) for axis in read.axes}
        units = keys | evaluator.units
        known = list(dict.fromkeys([*(name for row in rows for name in row.figures), *NAMED]))
        if all(row.refused for row in rows):
            raise SceneError(f"none of the first {len(rows)} designs can be computed: {rows[0].refused}")
        for figure in read.demands:
            if figure not in known and not figure.startswith(TIME_TO):
                raise SceneError(f"figures.{figure} must be one that there is {did_you_mean(figure, known)}")
        judge = Judge(read, units)
        rows = _search(read, judge, start, evaluate, progress)
        fronts = judge.fronts([row for row in rows if judge.meets(row, read.search.margin)])
        picked = _finalists(fronts, read.search.finalists) or [min(rows, key=judge.beyond)]
        checked = evaluate([row.point for row in picked], levels[1])
    finalists = []
    for number, (row, again) in enumerate(zip(picked, checked, strict=True), 1):
        if not again.refused:
            title = f"{read.scene.title}: design {number}"
            scene = scenes[levels[1]].with_keys({**row.point, "title": title})
            file = write_text(folder / f"design_{number}.toml", scene_text(scene))
            finalists.append(Finalist(row, again, scene, file))
    front = fronts[0] if fronts else []
    files = {f"pareto {k}": v for k, v in write_tables(folder, "pareto", front, units).items()}
    files |= {f"checked {k}": v for k, v in write_tables(folder, "checked", checked, units).items()}
    return DesignResult(read, judge, rows, front, finalists, evaluator.new, files)


def _finalists(fronts: Sequence[Sequence[Row]], number: int) -> list[Row]:
    """Pick at most so many rows: spread over the first front, and filled up from the next ones."""
    if not fronts:
        return []
    first, rest = fronts[0], [row for front in fronts[1:] for row in front]
    if len(first) <= number:
        return [*first, *rest[: number - len(first)]]
    places = {round(n * (len(first) - 1) / max(number - 1, 1)) for n in range(number)}
    return [first[place] for place in sorted(places)]


def _search(
    spec: Spec,
    judge: Judge,
    start: NDArray[np.float64],
    evaluate: Callable[[Sequence[Point]], list[Row]],
    progress: Progress | None,
) -> list[Row]:
    """Search by NSGA-II; all designs, each once, in the order in which they were first asked for.

    The search is over shares (0 to 1) of the ranges, so that whole numbers, lists and logarithmic ranges are
    searched alike. A design that is refused is beyond its limits. It begins at shares of shape (population,
    axes).
    """
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    settings, found = spec.search, dict[str, Row]()

    class Designs(Problem):  # type: ignore[misc]
        """Designs by shares of the ranges of their keys."""

        generation = 0

        def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
            rows = evaluate(of_shares(spec.axes, x))
            found.update({str(row.point): row for row in rows})
            out["F"] = np.array([judge.costs(row) for row in rows])
            out["G"] = np.array([judge.violations(row, settings.margin) for row in rows])
            self.generation += 1
            if progress is not None:
                progress(self.generation / settings.generations)

    keys, limits = len(spec.axes), len(judge.limits) + 1
    problem = Designs(n_var=keys, n_obj=len(spec.goals), n_ieq_constr=limits, xl=0.0, xu=1.0)
    algorithm = NSGA2(pop_size=settings.population, sampling=start)
    minimize(problem, algorithm, ("n_gen", settings.generations), seed=settings.seed)
    return list(found.values())
