"""Quantities by name, each by its formula: a paper has a table of formulas as printed, and an exact one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

# by the name of the quantity; a formula takes what it needs from the Forms it is called with
Formulas = dict[str, Callable[[Any], Any]]


class Forms:
    """What a table of formulas makes of its inputs, each quantity when it is first asked for.

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

    def given(self, **known: Any) -> Forms:
        """The same with other values of these; what has been worked out stays."""
        return Forms(**self.__dict__ | known)
