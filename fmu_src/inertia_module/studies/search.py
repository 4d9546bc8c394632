"""Search of designs: a global method with several seeds, and a local polish of the best design of each.

One goal: differential evolution (R. Storn and K. Price, Journal of Global Optimization 11, 1997).
Several goals: NSGA-II (K. Deb et al., IEEE Transactions on Evolutionary Computation 6, 2002).
Polish: COBYLA, linear approximations of goal and limits in a trust region (M. J. D. Powell, 1994), over the
continuous keys. It is repeated from the neighbours in each integer key while a neighbour is better (extended
poll: C. Audet and J. E. Dennis, SIAM Journal on Optimization 11, 2001).
The search has converged if the polished designs of all seeds nearly agree.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.terminal import Progress
from .axes import points_at, sample_shares
from .evaluation import Evaluate, Row

if TYPE_CHECKING:
    from .design_judge import Judge
    from .design_specification import Spec

Array = NDArray[np.float64]

# minimum relative decrease of the violation of the closest design in an improving search
MIN_DECREASE = 1e-3
# maximum relative difference between the best designs of the starts of a converged search
SPREAD = 0.05
# first step of each of the two passes of a polish, and their last step, as fractions of the ranges
POLISH_FIRST, POLISH_LAST = (0.1, 0.03), 1e-3
# maximum number of evaluations of a pass per free key
POLISH_EVALUATIONS = 14
# number of designs of a neighbour in integer keys that are polished in addition to the best design
CLOSEST = 4
# crossover probability of differential evolution; its difference factor is random between 0.5 and 1
CROSSOVER = 0.9
# cost over the cost at the start, of a design that cannot be computed during a polish
FAILED_COST = 10.0


class Start(NamedTuple):
    """Outcome of one start of a search.

    Attributes:
        seed: Random seed of the start.
        best: Best metric of each goal after the polish, by name; empty if no design satisfies all limits.
    """

    seed: int
    best: dict[str, float]


class Searched(NamedTuple):
    """Outcome of a search.

    Attributes:
        rows: All designs without duplicates, in the order of evaluation.
        starts: Completed starts.
        is_cut: True if the time limit ended the search.
    """

    rows: list[Row]
    starts: list[Start]
    is_cut: bool

    def spread(self) -> dict[str, float]:
        """Return the range of the best metrics of all starts, relative to the minimum magnitude, by goal."""
        spreads = {}
        for goal in dict.fromkeys(goal for start in self.starts for goal in start.best):
            values = [start.best[goal] for start in self.starts if goal in start.best]
            spreads[goal] = (max(values) - min(values)) / (min(map(abs, values)) or 1.0)
        return spreads

    @property
    def has_converged(self) -> bool:
        """Return True if at least two starts exist, all have a valid design, and their best designs agree."""
        successful = [start for start in self.starts if start.best]
        is_close = all(spread <= SPREAD for spread in self.spread().values())
        return len(successful) > 1 and len(successful) == len(self.starts) and is_close and not self.is_cut


def population(spec: Spec, seed: int) -> Array:
    """Return the first designs of a start as fractions of the ranges.

    Args:
        spec: The specification.
        seed: Random seed of the start.

    Returns:
        Latin hypercube, shape (population, axes).
    """
    return sample_shares(len(spec.axes), f"latin:{spec.search.population}", seed)


class DesignSearch:
    """Search for designs of a specification over fractions (0 to 1) of the ranges.

    Integers, lists and logarithmic ranges are searched in the same way. A design that cannot be computed
    violates all limits.

    Args:
        spec: The specification.
        judge: Judge of its limits and goals.
        evaluate: Function that returns the rows of points.
        progress: Function called with the completed fraction of the search, 0 to 1, or None.
    """

    def __init__(
        self, spec: Spec, judge: Judge, evaluate: Evaluate, progress: Progress | None = None
    ) -> None:
        self.spec, self.judge, self.evaluate, self.progress = spec, judge, evaluate, progress
        self._rows: dict[str, Row] = {}
        self._shares: dict[str, Array] = {}
        self._start_time = time.monotonic()

    def run(self) -> Searched:
        """Run all starts; each continues until a design satisfies all limits or the search stalls."""
        settings, starts = self.spec.search, list[Start]()
        for seed in range(settings.seed, settings.seed + settings.starts):
            rows, complete = self._run_start(seed, is_first=not starts)
            if not complete:
                return Searched(list(self._rows.values()), starts, True)
            starts.append(Start(seed, self._polish_best(rows)))
        return Searched(list(self._rows.values()), starts, False)

    def rows_at(self, shares: Array) -> list[Row]:
        """Evaluate designs.

        Args:
            shares: Fractions of the ranges, shape (designs, axes).
        """
        rows = self.evaluate(points_at(self.spec.axes, shares))
        for row, share in zip(rows, shares, strict=True):
            self._rows.setdefault(str(row.point), row)
            self._shares.setdefault(str(row.point), np.array(share))
        return rows

    def _problem(self, rows: list[Row]) -> Any:
        """Return the search as a problem of pymoo.

        Args:
            rows: List to which all designs of a start are appended.
        """
        from pymoo.core.problem import Problem

        search, margin = self, self.spec.search.margin

        class Designs(Problem):  # type: ignore[misc]
            """Designs as fractions of the ranges."""

            def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
                evaluated = search.rows_at(x)
                rows.extend(evaluated)
                out["F"] = np.array([search.judge.costs(row) for row in evaluated])
                out["G"] = np.array([search.judge.violations(row, margin) for row in evaluated])

        limits = len(self.judge.limits) + 1
        goals = len(self.spec.goals)
        return Designs(n_var=len(self.spec.axes), n_obj=goals, n_ieq_constr=limits, xl=0.0, xu=1.0)

    def _algorithm(self, seed: int) -> Any:
        """Return differential evolution for one goal, NSGA-II for several."""
        settings = {"pop_size": self.spec.search.population, "sampling": population(self.spec, seed)}
        if len(self.spec.goals) > 1:
            from pymoo.algorithms.moo.nsga2 import NSGA2

            return NSGA2(**settings)
        from pymoo.algorithms.soo.nonconvex.de import DE

        return DE(variant="DE/best/1/bin", CR=CROSSOVER, **settings)

    def _run_start(self, seed: int, is_first: bool) -> tuple[list[Row], bool]:
        """Run one start.

        While no design satisfies all limits, generations are added until the closest design has not improved
        over `stall` generations. If the first valid design appears late, the start runs `generations` more.

        Args:
            seed: Random seed of the start.
            is_first: True for the first start, whose `generations` have no time limit.

        Returns:
            All designs of the start, and False if the time limit ended it.
        """
        from pymoo.core.termination import NoTermination

        settings, rows = self.spec.search, list[Row]()
        algorithm = self._algorithm(seed)
        algorithm.setup(self._problem(rows), termination=NoTermination(), seed=seed)
        # violation of the closest design, by generation
        nearest, number, is_improving = list[float](), settings.generations, False
        while len(nearest) < number or is_improving:
            is_extra = not is_first or len(nearest) >= settings.generations
            if is_extra and time.monotonic() - self._start_time > settings.longest:
                return rows, False
            algorithm.next()
            nearest.append(float(np.maximum(algorithm.pop.get("G"), 0.0).sum(axis=1).min()))
            before = nearest[-1 - settings.stall] if len(nearest) > settings.stall else math.inf
            is_improving = 0.0 < nearest[-1] < (1.0 - MIN_DECREASE) * before
            if nearest[-1] == 0.0 and len(nearest) > number == settings.generations:
                number += len(nearest)
            if self.progress is not None:
                fraction = (seed - settings.seed) / settings.starts
                self.progress(fraction + min(len(nearest) / number, 1.0) / settings.starts)
        return rows, True

    def _polish_best(self, rows: Sequence[Row]) -> dict[str, float]:
        """Polish the best design of a start in each goal.

        Args:
            rows: Designs of the start.

        Returns:
            Best metric of each goal; empty if no design satisfies all limits.
        """
        margin = self.spec.search.margin
        valid = [row for row in rows if self.judge.meets(row, margin)]
        if not valid:
            return {}
        costs = {goal: partial(self._cost, number) for number, goal in enumerate(self.spec.goals)}
        for cost in costs.values():
            valid += self._descend(min(valid, key=cost), rows, cost)
        return {goal: min(valid, key=cost).metrics[goal] for goal, cost in costs.items()}

    def _descend(self, start: Row, rows: Sequence[Row], cost: Callable[[Row], float]) -> list[Row]:
        """Polish a design, and its neighbours in integer keys while a neighbour is better.

        A neighbour is polished from the best design and from other designs of the start, until one result is
        better. Several attempts are needed because the first designs of a neighbour can violate limits.

        Args:
            start: Design that satisfies all limits.
            rows: All designs of the start.
            cost: Function of a design to minimise.

        Returns:
            All evaluated designs within the limits.
        """
        margin, valid, best = self.spec.search.margin, list[Row](), start
        tried, queue = set[tuple[float | str, ...]](), [self._shares[str(start.point)]]
        while queue:
            shares = queue.pop(0)
            combination = self._combination(shares)
            if combination in tried:
                continue
            start_points = [shares, *(self._closest(rows, combination) if tried else [])]
            tried.add(combination)
            previous = best
            for start_point in start_points:
                results = [
                    row for row in self._polish(start_point, cost, best) if self.judge.meets(row, margin)
                ]
                valid += results
                best = min([best, *results], key=cost)
                if best is not previous:
                    break
            if best is not previous or len(tried) == 1:
                queue = self._neighbours(self._shares[str(best.point)])
        return valid

    def _closest(self, rows: Sequence[Row], combination: tuple[float | str, ...]) -> list[Array]:
        """Return the fractions of the designs of a combination that are closest to the limits.

        Args:
            rows: Designs to select from.
            combination: Integers and list values.
        """
        designs = {str(row.point): row for row in rows if not row.refused}
        designs = {
            key: row for key, row in designs.items() if self._combination(self._shares[key]) == combination
        }
        closest = sorted(designs, key=lambda key: self.judge.total_violation(designs[key]))
        return [self._shares[key] for key in closest[:CLOSEST]]

    def _combination(self, shares: Array) -> tuple[float | str, ...]:
        """Return the integers and list values of a design from its fractions."""
        axes = self.spec.axes
        return tuple(
            axis.at(float(s)) for axis, s in zip(axes, shares, strict=True) if axis.whole or axis.values
        )

    def _neighbours(self, shares: Array) -> list[Array]:
        """Return the fractions of the designs that differ by 1 in one integer key."""
        designs = []
        for n, axis in enumerate(self.spec.axes):
            if axis.whole and not axis.values:
                bins = axis.high - axis.low + 1.0
                for change in (-1.0, 1.0):
                    place = (math.floor(shares[n] * bins) + 0.5 + change) / bins
                    if 0.0 < place < 1.0:
                        designs.append(np.concatenate([shares[:n], [place], shares[n + 1 :]]))
        return designs

    def _cost(self, number: int, row: Row) -> float:
        """Return one goal of a design as a cost to minimise."""
        return self.judge.costs(row)[number]

    def _polish(self, shares: Array, cost: Callable[[Row], float], best: Row) -> list[Row]:
        """Minimise a cost within the limits over the continuous keys of a design.

        Args:
            shares: Fractions of the design.
            cost: Function of a design to minimise.
            best: Best design so far, for the scale of the cost.

        Returns:
            All evaluated designs.
        """
        from scipy.optimize import minimize

        axes = self.spec.axes
        free = [n for n, axis in enumerate(axes) if not (axis.whole or axis.values)]
        if not free:
            return self.rows_at(shares[None])
        rows, scale, margin = list[Row](), abs(cost(best)) or 1.0, self.spec.search.margin

        def row_at(x: Array) -> Row:
            """Return the design with these fractions of the continuous keys."""
            design = shares.copy()
            design[free] = np.clip(x, 0.0, 1.0)
            rows.extend(self.rows_at(design[None]))
            return rows[-1]

        def objective(x: Array) -> float:
            """Return the cost over the cost of the start."""
            row = row_at(x)
            return FAILED_COST if row.refused else cost(row) / scale

        def margins(x: Array) -> Array:
            """Return the margin to each limit, negative if violated."""
            return -np.array(self.judge.violations(row_at(x), margin))

        start_point = shares[free]
        for first_step in POLISH_FIRST:
            minimize(
                objective,
                start_point,
                method="COBYLA",
                bounds=[(0.0, 1.0)] * len(free),
                constraints={"type": "ineq", "fun": margins},
                options={"rhobeg": first_step, "tol": POLISH_LAST, "maxiter": POLISH_EVALUATIONS * len(free)},
            )
            valid = [row for row in rows if self.judge.meets(row, margin)]
            if not valid:
                break
            start_point = self._shares[str(min(valid, key=cost).point)][free]
        return rows
