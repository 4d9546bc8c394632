"""Design: values of free keys that satisfy the limits of a specification and are best for its goals.

Metrics in NAMED describe the steady state at a speed and a speed ratio, or the size of a mechanism. Other
metrics come from the summary of a run. A judge computes violations of limits and ranks designs.
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

from ..analysis.converter_chart import NOMINAL_SPEED, RATIOS, SteadyMachine, torque_converter_chart
from ..common.equality import ByContent
from ..common.errors import InertiaModuleError, ParameterError, SceneError, must_be, unknown
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..common.units import number_of
from ..fmi.instance import fmu_content
from ..interface.variables import BY_NAME, ENUMERATIONS, LARGEST_SPEED
from ..model import Module
from ..scene import Scene
from ..scene.keys import Duration, Keys, Strict, quantity, validated
from ..scene.parts import VehicleLoad
from ..scene.reading import load_tables, scene_text
from ..scene.run import TIME_TO, TRACTIVE_FORCE, Quantity, SceneRunner
from .axes import Axis, Point, axes_of, of_shares
from .evaluation import Evaluator, Figures, FiguresOf, Row, Task, summary_of, write_tables
from .search import SPREAD, DesignSearch, Searched, population

# --- metrics of a mechanism ---


class Mechanism(SteadyMachine):
    """Mechanism that computes steady pulses, samples and charts once per speed, rad/s, and ratio.

    Args:
        parameters: Parameters of the module, SI, by name.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        super().__init__(parameters)
        self.pulses = cache(self.at)
        self.sampled = cache(self.samples)
        self.chart = cache(lambda speed: torque_converter_chart(parameters, speed))

    @property
    def envelope_diameter(self) -> float:
        """Return the diameter about the central axis of all unbalanced masses and pitch circles, m."""
        # A point of the rim of a satellite moves like an unbalanced mass on its pitch circle.
        rim = Module("plain")
        rim.check(**{**self._values, "a": 1.0, "b": 1.0, "eccentricity": self.module["satellite_radius"]})
        return 2.0 * max(_maximum_radius(self.module.derived), _maximum_radius(rim.derived))

    def minimum_torque(self, speed: float) -> float:
        """Return the minimum mean output torque over all speed ratios, N.m; 0 without lock-up.

        Args:
            speed: Speed of link 1, rad/s.
        """
        numbers = self.chart(speed).summary(speed)
        return numbers["least_torque"] if numbers["lock_up_torque"] > 0.0 else 0.0

    def engagement_frequency(self, speed: float, ratio: float) -> float:
        """Return the maximum engagement frequency of both freewheels, Hz.

        Args:
            speed: Speed of link 1, rad/s.
            ratio: Speed ratio.
        """
        pulses = self.pulses(speed, ratio)
        return max(pulses.housing_engagements, pulses.output_engagements) * speed / math.tau

    def maximum(self, names: tuple[str, ...], speed: float, ratio: float) -> float:
        """Return the maximum magnitude of a vector of outputs in the steady state.

        Args:
            names: Names of the components.
            speed: Speed of link 1, rad/s.
            ratio: Speed ratio.
        """
        return float(np.linalg.norm(self.sampled(names, speed, ratio), axis=1).max())


def _maximum_radius(d: Any) -> float:
    """Return the maximum distance of an unbalanced mass from the central axis, m.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2), R^2 + T^2 + z^2 is
    linear in cos B, so the maximum is at cos B = 1 or -1.

    Args:
        d: Derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


class Named(NamedTuple):
    """Metric of a mechanism.

    Attributes:
        unit: Unit.
        asks: Required keys of a demand: "speed", "ratio", both or none.
        value: Function of mechanism, speed, rad/s, and speed ratio.
    """

    unit: str
    asks: tuple[str, ...]
    value: Callable[[Mechanism, float, float], float]


_BOTH = ("speed", "ratio")
_SPEED = ("speed",)
# speed ratios from stall to lock-up
_ALL = RATIOS[::4]
_FORCE, _MOMENT = (tuple(f"shaking_{load}_{axis}" for axis in "xyz") for load in ("force", "moment"))
_INPUT = ("input_torque",)
NAMED = {
    "stall_torque": Named("N.m", _SPEED, lambda m, w, i: m.pulses(w, 0.0).output_torque),
    "steady_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).output_torque),
    "least_torque": Named("N.m", _SPEED, lambda m, w, i: m.minimum_torque(w)),
    "lock_up_torque": Named("N.m", _SPEED, lambda m, w, i: m.chart(w).summary(w)["lock_up_torque"]),
    "end_ratio": Named("1", _SPEED, lambda m, w, i: m.chart(w).end_ratio),
    "steady_input_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).input_torque),
    "greatest_input_torque": Named("N.m", _SPEED, lambda m, w, i: m.chart(w).input_torque.max() * w**2),
    "input_torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.sampled(_INPUT, w, i).std()),
    "input_torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.maximum(_INPUT, w, i)),
    "steady_efficiency": Named("1", _BOTH, lambda m, w, i: m.pulses(w, i).efficiency),
    "torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).ripple),
    "torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).peak),
    "engagement_frequency": Named("Hz", _BOTH, lambda m, w, i: m.engagement_frequency(w, i)),
    "housing_torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).housing_peak),
    "housing_slip_peak": Named("rad/s", _BOTH, lambda m, w, i: m.pulses(w, i).housing_slip),
    "output_slip_peak": Named("rad/s", _BOTH, lambda m, w, i: m.pulses(w, i).output_slip),
    "bearing_force": Named("N", _BOTH, lambda m, w, i: m.pulses(w, i).bearing_force),
    "bearing_force_peak": Named("N", _SPEED, lambda m, w, i: max(m.pulses(w, r).bearing_force for r in _ALL)),
    # speed of the satellites with link 2 at rest
    "satellite_speed": Named("rad/s", _SPEED, lambda m, w, i: m.module.derived.k * m.module.derived.s * w),
    "mount_force": Named("N", _BOTH, lambda m, w, i: m.maximum(_FORCE, w, i)),
    "mount_moment": Named("N.m", _BOTH, lambda m, w, i: m.maximum(_MOMENT, w, i)),
    "envelope_diameter": Named("m", (), lambda m, w, i: m.envelope_diameter),
    "total_imbalance_mass": Named(
        "kg", (), lambda m, w, i: math.prod(m.module.read(("modules", "satellites", "imbalance_mass")))
    ),
}


# --- specifications ---

LEVELS = tuple(name for name, _, _ in ENUMERATIONS["Fidelity"])
MAX_GOALS = 3
# maximum relative margin of a metric that is at its limit
MARGIN_RTOL = 1e-9
# violation of a limit if the metric is missing, because the run failed or a speed is not reached
MISSING = 1.0


class Demand(Strict):
    """Limit or goal of a metric.

    Attributes:
        speed: Speed of link 1 for a steady-state metric, rad/s.
        ratio: Speed ratio for a steady-state metric.
        minimum: Minimum: number in the unit of the metric, or text with a unit; None for no limit.
        maximum: Maximum, likewise.
        goal: "least" to minimise, "greatest" to maximise, None for no goal.
    """

    speed: Annotated[float, quantity("rad/s", maximum=LARGEST_SPEED, above=0.0)] = 0.0
    ratio: Annotated[float, quantity("1", 0.0, 0.99)] = 0.0
    minimum: float | str | None = None
    maximum: float | str | None = None
    goal: Literal["least", "greatest"] | None = None


class Search(Strict):
    """Settings of the search for designs (docs/design.md).

    Attributes:
        population: Number of designs of a generation.
        generations: Number of generations of each start.
        starts: Number of independent searches with different seeds.
        stall: Number of generations without improvement that ends a start without a valid design.
        longest: Time limit, s. After it no generation is added and no start begins.
        seed: Random seed of the first start.
        fidelity: Fidelity of the search.
        check: Fidelity of the verification of finalists.
        finalists: Number of designs to verify.
        margin: Relative margin to the limits of summary metrics, for effects that the fidelity omits.
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
    """Specification of a design: a scene with free keys, demands and settings of the search.

    Attributes:
        free: Ranges or lists by key, as in axes_of.
        figures: Demands by metric.
        search: Settings of the search.
    """

    free: dict[str, Any] = Field(default={})
    figures: dict[str, Demand] = Field(min_length=1)
    search: Search = Search()

    @cached_property
    def axes(self) -> list[Axis]:
        """Return the free keys."""
        return axes_of(self.free, self)

    @property
    def goals(self) -> dict[str, str]:
        """Return the goals ("least" or "greatest") by metric."""
        return {name: demand.goal for name, demand in self.figures.items() if demand.goal is not None}

    @property
    def named(self) -> dict[str, tuple[float, float]]:
        """Return speed and ratio of the metrics that require no run of the scene, by name."""
        return {name: (d.speed, d.ratio) for name, d in self.figures.items() if name in NAMED}

    @model_validator(mode="after")
    def _check_demands(self) -> Spec:
        axes_of(self.free, self)
        for name, demand in self.figures.items():
            if demand.minimum is None and demand.maximum is None and demand.goal is None:
                goals = "a goal ('least' or 'greatest')"
                raise SceneError(f"figures.{name} requires a minimum, a maximum or {goals}")
            required_keys = NAMED[name].asks if name in NAMED else ()
            keys = tuple(key for key in ("speed", "ratio") if key in demand.model_fields_set)
            if keys != required_keys:
                at_speed = [metric for metric, named in NAMED.items() if named.asks]
                cause = "" if name in NAMED else f": {unknown('steady-state metric', name, at_speed)}"
                required = "accepts no speed and no ratio"
                if required_keys:
                    required = f"requires {' and '.join(required_keys)}"
                got = " and ".join(keys) or "none"
                raise SceneError(f"figures.{name} {required} (got {got}){cause}")
            if name in NAMED:
                limits_of(name, demand, NAMED[name].unit)
        number = len(self.goals)
        if not 1 <= number <= MAX_GOALS:
            raise SceneError(must_be("the number of metrics with a goal", f"1 to {MAX_GOALS}", number))
        return self


def read_spec(path: Path | str, keys: Keys = None) -> Spec:
    """Read and check a specification: a scene file with tables [free], [figures] and [search].

    Args:
        path: Path of the TOML file.
        keys: Values that replace values of the file, as in load_scene.

    Raises:
        SceneError: The file or a value is invalid.
    """
    return load_tables(path, keys, lambda tables: Spec)


def text_of(value: float | str, unit: str = "") -> str:
    """Return a value with its unit as text; names are unchanged.

    Args:
        value: Number or name.
        unit: Unit; "" or "1" for none.
    """
    return value if isinstance(value, str) else f"{value:.4g} {unit}".removesuffix(" 1").rstrip()


def figure_of(row: Row, name: str, unit: str = "") -> str:
    """Return the metric of a row with its unit as text, or the reason why it is missing.

    Args:
        row: The row.
        name: Name of the metric.
        unit: Unit of the metric.
    """
    absent = "not reached" if name.startswith(TIME_TO) and not row.refused else "not available"
    return text_of(row.figures.get(name, absent), unit)


class Limit(NamedTuple):
    """Limit of a metric.

    Attributes:
        figure: Name of the metric.
        unit: Unit of the metric.
        bound: Limit in this unit.
        side: 1.0 for a maximum, -1.0 for a minimum.
    """

    figure: str
    unit: str
    bound: float
    side: float

    def violation(self, row: Row, margin: float = 0.0) -> float:
        """Return the violation of the limit relative to the limit; negative values are the remaining margin.

        Args:
            row: The row.
            margin: Relative margin that tightens limits of summary metrics.
        """
        value = row.figures.get(self.figure, math.nan)
        if not math.isfinite(value):
            return MISSING
        tightening = 0.0 if self.figure in NAMED else margin
        return self.side * (value - self.bound) / (abs(self.bound) or 1.0) + tightening

    def text(self, row: Row) -> str:
        """Return a line that compares the metric of a row with the limit.

        Args:
            row: The row.
        """
        side = "at most" if self.side > 0.0 else "at least"
        metric = figure_of(row, self.figure, self.unit)
        return f"{self.figure} {metric} (limit: {side} {text_of(self.bound, self.unit)})"


def limits_of(name: str, demand: Demand, unit: str) -> list[Limit]:
    """Return the limits of a metric.

    Args:
        name: Name of the metric.
        demand: Demand with the limits.
        unit: Unit of the metric.

    Raises:
        SceneError: A limit is no quantity in the unit, or the minimum exceeds the maximum.
    """
    limits = []
    for field, side in (("minimum", -1.0), ("maximum", 1.0)):
        value = getattr(demand, field)
        if value is None:
            continue
        try:
            limits.append(Limit(name, unit, number_of(value, unit or "1"), side))
        except ValueError as error:
            message = must_be(f"figures.{name}.{field}", f"a number in {unit or '1'}", repr(value))
            raise SceneError(f"{message}: {error}") from None
    if len(limits) == 2 and limits[0].bound > limits[1].bound:
        low, high = (f"{limit.bound:g}" for limit in limits)
        raise SceneError(must_be(f"figures.{name}.minimum", f"at most the maximum, {high}", low))
    return limits


class Judge:
    """Judge of rows by the limits and goals of a specification.

    Args:
        spec: The specification.
        units: Units of metrics and keys, by name.

    Raises:
        SceneError: A limit is invalid.
    """

    def __init__(self, spec: Spec, units: dict[str, str]) -> None:
        self.spec, self.units, self.limits = spec, units, list[Limit]()
        for name, demand in spec.figures.items():
            self.limits += limits_of(name, demand, self.unit(name))

    def unit(self, name: str) -> str:
        """Return the unit of a metric or key, also of an acceleration time that no design reaches.

        Args:
            name: Name of the metric or key.
        """
        return self.units.get(name, "s" if name.startswith(TIME_TO) else "")

    def violations(self, row: Row, margin: float = 0.0) -> list[float]:
        """Return the violation of each limit, and finally of missing metrics of goals.

        Args:
            row: The row.
            margin: Relative margin that tightens limits of summary metrics.
        """
        missing = any(name not in row.figures for name in self.spec.goals)
        return [limit.violation(row, margin) for limit in self.limits] + [MISSING if missing else 0.0]

    def meets(self, row: Row, margin: float = 0.0) -> bool:
        """Return True if a row satisfies all limits.

        Args:
            row: The row.
            margin: Relative margin that tightens limits of summary metrics.
        """
        return max(self.violations(row, margin)) <= 0.0

    def beyond(self, row: Row) -> float:
        """Return the sum of all violations of a row; 0 if it satisfies all limits.

        Args:
            row: The row.
        """
        return sum(max(violation, 0.0) for violation in self.violations(row))

    def tightest(self, row: Row, rows: Sequence[Row] = ()) -> str:
        """Describe the limit with the maximum violation or the minimum margin.

        Args:
            row: The design.
            rows: All designs. A limit that none of them violates, or that all others just reach (such as a
                speed ratio of at least 1), does not restrict the design.

        Returns:
            A line; "" without limits.
        """
        restricting = [limit for limit in self.limits if self._restricts(limit, row, rows)]
        limit = max(restricting or self.limits, key=lambda limit: limit.violation(row), default=None)
        return "" if limit is None else limit.text(row)

    def _restricts(self, limit: Limit, row: Row, rows: Sequence[Row]) -> bool:
        """Return True if a row violates a limit, or other rows are on both sides of the limit."""
        if limit.violation(row) > 0.0 or not rows:
            return True
        violations = [limit.violation(other) for other in rows if limit.figure in other.figures]
        return max(violations, default=0.0) > 0.0 and min(violations, default=0.0) < -MARGIN_RTOL

    def costs(self, row: Row) -> list[float]:
        """Return the goals as costs to minimise.

        Args:
            row: The row.
        """
        sign = {"least": 1.0, "greatest": -1.0}
        return [sign[goal] * row.figures.get(name, 0.0) for name, goal in self.spec.goals.items()]

    def better(self, row: Row, others: Iterable[Row]) -> Row | None:
        """Return the best other row that satisfies all limits and dominates a row; None if there is none.

        Args:
            row: The row.
            others: Other rows.
        """
        costs = self.costs(row)
        valid = [other for other in others if self.meets(other) and self.costs(other) != costs]
        dominating = [other for other in valid if all(map(operator.le, self.costs(other), costs))]
        return min(dominating, key=self.costs, default=None)

    def fronts(self, rows: Sequence[Row]) -> list[list[Row]]:
        """Return the rows of each non-dominated front, the Pareto front first; at least one list.

        Args:
            rows: The rows.
        """
        from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

        if not rows:
            return [[]]
        ranks = NonDominatedSorting().do(np.array([self.costs(row) for row in rows]))
        return [sorted((rows[n] for n in rank), key=self.costs) for rank in ranks]


# --- the search ---

# additional key of a point: fidelity of the run
LEVEL = "fidelity"
# minimum angle of a moving load, rad: one revolution of the output shaft, or of the wheels of a vehicle
MIN_MOTION = math.tau


def figures_wanted(settings: dict[str, Any], runner: SceneRunner) -> FiguresOf:
    """Return a function from a point with a LEVEL to the metrics of a specification, as Task.prepare.

    Args:
        settings: "tables" of the scene, "named" as in Spec, and "runs", True if metrics require a run.
        runner: Runner of scenes.
    """
    # A deprecated method would add a warning, which here means a mechanism that cannot be built.
    base = validated(Scene, settings["tables"]).replaced(mechanism={"method": None})

    def figures(point: Point) -> Figures:
        keys = {name: value for name, value in point.items() if name != LEVEL}
        scene = base.with_keys(keys).with_fidelity(str(point[LEVEL]))
        mechanism = Mechanism(scene.parameters())
        if warnings := mechanism.module.warnings():
            raise ParameterError("; ".join(warnings))
        metrics = {
            name: Quantity(float(NAMED[name].value(mechanism, *at)), NAMED[name].unit)
            for name, at in settings["named"].items()
        }
        return metrics | summary_of(runner, scene) if settings["runs"] else metrics

    return figures


@dataclass(frozen=True, eq=False)
class Finalist(ByContent):
    """Verified design.

    Attributes:
        searched: Row at the fidelity of the search.
        checked: Row at the fidelity of the verification.
        scene: Scene of the design.
        file: File of the scene.
        doubts: Caveats: a sentence by short name.
    """

    searched: Row
    checked: Row
    scene: Scene
    file: Path
    doubts: dict[str, str]


def doubts_of(scene: Scene, figures: Mapping[str, float], speed: float) -> dict[str, str]:
    """Return caveats of a design that satisfies its limits: a sentence by short name.

    Args:
        scene: Scene of the design.
        figures: Metrics of its verification.
        speed: Speed of link 1 for lock-up and torque of the drive, rad/s.
    """
    caveats, mechanism = {}, Mechanism(scene.parameters())
    try:
        chart = mechanism.chart(speed)
        if not chart.lock_up_torque[0] > 0.0:
            caveats["no lock-up"] = f"no torque is transmitted above a speed ratio of {chart.end_ratio:.2g}"
        limit = scene.drive_torque_limit(speed)
        if limit is not None and (beyond := chart.beyond_drive(speed, limit)):
            caveats["drive too weak"] = beyond
    except InertiaModuleError as error:
        caveats["no mean torque"] = str(error)
    if mechanism.module["satellite_inertia"] == 0.0:
        caveats["satellites without inertia"] = "satellite_inertia is 0"
    # angle of the wheels of a vehicle, or upper bound of the angle of another load; infinite without a run
    angle = figures.get("omega_out_maximum", math.inf) * scene.run.stop_time
    if isinstance(scene.load, VehicleLoad):
        angle = figures.get("distance", math.inf) / scene.load.wheel_radius
    if isinstance(scene.load, VehicleLoad) and figures.get(TRACTIVE_FORCE, 0.0) > (
        scene.load.grip or math.inf
    ):
        force, grip = figures[TRACTIVE_FORCE], scene.load.grip
        caveats["wheels slip"] = f"the tractive force reaches {force:.4g} N, the grip is {grip:.4g} N"
    if angle < MIN_MOTION:
        caveats["load does not move"] = f"{angle / math.tau:.2g} revolutions in the run"
    return caveats


@dataclass(frozen=True, eq=False)
class DesignResult(ByContent):
    """Result of a design.

    Attributes:
        judge: Judge, with the specification in ``spec``.
        rows: All designs of the search, in the order of evaluation.
        front: Pareto front of the designs that satisfy all limits.
        finalists: Verified designs.
        new: Number of rows that were not in the journal.
        files: Paths of the written files, by kind.
        searched: Outcome of the search, with the best metrics of each start.
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
        """Return True if the time limit ended the search."""
        return self.searched.is_cut

    @property
    def chosen(self) -> list[Finalist]:
        """Return the finalists that satisfy all limits at the fidelity of the verification."""
        return [finalist for finalist in self.finalists if self.judge.meets(finalist.checked)]

    def lines(self, finalist: Finalist) -> dict[str, str]:
        """Return values, metrics and caveats of a finalist as texts by name.

        Args:
            finalist: The finalist.
        """
        keys = {
            name: text_of(value, self.judge.unit(name)) for name, value in finalist.searched.point.items()
        }
        keys |= {name: text_of(value, BY_NAME[name].unit) for name, value in finalist.scene.following.items()}
        figures = {}
        for name in self.judge.spec.figures:
            checked = figure_of(finalist.checked, name, self.judge.unit(name))
            figures[name] = f"{figure_of(finalist.searched, name)} → {checked}"
        violated = [limit.figure for limit in self.judge.limits if limit.violation(finalist.checked) > 0.0]
        limits = f"violated: {', '.join(violated)}" if violated else "satisfied"
        caveats = {f"caveat: {name}": reason for name, reason in finalist.doubts.items()}
        return keys | figures | {"limits": limits} | caveats

    def verdict(self) -> str:
        """Return a sentence with the number of valid designs, the tightest limit, convergence and caveats."""
        finalists, search = self.finalists, self.judge.spec.search
        # Without a valid design the closest one is described: a verified design if there is any.
        rows = [finalist.checked for finalist in self.chosen or finalists]
        rows = rows or [row for row in self.rows if not row.refused]
        row = rows[0] if self.chosen else min(rows, key=self.judge.beyond)
        limit = self.judge.tightest(row, self.rows)
        if self.chosen:
            first = self.chosen[0].file.stem.replace("_", " ")
            notes = f"; tightest in {first}: {limit}" if limit else ""
            names = [name for finalist in self.chosen for name in finalist.doubts]
            doubts = ", ".join(f"{name} in {names.count(name)}" for name in dict.fromkeys(names))
            notes += f"; caveats: {doubts} of them" if doubts else ""
            number = f"{len(self.chosen)} of {len(finalists)} verified designs satisfy all limits"
            return f"{number}; {self.convergence()}{notes}"
        designs = f"{len(self.rows)} designs"
        reason = f"no improvement in the last {search.stall} generations of {search.starts} starts"
        if self.front:
            designs = f"{len(finalists)} verified designs"
            reason = f"{len(self.front)} of {len(self.rows)} designs do with fidelity {search.fidelity!r}"
        elif self.cut:
            reason = f"search.longest = {search.longest:g} s ended the search before it was complete"
        return f"0 of {designs} satisfy all limits; {reason}; closest design: {limit}"

    def convergence(self) -> str:
        """Return a sentence that compares the best designs of the starts."""
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
    runs = len(specification.named) < len(specification.figures)
    settings = {"tables": base.tables, "named": specification.named, "runs": runs}
    task = Task(fmu_content(fmu), settings, figures_wanted)
    folder = OUTPUT_FOLDER / f"{name}_design" if output is None else Path(output)
    with Evaluator(task, folder, scheduler, workers) as evaluator:

        def evaluate(points: Sequence[Point], level: str = levels[0]) -> list[Row]:
            rows = evaluator([{**point, LEVEL: level} for point in points])
            return [row._replace(point=point) for row, point in zip(rows, points, strict=True)]

        rows = evaluate(of_shares(specification.axes, population(specification, specification.search.seed)))
        units = {axis.name: axis.unit for axis in specification.axes} | evaluator.units
        names = [*(name for row in rows for name in row.figures), *NAMED]
        if all(row.refused for row in rows):
            raise SceneError(f"none of the first {len(rows)} designs can be computed: {rows[0].refused}")
        for figure in specification.figures:
            if figure not in names and not figure.startswith(TIME_TO):
                raise SceneError(f"figures: {unknown('metric', figure, names)}")
        judge = Judge(specification, units)
        searched = DesignSearch(specification, judge, evaluate, progress).run()
        rows = searched.rows
        valid_rows = [row for row in rows if not row.refused]
        fronts = judge.fronts([row for row in valid_rows if judge.meets(row, specification.search.margin)])
        selected = _finalists(fronts, specification.search.finalists) or [min(valid_rows, key=judge.beyond)]
        checked = evaluate([row.point for row in selected], levels[1])
        # verified designs of searches with other seeds in the journal
        own_points = [{**row.point, LEVEL: levels[1]} for row in rows]
        in_journal = [row for row in evaluator.rows.values() if row.point[LEVEL] == levels[1]]
        others = [row for row in in_journal if row.point not in own_points]
    finalists, speed = [], max(demand.speed for demand in specification.figures.values()) or NOMINAL_SPEED
    for number, (row, verified) in enumerate(zip(selected, checked, strict=True), 1):
        if not verified.refused:
            title = f"{specification.title}: design {number}"
            scene = base.with_keys({**row.point, "title": title}).with_fidelity(levels[1])
            file = write_text(folder / f"design_{number}.toml", scene_text(scene))
            doubts = doubts_of(scene, verified.figures, speed)
            if better := judge.better(verified, others):
                goals = [
                    f"{goal} {text_of(better.figures[goal], judge.unit(goal))}"
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
