"""A named table of results: columns over time, with units, to and from CSV, and a plain plot."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
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
from ..common.units import factor_between

if TYPE_CHECKING:
    from ..common.colours import Picture

__all__ = ["Result", "TableError", "write_figure", "write_text"]

TIME = "time"
# rows at either end of a table that a notebook shows
ENDS = 5


@dataclass(frozen=True, eq=False)
class Origin(ByContent):
    """File of a table.

    Attributes:
        path: file.
        lines: file line of each row, shape (rows,).
        unread: why a column of the file is not in the table, by its name.
    """

    path: str
    lines: NDArray[np.int64]
    unread: dict[str, str]


@dataclass(frozen=True, eq=False)
class Result(ByContent):
    """Columns of equal length n, the first of them ``time`` (s).

    Attributes:
        columns: name -> array of shape (n,).
        units: name -> unit, for the columns that have one.
        origin: file that the table is from, or None.
    """

    columns: dict[str, NDArray[np.float64]]
    units: dict[str, str] = field(default_factory=dict)
    origin: Origin | None = field(default=None, repr=False, compare=False)

    @classmethod
    def from_columns(
        cls,
        columns: Mapping[str, ArrayLike],
        units: Mapping[str, str] | None = None,
        origin: Origin | None = None,
    ) -> Result:
        """Check and take over columns; time in another unit is converted to s.

        Raises:
            TableError: no time, time that does not grow, lengths that differ, or a value that is not finite.
        """
        arrays = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in columns.items()}
        if TIME not in arrays:
            raise TableError(f"missing column {TIME!r}{suggestion(TIME, arrays)}")
        given = dict(units or {})
        arrays[TIME] = arrays[TIME] * _factor(TIME, given.pop(TIME, "s"), "s")
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
        return cls(ordered, {TIME: "s", **given}, origin)

    @classmethod
    def from_rows(cls, names: Sequence[str], rows: NDArray[np.float64], units: Mapping[str, str]) -> Result:
        """Take over rows, shape (n, names), time first and in s. Raises as from_columns."""
        return cls.from_columns(dict(zip(names, rows.T, strict=True)), units)

    def without(self, names: Set[str]) -> Result:
        """The table without the columns of these names."""
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

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return int(self.time.size)

    def label(self, name: str) -> str:
        """Heading of a column: its name and, in brackets, its unit."""
        return heading(name, self.units.get(name, ""))

    def converted(self, units: Mapping[str, str]) -> Result:
        """Convert some columns to these units; one that has no unit yet is in it already.

        Raises:
            TableError: there is no such column, or its unit is of another kind.
        """
        columns = {
            name: self[name] * _factor(name, self.units.get(name, unit), unit) for name, unit in units.items()
        }
        return replace(self, columns=self.columns | columns, units=self.units | dict(units))

    def place(self, row: int) -> str:
        """Return the file and the line of a row, for the start of a message; "" for a table of no file."""
        return f"{self.origin.path} line {self.origin.lines[row]}: " if self.origin else ""

    def last(self) -> dict[str, float]:
        """The last row by name."""
        return {name: float(values[-1]) for name, values in self.columns.items()}

    def to_csv(self, path: Path | str) -> Path:
        """Write all columns to a path, with the digits that give the same doubles; whole or not at all."""
        return write_columns(Path(path), self.columns, self.units)

    @classmethod
    def from_csv(cls, path: Path | str) -> Result:
        """Read a CSV file of numbers over time (see CsvTable).

        Columns that are not numbers are left out; asking for one of them raises the reason.

        Raises:
            TableError: the file cannot be read, or has no column of times that never fall.
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

    def to_pandas(self) -> Any:
        """A pandas DataFrame with time, s, as its index, and headings with units.

        Raises:
            NotInstalled: there is no pandas here.
        """
        columns = {self.label(name): self[name] for name in self.names[1:]}
        pandas = library("pandas", "notebook")
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name=self.label(TIME)))

    def plot(self, *names: str) -> Picture:
        """A matplotlib Figure of columns over time, of all without names, one panel for each unit.

        Raises:
            TableError: there is no such column.
        """
        from ..common.colours import Picture

        panels: dict[str, list[str]] = {}
        for name in names or self.names[1:]:
            panels.setdefault(self.units.get(name, ""), []).append(name)
        figure = Picture(figsize=(9, 1 + 2.2 * max(1, len(panels))), layout="constrained")
        axes = figure.subplots(max(1, len(panels)), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (unit, members) in zip(axes, panels.items(), strict=False):
            for name in members:
                axis.plot(self.time, self[name], label=name, linewidth=0.9)
            axis.set_ylabel(unit or "-")
            axis.legend(loc="upper right", fontsize="small")
            axis.grid(alpha=0.3)
        axes[-1].set_xlabel(f"{TIME} [s]")
        return figure

    def _repr_png_(self) -> bytes:
        return self.plot()._repr_png_()

    def _repr_html_(self) -> str:
        """Show the first and the last rows in a notebook."""
        shown = range(len(self)) if len(self) <= 2 * ENDS else [*range(ENDS), *range(-ENDS, 0)]
        rows = [[f"{self[name][n]:.6g}" for name in self.names] for n in shown]
        if len(self) > 2 * ENDS:
            rows.insert(ENDS, ["…"] * len(self.names))
        return html_table([self.label(name) for name in self.names], rows)


def html_table(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table in HTML; what has a meaning there is escaped."""

    def line(kind: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{kind}>{html.escape(cell)}</{kind}>" for cell in cells) + "</tr>"

    return "<table>" + line("th", headings) + "".join(line("td", row) for row in rows) + "</table>"


def _factor(name: str, unit: str, wanted: str) -> float:
    try:
        return factor_between(unit, wanted)
    except ValueError as error:
        raise TableError(f"{name} must be in {wanted} or a compatible unit: {error}") from None


def heading(name: str, unit: str) -> str:
    """Heading of a column: its name and, in brackets, its unit, if it has one."""
    return f"{name} [{unit}]" if unit else name


def read_columns(path: Path | str) -> tuple[dict[str, list[float]], dict[str, str]]:
    """Read all columns of a CSV file whose first row has the headings (see CsvTable).

    Args:
        path: file.

    Returns:
        Columns by name, and their units by name, as written.

    Raises:
        TableError: the file cannot be read, or a column is not numbers.
    """
    table = CsvTable(path)
    return {name: table.numbers(name).tolist() for name in table.names}, table.units


def write_columns(
    path: Path, columns: Mapping[str, NDArray[np.float64]], units: Mapping[str, str] | None = None
) -> Path:
    """Write columns of equal length as CSV, whole or not at all; units: of those that have one, by name."""
    headings = [heading(name, (units or {}).get(name, "")) for name in columns]
    rows = ([repr(float(value)) for value in row] for row in zip(*columns.values(), strict=True))
    return write_rows(path, headings, rows)


def write_rows(path: Path, headings: Iterable[str], rows: Iterable[Iterable[Any]]) -> Path:
    """Write rows of cells as CSV below headings, whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(headings)
    writer.writerows(rows)
    return write_text(path, stream.getvalue())


def write_mat(path: Path, name: str, values: Mapping[str, Any], units: Mapping[str, str]) -> Path:
    """Write a struct of numbers and arrays, with the units of those that have one, as MAT of version 5."""
    from scipy.io import savemat  # takes half a second

    stream = io.BytesIO()
    struct = {**values, "units": {field: units.get(field) or "1" for field in values}}
    savemat(stream, {name: struct}, oned_as="column", long_field_names=True)
    return write_atomically(path, stream.getvalue())
