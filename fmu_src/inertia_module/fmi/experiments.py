"""Experiments with reference results in an FMU, in the format of the layered standard FMI-LS-REF.

The files are experiments (MA-HS-Experiments), inputs and results as CSV, and parameters as SSV of SSP.
A result without an experiment belongs to the default experiment. Files outside the unpacked FMU are not read.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FmuError, cannot_read, must_be, unknown
from ..common.units import BOOLEANS, factor_between
from .archive import parse_inside, read_inside
from .instance import to_number

Array = NDArray[np.float64]

MANIFEST = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"
# allowed deviation of a result without a tolerance, relative to the maximum of the reference
RELATIVE_DEVIATION = 1e-2
# exceptions that a file can cause if it violates the standards
FILE_ERRORS = (OSError, SyntaxError, LookupError, ValueError)
TEXTS = ("String", "Binary")
# name of an array element: "y[2]", "A[1,2]"
_ELEMENT = re.compile(r"(.+)\[\s*(\d+(?:\s*,\s*\d+)*)\s*\]$")
# name with a unit: "omega [rpm]"
_QUANTITY = re.compile(r"(.*?)\s*\[(.*)\]$")


class Experiment(NamedTuple):
    """An experiment with reference results.

    Attributes:
        name: name of the experiment.
        results: path of the results.
        settings: times and tolerance as texts, by name in the file.
        inputs: path of the inputs, or None.
        parameters: values by name: numbers, quantities with units, texts.
        allowed: allowed deviations by name of the variable.
    """

    name: str
    results: Path
    settings: Mapping[str, str] = {}
    inputs: Path | None = None
    parameters: Mapping[str, float | str] = {}
    allowed: Mapping[str, float] = {}


class Column(NamedTuple):
    """Values of a variable, or of one element of an array, over time.

    Attributes:
        variable: variable of fmpy.
        element: index of the element in the flat array, or None for the complete variable.
        values: numbers, shape (rows, elements), or texts.
    """

    variable: Any
    element: int | None
    values: Array | list[str]


class Table(NamedTuple):
    """Columns over time.

    Attributes:
        time: times, s, shape (rows,).
        columns: columns by heading.
    """

    time: Array
    columns: dict[str, Column]


def size_of(variable: Any) -> int:
    """Return the number of elements of a variable.

    Args:
        variable: variable of fmpy.
    """
    return math.prod(variable.shape)


def _parameters(folder: Path, file: Path) -> Iterator[tuple[str, float | str]]:
    """Yield names and values of a parameter set: numbers, quantities, texts."""
    for row in parse_inside(folder, file).iterfind(".//{*}Parameter"):
        text, unit = row[0].attrib["value"], row[0].get("unit", "1")
        value = float(text) if row[0].tag.endswith(("Real", "Integer")) else text
        yield row.attrib["name"], value if unit == "1" else f"{text} {unit}"


def _experiment(element: ElementTree.Element, folder: Path, source_folder: Path) -> Experiment:
    """Return an experiment of a file; paths are relative to the folder of this file."""
    # the place of the times differs between drafts of the format
    settings = {**getattr(element.find("TransientSimulation"), "attrib", {}), **element.attrib}
    files = {kind.tag: source_folder / kind.get("source", "") for kind in element}
    parameters = dict(_parameters(folder, files["Parameters"])) if "Parameters" in files else {}
    allowed = {row.attrib["variable"]: float(row.attrib["absolute"]) for row in element.iter("Tolerance")}
    name, inputs = settings["name"], files.get("Stimuli")
    return Experiment(name, files["References"], settings, inputs, parameters, allowed)


def experiments(folder: Path) -> list[Experiment]:
    """Return the experiments with results in an unpacked FMU.

    Args:
        folder: folder of the unpacked FMU.

    Raises:
        FmuError: a file is missing, or lies outside the FMU.
        SyntaxError: a file is no XML.
        LookupError: a file violates the standards: an item is missing.
        ValueError: a file violates the standards: a value is invalid.
    """
    manifest = folder / MANIFEST
    described: list[Experiment] = []
    result_files: list[Path] = []
    if not manifest.is_file():
        return []
    for related in parse_inside(folder, manifest).iterfind("Related"):
        role, file = related.get("role", ""), manifest.parent / related.get("source", "")
        if role.startswith("experiment"):
            rows = parse_inside(folder, file).iterfind("Experiment[References]")
            described += [_experiment(row, folder, file.parent) for row in rows]
        elif role == "result" and file.suffix == ".csv":
            result_files.append(file)
    used_files = [experiment.results for experiment in described]
    return described + [Experiment(file.stem, file) for file in result_files if file not in used_files]


# --- values and tables ---


def value_of(variable: Any, value: float | str) -> list[float] | list[str]:
    """Convert a value to the elements of a variable: numbers, or a text.

    Args:
        variable: variable of fmpy.
        value: a number, a quantity with a unit, the name of an item, a text, or numbers separated by spaces.

    Raises:
        FmuError: the value has another type or another number of elements.
    """
    if variable.type in TEXTS:
        return [str(value)]
    words = value.split() if isinstance(value, str) and variable.shape else [value]
    numbers = [to_number(variable, _number_or_text(word)) for word in words]
    if len(numbers) != size_of(variable):
        raise FmuError(must_be(variable.name, f"{size_of(variable)} numbers", str(len(numbers))))
    return numbers


def _number_or_text(word: float | str) -> float | str:
    """Convert a text to a number, if it is a number without a unit."""
    try:
        return float(word)
    except ValueError:
        return word


def _variable_and_element(name: str, variables: Mapping[str, Any]) -> tuple[Any, int | None]:
    """Return the variable of a heading, and the index of an array element or None.

    Raises:
        FmuError: there is no such variable.
    """
    match = _ELEMENT.match(name)
    if name not in variables and match is not None and variables.get(match[1]) is not None:
        variable, index = variables[match[1]], [int(number) - 1 for number in match[2].split(",")]
        try:
            return variable, int(np.ravel_multi_index(index, variable.shape))
        except ValueError:
            raise FmuError(f"{name} must be an element of {match[1]} (shape {variable.shape})") from None
    if name not in variables:
        raise FmuError(unknown("variable", name, variables))
    return variables[name], None


def _split_heading(heading: str, variables: Mapping[str, Any]) -> tuple[str, str | None]:
    """Return the name and the unit of a heading; None without a unit."""
    match = _QUANTITY.match(heading)
    if heading in variables or _ELEMENT.match(heading) or match is None:
        return heading, None
    return match[1], match[2]


def _column(heading: str, cells: Sequence[str], variables: Mapping[str, Any]) -> Column:
    """Convert cells to a column in the unit of its variable."""
    name, unit = _split_heading(heading, variables)
    variable, element = _variable_and_element(name, variables)
    own_unit = variable.unit or "1"
    try:
        factor = 1.0 if unit is None else factor_between(unit, own_unit)
    except ValueError as error:
        raise FmuError(f"heading {heading!r}: {error}") from None
    if variable.type in TEXTS:
        return Column(variable, None, list(cells))
    number, rows = 1 if element is not None else size_of(variable), []
    for row, cell in enumerate(cells, 1):
        words = cell.split()
        try:
            numbers = [BOOLEANS[word] if word in BOOLEANS else float(word) for word in words]
        except ValueError:
            raise FmuError(must_be(f"{name} in row {row}", "numbers", repr(cell))) from None
        if len(numbers) != number:
            raise FmuError(must_be(f"{name} in row {row}", f"{number} numbers", repr(cell)))
        rows.append(numbers)
    return Column(variable, element, np.array(rows, dtype=float).reshape(len(cells), number) * factor)


def read_table(folder: Path, file: Path, variables: Mapping[str, Any]) -> Table:
    """Read a CSV file of variables over time: numbers, Booleans, texts, arrays.

    Args:
        folder: folder of the unpacked FMU.
        file: path of the table.
        variables: variables of fmpy by name.

    Raises:
        FmuError: the file is no such table, or lies outside the FMU.
    """
    content = read_inside(folder, file)
    try:
        text = content.decode("utf-8-sig")
        first = text.lstrip().partition("\n")[0]
        reader = csv.reader(io.StringIO(text), delimiter=next((d for d in ";\t" if d in first), ","))
        rows = [[cell.strip() for cell in row] for row in reader if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise FmuError(cannot_read(file.name, f"invalid CSV: {error}")) from error
    if len(rows) < 2:
        demand = must_be("number of rows", "at least 2, with the headings", str(len(rows)))
        raise FmuError(cannot_read(file.name, demand))
    if not rows[0][-1]:  # each row ends with a separator
        rows = [row[: len(rows[0]) - 1] for row in rows]
    headings = rows.pop(0)
    for number, row in enumerate(rows, 1):
        if len(row) != len(headings):
            demand = must_be(f"number of cells in row {number}", str(len(headings)), str(len(row)))
            raise FmuError(cannot_read(file.name, demand))
    if len(set(headings)) < len(headings):
        raise FmuError(cannot_read(file.name, must_be("headings", "unique", ", ".join(headings))))
    times, *columns = map(list, zip(*rows, strict=True))
    try:
        time = np.array(times, dtype=float)
    except ValueError:
        demand = must_be("the first column", "times", headings[0])
        raise FmuError(cannot_read(file.name, demand)) from None
    if not np.isfinite(time).all() or (np.diff(time) < 0.0).any():
        raise FmuError(cannot_read(file.name, "times must be finite and must not decrease"))
    cells = zip(headings[1:], columns, strict=True)
    return Table(time, {heading: _column(heading, column, variables) for heading, column in cells})
