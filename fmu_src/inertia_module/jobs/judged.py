"""Designs against the limits of a specification: how far each is from meeting them, and which are best."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .named import NAMED
from .spec import Spec, absent, unit_of
from .task import Row

# of a limit whose figure there is not: the run was refused, or a speed is not reached
MISSING = 1.0


class Limit(NamedTuple):
    """A limit of a figure.

    Attributes:
        figure: its name. bound: in the unit of the figure. side: 1.0 for a maximum, -1.0 for a minimum.
    """

    figure: str
    bound: float
    side: float

    def violation(self, row: Row, margin: float = 0.0) -> float:
        """How far a row is beyond the limit, relative to it; below 0 what is left.

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


class Judge:
    """Judges rows by a specification.

    Args:
        spec: the specification. units: of the figures by name.

    Attributes:
        limits: all of them.

    Raises:
        SceneError: a limit is in a unit of another kind than its figure.
    """

    def __init__(self, spec: Spec, units: dict[str, str]) -> None:
        self.spec, self.units = spec, units
        self.limits = [
            Limit(name, bound, side)
            for name, demand in spec.demands.items()
            for which, side in (("minimum", -1.0), ("maximum", 1.0))
            if (bound := demand.limit(which, unit_of(name, units))) is not None
        ]

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
        table: NDArray[np.float64] = np.array([self.costs(row) for row in rows])
        ranks = NonDominatedSorting().do(table)
        return [sorted((rows[n] for n in rank), key=self.costs) for rank in ranks]
