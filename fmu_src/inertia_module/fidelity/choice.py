"""Choice of the cheapest fidelity level that meets an error, and its reasons."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..common.equality import ByContent
from ..common.errors import ParameterError
from ..common.terminal import Progress
from ..scene import Scene
from .levels import FIDELITIES, NOT_MODELLED, at_level, candidates
from .measure import trial_rows
from .rows import Row

_FIDELITY_NUMBERS = {name: number for number, name in FIDELITIES.items()}


@dataclass(frozen=True, eq=False)
class Choice(ByContent):
    """Chosen level with the reasons.

    Attributes:
        row: Cheapest level that meets the allowed error.
        outputs: Names of the outputs that must meet the error.
        error: Allowed relative error.
        next_row: Next more accurate level that meets the error, or None.
        rejections: Reasons to reject cheaper levels, by label.
    """

    row: Row
    outputs: tuple[str, ...]
    error: float
    next_row: Row | None
    rejections: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Return the run time of the next level over the run time of the chosen level."""
        return None if self.next_row is None else self.next_row.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """Return the choice, its reasons and the cost of the next level as lines."""

        def cost(row: Row) -> str:
            return f"{1e3 * row.wall_time:.3g} ms of kernel time per simulated second"

        error, output = self.row.max_error_of(self.outputs)
        accuracy = f"error {error:.2g} ({output}), requested {self.error:g}"
        lines = [f"chosen: {self.row.label}: {accuracy}, {cost(self.row)}"]
        lines += [f"rejected: {label}: {reason}" for label, reason in self.rejections.items()]
        if self.next_row is None:
            return [*lines, "next level: none"]
        next_accuracy = f"error {self.next_row.max_error(self.outputs):.2g}, {cost(self.next_row)}"
        return [
            *lines,
            f"next level: {self.next_row.label}: {next_accuracy}, {self.ratio:.3g} times the run time",
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the choice for JSON."""

        def brief(row: Row) -> dict[str, Any]:
            errors = {name: row.errors[name] for name in self.outputs}
            return row.as_dict() | {"error": row.max_error(self.outputs), "errors": errors}

        return {
            "request": {"error": self.error, "outputs": list(self.outputs)},
            "chosen": brief(self.row),
            "rejected": dict(self.rejections),
            "next": None if self.next_row is None else brief(self.next_row) | {"cost": self.ratio},
        }


def rejection(row: Row, error: float, outputs: Sequence[str]) -> str:
    """Return the reason why a row does not meet an error; "" if it does.

    Args:
        row: The row.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.
    """
    if row.failure:
        return row.failure
    not_modelled = NOT_MODELLED.get(_FIDELITY_NUMBERS.get(row.fidelity, -1), {})
    for name in outputs:
        if name in not_modelled:
            return f"it {not_modelled[name]} ({name})"
    without_reference = [name for name in outputs if math.isnan(row.errors.get(name, math.nan))]
    if without_reference:
        return f"no reference for {', '.join(without_reference)}"
    maximum, output = row.max_error_of(outputs)
    return "" if maximum <= error else f"error {maximum:.2g} ({output})"


def cheapest(rows: Sequence[Row]) -> Row | None:
    """Return the row with the minimum run time, or None without rows.

    Settings of one level are compared by right-hand-side evaluations, which have no measurement noise.

    Args:
        rows: The rows.
    """
    best: dict[tuple[str, float], Row] = {}
    for row in sorted(rows, key=lambda row: row.evaluations):
        best.setdefault((row.level, row.communication_step), row)
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, outputs: Sequence[str]) -> Choice:
    """Recommend the cheapest level of the module that meets an error; peers are excluded.

    The next level is the cheapest level of a higher fidelity that meets the error. If there is none, it is
    the cheapest level with a tenth of the error.

    Args:
        rows: Measured rows.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.

    Raises:
        ParameterError: No level meets the error; the message contains the error of the best level.
    """
    module_rows = sorted(
        (row for row in rows if row.fidelity in _FIDELITY_NUMBERS), key=lambda row: row.max_error(outputs)
    )
    accurate = [row for row in module_rows if not rejection(row, error, outputs)]
    chosen = cheapest(accurate)
    if chosen is None:
        best = (
            f"best: {module_rows[0].label}: {rejection(module_rows[0], error, outputs)}"
            if module_rows
            else "no level was measured"
        )
        request = f"error = {error:g} in {', '.join(outputs)}"
        raise ParameterError(f"no fidelity level reaches {request}; {best}")
    higher = [row for row in accurate if _FIDELITY_NUMBERS[row.fidelity] > _FIDELITY_NUMBERS[chosen.fidelity]]
    fine_error = 0.1 * min(error, chosen.max_error(outputs))
    finer = [
        row for row in accurate if row.max_error(outputs) <= fine_error and row.wall_time > chosen.wall_time
    ]
    # One line per level: its most accurate row that is not slower than the choice, or that failed.
    rejections: dict[str, tuple[str, str]] = {}
    for row in module_rows:
        reason = rejection(row, error, outputs)
        if reason and not row.wall_time > chosen.wall_time:
            rejections.setdefault(row.level, (row.label, reason))
    next_row = cheapest(higher) or cheapest(finer)
    return Choice(chosen, tuple(outputs), error, next_row, dict(rejections.values()))


def best_rows(rows: Sequence[Row], error: float, outputs: Sequence[str]) -> list[Row]:
    """Return a row for each level: its cheapest row that meets the error, or else its most accurate row.

    The rule is the rule of recommend, so the recommended row is included.

    Args:
        rows: Measured rows.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not rejection(row, error, outputs)])
        or min(level, key=lambda row: row.max_error(outputs))
        for level in levels.values()
    ]


def choose(scene: Scene, progress: Progress | None = None) -> tuple[Scene, Choice]:
    """Choose the cheapest level that meets accuracy.error in all outputs of a scene.

    Args:
        scene: Scene with accuracy.error.
        progress: Function called with the completed fraction, 0 to 1.

    Returns:
        The scene at the level, and the reasons.

    Raises:
        ParameterError: No level meets the error.
    """
    assert scene.accuracy.error is not None
    choice = recommend(trial_rows(scene, progress), scene.accuracy.error, scene.run.outputs)
    (level,) = (level for level in candidates(scene) if level.label == choice.row.label)
    return at_level(scene, level), choice
