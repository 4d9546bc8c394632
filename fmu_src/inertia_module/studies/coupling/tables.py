"""Tables in Markdown, and errors in percent."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Lines of a table."""
    yield f"| {' | '.join(heads)} |"
    yield f"|{'---|' * len(heads)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"
    yield ""


def percent(value: float) -> str:
    """A share in percent, to two digits; – where there is none."""
    if math.isnan(value):
        return "–"
    if abs(value) >= 1.0:
        return f"{100 * value:.0f}"
    return f"{100 * value:.3f}" if abs(value) < 1e-3 else f"{100 * value:.2g}"
