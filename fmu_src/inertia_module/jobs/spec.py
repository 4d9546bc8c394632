"""Specification of a design: a scene with its free keys, limits and goals of figures, and the search.

Figures of a mechanism by name are of steady pulses at a speed and a speed ratio, and of its size; others are
of the summary of a run. A judge says how far a design is from meeting it, and which designs are best.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from ..common.errors import Refused, must_be
from ..common.units import to_si
from ..contract.variables import ENUMERATIONS, LARGEST_SPEED
from ..harness.chart import SteadyMachine, SteadyPulses, torque_converter_chart
from ..memory import Module
from ..scene import Scene, SceneError
from ..scene.keys import Strict, quantity, validated
from ..scene.reading import load_tables
from ..scene.run import TIME_TO
from .axes import Axis, axes_of
from .evaluation import Row

# --- figures of a mechanism ---


class Mechanism:
    """A mechanism whose steady pulses are found once for each speed and ratio.

    Args:
        parameters: of the module by name, those that differ from the defaults.

    Raises:
        Refused: the parameters cannot be.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        self.parameters = parameters
        self.module = Module("plain")
        self.module.check(**parameters)

    def check_room(self) -> None:
        """Refuse what can be computed but not built.

        Raises:
            Refused: the module warns that there is no room for its parts, or that they are no bodies.
        """
        if found := self.module.warnings():
            raise Refused("; ".join(found))

    @property
    def envelope_diameter(self) -> float:
        """Diameter about the central axis that imbalances and pitch circles of the satellites need, m."""
        # the rim of a satellite is where an imbalance on its pitch circle would be
        rim = Module("plain")
        rim.check(**{**self.parameters, "a": 1.0, "b": 1.0, "eccentricity": self.module["satellite_radius"]})
        return 2.0 * max(_farthest(self.module.derived), _farthest(rim.derived))

    @property
    def total_imbalance_mass(self) -> float:
        """Mass of the imbalances of all satellites of all modules, kg."""
        return math.prod(self.module[name] for name in ("modules", "satellites", "imbalance_mass"))

    @cached_property
    def machine(self) -> SteadyMachine:
        """The mechanism with its output shaft held."""
        return SteadyMachine(self.parameters)

    @cached_property
    def pulses(self) -> Callable[[float, float], SteadyPulses]:
        """Function from a speed, rad/s, and a ratio to steady pulses; refuses a missing freewheel."""
        return cache(self.machine.at)

    def greatest_input_torque(self, speed: float) -> float:
        """Largest mean input torque over the speed ratios, N.m."""
        chart = torque_converter_chart(self.parameters, omega1=speed)
        return float(chart.input_torque.max()) * speed**2


def _farthest(d: Any) -> float:
    """Largest distance of an imbalance from the central axis, m, at any drive angle.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2) R^2 + T^2 + z^2 is
    linear in cos B, hence largest where that is 1 or -1.

    Args:
        d: derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


class Named(NamedTuple):
    """A figure.

    Attributes:
        unit: of its values. asks: what it is to be given, of speed (rad/s) and ratio (1).
        value: of a mechanism at a speed and a ratio.
    """

    unit: str
    asks: tuple[str, ...]
    value: Callable[[Mechanism, float, float], float]


_BOTH = ("speed", "ratio")
NAMED = {
    "stall_torque": Named("N.m", ("speed",), lambda m, w, i: m.pulses(w, 0.0).output_torque),
    "steady_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).output_torque),
    "steady_input_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).input_torque),
    "greatest_input_torque": Named("N.m", ("speed",), lambda m, w, i: m.greatest_input_torque(w)),
    "steady_efficiency": Named("1", _BOTH, lambda m, w, i: m.pulses(w, i).efficiency),
    "torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).ripple),
    "torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).peak),
    "bearing_force": Named("N", _BOTH, lambda m, w, i: m.pulses(w, i).bearing_force),
    "mount_force": Named("N", _BOTH, lambda m, w, i: m.machine.mount("force", w, i)),
    "mount_moment": Named("N.m", _BOTH, lambda m, w, i: m.machine.mount("moment", w, i)),
    "envelope_diameter": Named("m", (), lambda m, w, i: m.envelope_diameter),
    "total_imbalance_mass": Named("kg", (), lambda m, w, i: m.total_imbalance_mass),
}


# --- specifications ---

LEVELS = tuple(name for name, _, _ in ENUMERATIONS["Fidelity"])
MOST_GOALS = 3
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

    @model_validator(mode="after")
    def _asks_something(self) -> Demand:
        if self.minimum is None and self.maximum is None and self.goal is None:
            raise ValueError("must have a minimum, a maximum or a goal ('least' or 'greatest'), has none")
        return self


class Search(Strict):
    """Settings of the search for designs.

    Attributes:
        population, generations: of NSGA-II. seed: same seed, same result. fidelity: of the search.
        check: fidelity at which the finalists are run. finalists: how many of them.
        margin: by which limits of what the scene gives are narrower in the search, for what the cheap
            fidelity leaves out; steady figures and sizes are the same at all.
    """

    population: int = Field(default=40, ge=4, le=10_000)
    generations: int = Field(default=20, ge=1, le=10_000)
    seed: int = Field(default=1, ge=0)
    fidelity: Literal[LEVELS] = "averaged"  # type: ignore[valid-type]
    check: Literal[LEVELS] = "rigid"  # type: ignore[valid-type]
    finalists: int = Field(default=5, ge=1, le=1000)
    margin: Annotated[float, quantity("1", 0.0, 0.5)] = 0.0


class Tables(Strict):
    """The tables of a specification beside those of its scene."""

    free: dict[str, Any] = Field(min_length=1)
    figures: dict[str, Demand] = Field(min_length=1)
    search: Search = Search()


@dataclass(frozen=True)
class Spec:
    """A specification.

    Attributes:
        scene: with all that is not free. axes: the free keys. demands: by figure. search: how.
    """

    scene: Scene
    axes: list[Axis]
    demands: dict[str, Demand]
    search: Search

    @property
    def goals(self) -> dict[str, str]:
        """Figures that are to be the least or the greatest."""
        return {name: demand.goal for name, demand in self.demands.items() if demand.goal is not None}

    @property
    def named(self) -> dict[str, tuple[float, float]]:
        """The figures that need no run of the scene, with speed and ratio; others are of its summary."""
        return {name: (d.speed, d.ratio) for name, d in self.demands.items() if name in NAMED}


def read_spec(path: Path | str, keys: Mapping[str, Any] | None = None) -> Spec:
    """Read and check a specification: the TOML of a scene with [free], [figures] and [search].

    Args:
        path, keys: as for load_scene.

    Raises:
        SceneError: in one line, the file, the key, the value and what is allowed.
    """
    return load_tables(path, keys, _spec)


def _spec(data: dict[str, Any], folder: Path) -> Spec:
    own = {name: data.pop(name) for name in Tables.model_fields if name in data}
    if not own.get("free"):
        raise SceneError("[free] must have at least one free key, such as imbalance_mass = '0.5 kg:2 kg'")
    tables = validated(Tables, own)
    scene = validated(Scene, data, folder)
    for name, demand in tables.figures.items():
        asked = NAMED[name].asks if name in NAMED else ()
        given = tuple(one for one in ("speed", "ratio") if one in demand.model_fields_set)
        if given != asked:
            at_speed = ", ".join(one for one, named in NAMED.items() if named.asks)
            known = "" if name in NAMED else f"; figures at a speed are {at_speed}"
            raise SceneError(
                f"figures.{name} must be given {' and '.join(asked) or 'no speed and no ratio'}, is given"
                f" {' and '.join(given) or 'none of it'}{known}"
            )
        if name in NAMED:
            limits_of(name, demand, NAMED[name].unit)
    spec = Spec(scene, axes_of(tables.free, scene), tables.figures, tables.search)
    if not 1 <= len(spec.goals) <= MOST_GOALS:
        raise SceneError(must_be("the number of figures with a goal", f"1 to {MOST_GOALS}", len(spec.goals)))
    return spec


def absent(name: str, row: Row) -> str:
    """Say of a figure that a row has not why."""
    return "not reached" if name.startswith(TIME_TO) and not row.refused else "missing"


class Limit(NamedTuple):
    """A limit of a figure.

    Attributes:
        figure: its name. bound: in the unit of the figure. side: 1.0 for a maximum, -1.0 for a minimum.
    """

    figure: str
    bound: float
    side: float

    def violation(self, row: Row, margin: float = 0.0) -> float:
        """Excess of a row over the limit, relative to it; below 0 what is left.

        Args:
            row: of the design. margin: by which the limit is narrower, relative to it.
        """
        value = row.figures.get(self.figure)
        if value is None or not math.isfinite(value):
            return MISSING
        narrower = 0.0 if self.figure in NAMED else margin
        return self.side * (value - self.bound) / (abs(self.bound) or 1.0) + narrower

    def text(self, row: Row, unit: str) -> str:
        """Compare what a row has with the limit, in a line."""
        value = row.figures.get(self.figure)
        has = absent(self.figure, row) if value is None else f"{value:.4g} {unit}".strip()
        allowed = f"{'at most' if self.side > 0.0 else 'at least'} {self.bound:.4g} {unit}".strip()
        return f"{self.figure} is {has}, must be {allowed}"


def limits_of(name: str, demand: Demand, unit: str) -> list[Limit]:
    """Limits of a figure in its unit.

    Raises:
        SceneError: one is no quantity in this unit, or no number meets both.
    """
    found = []
    for which, side in (("minimum", -1.0), ("maximum", 1.0)):
        given = getattr(demand, which)
        try:
            if isinstance(given, str):
                given = to_si(given, unit or "1")
        except ValueError as error:
            raise SceneError(
                f"figures.{name}.{which} must be a number in {unit or '1'}, is {given!r}: {error}"
            ) from None
        if given is not None:
            found.append(Limit(name, float(given), side))
    if len(found) == 2 and found[0].bound > found[1].bound:
        low, high = (limit.bound for limit in found)
        raise SceneError(f"figures.{name}: minimum must be at most maximum, {low:g} is above {high:g}")
    return found


class Judge:
    """Judges rows by a specification.

    Args:
        spec: the specification. units: of the figures by name.

    Attributes:
        limits: all of them.

    Raises:
        SceneError: as limits_of.
    """

    def __init__(self, spec: Spec, units: dict[str, str]) -> None:
        self.spec, self.units, self.limits = spec, units, list[Limit]()
        for name, demand in spec.demands.items():
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
        """Sum of all violations: 0 where all limits are met."""
        return sum(max(violation, 0.0) for violation in self.violations(row))

    def tightest(self, row: Row) -> Limit | None:
        """The limit that a row is the furthest beyond, or nearest to; None without limits."""
        return max(self.limits, key=lambda limit: limit.violation(row), default=None)

    def costs(self, row: Row) -> list[float]:
        """The goals as numbers that are to be small."""
        sign = {"least": 1.0, "greatest": -1.0}
        return [sign[goal] * row.figures.get(name, 0.0) for name, goal in self.spec.goals.items()]

    def fronts(self, rows: Sequence[Row]) -> list[list[Row]]:
        """Rows by rank: the first ones are those that no other is better than in every goal."""
        from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

        if not rows:
            return []
        ranks = NonDominatedSorting().do(np.array([self.costs(row) for row in rows]))
        return [sorted((rows[n] for n in rank), key=self.costs) for rank in ranks]
