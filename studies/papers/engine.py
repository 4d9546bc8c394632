"""The engine under the papers: quantities by formulas, equations and claims under their verdicts.

A paper is a table of rows, each a quantity by its formula as printed and exact (PAPER_forms.toml), and a
table of claims. An equation is judged alone, fed with exact values of all it takes, and is right if rounding
is all that is left. A claim is taken apart into what it says: it holds if all of it does. Its words stand in
the Markdown beside the code, which names its figures.

Formulas are written in the symbols of the paper and take and give numbers, arrays over n times or angles,
shape (n,), and vectors with their components first, shape (3, n).
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

# of a complex time, s
STEP = 1e-30
ROUNDING = 1e-12
HOLDS, PARTLY, FAILS = "holds", "holds partly", "does not hold"
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


def rows_of(paper: str) -> list[Row]:
    """Read the table of a paper's quantities, which stands beside the code: rows of Row."""
    text = Path(__file__).with_name(f"{paper}_forms.toml").read_text(encoding="utf-8")
    return [Row(*row) for row in tomllib.loads(text)["rows"]]


def tables(rows: Iterable[Row], *functions: Callable[..., Any]) -> tuple[Formulas, Formulas]:
    """Compile the formulas as printed and the exact ones, by the name of the quantity.

    Args:
        rows: of the paper. functions: that formulas use besides those of numpy.
    """
    used = {**vars(np), **{function.__name__: function for function in functions}}

    def formula(text: str) -> Formula:
        code = compile(text, text, "eval")
        return lambda forms: eval(code, used, forms)

    printed: Formulas = {}
    exact: Formulas = {}
    for row in rows:
        names = row.name.split(", ")
        for n, name in enumerate(names):
            # in brackets it may go over lines
            part = "({})" if len(names) == 1 else f"({{}})[{n}]"
            printed[name] = formula(part.format(row.printed))
            exact[name] = formula(part.format(row.exact or row.printed))
    return printed, exact


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
        lengths = np.sqrt(np.sum(np.square(values), axis=0)) if np.ndim(values) > 1 else values
        return largest(lengths)

    return longest(np.subtract(printed, exact)) / (scale or longest(exact))


def rounds_to(found: float, printed: str) -> bool:
    """Compare a figure found with a printed one, to the digits behind the point that are printed."""
    return f"{found:.{len(printed.partition('.')[2])}f}" == printed


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
    return Equation(name, lambda: (printed[name](exact), exact[name]))


def told(value: Any) -> str:
    """A text, a count, or a relative difference; rounding differs from machine to machine: not spelt out."""
    if not isinstance(value, float):
        return str(value)
    return "rounding" if value < ROUNDING else f"{value:.2g}"


class Found:
    """Figures of a claim as the page tells them, several after one another.

    Args:
        value: number, text, or several of them. A format that ends in % gives shares in percent; without a
            format they are told as differences.
    """

    def __init__(self, value: Any) -> None:
        self.value = value

    def __getitem__(self, place: Any) -> Found:
        return Found(self.value[place])

    def __format__(self, form: str) -> str:
        if form.endswith("%"):
            return f"{Found(np.multiply(100.0, self.value)):{form[:-1]}f} %"
        values = np.ravel(np.array(self.value, dtype=object))
        return ", ".join(format(value, form) if form else told(value) for value in values)


class Claim:
    """A claim in the text of a paper: what was found of it, its words being in the Markdown of the paper.

    Args:
        says: whether each thing the claim says is so, or in each of the cases it names or leaves open.
        figures: by the names by which the words have them.
    """

    def __init__(self, *says: Any, **figures: Any) -> None:
        self.says = [bool(so) for so in says]
        self.figures = figures

    def __getattr__(self, name: str) -> Found:
        if name not in self.__dict__["figures"]:
            raise AttributeError(name)
        return Found(self.figures[name])

    def __str__(self) -> str:
        return HOLDS if all(self.says) else PARTLY if any(self.says) else FAILS
