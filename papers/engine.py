"""The engine under the papers: quantities by formulas, equations and claims under their verdicts.

A paper is a table of rows, each a quantity by its formula as printed and exact (PAPER_forms.toml), and a
table of claims (PAPER_claims.toml). An equation is judged alone, fed with exact values of all it takes, and
is right if rounding is all that is left. A claim is taken apart into what it says: it holds if all of it
does. Its words stand in the Markdown beside the code (PAPER.md), which names its figures.

Formulas are written in the symbols of the paper and take and give numbers, arrays over n times or angles,
shape (n,), and vectors with their components first, shape (3, n).
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

# of a complex time, s
STEP = 1e-30
ROUNDING = 1e-12
HOLDS, PARTLY, FAILS = "holds", "holds partly", "does not hold"
# what every formula may use
NAMES = {**vars(np), "replace": replace}
# takes what it needs from the Forms it is called with
Formula = Callable[["Forms"], Any]
Formulas = dict[str, Formula]


class Row(NamedTuple):
    """A quantity of a paper.

    Attributes:
        number: of the equations that give it; none of what stands in between.
        name: of the quantity; of more than one, parts of what the formula gives.
        printed: its formula on the page. exact: its exact formula, if that is another.
        drawn: components with their units, where both are drawn.
    """

    number: str
    name: str
    printed: str
    exact: str = ""
    drawn: str = ""


class Forms(dict[str, Any]):
    """Results of a table of formulas, by name or as attributes, worked out when they are first asked for.

    A printed formula called with the exact forms is fed with exact values of all it takes: so it is judged
    alone. Forms of the printed table feed each formula with the printed results before it.

    Args:
        formulas: by name. known: inputs by name; they also stand in place of formulas.
    """

    def __init__(self, formulas: Formulas, **known: Any) -> None:
        super().__init__(known)
        self.formulas = formulas

    def __missing__(self, name: str) -> Any:
        value = self[name] = self.formulas[name](self)
        return value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def replaced(self, **known: Any) -> Forms:
        """Copy with other values of some; what has been worked out stays."""
        return Forms(self.formulas, **self | known)


def words(name: str) -> str:
    """A text beside the code."""
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def tables(paper: str, functions: dict[str, Any]) -> tuple[list[Row], Formulas, Formulas]:
    """Read the rows of a paper, and compile its formulas as printed and the exact ones, by quantity.

    They use functions, by name, besides those of numpy.
    """
    used = NAMES | functions

    def formula(text: str) -> Formula:
        code = compile(text, text, "eval")
        return lambda forms: eval(code, used, forms)

    rows = [Row(*row) for row in tomllib.loads(words(f"{paper}_forms.toml"))["rows"]]
    printed: Formulas = {}
    exact: Formulas = {}
    for row in rows:
        names = row.name.split(", ")
        for n, name in enumerate(names):
            # in brackets it may go over lines
            part = "({})" if len(names) == 1 else f"({{}})[{n}]"
            printed[name] = formula(part.format(row.printed))
            exact[name] = formula(part.format(row.exact or row.printed))
    return rows, printed, exact


def in_time(t: Any) -> Any:
    """Times, s, as complex numbers, as of which quantities carry their rates: see rate."""
    return np.asarray(t) + STEP * 1j


def rate(quantity: Any) -> Any:
    """Time derivative, right to rounding, of what was worked out as of in_time.

    By a complex step: f(t + i h) = f(t) + i h f'(t) but for terms of h squared, which round to nothing.
    """
    return quantity.imag / STEP


def vector(*components: Any) -> Any:
    """Stack numbers and arrays of shape (n,): shape (3, n)."""
    return np.stack(np.broadcast_arrays(*components))


def largest(values: Any) -> float:
    """Largest magnitude of numbers."""
    return float(np.abs(values).max())


def worst(printed: Any, exact: Any, scale: float | None = None) -> float:
    """Largest length of the difference over the times, relative to the largest length of the exact.

    Args:
        printed, exact: a number, shape (n,), or vectors, components first.
        scale: in place of the largest exact length, where that is 0.
    """

    def longest(values: Any) -> float:
        return largest(np.linalg.norm(values, axis=0) if np.ndim(values) > 1 else values)

    return longest(np.subtract(printed, exact)) / (scale or longest(exact))


def rounds_to(found: float, printed: str) -> bool:
    """Compare a figure found with a printed one, to the digits behind the point that are printed."""
    return f"{found:.{len(printed.partition('.')[2])}f}" == printed


class Equation(NamedTuple):
    """An equation of a paper under its verdict.

    Attributes:
        name: of the quantity in the tables of formulas.
        forms: its printed and exact form over a period, as arguments of worst.
    """

    name: str
    forms: Callable[[], tuple[Any, ...]]

    @property
    def difference(self) -> float:
        """Difference of the two forms: see worst."""
        return worst(*self.forms())

    def __str__(self) -> str:
        """Verdict, with the name in the code and the difference, in Markdown."""
        difference = self.difference
        wrong = f"**wrong**, difference {difference:.2g}"
        return f"{'**right**' if difference < ROUNDING else wrong} (`{self.name}`)"


def compared(name: str, printed: Formulas, exact: Forms) -> Equation:
    """Compare the printed formula of a quantity, fed with the exact forms, with these."""
    return Equation(name, lambda: (printed[name](exact), exact[name]))


class Found:
    """Values of a claim, formatted for the page as a list separated by commas.

    A format that ends in % prints fractions in percent. Values without a format are differences; the page
    prints "round-off" for small ones, because round-off depends on the machine.

    Args:
        value: number, text, or several of them.
    """

    def __init__(self, value: Any) -> None:
        self.value = value

    def __getitem__(self, place: Any) -> Found:
        return Found(self.value[place])

    def __format__(self, form: str) -> str:
        if form.endswith("%"):
            return f"{Found(np.multiply(100.0, self.value)):{form[:-1]}f} %"
        texts = []
        for value in np.ravel(np.array(self.value, dtype=object)):
            difference = not form and isinstance(value, float)
            small = difference and value < ROUNDING
            texts.append("round-off" if small else format(value, ".2g" if difference else form))
        return ", ".join(texts)


def verdict(says: Any) -> str:
    """Judge a claim by whether each thing it says is so."""
    so = np.ravel(says)
    return HOLDS if so.all() else PARTLY if so.any() else FAILS


def claims_of(paper: str, module: ModuleType) -> dict[str, dict[str, Found]]:
    """Work out the table of a paper's claims, which stands beside the code.

    Formulas use what its module has, what is known to all claims and the figures before them.

    Returns:
        Of each claim the figures by name, with its verdict; its words name them.
    """
    known = NAMES | globals() | vars(module)

    def worked_out(formulas: dict[str, str]) -> dict[str, Any]:
        scope = dict(known)
        for name, formula in formulas.items():
            scope[name] = eval(compile(f"({formula})", formula, "eval"), scope)
        return {name: scope[name] for name in formulas}

    table = tomllib.loads(words(f"{paper}_claims.toml"))
    known |= worked_out(table.pop("known"))
    figures = {name: worked_out(formulas) for name, formulas in table.items()}
    for found in figures.values():
        found["verdict"] = verdict(found["says"])
    return {name: {figure: Found(found[figure]) for figure in found} for name, found in figures.items()}
