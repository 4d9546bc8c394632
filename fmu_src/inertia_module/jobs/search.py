"""Search of designs: a global method from several seeds, then a local polish of the best design of each.

One goal: differential evolution (R. Storn and K. Price, Journal of Global Optimization 11, 1997).
Several goals: NSGA-II (K. Deb et al., IEEE Transactions on Evolutionary Computation 6, 2002).
Polish: COBYLA, linear approximations of goal and limits in a trust region (M. J. D. Powell, 1994), over the
continuous keys; then the same from the neighbours in each whole number, as long as one is better (the
extended poll of C. Audet and J. E. Dennis, SIAM Journal on Optimization 11, 2001). The spread of the polished
designs over the seeds shows if the search has converged.
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
from .axes import of_shares, shares_sampled
from .evaluation import Evaluate, Row

if TYPE_CHECKING:
    from .design import Judge, Spec

Array = NDArray[np.float64]

# share by which the nearest design comes nearer to the limits while a search still improves
NEARER = 1e-3
# largest relative difference of the best designs of two starts in a search that has converged
SPREAD = 0.05
# first steps of the two passes of a polish and their last step, as shares of the ranges; evaluations of a
# pass for each free key; designs of a neighbour in whole numbers that are polished besides the best one
POLISH_FIRST, POLISH_LAST, POLISH_EVALUATIONS = (0.1, 0.03), 1e-3, 14
CLOSEST = 4
# differential evolution: probability of crossover; the factor of differences is drawn from 0.5 to 1
CROSSOVER = 0.9
# the cost, over the cost of its start, of a design that cannot be computed during a polish
REFUSED_COST = 10.0


class Start(NamedTuple):
    """Outcome of one start of a search.

    Attributes:
        seed: of the start.
        best: polished best figure of each goal by name; empty if no design satisfies all limits.
    """

    seed: int
    best: dict[str, float]


class Searched(NamedTuple):
    """Outcome of a search.

    Attributes:
        rows: all designs, each once, in the order of their evaluation.
        starts: the starts that were completed.
        is_cut: True if time ended the search.
    """

    rows: list[Row]
    starts: list[Start]
    is_cut: bool

    def spread(self) -> dict[str, float]:
        """Return the difference of the best figures of all starts, relative to the smallest, by goal."""
        spreads = {}
        for goal in dict.fromkeys(goal for start in self.starts for goal in start.best):
            values = [start.best[goal] for start in self.starts if goal in start.best]
            spreads[goal] = (max(values) - min(values)) / (min(map(abs, values)) or 1.0)
        return spreads

    @property
    def has_converged(self) -> bool:
        """True if two starts or more have found designs, none has failed, and their best ones agree."""
        found = [start for start in self.starts if start.best]
        agree = all(spread <= SPREAD for spread in self.spread().values())
        return len(found) > 1 and len(found) == len(self.starts) and agree and not self.is_cut


def population(spec: Spec, seed: int) -> Array:
    """Return the first designs of a start as shares of the ranges.

    Args:
        spec: the specification.
        seed: of the start.

    Returns:
        Latin hypercube, shape (population, axes).
    """
    return shares_sampled(len(spec.axes), f"latin:{spec.search.population}", seed)


class DesignSearch:
    """Search of a specification over shares (0 to 1) of the ranges.

    Whole numbers, lists and logarithmic ranges are searched alike. A design that is refused violates all
    limits.

    Args:
        spec: the specification.
        judge: of its limits and goals.
        evaluate: gives rows of points.
        progress: called with the share of the search that is done, 0 to 1, or None.
    """

    def __init__(
        self, spec: Spec, judge: Judge, evaluate: Evaluate, progress: Progress | None = None
    ) -> None:
        self.spec, self.judge, self.evaluate, self.progress = spec, judge, evaluate, progress
        self._rows: dict[str, Row] = {}
        self._shares: dict[str, Array] = {}
        self._begun = time.monotonic()

    def run(self) -> Searched:
        """Run all starts; each gets generations until one design satisfies all limits or it stalls."""
        settings, starts = self.spec.search, list[Start]()
        for seed in range(settings.seed, settings.seed + settings.starts):
            rows, complete = self._start(seed, is_first=not starts)
            if not complete:
                return Searched(list(self._rows.values()), starts, True)
            starts.append(Start(seed, self._polished(rows)))
        return Searched(list(self._rows.values()), starts, False)

    def rows_at(self, shares: Array) -> list[Row]:
        """Evaluate designs.

        Args:
            shares: of the ranges, shape (designs, axes).
        """
        rows = self.evaluate(of_shares(self.spec.axes, shares))
        for row, share in zip(rows, shares, strict=True):
            self._rows.setdefault(str(row.point), row)
            self._shares.setdefault(str(row.point), np.array(share))
        return rows

    def _problem(self, rows: list[Row]) -> Any:
        """Return the search as a problem of pymoo; rows: takes all designs of a start."""
        from pymoo.core.problem import Problem

        search, margin = self, self.spec.search.margin

        class Designs(Problem):  # type: ignore[misc]
            """Designs by shares of the ranges of their keys."""

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

    def _start(self, seed: int, is_first: bool) -> tuple[list[Row], bool]:
        """Run one start.

        As long as no design satisfies all limits the start gets more generations, until the closest design
        has not improved over `stall` of them. From the first such design on it gets all generations.

        Args:
            seed: of the start.
            is_first: True for the first start, whose generations time does not limit.

        Returns:
            All designs of the start, and True unless time has ended it.
        """
        from pymoo.core.termination import NoTermination

        settings, rows = self.spec.search, list[Row]()
        algorithm = self._algorithm(seed)
        algorithm.setup(self._problem(rows), termination=NoTermination(), seed=seed)
        # of the closest design to the limits, by generation: sum of its violations
        nearest, number, improving = list[float](), settings.generations, False
        while len(nearest) < number or improving:
            added = not is_first or len(nearest) >= settings.generations
            if added and time.monotonic() - self._begun > settings.longest:
                return rows, False
            algorithm.next()
            nearest.append(float(np.maximum(algorithm.pop.get("G"), 0.0).sum(axis=1).min()))
            before = nearest[-1 - settings.stall] if len(nearest) > settings.stall else math.inf
            improving = 0.0 < nearest[-1] < (1.0 - NEARER) * before
            if nearest[-1] == 0.0 and len(nearest) > number == settings.generations:
                number += len(nearest)
            if self.progress is not None:
                begun = (seed - settings.seed) / settings.starts
                self.progress(begun + min(len(nearest) / number, 1.0) / settings.starts)
        return rows, True

    def _polished(self, rows: Sequence[Row]) -> dict[str, float]:
        """Polish the best design of a start in each goal.

        Args:
            rows: of the start.

        Returns:
            Best figure of each goal; empty if no row satisfies all limits.
        """
        margin = self.spec.search.margin
        satisfying = [row for row in rows if self.judge.meets(row, margin)]
        if not satisfying:
            return {}
        costs = {goal: partial(self._cost, number) for number, goal in enumerate(self.spec.goals)}
        for cost in costs.values():
            satisfying += self._descend(min(satisfying, key=cost), rows, cost)
        return {goal: min(satisfying, key=cost).figures[goal] for goal, cost in costs.items()}

    def _descend(self, start: Row, rows: Sequence[Row], cost: Callable[[Row], float]) -> list[Row]:
        """Polish a design, and its neighbours in whole numbers as long as one is better.

        A neighbour has several polishes, from the best design and from other designs of the start, until one
        is better: it need not satisfy the limits yet, and a polish may end before it does.

        Args:
            start: a design that satisfies all limits.
            rows: all designs of the start.
            cost: of a design, to be small.

        Returns:
            All designs within the limits that were evaluated.
        """
        margin, satisfying, best = self.spec.search.margin, list[Row](), start
        tried, ahead = set[tuple[float | str, ...]](), [self._shares[str(start.point)]]
        while ahead:
            shares = ahead.pop(0)
            combination = self._combination(shares)
            if combination in tried:
                continue
            begins = [shares, *(self._closest(rows, combination) if tried else [])]
            tried.add(combination)
            before = best
            for begin in begins:
                polished = [row for row in self._polish(begin, cost, best) if self.judge.meets(row, margin)]
                satisfying += polished
                best = min([best, *polished], key=cost)
                if best is not before:
                    break
            if best is not before or len(tried) == 1:
                ahead = self._neighbours(self._shares[str(best.point)])
        return satisfying

    def _closest(self, rows: Sequence[Row], combination: tuple[float | str, ...]) -> list[Array]:
        """Return the shares of the designs of a combination that are the closest to the limits.

        Args:
            rows: designs to choose from.
            combination: whole numbers and list values.
        """
        own = {str(row.point): row for row in rows if not row.refused}
        own = {key: row for key, row in own.items() if self._combination(self._shares[key]) == combination}
        closest = sorted(own, key=lambda key: self.judge.beyond(own[key]))
        return [self._shares[key] for key in closest[:CLOSEST]]

    def _combination(self, shares: Array) -> tuple[float | str, ...]:
        """Return the whole numbers and list values of a design, given by its shares."""
        axes = self.spec.axes
        return tuple(
            axis.at(float(s)) for axis, s in zip(axes, shares, strict=True) if axis.whole or axis.values
        )

    def _neighbours(self, shares: Array) -> list[Array]:
        """Return the designs with one whole number smaller or larger by one, as shares."""
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
        """Return one goal of a design as a number that is to be small."""
        return self.judge.costs(row)[number]

    def _polish(self, shares: Array, cost: Callable[[Row], float], best: Row) -> list[Row]:
        """Minimise a cost within the limits from a design on, over its continuous keys.

        Args:
            shares: of the design.
            cost: of a design, to be small.
            best: the best design so far.

        Returns:
            All designs that were evaluated.
        """
        from scipy.optimize import minimize

        axes = self.spec.axes
        free = [n for n, axis in enumerate(axes) if not (axis.whole or axis.values)]
        if not free:
            return self.rows_at(shares[None])
        rows, scale, margin = list[Row](), abs(cost(best)) or 1.0, self.spec.search.margin
        before: dict[bytes, Row] = {}

        def row_at(x: Array) -> Row:
            """Return the design with these shares of the continuous keys."""
            if x.tobytes() not in before:
                design = shares.copy()
                design[free] = np.clip(x, 0.0, 1.0)
                before[x.tobytes()] = row = self.rows_at(design[None])[0]
                rows.append(row)
            return before[x.tobytes()]

        def objective(x: Array) -> float:
            """Return the cost over the cost of the start."""
            row = row_at(x)
            return REFUSED_COST if row.refused else cost(row) / scale

        def reserves(x: Array) -> Array:
            """Return the reserve to each limit, below 0 if it is violated."""
            return -np.array(self.judge.violations(row_at(x), margin))

        begin = shares[free]
        for first_step in POLISH_FIRST:
            minimize(
                objective,
                begin,
                method="COBYLA",
                bounds=[(0.0, 1.0)] * len(free),
                constraints={"type": "ineq", "fun": reserves},
                options={"rhobeg": first_step, "tol": POLISH_LAST, "maxiter": POLISH_EVALUATIONS * len(free)},
            )
            satisfying = [row for row in rows if self.judge.meets(row, margin)]
            if not satisfying:
                break
            begin = self._shares[str(min(satisfying, key=cost).point)][free]
        return rows
