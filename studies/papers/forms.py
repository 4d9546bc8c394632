"""Quantities of a paper by name, each by its formula, as printed and exact, and the d/dt in them.

A paper has a table of rows. Formulas are written in its symbols and take and give numbers, arrays over n
times or angles, shape (n,), and vectors with their components first, shape (3, n).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

# of a complex time, s
STEP = 1e-30
# takes what it needs from the Forms it is called with
Formula = Callable[["Forms"], Any]
Formulas = dict[str, Formula]


class Row(NamedTuple):
    """A quantity of a paper.

    Attributes:
        number: of the equations that give it; none of what stands in between.
        name: of the quantity; of more than one, parts of what the formula gives.
        printed: its formula on the page. exact: its exact formula, if that is another.
    """

    number: str
    name: str
    printed: str
    exact: str = ""


class Forms:
    """Results of a table of formulas, each worked out when it is first asked for.

    A printed formula called with the exact forms is fed with exact values of all it takes: so it is judged
    alone. Forms of the printed table feed each formula with the printed results before it.

    Args:
        formulas: by name. known: inputs by name; they also stand in place of formulas.
    """

    def __init__(self, formulas: Formulas, **known: Any) -> None:
        self.__dict__ |= known | {"formulas": formulas}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name not in self.formulas:
            raise AttributeError(name)
        value = self.__dict__[name] = self.formulas[name](self)
        return value

    def __getitem__(self, name: str) -> Any:
        if name in self.__dict__ or name in self.formulas:
            return getattr(self, name)
        raise KeyError(name)

    def replaced(self, **known: Any) -> Forms:
        """These forms with other values of some; what has been worked out stays."""
        return Forms(**self.__dict__ | known)


def tables(rows: Iterable[Row], *functions: Callable[..., Any]) -> tuple[Formulas, Formulas]:
    """The formulas as printed and the exact ones by the name of the quantity.

    Args:
        rows: of the paper. functions: that formulas use besides those of mathematics.
    """
    known: tuple[Any, ...] = (
        np.sin,
        np.cos,
        np.arctan,
        np.arccos,
        np.sqrt,
        np.exp,
        np.angle,
        np.conjugate,
        *functions,
    )
    used = {"pi": np.pi, **{function.__name__: function for function in known}}

    def formula(text: str) -> Formula:
        code = compile(text, text, "eval")
        return lambda forms: eval(code, used, forms)  # type: ignore[arg-type]

    printed: Formulas = {}
    exact: Formulas = {}
    for row in rows:
        names = row.name.split(", ")
        for n, name in enumerate(names):
            part = "{}" if len(names) == 1 else f"({{}})[{n}]"
            printed[name] = formula(part.format(row.printed))
            exact[name] = formula(part.format(row.exact or row.printed))
    return printed, exact


def in_time(t: Any) -> Any:
    """Times, s, as of which quantities carry their rates: see rate."""
    return np.asarray(t) + STEP * 1j


def rate(quantity: Any) -> Any:
    """Time derivative, right to rounding, of what was worked out as of in_time.

    By a complex step: f(t + i h) = f(t) + i h f'(t) but for terms of h squared, which round to nothing.
    """
    return quantity.imag / STEP


def vector(*components: Any) -> Any:
    """Stack numbers and arrays of shape (n,): shape (3, n)."""
    return np.stack(np.broadcast_arrays(*components))
