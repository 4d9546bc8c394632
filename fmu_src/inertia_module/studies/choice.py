"""The cheapest rung that meets an accuracy, read off measured rows, and in words why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .rungs import FIDELITIES, NOT_MODELLED
from .trajectory import Row

_NUMBER = {name: number for number, name in FIDELITIES.items()}
# where there is no higher rung, the next is one that is so much more accurate
_FINER = 0.1


class NoneMeets(ValueError):
    """No measured rung meets the accuracy: how far the best of them gets, and why others do not count."""


@dataclass(frozen=True)
class Choice:
    """What was chosen and why.

    Attributes:
        row: the cheapest that meets the error. wanted: outputs it was asked of. error: asked for.
        following: what is next on the ladder and meets it too, or None. passed: cheaper rungs and in
            words why not.
    """

    row: Row
    wanted: tuple[str, ...]
    error: float
    following: Row | None
    passed: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Wall time of the next rung over that of the chosen one."""
        return None if self.following is None else self.following.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """What was chosen, why, and what the next rung would cost."""
        worst = max(self.wanted, key=lambda name: self.row.errors[name])
        met = f"error {self.row.worst(self.wanted):.2g} ({worst}) where {self.error:g} was asked for"
        lines = [f"chosen: {self.row.label}: {met}, {_time(self.row)}"]
        lines += [f"not enough: {label}: {reason}" for label, reason in self.passed.items()]
        if self.following is None:
            lines.append("next rung: none of those measured")
        else:
            reached = f"error {self.following.worst(self.wanted):.2g}, {_time(self.following)}"
            lines.append(f"next rung: {self.following.label}: {reached}, {self.ratio:.3g} times as long")
        return lines

    def as_dict(self) -> dict[str, Any]:
        """The same for machines."""

        def brief(row: Row) -> dict[str, Any]:
            return {
                "rung": row.rung,
                "method": row.method,
                "setting": row.setting,
                "error": row.worst(self.wanted),
                "wall_time_per_second": row.wall_time,
                "errors": {name: row.errors[name] for name in self.wanted},
            }

        following = None if self.following is None else brief(self.following) | {"cost": self.ratio}
        asked = {"error": self.error, "wanted": list(self.wanted)}
        return {"asked": asked, "chosen": brief(self.row), "passed": dict(self.passed), "next": following}


def _time(row: Row) -> str:
    return f"{1e3 * row.wall_time:.3g} ms per simulated second in the kernel"


def why_not(row: Row, error: float, wanted: Sequence[str]) -> str:
    """Why a row does not meet an error, "" where it does."""
    if row.failure:
        return row.failure
    lacking = NOT_MODELLED.get(_NUMBER.get(row.rung, -1), {})
    for name in wanted:
        if name in lacking:
            return f"it {lacking[name]} ({name})"
    unknown = [name for name in wanted if not row.errors.get(name, float("nan")) >= 0.0]
    if unknown:
        return f"it has nothing to tell of {', '.join(unknown)}"
    worst = max(wanted, key=lambda name: row.errors[name])
    return "" if row.errors[worst] <= error else f"error {row.errors[worst]:.2g} ({worst})"


def _following(row: Row, candidates: Sequence[Row], error: float, wanted: Sequence[str]) -> Row | None:
    """The cheapest of a higher fidelity that meets the error, else the cheapest that is much finer."""
    higher = [other for other in candidates if _NUMBER[other.rung] > _NUMBER[row.rung]]
    much = _FINER * min(error, row.worst(wanted))
    finer = [other for other in candidates if other.worst(wanted) <= much and other.wall_time > row.wall_time]
    return cheapest(higher) or cheapest(finer)


def cheapest(rows: Sequence[Row]) -> Row | None:
    """The cheapest by wall time; among settings of one rung by right-hand sides, which do not jitter."""
    best: dict[tuple[str, str, float], Row] = {}
    for row in rows:
        kind = (row.rung, row.method, row.communication_step)
        if kind not in best or row.evaluations < best[kind].evaluations:
            best[kind] = row
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> Choice:
    """The cheapest rung of the module that meets an error in all wanted outputs.

    Args:
        rows: measured; those of peers are left out. error: largest allowed. wanted: names in Row.errors.

    Raises:
        NoneMeets: none of them does.
    """
    ours = [row for row in rows if row.rung in _NUMBER]
    meeting = [row for row in ours if not why_not(row, error, wanted)]
    if not meeting:
        best = min(ours, key=lambda row: row.worst(wanted), default=None)
        reached = "none was measured"
        if best is not None:
            reached = f"the best is {best.label}: {why_not(best, error, wanted)}"
        raise NoneMeets(f"error = {error:g} in {', '.join(wanted)} is refused: no rung meets it; {reached}")
    chosen = cheapest(meeting)
    assert chosen is not None
    # one line a fidelity and method: the best that is cheaper or, where nothing is known, any
    passed: dict[str, str] = {}
    for row in sorted(ours, key=lambda row: row.worst(wanted)):
        reason = why_not(row, error, wanted)
        kind = ", ".join(word for word in (row.rung, row.method) if word)
        if reason and not row.wall_time > chosen.wall_time and not any(k.startswith(kind) for k in passed):
            passed[row.label] = reason
    return Choice(chosen, tuple(wanted), error, _following(chosen, meeting, error, wanted), passed)
