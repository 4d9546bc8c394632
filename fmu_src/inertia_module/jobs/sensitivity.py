"""Sobol indices: how much of the variance of a figure each key makes, alone and with the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused
from ..harness.results import write_rows
from .axes import Axis, Point, of_shares
from .task import Row

# a figure that varies less than this, relative to its magnitude, does not vary
CONSTANT = 1e-9


@dataclass(frozen=True)
class Sensitivity:
    """Sobol indices.

    Source: Saltelli et al. (2010), Variance based sensitivity analysis of model output, table 2.

    Attributes:
        keys: n names. figures: m names of those that vary.
        first: share of the variance that a key makes alone, shape (m, n).
        total: with all that it does together with others, shape (m, n).
    """

    keys: list[str]
    figures: list[str]
    first: NDArray[np.float64]
    total: NDArray[np.float64]

    def save(self, path: Path) -> Path:
        """Write as CSV, a row for each figure and key."""
        pairs = [(m, n) for m in range(len(self.figures)) for n in range(len(self.keys))]
        rows = [
            (self.figures[m], self.keys[n], repr(float(self.first[m, n])), repr(float(self.total[m, n])))
            for m, n in pairs
        ]
        return write_rows(path, ("figure", "key", "first_order", "total"), rows)


def indices(
    axes: Sequence[Axis], number: int, seed: int, evaluate: Callable[[Sequence[Point]], list[Row]]
) -> tuple[Sensitivity, list[Point]]:
    """Sobol indices of all figures that vary, and the points they are from.

    Args:
        axes: the ranges, independent and uniform. number: n, a power of 2, for n (d + 2) runs. seed: of the
            points. evaluate: gives rows of points.

    Raises:
        Refused: number is no power of 2, or a point was refused: indices take whole ranges.
    """
    from scipy.stats import sobol_indices, uniform

    if number < 2 or number & (number - 1):
        raise Refused(f"sensitivity must be a power of 2, such as 256, is {number}")
    points: list[Point] = []
    names: list[str] = []

    def figures_at(shares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Figures, shape (m, points), at shares of the ranges, shape (axes, points)."""
        asked = of_shares(axes, shares.T)
        rows = evaluate(asked)
        points.extend(asked)
        refused = next((row for row in rows if row.refused), None)
        if refused is not None:
            raise Refused(
                f"Sobol indices must have runs at all points, at {refused.point}: {refused.refused}"
            )
        names[:] = names or sorted(set.intersection(*(set(row.figures) for row in rows)))
        return np.array([[row.figures[name] for row in rows] for name in names])

    with np.errstate(divide="ignore", invalid="ignore"):
        found = sobol_indices(func=figures_at, n=number, dists=[uniform()] * len(axes), rng=seed)
    values = evaluate(points)
    table = np.array([[row.figures[name] for name in names] for row in values])
    varies = np.ptp(table, axis=0) > CONSTANT * np.abs(table).max(axis=0)
    kept = [name for name, one in zip(names, varies, strict=True) if one]
    first, total = found.first_order[varies], found.total_order[varies]
    return Sensitivity([one.name for one in axes], kept, first, total), points
