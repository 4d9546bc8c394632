"""Number with its unit, the type of the metrics of a run."""

from __future__ import annotations

from typing import NamedTuple


class Quantity(NamedTuple):
    """Number with its unit.

    Attributes:
        value: The number.
        unit: Unit; "" for counts and ratios.
    """

    value: float
    unit: str
