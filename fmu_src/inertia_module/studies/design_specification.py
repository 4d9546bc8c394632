"""Specification of a design: a scene with free keys, limits and goals of metrics, and search settings."""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, model_validator

from ..common.deprecated import warn_renamed
from ..common.errors import SceneError, must_be, unknown
from ..common.units import number_of, printed_unit
from ..interface.variables import ENUMERATIONS, LARGEST_SPEED
from ..scene import Scene
from ..scene.keys import Duration, Keys, Strict, quantity
from ..scene.reading import load_model
from ..scene.vehicle_metrics import TIME_TO
from .axes import Axis, axes_of
from .evaluation import Row
from .steady_metrics import STEADY_METRICS

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
        metrics: Demands by metric.
        search: Settings of the search.
    """

    free: dict[str, Any] = Field(default={})
    metrics: dict[str, Demand] = Field(min_length=1)
    search: Search = Search()

    @cached_property
    def axes(self) -> list[Axis]:
        """Return the free keys."""
        return axes_of(self.free, self)

    @property
    def goals(self) -> dict[str, str]:
        """Return the goals ("least" or "greatest") by metric."""
        return {name: demand.goal for name, demand in self.metrics.items() if demand.goal is not None}

    @property
    def steady_demands(self) -> dict[str, tuple[float, float]]:
        """Return speed and ratio of the metrics that require no run of the scene, by name."""
        return {name: (d.speed, d.ratio) for name, d in self.metrics.items() if name in STEADY_METRICS}

    @model_validator(mode="before")
    @classmethod
    def _rename_figures(cls, tables: Any) -> Any:
        """Accept the table [metrics] under its old name [figures]."""
        if not isinstance(tables, dict) or "figures" not in tables:
            return tables
        warn_renamed("the table [figures]", "[metrics]")
        others = {name: table for name, table in tables.items() if name != "figures"}
        return {**others, "metrics": {**tables["figures"], **tables.get("metrics", {})}}

    @model_validator(mode="after")
    def _check_demands(self) -> Spec:
        axes_of(self.free, self)
        for name, demand in self.metrics.items():
            if demand.minimum is None and demand.maximum is None and demand.goal is None:
                goals = "a goal ('least' or 'greatest')"
                raise SceneError(f"metrics.{name} requires a minimum, a maximum or {goals}")
            required_keys = STEADY_METRICS[name].needs if name in STEADY_METRICS else ()
            keys = tuple(key for key in ("speed", "ratio") if key in demand.model_fields_set)
            if keys != required_keys:
                at_speed = [metric for metric, steady in STEADY_METRICS.items() if steady.needs]
                cause = (
                    "" if name in STEADY_METRICS else f": {unknown('steady-state metric', name, at_speed)}"
                )
                required = "accepts no speed and no ratio"
                if required_keys:
                    required = f"requires {' and '.join(required_keys)}"
                got = " and ".join(keys) or "none"
                raise SceneError(f"metrics.{name} {required} (got {got}){cause}")
            if name in STEADY_METRICS:
                limits_of(name, demand, STEADY_METRICS[name].unit)
        number = len(self.goals)
        if not 1 <= number <= MAX_GOALS:
            raise SceneError(must_be("the number of metrics with a goal", f"1 to {MAX_GOALS}", number))
        return self


def read_spec(path: Path | str, keys: Keys | None = None) -> Spec:
    """Read and check a specification: a scene file with tables [free], [metrics] and [search].

    Args:
        path: Path of the TOML file.
        keys: Values that replace values of the file, as in load_scene.

    Raises:
        SceneError: The file or a value is invalid.
    """
    return load_model(path, keys, lambda tables: Spec)


def text_of(value: float | str, unit: str = "") -> str:
    """Return a value with its unit as text; names are unchanged.

    Args:
        value: Number or name.
        unit: Unit; "" or "1" for none.
    """
    return (
        value if isinstance(value, str) else f"{value:.4g} {printed_unit(unit)}".removesuffix(" 1").rstrip()
    )


def metric_text(row: Row, name: str, unit: str = "") -> str:
    """Return the metric of a row with its unit as text, or the reason why it is missing.

    Args:
        row: The row.
        name: Name of the metric.
        unit: Unit of the metric.
    """
    absent = "not reached" if name.startswith(TIME_TO) and not row.refused else "not available"
    return text_of(row.metrics.get(name, absent), unit)


class Limit(NamedTuple):
    """Limit of a metric.

    Attributes:
        metric: Name of the metric.
        unit: Unit of the metric.
        bound: Limit in this unit.
        side: 1.0 for a maximum, -1.0 for a minimum.
    """

    metric: str
    unit: str
    bound: float
    side: float

    def violation(self, row: Row, margin: float = 0.0) -> float:
        """Return the violation of the limit relative to the limit; negative values are the remaining margin.

        Args:
            row: The row.
            margin: Relative margin that tightens limits of summary metrics.
        """
        value = row.metrics.get(self.metric, math.nan)
        if not math.isfinite(value):
            return MISSING
        tightening = 0.0 if self.metric in STEADY_METRICS else margin
        return self.side * (value - self.bound) / (abs(self.bound) or 1.0) + tightening

    def text(self, row: Row) -> str:
        """Return a line that compares the metric of a row with the limit.

        Args:
            row: The row.
        """
        side = "at most" if self.side > 0.0 else "at least"
        metric = metric_text(row, self.metric, self.unit)
        return f"{self.metric} {metric} (limit: {side} {text_of(self.bound, self.unit)})"


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
            message = must_be(f"metrics.{name}.{field}", f"a number in {unit or '1'}", repr(value))
            raise SceneError(f"{message}: {error}") from None
    if len(limits) == 2 and limits[0].bound > limits[1].bound:
        low, high = (f"{limit.bound:g}" for limit in limits)
        raise SceneError(must_be(f"metrics.{name}.minimum", f"at most the maximum, {high}", low))
    return limits
