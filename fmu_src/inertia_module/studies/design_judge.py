"""Judge of designs: violations of limits, costs of goals and Pareto fronts."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence

import numpy as np

from ..scene.vehicle_metrics import TIME_TO
from .design_specification import MARGIN_RTOL, MISSING, Limit, Spec, limits_of
from .evaluation import Row


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
        for name, demand in spec.metrics.items():
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
        missing = any(name not in row.metrics for name in self.spec.goals)
        return [limit.violation(row, margin) for limit in self.limits] + [MISSING if missing else 0.0]

    def meets(self, row: Row, margin: float = 0.0) -> bool:
        """Return True if a row satisfies all limits.

        Args:
            row: The row.
            margin: Relative margin that tightens limits of summary metrics.
        """
        return max(self.violations(row, margin)) <= 0.0

    def total_violation(self, row: Row) -> float:
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
        violations = [limit.violation(other) for other in rows if limit.metric in other.metrics]
        return max(violations, default=0.0) > 0.0 and min(violations, default=0.0) < -MARGIN_RTOL

    def costs(self, row: Row) -> list[float]:
        """Return the goals as costs to minimise.

        Args:
            row: The row.
        """
        sign = {"least": 1.0, "greatest": -1.0}
        return [sign[goal] * row.metrics.get(name, 0.0) for name, goal in self.spec.goals.items()]

    def dominating_row(self, row: Row, others: Iterable[Row]) -> Row | None:
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
