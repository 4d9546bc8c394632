"""Numbers of a column in the notations of people and programs.

The decimal sign is a point or a comma. Groups of three digits may be separated by the other sign, a blank, an
apostrophe or an underscore. A column has one decimal sign and one group sign.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .units import BOOLEANS

# signs that separate groups of digits and are never decimal signs
GROUP_SIGNS = " '_"
# replacements of non-breaking blanks, the apostrophe and the minus sign by ASCII characters
_ASCII_SIGNS = str.maketrans({"\u00a0": " ", "\u2009": " ", "\u202f": " ", "\u2019": "'", "\u2212": "-"})


@dataclass(frozen=True)
class Reading:
    """One interpretation of a column.

    Attributes:
        cells: texts of the column.
        decimal: decimal sign.
        group: sign between groups of three digits, or "".
    """

    cells: Sequence[str]
    decimal: str
    group: str

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """Numbers of a complete reading, shape (cells,)."""
        cells = self.cells
        for sign, other in ((self.group, ""), (self.decimal, ".")):
            if sign not in ("", other):
                cells = [cell.replace(sign, other) for cell in cells]
        return np.array([*map(float, cells)])

    @cached_property
    def failure(self) -> int:
        """Index of the first cell that is not a number in this interpretation, or -1."""
        if not self.group:
            with contextlib.suppress(ValueError):
                finite = np.isfinite(self.values)
                return -1 if finite.all() else int(np.argmin(finite))
        number = _number(self.decimal, self.group)
        # one match for all cells is faster than a match for each; no cell contains the character 0
        if re.compile(f"{number}(?:\0{number})*+", re.ASCII).fullmatch("\0".join(self.cells)):
            return -1
        matches = re.compile(number, re.ASCII).fullmatch
        return next((n for n, cell in enumerate(self.cells) if not matches(cell)), -1)

    @property
    def is_complete(self) -> bool:
        """True if all cells are numbers in this interpretation."""
        return self.failure < 0


def _number(decimal: str, group: str) -> str:
    """Return a regular expression for a number with these signs; group "" excludes groups of digits."""
    point, exponent, whole = re.escape(decimal), r"(?:[eE][+-]?\d++)?", r"\d++"
    if group:
        whole, exponent = rf"(?:[1-9]\d{{0,2}}(?:{re.escape(group)}\d{{3}})++|\d{{1,3}})", ""
    return rf"[+-]?(?:{whole}(?:{point}\d*+)?|{point}\d++){exponent}"


def _signs(text: str, comma_separated: bool) -> list[tuple[str, str]]:
    """Return the pairs of decimal sign and group sign that a text of numbers allows."""
    points, commas = "." in text, "," in text
    spacers = [sign for sign in GROUP_SIGNS if sign in text]
    if spacers:
        decimals = "," * (commas and not comma_separated) + "." * points or "."
        return [(decimal, spacers[0]) for decimal in decimals]
    pairs = [(".", "")] if not commas else [(".", ",")]
    if commas and not points and not comma_separated:
        pairs.append((",", ""))
    if points and not (commas and comma_separated):
        pairs.append((",", "."))
    return pairs


def readings(cells: Sequence[str], comma_separated: bool = False) -> list[Reading]:
    """Return all interpretations of a column that its signs allow.

    Args:
        cells: texts of the column.
        comma_separated: True if commas separate the columns of the file; the decimal sign then is a point.

    Returns:
        At least one interpretation; two complete ones if the column has two meanings.
    """
    text = "\n".join(cells)
    if not text.isascii():
        text = "\n".join(cells := [cell.translate(_ASCII_SIGNS) for cell in cells])
    if " " in text or "\t" in text:
        text = "\n".join(cells := [cell.strip() for cell in cells])
    if not text.isascii():  # float accepts the digits of all scripts
        cells = [cell if cell.isascii() else "" for cell in cells]
    return [Reading(cells, *signs) for signs in _signs(text, comma_separated)]


def booleans(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Return 1 and 0 for a column of true and false, shape (cells,); None if a cell is neither.

    Args:
        cells: texts of the column.
    """
    words = [cell.strip().lower() for cell in cells]
    return np.array([BOOLEANS[word] for word in words]) if BOOLEANS.keys() >= set(words) else None
