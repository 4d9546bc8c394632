"""What the mechanisms of the papers refuse."""

from __future__ import annotations

import math


def above(value: float, name: str, zero: bool = False, largest: float = math.inf) -> float:
    """The value, if it is finite, above 0 (or 0, where that is allowed) and not too large.

    Raises:
        ValueError: otherwise; names the value and the allowed range.
    """
    if not (math.isfinite(value) and 0.0 <= value <= largest) or (value == 0.0 and not zero):
        upper = f" and at most {largest:g}" if math.isfinite(largest) else ""
        raise ValueError(f"{name} must be finite, {'at least' if zero else 'above'} 0{upper}, is {value}")
    return float(value)
