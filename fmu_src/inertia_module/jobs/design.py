"""Design: values of the free keys that meet the limits of a specification and are best for its goals.

Figures of a mechanism by name are of steady pulses at a speed and a speed ratio, and of its size; others are
of the summary of a run. A judge says how far a design is from meeting its limits, and which ones are best.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from ..common.equality import ByContent
from ..common.errors import Refused, must_be, unknown
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..common.units import number_of
from ..contract.variables import BY_NAME, ENUMERATIONS, LARGEST_SPEED
from ..harness.chart import NOMINAL_SPEED, RATIOS, SteadyMachine, torque_converter_chart
from ..harness.fmu import fmu_content
from ..memory import Module
from ..scene import Scene, SceneError
from ..scene.keys import Duration, Keys, Strict, quantity, validated
from ..scene.parts import VehicleLoad
from ..scene.reading import load_tables, scene_text
from ..scene.run import TIME_TO, TRACTIVE_FORCE, Quantity, SceneRunner
from .axes import Axis, Point, axes_of, of_shares
from .evaluation import Evaluator, Figures, FiguresOf, Row, Task, summary_of, write_tables
from .search import SPREAD, DesignSearch, Searched, population

# --- figures of a mechanism ---


class Mechanism(SteadyMachine):
    """A mechanism whose steady pulses, samples and charts are found once for each speed, rad/s, and ratio."""

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        super().__init__(parameters)
        self.pulses = cache(self.at)
        self.sampled = cache(self.samples)
        self.chart = cache(lambda speed: torque_converter_chart(parameters, speed))

    @property
    def envelope_diameter(self) -> float:
        """Diameter about the central axis that imbalances and pitch circles of the satellites need, m."""
        # the rim of a satellite is where an imbalance on its pitch circle would be
        rim = Module("plain")
        rim.check(**{**self._values, "a": 1.0, "b": 1.0, "eccentricity": self.module["satellite_radius"]})
        return 2.0 * max(_farthest(self.module.derived), _farthest(rim.derived))

    def least_torque(self, speed: float) -> float:
        """Least mean output torque over all speed ratios, N.m: 0 without lock-up, for it then ends."""
        numbers = self.chart(speed).summary(speed)
        return numbers["least_torque"] if numbers["lock_up_torque"] > 0.0 else 0.0

    def engagement_frequency(self, speed: float, ratio: float) -> float:
        """Engagements a second of the freewheel that engages more often, Hz; speed in rad/s."""
        pulses = self.pulses(speed, ratio)
        return max(pulses.housing_engagements, pulses.output_engagements) * speed / math.tau

    def largest(self, names: tuple[str, ...], speed: float, ratio: float) -> float:
        """Largest magnitude of the vector of some outputs in steady pulses; speed in rad/s."""
        return float(np.linalg.norm(self.sampled(names, speed, ratio), axis=1).max())


def _farthest(d: Any) -> float:
    """Largest distance of an imbalance from the central axis, m, at any drive angle.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2) R^2 + T^2 + z^2 is
    linear in cos B, hence largest where that is 1 or -1. d: derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


class Named(NamedTuple):
    """A figure: its unit, which of speed (rad/s) and ratio it asks for, and its value at these."""

    unit: str
    asks: tuple[str, ...]
    value: Callable[[Mechanism, float, float], float]


_BOTH = ("speed", "ratio")
_SPEED = ("speed",)
# all the way from stall on
_ALL = RATIOS[::4]
_FORCE, _MOMENT = (tuple(f"shaking_{load}_{axis}" for axis in "xyz") for load in ("force", "moment"))
_INPUT = ("input_torque",)
NAMED = {
    "stall_torque": Named("N.m", _SPEED, lambda m, w, i: m.pulses(w, 0.0).output_torque),
    "steady_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).output_torque),
    "least_torque": Named("N.m", _SPEED, lambda m, w, i: m.least_torque(w)),
    "lock_up_torque": Named("N.m", _SPEED, lambda m, w, i: m.chart(w).summary(w)["lock_up_torque"]),
    "end_ratio": Named("1", _SPEED, lambda m, w, i: m.chart(w).end_ratio),
    "steady_input_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).input_torque),
    "greatest_input_torque": Named("N.m", _SPEED, lambda m, w, i: m.chart(w).input_torque.max() * w**2),
    "input_torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.sampled(_INPUT, w, i).std()),
    "input_torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.largest(_INPUT, w, i)),
    "steady_efficiency": Named("1", _BOTH, lambda m, w, i: m.pulses(w, i).efficiency),
    "torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).ripple),
    "torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).peak),
    "engagement_frequency": Named("Hz", _BOTH, lambda m, w, i: m.engagement_frequency(w, i)),
    "housing_torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).housing_peak),
    "housing_slip_peak": Named("rad/s", _BOTH, lambda m, w, i: m.pulses(w, i).housing_slip),
    "output_slip_peak": Named("rad/s", _BOTH, lambda m, w, i: m.pulses(w, i).output_slip),
    "bearing_force": Named("N", _BOTH, lambda m, w, i: m.pulses(w, i).bearing_force),
    "bearing_force_peak": Named("N", _SPEED, lambda m, w, i: max(m.pulses(w, r).bearing_force for r in _ALL)),
    # where link 2 is at rest
    "satellite_speed": Named("rad/s", _SPEED, lambda m, w, i: m.module.derived.k * m.module.derived.s * w),
    "mount_force": Named("N", _BOTH, lambda m, w, i: m.largest(_FORCE, w, i)),
    "mount_moment": Named("N.m", _BOTH, lambda m, w, i: m.largest(_MOMENT, w, i)),
    "envelope_diameter": Named("m", (), lambda m, w, i: m.envelope_diameter),
    "total_imbalance_mass": Named(
        "kg", (), lambda m, w, i: math.prod(m.module.read(("modules", "satellites", "imbalance_mass")))
    ),
}


# --- specifications ---

LEVELS = tuple(name for name, _, _ in ENUMERATIONS["Fidelity"])
MOST_GOALS = 3
# reserve to a limit, relative to it, below which a figure is at the limit
TOUCHING = 1e-9
# violation of a limit whose figure there is not: the run was refused, or a speed is not reached
MISSING = 1.0


class Demand(Strict):
    """Demand on a figure: a limit or a goal.

    Attributes:
        speed, ratio: of link 1, rad/s, and of the output to it: where a steady figure is taken.
        minimum, maximum: limits, as numbers in the unit of the figure or with a unit.
        goal: whether it is to be the least or the greatest.
    """

    speed: Annotated[float, quantity("rad/s", maximum=LARGEST_SPEED, above=0.0)] = 0.0
    ratio: Annotated[float, quantity("1", 0.0, 0.99)] = 0.0
    minimum: float | str | None = None
    maximum: float | str | None = None
    goal: Literal["least", "greatest"] | None = None


class Search(Strict):
    """Settings of the search for designs (docs/design.md).

    Attributes:
        population, generations: of each start.
        starts: number of independent searches, each with another seed and population.
        stall: generations without improvement that end a start in which no design satisfies all limits.
        longest: s, after which no generation is added and no start begins.
        seed: of the first start.
        fidelity, check: levels of the search and of the finalists.
        finalists: number of designs to verify.
        margin: relative reserve to the limits of summary metrics, for effects that the fidelity omits.
    """

    population: int = Field(default=40, ge=4, le=10_000)
    generations: int = Field(default=20, ge=1, le=10_000)
    starts: int = Field(default=3, ge=1, le=1000)
    stall: int = Field(default=8, ge=1, le=10_000)
    longest: Duration = 600.0
    seed: int = Field(default=1, ge=0)
    fidelity: Literal[LEVELS] = "averaged"  # type: ignore[valid-type]
    check: Literal[LEVELS] = "rigid"  # type: ignore[valid-type]
    finalists: int = Field(default=5, ge=1, le=1000)
    margin: Annotated[float, quantity("1", 0.0, 0.5)] = 0.0


class Spec(Scene):
    """A specification: a scene of all that is not free, what is asked of it, and how it is searched.

    Attributes:
        free: ranges or lists by key; see axes_of. figures: demands by figure. search: how.
    """

    free: dict[str, Any] = Field(default={})
    figures: dict[str, Demand] = Field(min_length=1)
    search: Search = Search()

    @cached_property
    def axes(self) -> list[Axis]:
        """The free keys."""
        return axes_of(self.free, self)

    @property
    def goals(self) -> dict[str, str]:
        """Figures that are to be the least or the greatest."""
        return {name: demand.goal for name, demand in self.figures.items() if demand.goal is not None}

    @property
    def named(self) -> dict[str, tuple[float, float]]:
        """The figures that need no run of the scene, with speed and ratio; others are of its summary."""
        return {name: (d.speed, d.ratio) for name, d in self.figures.items() if name in NAMED}

    @model_validator(mode="after")
    def _check_demands(self) -> Spec:
        axes_of(self.free, self)
        for name, demand in self.figures.items():
            if demand.minimum is None and demand.maximum is None and demand.goal is None:
                goals = "a goal ('least' or 'greatest')"
                raise SceneError(f"figures.{name} requires a minimum, a maximum or {goals}")
            asked = NAMED[name].asks if name in NAMED else ()
            given = tuple(one for one in ("speed", "ratio") if one in demand.model_fields_set)
            if given != asked:
                at_speed = [one for one, named in NAMED.items() if named.asks]
                cause = "" if name in NAMED else f": {unknown('steady-state metric', name, at_speed)}"
                required = f"requires {' and '.join(asked)}" if asked else "accepts no speed and no ratio"
                got = " and ".join(given) or "none"
                raise SceneError(f"figures.{name} {required} (got {got}){cause}")
            if name in NAMED:
                limits_of(name, demand, NAMED[name].unit)
        number = len(self.goals)
        if not 1 <= number <= MOST_GOALS:
            raise SceneError(must_be("the number of metrics with a goal", f"1 to {MOST_GOALS}", number))
        return self


def read_spec(path: Path | str, keys: Keys = None) -> Spec:
    """Read a specification: the TOML of a scene with [free], [figures] and [search]; all as load_scene."""
    return load_tables(path, keys, lambda tables: Spec)


def shown(value: float | str, unit: str = "") -> str:
    """Write a value with its unit, a name as it is."""
    return value if isinstance(value, str) else f"{value:.4g} {unit}".removesuffix(" 1").rstrip()


def figure_of(row: Row, name: str, unit: str = "") -> str:
    """Write the figure of a row with its unit, or why it has none."""
    absent = "not reached" if name.startswith(TIME_TO) and not row.refused else "not available"
    return shown(row.figures.get(name, absent), unit)


class Limit(NamedTuple):
    """A limit of a figure, in its unit; side: 1.0 for a maximum, -1.0 for a minimum."""

    figure: str
    unit: str
    bound: float
    side: float

    def violation(self, row: Row, margin: float = 0.0) -> float:
        """Excess of a row over the limit, narrower by a margin, relative to it; below 0 what is left."""
        value = row.figures.get(self.figure, math.nan)
        if not math.isfinite(value):
            return MISSING
        narrower = 0.0 if self.figure in NAMED else margin
        return self.side * (value - self.bound) / (abs(self.bound) or 1.0) + narrower

    def text(self, row: Row) -> str:
        """Compare what a row has with the limit, in a line."""
        side = "at most" if self.side > 0.0 else "at least"
        has = figure_of(row, self.figure, self.unit)
        return f"{self.figure} {has} (limit: {side} {shown(self.bound, self.unit)})"


def limits_of(name: str, demand: Demand, unit: str) -> list[Limit]:
    """Limits of a figure in its unit; refused if one is no quantity in it, or no number meets both."""
    found = []
    for which, side in (("minimum", -1.0), ("maximum", 1.0)):
        given = getattr(demand, which)
        if given is None:
            continue
        try:
            found.append(Limit(name, unit, number_of(given, unit or "1"), side))
        except ValueError as error:
            message = must_be(f"figures.{name}.{which}", f"a number in {unit or '1'}", repr(given))
            raise SceneError(f"{message}: {error}") from None
    if len(found) == 2 and found[0].bound > found[1].bound:
        low, high = (f"{limit.bound:g}" for limit in found)
        raise SceneError(must_be(f"figures.{name}.minimum", f"at most the maximum, {high}", low))
    return found


class Judge:
    """Judges rows by a specification, with units of the figures by name; refuses as limits_of."""

    def __init__(self, spec: Spec, units: dict[str, str]) -> None:
        self.spec, self.units, self.limits = spec, units, list[Limit]()
        for name, demand in spec.figures.items():
            self.limits += limits_of(name, demand, self.unit(name))

    def unit(self, name: str) -> str:
        """Unit of a figure; of a time that no design has reached, s."""
        return self.units.get(name, "s" if name.startswith(TIME_TO) else "")

    def violations(self, row: Row, margin: float = 0.0) -> list[float]:
        """Violation of each limit, and at last whether a goal has no figure."""
        missing = any(name not in row.figures for name in self.spec.goals)
        return [limit.violation(row, margin) for limit in self.limits] + [MISSING if missing else 0.0]

    def meets(self, row: Row, margin: float = 0.0) -> bool:
        """Tell whether a row meets all limits."""
        return max(self.violations(row, margin)) <= 0.0

    def beyond(self, row: Row) -> float:
        """Sum of what a row is beyond its limits: 0 where all are met."""
        return sum(max(violation, 0.0) for violation in self.violations(row))

    def tightest(self, row: Row, rows: Sequence[Row] = ()) -> str:
        """Describe the limit that a row violates most, or is nearest to.

        Args:
            row: a design.
            rows: all designs; a limit that none of them violates, or that all others just reach, like a speed
                ratio of at least 1, does not restrict the design.

        Returns:
            A line, or "" without limits.
        """
        restricting = [limit for limit in self.limits if self._restricts(limit, row, rows)]
        limit = max(restricting or self.limits, key=lambda limit: limit.violation(row), default=None)
        return "" if limit is None else limit.text(row)

    def _restricts(self, limit: Limit, row: Row, rows: Sequence[Row]) -> bool:
        """Return True if a row violates a limit, or other rows lie on both sides of it."""
        if limit.violation(row) > 0.0 or not rows:
            return True
        violations = [limit.violation(other) for other in rows if limit.figure in other.figures]
        return any(one > 0.0 for one in violations) and any(one < -TOUCHING for one in violations)

    def costs(self, row: Row) -> list[float]:
        """The goals as numbers that are to be small."""
        sign = {"least": 1.0, "greatest": -1.0}
        return [sign[goal] * row.figures.get(name, 0.0) for name, goal in self.spec.goals.items()]

    def better(self, row: Row, others: Iterable[Row]) -> Row | None:
        """The best of other rows that meet all limits, are no worse in any goal and better in one."""
        costs = self.costs(row)
        found = [one for one in others if self.meets(one) and self.costs(one) != costs]
        found = [one for one in found if all(map(operator.le, self.costs(one), costs))]
        return min(found, key=self.costs, default=None)

    def fronts(self, rows: Sequence[Row]) -> list[list[Row]]:
        """Rows by rank, at least one: the first ones are those that no other is better than in every goal."""
        from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

        if not rows:
            return [[]]
        ranks = NonDominatedSorting().do(np.array([self.costs(row) for row in rows]))
        return [sorted((rows[n] for n in rank), key=self.costs) for rank in ranks]


# --- the search ---

# key of a point that is none of the scene: the fidelity it is run at
LEVEL = "fidelity"
# rad, a turn of the output shaft, or of the wheels of a car, below which a load stays at rest
AT_REST = math.tau


def figures_wanted(settings: dict[str, Any], runner: SceneRunner) -> FiguresOf:
    """Prepare for the figures of a specification at points with a LEVEL; see Task.

    Of the settings "tables" are those of the scene, "named" as of Spec, "runs" whether the scene is run.
    """
    # (its deprecated value has a warning, but the mechanism can be built)
    base = validated(Scene, settings["tables"]).replaced(mechanism={"method": None})

    def figures(point: Point) -> Figures:
        keys = {name: value for name, value in point.items() if name != LEVEL}
        scene = base.with_keys(keys).with_fidelity(str(point[LEVEL]))
        mechanism = Mechanism(scene.parameters())
        if unbuildable := mechanism.module.warnings():
            raise Refused("; ".join(unbuildable))
        found = {
            name: Quantity(float(NAMED[name].value(mechanism, *at)), NAMED[name].unit)
            for name, at in settings["named"].items()
        }
        return found | summary_of(runner, scene) if settings["runs"] else found

    return figures


@dataclass(frozen=True, eq=False)
class Finalist(ByContent):
    """A design that was run at the fidelities of search and check, as a scene in a file."""

    searched: Row
    checked: Row
    scene: Scene
    file: Path
    doubts: dict[str, str]


def doubts_of(scene: Scene, figures: Mapping[str, float], speed: float) -> dict[str, str]:
    """Say why a design that meets its limits may be no answer: what in short, and in a sentence.

    Figures are those of its check; lock-up is looked at at a speed of link 1, rad/s.
    """
    found, mechanism = {}, Mechanism(scene.parameters())
    try:
        chart = mechanism.chart(speed)
        if not chart.lock_up_torque[0] > 0.0:
            found["no lock-up"] = f"no torque is transmitted above a speed ratio of {chart.end_ratio:.2g}"
        limit = scene.drive_torque_limit(speed)
        if limit is not None and (beyond := chart.beyond_drive(speed, limit)):
            found["drive too weak"] = beyond
    except Refused as error:
        found["no mean torque"] = str(error)
    if mechanism.module["satellite_inertia"] == 0.0:
        found["satellites without inertia"] = "satellite_inertia is 0"
    # of the wheels of a car, at most of another load; where nothing was run there is nothing to say
    turned = figures.get("omega_out_maximum", math.inf) * scene.run.stop_time
    if isinstance(scene.load, VehicleLoad):
        turned = figures.get("distance", math.inf) / scene.load.wheel_radius
    if isinstance(scene.load, VehicleLoad) and figures.get(TRACTIVE_FORCE, 0.0) > (
        scene.load.grip or math.inf
    ):
        force, grip = figures[TRACTIVE_FORCE], scene.load.grip
        found["wheels slip"] = f"the tractive force reaches {force:.4g} N, the grip is {grip:.4g} N"
    if turned < AT_REST:
        found["load does not move"] = f"{turned / math.tau:.2g} revolutions in the run"
    return found


@dataclass(frozen=True, eq=False)
class DesignResult(ByContent):
    """Result of a design.

    Attributes:
        judge: by the specification, its spec. rows: all designs of the search, in order.
        front: those of them that meet all limits and that no other is better than.
        finalists: those that were checked. new: how many rows were not there before. files: by kind.
        searched: outcome of the search, with the best figures of each start.
    """

    judge: Judge
    rows: list[Row]
    front: list[Row]
    finalists: list[Finalist]
    new: int
    files: dict[str, Path]
    searched: Searched

    @property
    def cut(self) -> bool:
        """True if time ended the search before it had made its starts."""
        return self.searched.is_cut

    @property
    def chosen(self) -> list[Finalist]:
        """Finalists that meet all limits at the fidelity of the check."""
        return [one for one in self.finalists if self.judge.meets(one.checked)]

    def lines(self, one: Finalist) -> dict[str, str]:
        """The values of a finalist and its figures, searched and checked, as text by name."""
        keys = {name: shown(value, self.judge.unit(name)) for name, value in one.searched.point.items()}
        keys |= {name: shown(value, BY_NAME[name].unit) for name, value in one.scene.following.items()}
        figures = {}
        for name in self.judge.spec.figures:
            checked = figure_of(one.checked, name, self.judge.unit(name))
            figures[name] = f"{figure_of(one.searched, name)} → {checked}"
        missed = [limit.figure for limit in self.judge.limits if limit.violation(one.checked) > 0.0]
        limits = f"violated: {', '.join(missed)}" if missed else "satisfied"
        caveats = {f"caveat: {name}": reason for name, reason in one.doubts.items()}
        return keys | figures | {"limits": limits} | caveats

    def verdict(self) -> str:
        """Say in a sentence how many meet the limits, which one binds or stops them, and what is in doubt."""
        finalists, search = self.finalists, self.judge.spec.search
        # where none meets them the one that is the least beyond the limits: of those checked, if any was
        rows = [one.checked for one in self.chosen or finalists]
        rows = rows or [row for row in self.rows if not row.refused]
        row = rows[0] if self.chosen else min(rows, key=self.judge.beyond)
        where = self.judge.tightest(row, self.rows)
        if self.chosen:
            first = self.chosen[0].file.stem.replace("_", " ")
            binds = f"; tightest in {first}: {where}" if where else ""
            short = [name for one in self.chosen for name in one.doubts]
            doubts = ", ".join(f"{name} in {short.count(name)}" for name in dict.fromkeys(short))
            binds += f"; caveats: {doubts} of them" if doubts else ""
            number = f"{len(self.chosen)} of {len(finalists)} verified designs satisfy all limits"
            return f"{number}; {self.convergence()}{binds}"
        what = f"{len(self.rows)} designs"
        why = f"no improvement in the last {search.stall} generations of {search.starts} starts"
        if self.front:
            what = f"{len(finalists)} verified designs"
            why = f"{len(self.front)} of {len(self.rows)} designs do with fidelity {search.fidelity!r}"
        elif self.cut:
            why = f"search.longest = {search.longest:g} s ended the search before it was complete"
        return f"0 of {what} satisfy all limits; {why}; closest design: {where}"

    def convergence(self) -> str:
        """Compare the best designs of the starts: converged or not, with their figures."""
        searched, search = self.searched, self.judge.spec.search
        starts, successful = searched.starts, [start for start in searched.starts if start.best]
        texts = []
        for goal, spread in searched.spread().items():
            values = ", ".join(f"{start.best[goal]:.4g}" for start in successful)
            texts.append(f"{goal} {values} {self.judge.unit(goal)} (spread {100.0 * spread:.2g} %)")
        best = f"best of {len(successful)} starts: {', '.join(texts)}"
        if searched.has_converged:
            return f"converged; {best}"
        if searched.is_cut:
            reason = f"search.longest = {search.longest:g} s ended the search"
        elif len(starts) < 2:
            reason = "one start shows no spread; increase search.starts"
        elif len(successful) < len(starts):
            reason = (
                f"{len(starts) - len(successful)} of {len(starts)} starts found no design within the limits"
            )
        else:
            reason = f"the best designs of the starts differ by more than {100.0 * SPREAD:g} %"
            reason += "; increase search.generations or search.population"
        return f"not converged: {reason}" + (f"; {best}" if texts else "")


def design(
    spec: Path | str | Spec,
    *,
    output: Path | str | None = None,
    fmu: Path | str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> DesignResult:
    """Search designs at a cheap fidelity, check finalists, and write tables and scenes.

    For methods and sources see jobs/search.py.

    Args:
        spec: a specification, or its file.
        output: folder, by default out/SPEC_design: what is computed there is not computed again.
        fmu: as of sweep.
        scheduler: as of sweep.
        workers: as of sweep.
        progress: as of sweep.

    Raises:
        SceneError: the specification is not as it must be, in one sentence.
        Refused: the folder holds results of another one. NotInstalled: the extra jobs is not.
    """
    for name in ("distributed", "pyarrow", "pymoo", "tomli_w"):
        library(name, "jobs")
    read, name = (spec, "spec") if isinstance(spec, Spec) else (read_spec(spec), Path(spec).stem)
    base, levels = read.with_keys({}), (read.search.fidelity, read.search.check)
    runs = len(read.named) < len(read.figures)
    settings = {"tables": base.tables, "named": read.named, "runs": runs}
    task = Task(fmu_content(fmu), settings, figures_wanted)
    folder = OUTPUT_FOLDER / f"{name}_design" if output is None else Path(output)
    with Evaluator(task, folder, scheduler, workers) as evaluator:

        def evaluate(points: Sequence[Point], level: str = levels[0]) -> list[Row]:
            rows = evaluator([{**point, LEVEL: level} for point in points])
            return [row._replace(point=point) for row, point in zip(rows, points, strict=True)]

        rows = evaluate(of_shares(read.axes, population(read, read.search.seed)))
        units = {axis.name: axis.unit for axis in read.axes} | evaluator.units
        known = [*(name for row in rows for name in row.figures), *NAMED]
        if all(row.refused for row in rows):
            raise SceneError(f"none of the first {len(rows)} designs can be computed: {rows[0].refused}")
        for figure in read.figures:
            if figure not in known and not figure.startswith(TIME_TO):
                raise SceneError(f"figures: {unknown('metric', figure, known)}")
        judge = Judge(read, units)
        searched = DesignSearch(read, judge, evaluate, progress).run()
        rows = searched.rows
        computed = [row for row in rows if not row.refused]
        fronts = judge.fronts([row for row in computed if judge.meets(row, read.search.margin)])
        picked = _finalists(fronts, read.search.finalists) or [min(computed, key=judge.beyond)]
        checked = evaluate([row.point for row in picked], levels[1])
        # what the journal has of searches by other seeds
        own = [{**row.point, LEVEL: levels[1]} for row in rows]
        there = [row for row in evaluator.rows.values() if row.point[LEVEL] == levels[1]]
        others = [row for row in there if row.point not in own]
    finalists, speed = [], max(demand.speed for demand in read.figures.values()) or NOMINAL_SPEED
    for number, (row, again) in enumerate(zip(picked, checked, strict=True), 1):
        if not again.refused:
            title = f"{read.title}: design {number}"
            scene = base.with_keys({**row.point, "title": title}).with_fidelity(levels[1])
            file = write_text(folder / f"design_{number}.toml", scene_text(scene))
            doubts = doubts_of(scene, again.figures, speed)
            if better := judge.better(again, others):
                goals = [f"{goal} {shown(better.figures[goal], judge.unit(goal))}" for goal in read.goals]
                doubts["dominated by another search"] = f"a better design has {', '.join(goals)}"
            finalists.append(Finalist(row, again, scene, file, doubts))
    files = {f"pareto {k}": v for k, v in write_tables(folder, "pareto", fronts[0], units).items()}
    files |= {f"checked {k}": v for k, v in write_tables(folder, "checked", checked, units).items()}
    return DesignResult(judge, rows, fronts[0], finalists, evaluator.new, files, searched)


def _finalists(fronts: Sequence[Sequence[Row]], number: int) -> list[Row]:
    """Pick at most so many rows: spread over the first front, and filled up from the next ones."""
    first, rest = fronts[0], [row for front in fronts[1:] for row in front]
    if len(first) <= number:
        return [*first, *rest[: number - len(first)]]
    places = {round(n * (len(first) - 1) / max(number - 1, 1)) for n in range(number)}
    return [first[place] for place in sorted(places)]
