"""Tables of results: named columns over time with units, CSV files, and plots."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Iterable, Iterator, KeysView, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.csv_table import CsvTable, TableError
from ..common.equality import ByContent
from ..common.errors import must_be, suggestion, unknown
from ..common.extras import library
from ..common.files import write_atomically, write_figure, write_text
from ..common.units import factor_between, printed_unit

if TYPE_CHECKING:
    from pandas import DataFrame

    from ..common.colours import Picture

__all__ = ["Result", "TableError", "write_figure", "write_text"]

TIME = "time"
# number of rows at each end of a table that a notebook shows
ENDS = 5


@dataclass(frozen=True, eq=False)
class Origin(ByContent):
    """File of a table.

    Attributes:
        path: path of the file.
        lines: file line of each row, shape (rows,).
        unread: reasons by name for the columns of the file that are not in the table.
    """

    path: str
    lines: NDArray[np.int64]
    unread: dict[str, str]


@dataclass(frozen=True, eq=False, repr=False, match_args=False)
class Result(ByContent):
    """Table with columns of equal length n; the first column is ``time`` (s).

    result["omega_out"] is a column, list(result.keys()) are the names of all columns, and "q" in result tests
    for a column.

    Attributes:
        columns: columns by name, shape (n,) each.
        units: units by name, for the columns that have a unit.
        origin: file of the table, or None.
    """

    columns: dict[str, NDArray[np.float64]]
    units: dict[str, str] = field(default_factory=dict)
    origin: Origin | None = field(default=None, compare=False)

    @classmethod
    def from_columns(
        cls,
        columns: Mapping[str, ArrayLike],
        units: Mapping[str, str] | None = None,
        origin: Origin | None = None,
    ) -> Result:
        """Create a table from checked columns; time in another unit is converted to s.

        Args:
            columns: columns by name, shape (n,) each.
            units: units by name, for the columns that have a unit.
            origin: file of the table, or None.

        Raises:
            TableError: time is missing or decreases, the lengths differ, or a value is not finite.
        """
        arrays = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in columns.items()}
        if TIME not in arrays:
            raise TableError(f"missing column {TIME!r}{suggestion(TIME, arrays)}")
        remaining_units = dict(units or {})
        arrays[TIME] = arrays[TIME] * _factor(TIME, remaining_units.pop(TIME, "s"), "s")
        n = arrays[TIME].size
        for name, values in arrays.items():
            if values.shape != (n,):
                raise TableError(must_be(f"shape of {name}", f"({n},), as of {TIME}", str(values.shape)))
        finite = np.isfinite(list(arrays.values()))
        if not finite.all():
            (column, row), names = np.argwhere(~finite)[0], list(arrays)
            raise TableError(must_be(f"{names[column]} in row {row}", "finite", arrays[names[column]][row]))
        if (np.diff(arrays[TIME]) < 0).any():
            row = int(np.argmax(np.diff(arrays[TIME]) < 0)) + 1
            raise TableError(f"{TIME} must not decrease (got {arrays[TIME][row]} in row {row})")
        ordered = {TIME: arrays.pop(TIME), **arrays}
        return cls(ordered, {TIME: "s", **remaining_units}, origin)

    @classmethod
    def from_rows(cls, names: Sequence[str], rows: NDArray[np.float64], units: Mapping[str, str]) -> Result:
        """Create a table from rows.

        Args:
            names: names of the columns, time first.
            rows: values, shape (n, names), time in s.
            units: units by name, for the columns that have a unit.

        Raises:
            TableError: time is missing or decreases, or a value is not finite.
        """
        return cls.from_columns(dict(zip(names, rows.T, strict=True)), units)

    def without(self, names: Set[str]) -> Result:
        """Return the table without some columns.

        Args:
            names: names of these columns.
        """
        columns = {name: values for name, values in self.columns.items() if name not in names}
        units = {name: unit for name, unit in self.units.items() if name in columns}
        return replace(self, columns=columns, units=units)

    @property
    def time(self) -> NDArray[np.float64]:
        """Time, s, shape (n,)."""
        return self.columns[TIME]

    @property
    def names(self) -> list[str]:
        """Names of the columns, time first."""
        return list(self.columns)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name in self.columns:
            return self.columns[name]
        unread = self.origin.unread if self.origin else {}
        raise TableError(unread.get(name) or unknown("column", name, self.columns))

    def __repr__(self) -> str:
        return f"Result({self._size_text()})"

    def _size_text(self) -> str:
        """Return the number of rows and columns and the range of time as text."""
        span = f", {self.time[0]:g}…{self.time[-1]:g} s" if len(self) else ""
        return f"{len(self)} rows × {len(self.columns)} columns{span}"

    def keys(self) -> KeysView[str]:
        """Return the names of the columns, time first."""
        return self.columns.keys()

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return int(self.time.size)

    def label(self, name: str) -> str:
        """Return the heading of a column: its name and, in brackets, its unit.

        Args:
            name: name of the column.
        """
        return heading(name, self.units.get(name, ""))

    def converted(self, units: Mapping[str, str]) -> Result:
        """Return the table with some columns converted to other units.

        Args:
            units: new units by name; a column without a unit is assumed to have its new unit already.

        Raises:
            TableError: there is no such column, or the units are incompatible.
        """
        columns = {
            name: self[name] * _factor(name, self.units.get(name, unit), unit) for name, unit in units.items()
        }
        return replace(self, columns=self.columns | columns, units=self.units | dict(units))

    def last(self) -> dict[str, float]:
        """Return the values of the last row by name."""
        return {name: float(values[-1]) for name, values in self.columns.items()}

    def to_csv(self, path: Path | str) -> Path:
        """Write the table as CSV atomically, with the digits that give the same doubles; return the path.

        Args:
            path: path of the file.
        """
        return write_columns(Path(path), self.columns, self.units)

    @classmethod
    def from_csv(cls, path: Path | str) -> Result:
        """Read a CSV file of numbers over time (see CsvTable).

        The table omits columns that are not numbers; access to such a column raises an error with the reason.

        Args:
            path: path of the file.

        Raises:
            TableError: the file cannot be read, or the column time is missing or decreases.
        """
        table = CsvTable(path, [TIME])
        columns, unread = {TIME: table.points(TIME)}, {}
        for name in table.names:
            try:
                columns.setdefault(name, table.numbers(name))
            except TableError as error:
                unread[name] = str(error)
        units = {name: unit for name, unit in table.units.items() if name in columns}
        try:
            return cls.from_columns(columns, units, Origin(table.path, table.lines, unread))
        except TableError as error:
            raise TableError(f"{path}: {error}") from None

    def to_pandas(self) -> DataFrame:
        """Return a pandas DataFrame with time, s, as its index, and headings with units.

        Raises:
            MissingDependencyError: pandas is not installed.
        """
        columns = {self.label(name): self[name] for name in self.names[1:]}
        pandas = library("pandas", "notebook")
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name=self.label(TIME)))

    def plot(self, *names: str) -> Picture:
        """Return a matplotlib Figure of columns over time, with one panel for each unit.

        Args:
            names: names of the columns; all columns without names.

        Raises:
            TableError: there is no such column.
        """
        from ..common.colours import Picture, styled

        panels: dict[str, list[str]] = {}
        for name in names or self.names[1:]:
            panels.setdefault(self.units.get(name, ""), []).append(name)
        with styled():
            figure = Picture(figsize=(9, 1 + 2.2 * max(1, len(panels))), layout="constrained")
            axes = figure.subplots(max(1, len(panels)), 1, sharex=True, squeeze=False)[:, 0]
            for axis, (unit, members) in zip(axes, panels.items(), strict=False):
                for name in members:
                    axis.plot(self.time, self[name], label=name, linewidth=0.9)
                axis.set_ylabel(printed_unit(unit) or "-")
                axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5)
            axes[-1].set_xlabel(f"{TIME} [s]")
        return figure

    def _repr_png_(self) -> bytes:
        return self.plot()._repr_png_()

    def _repr_html_(self) -> str:
        """Return an HTML table of the first and the last rows for a notebook."""
        indices = range(len(self)) if len(self) <= 2 * ENDS else [*range(ENDS), *range(-ENDS, 0)]
        rows = [[f"{self[name][n]:.6g}" for name in self.names] for n in indices]
        if len(self) > 2 * ENDS:
            rows.insert(ENDS, ["…"] * len(self.names))
        return html_table([self.label(name) for name in self.names], rows)


def html_table(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in HTML; special characters are escaped.

    Args:
        headings: headings of the columns.
        rows: cells of each row.
    """

    def line(kind: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{kind}>{html.escape(cell)}</{kind}>" for cell in cells) + "</tr>"

    return "<table>" + line("th", headings) + "".join(line("td", row) for row in rows) + "</table>"


def _factor(name: str, unit: str, target: str) -> float:
    try:
        return factor_between(unit, target)
    except ValueError as error:
        raise TableError(f"{name} must be in {target} or a compatible unit: {error}") from None


def heading(name: str, unit: str) -> str:
    """Return the heading of a column: its name and, in brackets, its unit.

    Args:
        name: name of the column.
        unit: unit, or "" for a heading without brackets.
    """
    return f"{name} [{unit}]" if unit else name


def read_columns(path: Path | str) -> tuple[dict[str, list[float]], dict[str, str]]:
    """Read all columns of a CSV file with the headings in its first row (see CsvTable).

    Args:
        path: path of the file.

    Returns:
        Columns by name, and their units by name, as written.

    Raises:
        TableError: the file cannot be read, or a column does not consist of numbers.
    """
    table = CsvTable(path)
    return {name: table.numbers(name).tolist() for name in table.names}, table.units


def write_columns(
    path: Path, columns: Mapping[str, NDArray[np.float64]], units: Mapping[str, str] | None = None
) -> Path:
    """Write columns of equal length as CSV atomically; return the path.

    Args:
        path: path of the file.
        columns: columns by name, shape (n,) each.
        units: units by name, for the columns that have a unit.
    """
    headings = [heading(name, (units or {}).get(name, "")) for name in columns]
    rows = ([repr(float(value)) for value in row] for row in zip(*columns.values(), strict=True))
    return write_rows(path, headings, rows)


def write_rows(path: Path, headings: Iterable[str], rows: Iterable[Iterable[Any]]) -> Path:
    """Write headings and rows of cells as CSV atomically; return the path.

    Args:
        path: path of the file.
        headings: headings of the columns.
        rows: cells of each row.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(headings)
    writer.writerows(rows)
    return write_text(path, stream.getvalue())


def write_mat(path: Path, name: str, values: Mapping[str, Any], units: Mapping[str, str]) -> Path:
    """Write a struct of numbers and arrays as a MAT file of version 5; return the path.

    Args:
        path: path of the file.
        name: name of the struct.
        values: numbers and arrays by name.
        units: units by name, for the values that have a unit; others are pure numbers.
    """
    from scipy.io import savemat  # the import takes half a second

    stream = io.BytesIO()
    struct = {**values, "units": {field: units.get(field) or "1" for field in values}}
    savemat(stream, {name: struct}, oned_as="column", long_field_names=True)
    return write_atomically(path, stream.getvalue())
