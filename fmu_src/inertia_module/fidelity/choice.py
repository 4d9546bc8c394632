"""Choice of the cheapest level of fidelity that meets an accuracy, from measured rows, and its reasons."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .levels import FIDELITIES, NOT_MODELLED, PEER, Row

_NUMBER = {name: number for number, name in FIDELITIES.items()}
# where there is no higher fidelity, the next level is one that is so much more accurate
_FINER = 0.1
# the largest error of a level shown where none is asked for
USUAL_ERROR = 0.01
# columns that any table fits in
_WIDE = 10_000


class NoneMeets(ValueError):
    """No measured level meets the accuracy: how far the best of them gets, and why others do not count."""


@dataclass(frozen=True)
class Choice:
    """Chosen level and the reasons.

    Attributes:
        row: the cheapest that meets the error. wanted: outputs it was asked of. error: asked for.
        following: the next level that meets it too, or None. passed: cheaper levels and why not.
    """

    row: Row
    wanted: tuple[str, ...]
    error: float
    following: Row | None
    passed: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Wall time of the next level over that of the chosen one."""
        return None if self.following is None else self.following.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """Say what was chosen, why, and what the next level would cost."""

        def cost(row: Row) -> str:
            return f"{1e3 * row.wall_time:.3g} ms per simulated second in the kernel"

        worst = max(self.wanted, key=lambda name: self.row.errors[name])
        met = f"error {self.row.worst(self.wanted):.2g} ({worst}) where {self.error:g} was asked for"
        lines = [f"chosen: {self.row.label}: {met}, {cost(self.row)}"]
        lines += [f"not enough: {label}: {reason}" for label, reason in self.passed.items()]
        if self.following is None:
            return [*lines, "next level: none of those measured"]
        reached = f"error {self.following.worst(self.wanted):.2g}, {cost(self.following)}"
        return [*lines, f"next level: {self.following.label}: {reached}, {self.ratio:.3g} times as long"]

    def as_dict(self) -> dict[str, Any]:
        """Give the choice for machines."""

        def brief(row: Row) -> dict[str, Any]:
            known = {name: getattr(row, name) for name in ("fidelity", "method", "setting")}
            errors = {name: row.errors[name] for name in self.wanted}
            cost = {"wall_time_per_second": row.wall_time}
            return {**known, "error": row.worst(self.wanted), **cost, "errors": errors}

        following = None if self.following is None else brief(self.following) | {"cost": self.ratio}
        asked = {"error": self.error, "wanted": list(self.wanted)}
        return {"asked": asked, "chosen": brief(self.row), "passed": dict(self.passed), "next": following}


def why_not(row: Row, error: float, wanted: Sequence[str]) -> str:
    """Say why a row does not meet an error, "" where it does."""
    if row.failure:
        return row.failure
    lacking = NOT_MODELLED.get(_NUMBER.get(row.fidelity, -1), {})
    for name in wanted:
        if name in lacking:
            return f"it {lacking[name]} ({name})"
    unknown = [name for name in wanted if math.isnan(row.errors.get(name, math.nan))]
    if unknown:
        return f"nothing is known of {', '.join(unknown)}"
    worst = max(wanted, key=lambda name: row.errors[name])
    return "" if row.errors[worst] <= error else f"error {row.errors[worst]:.2g} ({worst})"


def cheapest(rows: Sequence[Row]) -> Row | None:
    """Pick the cheapest by wall time; of settings of one level by right-hand sides, which do not jitter."""
    best: dict[tuple[str, float], Row] = {}
    for row in sorted(rows, key=lambda row: row.evaluations):
        best.setdefault((row.level, row.communication_step), row)
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> Choice:
    """Recommend the cheapest level of the module that meets an error in all wanted outputs.

    The next is the cheapest of a higher fidelity that meets it too, else the cheapest that is much finer.

    Args:
        rows: measured; those of peers are left out. error: largest allowed. wanted: names in Row.errors.

    Raises:
        NoneMeets: none of them does.
    """
    ours = sorted((row for row in rows if row.fidelity in _NUMBER), key=lambda row: row.worst(wanted))
    meeting = [row for row in ours if not why_not(row, error, wanted)]
    chosen = cheapest(meeting)
    if chosen is None:
        best = (
            f"the best is {ours[0].label}: {why_not(ours[0], error, wanted)}" if ours else "none was measured"
        )
        raise NoneMeets(f"error = {error:g} in {', '.join(wanted)} is met by no level of fidelity; {best}")
    higher = [row for row in meeting if _NUMBER[row.fidelity] > _NUMBER[chosen.fidelity]]
    much = _FINER * min(error, chosen.worst(wanted))
    finer = [row for row in meeting if row.worst(wanted) <= much and row.wall_time > chosen.wall_time]
    # one line a level: its best that is cheaper or, where nothing is known, any
    passed: dict[str, tuple[str, str]] = {}
    for row in ours:
        reason = why_not(row, error, wanted)
        if reason and not row.wall_time > chosen.wall_time:
            passed.setdefault(row.level, (row.label, reason))
    following = cheapest(higher) or cheapest(finer)
    return Choice(chosen, tuple(wanted), error, following, dict(passed.values()))


# --- on a terminal ---


def at_levels(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> list[Row]:
    """Pick a row for each fidelity and method: its cheapest that meets the error, else its most accurate.

    The cheapest is found as in recommend, so the recommended row is one of these.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, wanted)])
        or min(level, key=lambda row: row.worst(wanted))
        for level in levels.values()
    ]


def _table(rows: Sequence[Row], wanted: Sequence[str], largest: bool) -> Any:
    """Lay out a column for each wanted output, or one for the largest error and one for where it is."""
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("level of fidelity", "setting"):
        table.add_column(heading, no_wrap=True)
    for heading in ("error",) if largest else wanted:
        table.add_column(heading.replace("_", " "), justify="right")
    table.add_column("ms per s", justify="right")
    if largest:
        table.add_column("largest error in", no_wrap=True)
    for row in rows:
        known = {name: row.errors.get(name, math.nan) for name in wanted}
        # an output that nothing is known of counts as the worst
        worst = [max(known, key=lambda name: (math.isnan(known[name]), known[name]))] if largest else []
        errors = [text(known[name], ".1e") for name in worst or wanted]
        level = row.method if row.fidelity == PEER else row.level
        table.add_row(level, row.setting, *errors, text(1e3 * row.wall_time, ".3g"), *worst)
    return table


def print_levels(title: str, rows: Sequence[Row], wanted: Sequence[str], error: float | None = None) -> None:
    """Print a line for each level of fidelity: its errors in the wanted outputs, and its cost.

    Where the terminal is too narrow for all of these outputs, the one with the largest error is named.

    Args:
        title: of the table. rows: measured, in one communication step. wanted: names in Row.errors.
        error: largest allowed; by default USUAL_ERROR.
    """
    from ..common.terminal import terminal

    console = terminal()
    allowed = USUAL_ERROR if error is None else error
    levels = at_levels(rows, allowed, wanted)
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with errors up to {allowed:g}, else at its most accurate;"
        f" communication step {rows[0].communication_step:g} s; ms of the kernel per simulated second"
    )
    table = _table(levels, wanted, largest=False)
    if console.measure(table, options=console.options.update(width=_WIDE)).minimum > console.width:
        table = _table(levels, wanted, largest=True)
    console.print(table)
