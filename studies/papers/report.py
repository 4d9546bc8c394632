"""Measures and verdicts for what was found of a paper: figures here, words in the Markdown beside the code.

One measure for all. An equation is judged alone, fed with exact values of all it takes, and is right if
rounding is all that is left. A claim is taken apart into what it says: it holds if all of it does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .forms import Forms, Formulas

ROUNDING = 1e-12
HOLDS, PARTLY, FAILS = "holds", "holds partly", "does not hold"


class Equation(NamedTuple):
    """An equation of a paper under its verdict.

    Attributes:
        name: of the quantity in the tables of formulas, if it is in them.
        forms: its printed and exact form over a period, as arguments of worst.
        verdict: in words, where there is nothing to compare.
    """

    name: str = ""
    forms: Callable[[], tuple[Any, ...]] = tuple
    verdict: str = ""

    @property
    def difference(self) -> float:
        """Of the two forms: see worst."""
        return worst(*self.forms())

    def __str__(self) -> str:
        """Verdict, with the name in the code and the difference, in Markdown."""
        if self.verdict:
            return f"**{self.verdict}**"
        difference = self.difference
        if difference < ROUNDING:
            return f"**right** (`{self.name}`)"
        return f"**wrong**, by {difference:.2g} (`{self.name}`)"


def compared(name: str, printed: Formulas, exact: Forms) -> Equation:
    """Compare the printed formula of a quantity, fed with the exact forms, with these."""
    return Equation(name, lambda: (printed[name](exact), getattr(exact, name)))


def worst(printed: Any, exact: Any, scale: float | None = None) -> float:
    """Largest length of the difference over the times, relative to the largest length of the exact.

    Args:
        printed, exact: a number, shape (n,), or vectors, components first.
        scale: in place of the largest exact length, where that is 0.
    """

    def largest(values: Any) -> Any:
        lengths = np.sqrt(np.sum(np.square(values), axis=0)) if np.ndim(values) > 1 else np.abs(values)
        return np.max(lengths)

    return float(largest(np.subtract(printed, exact)) / (scale or largest(exact)))


def shown(difference: float) -> str:
    """A relative difference; rounding differs from machine to machine and is not spelt out."""
    return "rounding" if difference < ROUNDING else f"{difference:.2g}"


def percent(values: Any, digits: int = 0) -> str:
    """Shares in percent, after one another."""
    return ", ".join(f"{100.0 * share:.{digits}f}" for share in values)


def rounds_to(found: float, printed: str) -> bool:
    """Compare a figure found with a printed one, to the digits behind the point that are printed."""
    return f"{found:.{len(printed.partition('.')[2])}f}" == printed


class Finding:
    """A row of the table of claims, its words being in page.md.

    Args:
        says: whether each thing the claim says is so, or in each of the cases it names or leaves open.
        figures: attributes by which the words of the page name them.
    """

    def __init__(self, *says: Any, **figures: Any) -> None:
        self.says = [bool(so) for so in says]
        self.__dict__.update(figures)

    def __str__(self) -> str:
        return HOLDS if all(self.says) else PARTLY if any(self.says) else FAILS
