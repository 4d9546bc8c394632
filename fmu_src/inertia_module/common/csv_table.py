"""CSV files from rigs, loggers and spreadsheets: columns of numbers by name, with units and file lines.

Only the requested columns must contain numbers. A file may have lines above the headings, comments and a row
of units. A number with two possible meanings is an error.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import ParameterError, cannot_read, must_be, suggestion, unknown
from .files import MAX_TEXT_SIZE, read_file
from .units import parse_unit
from .written_numbers import Reading, booleans, readings

# separators of columns, the most common one last
SEPARATORS = ";\t,"
# number of rows that are searched for the headings
HEADING_ROWS = 1000
# number of rows that are moved to the columns together, small enough not to start the garbage collector
BLOCK_ROWS = 100
COMMENTS = ("#", "%", "//")
# heading of a column: its name and, in brackets, its unit
_HEADING = re.compile(r"(.*?)\s*\[(.*)\]$|(.*?)\s+\((.*)\)$", re.DOTALL)
# first line in which a spreadsheet states the separator
_SEPARATOR_LINE = re.compile(r'"?sep=(.)"?\s*\n')


class TableError(ParameterError):
    """Error of a table: the message contains the column and the allowed values."""


def _text_of(path: Path | str) -> str:
    """Read a text file in UTF-8, in UTF-16 with a byte-order mark, or else in Latin-1."""
    name = str(path)
    try:
        content = read_file(Path(path), MAX_TEXT_SIZE)
    except OSError as error:
        hint = ". Write / instead of \\." if "\\" in name and isinstance(error, FileNotFoundError) else ""
        raise TableError(f"{cannot_read(name, error)}{hint}") from error
    encoding = "utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\0" in text:
        raise TableError(f"{cannot_read(name, 'not a text file')}. Save the table as CSV.")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _name_and_unit(cell: str) -> tuple[str, str]:
    """Split a heading into name and unit, "" if it has none."""
    match = _HEADING.match(cell.strip())
    return (match[1] or match[3] or "", match[2] or match[4] or "") if match else (cell.strip(), "")


def _is_unit(cell: str) -> bool:
    """Return True if a cell is a unit and no number."""
    text = cell.strip("[]() ")
    if not text or readings([text])[0].is_complete:
        return False
    try:
        parse_unit(text)
    except ValueError:
        return False
    return True


def _reader(text: str, separator: str) -> Any:
    return csv.reader(io.StringIO(text), delimiter=separator, skipinitialspace=True)


def _is_blank(row: list[str]) -> bool:
    return not any(map(str.strip, row))


def _is_comment(row: list[str]) -> bool:
    return row[0].lstrip().startswith(COMMENTS)


class CsvTable:
    """Columns of a CSV file, which become numbers on request.

    Commas, semicolons, tabs, or the sign in a first line such as sep=; separate the columns. The headings are
    the longest of the first rows that contains all keys. Rows that begin with #, % or // are comments.

    Args:
        path: path of the file.
        keys: names of columns that the file must have; without keys the first row contains the headings.

    Attributes:
        path: path of the file, for messages.
        names: names of the columns in the order of the file.
        units: units by name, as written, for the columns that have a unit.
        lines: file line of each row, shape (rows,).

    Raises:
        TableError: the file cannot be read, or has no such columns or no row.
    """

    def __init__(self, path: Path | str, keys: Sequence[str] = ()) -> None:
        self.path = str(path)
        text = _text_of(path)
        try:
            self._separator, line, headings = self._find_headings(text, keys)
            self._headings = [name for name, _ in headings]
            lines, self._columns = self._read_columns(text, line)
        except csv.Error as error:
            raise TableError(cannot_read(self.path, f"invalid CSV: {error}")) from error
        self.names = [name for name in dict.fromkeys(self._headings) if name]
        self.units = {name: unit for name, unit in headings if name and unit}
        first = self._columns[self._headings.index(keys[0]) if keys else 0][:1]
        if first and _is_unit(first[0]):
            self._read_units(lines.pop(0), [column.pop(0) for column in self._columns])
        if not lines:
            raise TableError(f"{self.path}: no rows below the headings in line {line}")
        self.lines = np.array(lines)
        self._decimal_signs: dict[str, str] = {}

    # --- rows ---

    def _find_headings(self, text: str, keys: Sequence[str]) -> tuple[str, int, list[tuple[str, str]]]:
        """Return separator, file line, and names with units of the first row with the most keys."""
        separator_line = _SEPARATOR_LINE.match(text)
        ranked = []
        for separator in separator_line[1] if separator_line else SEPARATORS:
            reader = _reader(text, separator)
            for row in islice(reader, HEADING_ROWS):
                if _is_blank(row):
                    continue
                line, is_comment = reader.line_num, _is_comment(row)
                row[0] = row[0].lstrip("#% ")
                headings = [_name_and_unit(cell) for cell in row]
                number = len({name for name, _ in headings}.intersection(keys))
                rank = (number, len(row) if number else 0, -line, len(row))
                # a comment with keys contains the headings: NumPy writes such files
                if not (separator_line and line == 1) and (number or not is_comment):
                    ranked.append((rank, separator, line, headings))
        if not ranked:
            raise TableError(cannot_read(self.path, "no headings and no numbers"))
        _, separator, line, headings = max(ranked)
        names = [name for name, _ in headings if name]
        for key in keys:
            if key not in names:
                missing = f"missing column {key!r}{suggestion(key, names)}"
                raise TableError(f"{self.path}: {missing} (headings from line {line})")
        return separator, line, headings

    def _body(self, text: str, line: int) -> Iterator[tuple[int, list[str]]]:
        """Yield the rows below a line with their file lines, without comments, as long as the headings."""
        reader, width = _reader(text, self._separator), len(self._headings)
        for row in reader:
            # nearly all rows have the right length and begin with a digit: they skip the slow checks
            if len(row) != width or not row[0][:1].isdigit():
                if _is_blank(row) or _is_comment(row) or reader.line_num <= line:
                    continue
                self._match_headings(reader.line_num, row)
            if reader.line_num > line:
                yield reader.line_num, row

    def _read_columns(self, text: str, line: int) -> tuple[list[int], list[list[str]]]:
        """Return the file lines of the rows below a line, and their cells by column."""
        lines: list[int] = []
        columns: list[list[str]] = [[] for _ in self._headings]
        body = self._body(text, line)
        # reading in blocks is faster: the garbage collector would visit a list of all rows repeatedly
        while block := list(islice(body, BLOCK_ROWS)):
            numbers, rows = zip(*block, strict=True)
            lines += numbers
            for column, cells in zip(columns, zip(*rows, strict=True), strict=True):
                column.extend(cells)
        return lines, columns

    def _match_headings(self, line: int, row: list[str]) -> None:
        """Cut or extend a row to the length of the headings; cells without a heading must be empty."""
        width = len(self._headings)
        if any(cell.strip() for cell in row[width:]):
            demand = must_be("the number of cells", f"{width}, as in the headings", f"{len(row)}")
            raise TableError(
                f"{self.path} line {line}: {demand}. Separate columns by semicolons if numbers have decimal"
                " commas."
            )
        row[width:] = []
        row += [""] * (width - len(row))

    def _read_units(self, line: int, row: list[str]) -> None:
        """Take the units of a row below the headings."""
        for name, cell in zip(self._headings, row, strict=True):
            unit = cell.strip("[]() ")
            if name and unit and self.units.setdefault(name, unit) != unit:
                demand = must_be(f"the unit of {name}", f"{self.units[name]}, as in its heading", unit)
                raise TableError(f"{self.path} line {line}: {demand}")

    def place(self, row: int) -> str:
        """Return the file and the line of a row, for messages.

        Args:
            row: index of the row.
        """
        return f"{self.path} line {self.lines[row]}"

    # --- numbers ---

    def _column(self, name: str) -> list[str]:
        """Return the cells of a column."""
        places = [place for place, heading in enumerate(self._headings) if heading == name]
        if not places:
            raise TableError(f"{self.path}: {unknown('column', name, self.names)}")
        if len(places) > 1:
            numbers = " and ".join(str(place + 1) for place in places)
            raise TableError(f"{self.path}: {must_be(name, 'the name of one column', f'columns {numbers}')}")
        return self._columns[places[0]]

    def _readings(self, cells: Sequence[str]) -> list[Reading]:
        return readings(cells, self._separator == ",")

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return the numbers of a column, shape (rows,), in the unit of the file.

        Args:
            name: name of the column.

        Raises:
            TableError: there is no such column, a cell is not a number, or it has two meanings. The message
                contains the line.
        """
        cells = self._column(name)
        every = self._readings(cells)
        possible = [reading for reading in every if reading.is_complete]
        if possible:
            return (possible[0] if len(possible) == 1 else self._decide(name, cells, possible)).values
        values = booleans(cells)
        if values is None:
            raise self._no_number(name, cells, max(reading.failure for reading in every))
        return values

    def points(self, name: str) -> NDArray[np.float64]:
        """Return the numbers of a column, shape (rows,), in the unit of the file; they must not decrease.

        Args:
            name: name of the column.

        Raises:
            TableError: a number decreases, or numbers() raises.
        """
        values = self.numbers(name)
        falling = np.flatnonzero(np.diff(values) < 0.0)
        if falling.size:
            before, after = values[falling[0] : falling[0] + 2]
            raise TableError(
                f"{self.place(falling[0] + 1)}: {name} must not decrease (got {after:g} after {before:g})"
            )
        return values

    def _decide(self, name: str, cells: Sequence[str], possible: Sequence[Reading]) -> Reading:
        """Choose between decimals and groups for a column such as 1.200.

        The decimal sign of the other columns decides, if this column has the matching form. A column with
        a sign in each number has the form of three decimals. A column such as 900, 1.200 has the form of
        groups.
        """
        plain, grouped = sorted(possible, key=lambda reading: reading.group)
        is_mixed = any(plain.decimal not in cell for cell in cells)
        signs = {self._decimal_sign(other) for other in self.names if other != name} - {""}
        if signs == {plain.decimal} or (not signs and not is_mixed):
            return plain
        if signs == {grouped.decimal} and is_mixed:
            return grouped
        row = next(n for n, cell in enumerate(cells) if plain.decimal in cell)
        values = f"{plain.values[row]:.15g} or {grouped.values[row]:.15g}"
        demand = must_be(name, "a number with one meaning", repr(cells[row].strip()))
        raise TableError(f"{self.place(row)}: {demand}. Write {values}.")

    def _decimal_sign(self, name: str) -> str:
        """Return the decimal sign of a column; "" without a sign, with two meanings, or without numbers."""
        if name not in self._decimal_signs:
            cells = self._column(name) if self._headings.count(name) == 1 else []
            # slow sensors leave cells empty
            cells = [cell for cell in cells if cell.strip()]
            every = self._readings(cells) if any("." in cell or "," in cell for cell in cells) else []
            signs = [reading.decimal for reading in every if reading.is_complete]
            self._decimal_signs[name] = signs[0] if len(signs) == 1 else ""
        return self._decimal_signs[name]

    def _no_number(self, name: str, cells: Sequence[str], row: int) -> TableError:
        """Explain why a cell of a column is not a number."""
        cell = cells[row].strip()
        start = f"{self.place(row)}: {name} must be"
        if any(reading.is_complete for reading in self._readings([cell])):
            others = (n for n in range(row) if re.search(r"[.,'_\s]", cells[n].strip()))
            other = next(others, max(row - 1, 0))
            example = cells[other].strip()
            error = f"{start} written like {example!r} in line {self.lines[other]} (got {cell!r})"
            values = [f"{reading.values[0]:.15g}" for reading in readings([example]) if reading.is_complete]
            meanings = f". {example!r} can mean {' or '.join(values)}." if values[1:] else ""
            return TableError(f"{error}{meanings}")
        error = f"{start} a finite number (got {cell!r})"
        decimal = readings([cell])[-1]
        if decimal.is_complete:
            number = f"{decimal.values[0]:.15g}"
            error += (
                ". In this file commas separate columns and groups of three digits."
                f" Write {number}, or separate columns by semicolons."
            )
        return TableError(error)
