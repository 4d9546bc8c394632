"""Evaluation of the papers: quantities by formula, verdicts on equations and claims.

- PAPER_forms.toml contains the quantities of a paper, each with its printed and its exact formula.
- PAPER_claims.toml contains its claims. PAPER.md contains their text, with the names of the computed values.
- An equation is tested alone, with exact values of all its inputs. It is right if the difference is
  round-off.
- A claim consists of statements. It holds if all statements are true.

Formulas use the symbols of the paper. Arguments and results are numbers, arrays over n times or angles, shape
(n,), and vectors with the components first, shape (3, n).
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

# imaginary step of complex times, s
STEP = 1e-30
# maximum difference of a right equation
ROUNDING = 1e-12
HOLDS, PARTLY, FAILS = "holds", "holds partly", "does not hold"
# names that every formula can use
NAMES = {**vars(np), "replace": replace}
# function of the Forms that contain its inputs
Formula = Callable[["Forms"], Any]
Formulas = dict[str, Formula]


class Row(NamedTuple):
    """Quantity of a paper.

    Attributes:
        number: Numbers of its equations; "" for an intermediate quantity.
        name: Name of the quantity; several names for the parts of a result.
        printed: Printed formula.
        exact: Exact formula if it differs.
        drawn: Components with units if both forms are drawn.
    """

    number: str
    name: str
    printed: str
    exact: str = ""
    drawn: str = ""


class Forms(dict[str, Any]):
    """Results of formulas by name or as attributes, each evaluated at its first use.

    A printed formula that is called with the exact forms uses exact values of its inputs, so it is tested
    alone. Forms of the printed formulas use printed results as inputs.

    Args:
        formulas: Formulas by name.
        values: Inputs by name; they override formulas of the same name.
    """

    def __init__(self, formulas: Formulas, **values: Any) -> None:
        super().__init__(values)
        self.formulas = formulas

    def __missing__(self, name: str) -> Any:
        value = self[name] = self.formulas[name](self)
        return value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def replaced(self, **values: Any) -> Forms:
        """Return a copy with other values; evaluated results stay.

        Args:
            values: New values by name.
        """
        return Forms(self.formulas, **self | values)


def read_file(name: str) -> str:
    """Return the text of a file in this folder.

    Args:
        name: Name of the file.
    """
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def tables(paper: str, functions: dict[str, Any]) -> tuple[list[Row], Formulas, Formulas]:
    """Read the rows of a paper and compile its formulas.

    Args:
        paper: Name of the paper.
        functions: Functions that the formulas use in addition to numpy, by name.

    Returns:
        Rows, printed formulas and exact formulas by name.
    """
    scope = NAMES | functions

    def formula(text: str) -> Formula:
        code = compile(text, text, "eval")
        return lambda forms: eval(code, scope, forms)

    rows = [Row(*row) for row in tomllib.loads(read_file(f"{paper}_forms.toml"))["rows"]]
    printed: Formulas = {}
    exact: Formulas = {}
    for row in rows:
        names = row.name.split(", ")
        for n, name in enumerate(names):
            # parentheses allow line breaks
            part = "({})" if len(names) == 1 else f"({{}})[{n}]"
            printed[name] = formula(part.format(row.printed))
            exact[name] = formula(part.format(row.exact or row.printed))
    return rows, printed, exact


def in_time(t: Any) -> Any:
    """Return times with the imaginary step, so that results contain their rates (see rate).

    Args:
        t: Times, s.
    """
    return np.asarray(t) + STEP * 1j


def rate(quantity: Any) -> Any:
    """Return the time derivative of a quantity at times of in_time, exact to round-off.

    Complex step: f(t + i h) = f(t) + i h f'(t) except for terms of order h², which vanish in round-off.
    Source: Squire, Trapp, SIAM Review 40 (1998).

    Args:
        quantity: Complex values.
    """
    return quantity.imag / STEP


def vector(*components: Any) -> Any:
    """Stack components into a vector, shape (3, n).

    Args:
        components: Numbers or arrays, shape (n,).
    """
    return np.stack(np.broadcast_arrays(*components))


def max_abs(values: Any) -> float:
    """Return the maximum magnitude.

    Args:
        values: Numbers, any shape.
    """
    return float(np.abs(values).max())


def max_difference(printed: Any, exact: Any, scale: float | None = None) -> float:
    """Return the maximum length of the difference relative to the maximum length of the exact values.

    Args:
        printed: Printed values: number, shape (n,), or vectors, shape (3, n).
        exact: Exact values of the same shape.
        scale: Length to divide by if all exact values are 0.
    """

    def max_length(values: Any) -> float:
        return max_abs(np.linalg.norm(values, axis=0) if np.ndim(values) > 1 else values)

    return max_length(np.subtract(printed, exact)) / (scale or max_length(exact))


def rounds_to(value: float, printed: str) -> bool:
    """Return True if a value rounds to a printed number.

    Args:
        value: Computed value.
        printed: Printed number, whose decimals determine the rounding.
    """
    return f"{value:.{len(printed.partition('.')[2])}f}" == printed


class Equation(NamedTuple):
    """Equation of a paper with its verdict.

    Attributes:
        name: Name of the quantity in the tables of formulas.
        forms: Function that returns the printed and exact values, as arguments of max_difference.
    """

    name: str
    forms: Callable[[], tuple[Any, ...]]

    @property
    def difference(self) -> float:
        """Return the difference of both forms (see max_difference)."""
        return max_difference(*self.forms())

    def __str__(self) -> str:
        """Return the verdict, the name in the code and the difference, in Markdown."""
        difference = self.difference
        wrong = f"**wrong**, difference {difference:.2g}"
        return f"{'**right**' if difference < ROUNDING else wrong} (`{self.name}`)"


def compared(name: str, printed: Formulas, exact: Forms) -> Equation:
    """Return the equation of a quantity: its printed formula with exact inputs, and its exact formula.

    Args:
        name: Name of the quantity.
        printed: Printed formulas.
        exact: Exact forms.
    """
    return Equation(name, lambda: (printed[name](exact), exact[name]))


class Values:
    """Values of a claim, formatted for the page as a list separated by commas.

    A format that ends in % prints fractions in percent. Values without a format are differences; the page
    prints "round-off" for small ones, because round-off depends on the machine.

    Args:
        value: Number, text, or a sequence of these.
    """

    def __init__(self, value: Any) -> None:
        self.value = value

    def __getitem__(self, place: Any) -> Values:
        return Values(self.value[place])

    def __format__(self, form: str) -> str:
        if form.endswith("%"):
            return f"{Values(np.multiply(100.0, self.value)):{form[:-1]}f} %"
        texts = []
        for value in np.ravel(np.array(self.value, dtype=object)):
            difference = not form and isinstance(value, float)
            small = difference and value < ROUNDING
            texts.append("round-off" if small else format(value, ".2g" if difference else form))
        return ", ".join(texts)


def verdict(statements: Any) -> str:
    """Return the verdict on a claim.

    Args:
        statements: Truth of each statement of the claim.
    """
    truths = np.ravel(statements)
    return HOLDS if truths.all() else PARTLY if truths.any() else FAILS


def claims_of(paper: str, module: ModuleType) -> dict[str, dict[str, Values]]:
    """Evaluate the claims of a paper.

    Formulas use names of this module and of the module of the paper, the common values of all claims, and
    values before them in the same claim.

    Args:
        paper: Name of the paper.
        module: Module of the paper.

    Returns:
        Values of each claim by name, with its verdict.
    """
    names = NAMES | globals() | vars(module)

    def evaluate(formulas: dict[str, str]) -> dict[str, Any]:
        scope = dict(names)
        for name, formula in formulas.items():
            scope[name] = eval(compile(f"({formula})", formula, "eval"), scope)
        return {name: scope[name] for name in formulas}

    table = tomllib.loads(read_file(f"{paper}_claims.toml"))
    names |= evaluate(table.pop("common"))
    claims = {name: evaluate(formulas) for name, formulas in table.items()}
    for values in claims.values():
        values["verdict"] = verdict(values["statements"])
    return {
        claim: {name: Values(value) for name, value in values.items()} for claim, values in claims.items()
    }
