"""NSGA-II over the free keys, each generation evaluated at once by whoever evaluates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..harness.simulate import Progress
from .axes import Point, of_shares, shares_sampled
from .judged import Judge
from .spec import Spec
from .task import Row


def search(
    spec: Spec,
    judge: Judge,
    evaluate: Callable[[Sequence[Point]], list[Row]],
    progress: Progress | None = None,
) -> list[Row]:
    """All designs of a search, each once, in the order in which they were first asked for.

    The search is over shares (0 to 1) of the ranges, so that whole numbers, lists and logarithmic ranges are
    searched alike. A design that is refused is beyond its limits.

    Args:
        spec: what is searched. judge: of its limits. evaluate: gives rows of points.
        progress: told the share of the generations done.
    """
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    settings, found = spec.search, dict[str, Row]()
    tell = progress or (lambda share: None)

    class Designs(Problem):  # type: ignore[misc]
        """Designs by shares of the ranges of their keys."""

        generation = 0

        def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
            rows = evaluate(of_shares(spec.axes, x))
            found.update({str(row.point): row for row in rows})
            out["F"] = np.array([judge.costs(row) for row in rows])
            out["G"] = np.array([judge.violations(row, settings.margin) for row in rows])
            self.generation += 1
            tell(self.generation / settings.generations)

    keys, limits = len(spec.axes), len(judge.limits) + 1
    problem = Designs(n_var=keys, n_obj=len(spec.goals), n_ieq_constr=limits, xl=0.0, xu=1.0)
    start = shares_sampled(keys, f"latin:{settings.population}", settings.seed)
    algorithm = NSGA2(pop_size=settings.population, sampling=start)
    minimize(problem, algorithm, ("n_gen", settings.generations), seed=settings.seed)
    return list(found.values())
