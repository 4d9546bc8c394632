"""How the verdict on an equation or a claim of a paper is written down: docs/papers.md is made of these."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

HOLDS = "holds"
PARTLY = "holds partly"
FAILS = "does not hold"


@dataclass(frozen=True)
class Equation:
    """One numbered equation of a paper.

    Attributes:
        number: as printed, "(2)". subject: what it gives, in a few words.
        exact, printed: names of the functions that are its exact and its printed form ("" if none).
        right: whether the printed form is right (None: not known).
        correction: what has to be changed ("" if nothing).
        difference: computes the worst difference of the printed from the exact form over a period,
            relative to the largest exact value (None where there is nothing to compare).
    """

    number: str
    subject: str
    exact: str
    printed: str
    right: bool | None
    correction: str = ""
    difference: Callable[[], float] | None = None


@dataclass(frozen=True)
class Claim:
    """One claim in the text of a paper.

    Attributes:
        where: place in the paper. text: the claim, translated.
        verdict: HOLDS, PARTLY or FAILS. found: computes a sentence with the figures found.
    """

    where: str
    text: str
    verdict: str
    found: Callable[[], str]
