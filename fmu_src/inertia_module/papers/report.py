"""How what was found of a paper is written down: figures here, words in the Markdown beside the code.

One measure for all. An equation is judged alone, fed with exact values of all it takes, and is right if
rounding is all that is left. A claim is taken apart into what it says: it holds if all of it does.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

ROUNDING = 1e-12
HOLDS, PARTLY, FAILS = "holds", "holds partly", "does not hold"

# printed and exact form of an equation over a period, as arguments of worst; None: nothing to compare
Equations = dict[str, Callable[[], tuple[Any, ...]] | bool | None]


def worst(printed: Any, exact: Any, scale: float | None = None) -> float:
    """Largest length of the difference over the times, relative to the largest length of the exact.

    Args:
        printed, exact: a number or shape (n,), or a tuple of such components.
        scale: in place of the largest exact length, where that is 0.
    """
    both = [form if isinstance(form, tuple) else (form,) for form in (printed, exact)]
    difference = _length(np.subtract(p, e) for p, e in zip(*both, strict=True))
    return float(np.max(difference) / (scale or np.max(_length(both[1]))))


def _length(components: Any) -> Any:
    return np.sqrt(sum(np.square(np.asarray(component, dtype=np.float64)) for component in components))


def shown(difference: float) -> str:
    """A relative difference; rounding differs from machine to machine and is not spelt out."""
    return "rounding" if difference < ROUNDING else f"{difference:.2g}"


def rounds_to(found: float, printed: str) -> bool:
    """Whether a figure found is the one printed, with as many digits behind the point as printed."""
    return f"{found:.{len(printed.partition('.')[2])}f}" == printed


class Finding:
    """What was found of a claim.

    Args:
        says: whether each thing the claim says is so, or in each of the cases it names or leaves open.
        figures: attributes by which the words of the page name them.
    """

    def __init__(self, *says: Any, **figures: Any) -> None:
        self.says = [bool(so) for so in says]
        self.__dict__.update(figures)

    def __str__(self) -> str:
        return HOLDS if all(self.says) else PARTLY if any(self.says) else FAILS


def claims_in(module: ModuleType) -> tuple[Callable[[], Finding], ...]:
    """The functions of a module that return a Finding: each is a claim."""
    functions = (value for value in vars(module).values() if callable(value))
    return tuple(f for f in functions if getattr(f, "__annotations__", {}).get("return") == "Finding")


def judged(equations: Equations) -> dict[str, str]:
    """By number: "yes" or "no" and the difference, as two cells of a table."""
    return {number: _cells(forms) for number, forms in equations.items()}


def _cells(forms: Callable[[], tuple[Any, ...]] | bool | None) -> str:
    if not callable(forms):
        return {None: "not known | ", True: "yes | ", False: "no | "}[forms]
    difference = worst(*forms())
    return f"{'yes' if difference < ROUNDING else 'no'} | {shown(difference)}"
