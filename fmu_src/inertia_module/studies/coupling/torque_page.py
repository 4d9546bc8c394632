"""What docs/coupling.md says of the module driven by torque, from the committed rows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from .figure import worst
from .tables import percent, table
from .text import TORQUE_COST, TORQUE_DRIVEN, TORQUE_ERRORS
from .torque import COMPARED, COMPARED_RATIO, TORQUE, TorqueTrial

# of the governor of the cases, s
SAMPLE_TIME = 5e-3
# below this share an error is rounding and tolerance
_NOTHING = 5e-7


def _error(value: float) -> str:
    return "<" if abs(value) < _NOTHING else percent(value)


def _meets(row: TorqueTrial) -> bool:
    """Whether every sample of the governor falls on a communication point."""
    steps = SAMPLE_TIME / row.step
    return abs(steps - round(steps)) < 1e-6 and round(steps) >= 1


def _triple(row: TorqueTrial) -> str:
    if math.isnan(row.speed_error):
        return "unstable"
    return " / ".join(_error(error) for error in (row.speed_error, row.output_error, row.work_error))


def _errors(rows: Sequence[TorqueTrial], case: str) -> Iterator[str]:
    """Errors over step and ratio."""
    here = [row for row in rows if row.case == case and row.scheme == TORQUE]
    ratios = sorted({row.ratio for row in here})
    cells = {(row.step, row.ratio): _triple(row) for row in here}
    yield TORQUE_ERRORS.format(case=case)
    body = [
        [f"{1e3 * step:g} ms", *(cells[step, ratio] for ratio in ratios)]
        for step in sorted({row.step for row in here})
    ]
    yield from table(("step", *(f"{ratio:g}" for ratio in ratios)), body)


def _compared(rows: Sequence[TorqueTrial]) -> list[TorqueTrial]:
    """The rows that were timed in turn with the couplings by speed, at the steps of these."""
    here = [row for row in rows if row.ratio == COMPARED_RATIO]
    steps = {row.step for row in here if row.scheme != TORQUE}
    return [row for name in COMPARED for row in here if row.scheme == name and row.step in steps]


def _costs(rows: Sequence[TorqueTrial]) -> Iterator[str]:
    """Errors and cost beside the couplings by speed."""
    body = [
        (
            row.case,
            row.scheme,
            f"{1e3 * row.step:g}",
            _error(row.speed_error),
            _error(row.output_error),
            _error(row.energy_error),
            f"{row.milliseconds:.0f}",
            f"{row.cost_ratio:.1f}",
        )
        for row in sorted(_compared(rows), key=lambda row: row.case, reverse=True)
    ]
    yield TORQUE_COST.format(ratio=COMPARED_RATIO)
    heads = ("case", "scheme", "step, ms", "ω1, %", "ω_out, %", "energy, %", "time, ms", "times")
    yield from table(heads, body)


def torque_section(rows: Sequence[TorqueTrial]) -> Iterator[str]:
    """The section in lines.

    Args:
        rows: of the part torque.
    """
    mine = [row for row in rows if row.scheme == TORQUE]
    implicit = [row for row in rows if row.scheme == "implicit ramp" and row.step == 1e-3]
    exact = max(worst(row) for row in mine if _meets(row))
    shares = sorted(1.0 / row.cost_ratio for row in implicit)
    yield TORQUE_DRIVEN.format(
        exact=f"{100 * 10.0 ** math.ceil(math.log10(exact)):g}".replace("e-0", "e-"),
        sample=1e3 * SAMPLE_TIME,
        ratio=COMPARED_RATIO,
        cheaper=" to ".join(dict.fromkeys(f"{100 * share:.0f} %" for share in shares)),
        implicit=" to ".join(percent(error) for error in sorted(map(worst, implicit))),
        miss=percent(max(worst(row) for row in mine if row.step == 2e-3)),
        late=percent(max(worst(row) for row in mine if row.step == 1e-2)),
    )
    for case in dict.fromkeys(row.case for row in rows):
        yield from _errors(rows, case)
    yield from _costs(rows)
