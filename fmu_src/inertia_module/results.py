"""A named table of results: columns over time, with units, to and from CSV, and a plain plot."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .files import write_atomically

TIME = "time"


class TableError(ValueError):
    """A table that cannot be used: the message names the column and what is allowed."""


@dataclass(frozen=True)
class Result:
    """Columns of equal length n, the first of them ``time`` (s).

    Attributes:
        columns: name -> array of shape (n,).
        units: name -> unit, for the columns that have one.
    """

    columns: dict[str, NDArray[np.float64]]
    units: dict[str, str] = field(default_factory=dict)

    @classmethod
    def from_columns(cls, columns: Mapping[str, ArrayLike], units: Mapping[str, str] | None = None) -> Result:
        """Check and take over columns.

        Raises:
            TableError: no time, time that does not grow, lengths that differ, or a value that is no number.
        """
        arrays = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in columns.items()}
        if TIME not in arrays:
            raise TableError(f"columns {', '.join(arrays) or 'none'} are refused: a column {TIME} is needed")
        n = arrays[TIME].size
        for name, values in arrays.items():
            if values.shape != (n,):
                raise TableError(f"{name} has shape {values.shape}: allowed is ({n},), that of {TIME}")
            if not np.isfinite(values).all():
                row = int(np.argmin(np.isfinite(values)))
                raise TableError(
                    f"{name} = {values[row]} in row {row} is refused: allowed are finite numbers"
                )
        if (np.diff(arrays[TIME]) < 0).any():
            row = int(np.argmax(np.diff(arrays[TIME]) < 0)) + 1
            raise TableError(f"{TIME} = {arrays[TIME][row]} in row {row} is refused: {TIME} may not go back")
        ordered = {TIME: arrays.pop(TIME), **arrays}
        return cls(ordered, {TIME: "s", **(units or {})})

    @property
    def time(self) -> NDArray[np.float64]:
        """Time, s, shape (n,)."""
        return self.columns[TIME]

    @property
    def names(self) -> list[str]:
        """Names of the columns, time first."""
        return list(self.columns)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self.columns:
            raise TableError(f"{name} is refused: no such column; allowed are {', '.join(self.columns)}")
        return self.columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return int(self.time.size)

    def label(self, name: str) -> str:
        """Heading of a column: its name and, in brackets, its unit."""
        unit = self.units.get(name, "")
        return f"{name} [{unit}]" if unit else name

    def last(self) -> dict[str, float]:
        """The last row by name."""
        return {name: float(values[-1]) for name, values in self.columns.items()}

    def to_csv(self, path: Path | str) -> Path:
        """Write all columns with enough digits to read back the same doubles; whole or not at all."""
        return write_columns(Path(path), {self.label(name): values for name, values in self.columns.items()})

    @classmethod
    def from_csv(cls, path: Path | str) -> Result:
        """Read a CSV file with a heading row of names (a unit in brackets may follow each).

        Raises:
            TableError: the file is missing, empty, or has a cell that is no number.
        """
        try:
            text = Path(path).read_text(encoding="utf-8-sig")
        except OSError as error:
            raise TableError(f"{path} is refused: {error.strerror}; allowed is a CSV file") from error
        rows = [row for row in csv.reader(io.StringIO(text)) if row and any(cell.strip() for cell in row)]
        if len(rows) < 2:
            raise TableError(f"{path} is refused: allowed is a heading row and at least one row of numbers")
        names, units = [], {}
        for heading in rows[0]:
            name, _, unit = heading.strip().partition("[")
            names.append(name.strip())
            if unit:
                units[name.strip()] = unit.rstrip("] ")
        values: dict[str, list[float]] = {name: [] for name in names}
        for number, row in enumerate(rows[1:], 2):
            if len(row) != len(names):
                raise TableError(f"{path} line {number} has {len(row)} cells: allowed are {len(names)}")
            for name, cell in zip(names, row, strict=True):
                try:
                    values[name].append(float(cell))
                except ValueError:
                    message = f"{path} line {number}: {name} = {cell!r} is refused: allowed are numbers"
                    raise TableError(message) from None
        return cls.from_columns(values, units)

    def figure(self, names: Sequence[str] | None = None) -> Any:
        """A matplotlib Figure of columns over time, one panel for each unit.

        Raises:
            TableError: a name that is no column.
        """
        from matplotlib.figure import Figure

        chosen = [name for name in (names or self.names) if name != TIME]
        panels: dict[str, list[str]] = {}
        for name in chosen:
            self[name]
            panels.setdefault(self.units.get(name, ""), []).append(name)
        figure = Figure(figsize=(9, 1 + 2.2 * max(1, len(panels))), layout="constrained")
        axes = figure.subplots(max(1, len(panels)), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (unit, members) in zip(axes, panels.items(), strict=False):
            for name in members:
                axis.plot(self.time, self[name], label=name, linewidth=0.9)
            axis.set_ylabel(unit or "-")
            axis.legend(loc="upper right", fontsize="small")
            axis.grid(alpha=0.3)
        axes[-1].set_xlabel(f"{TIME} [s]")
        return figure


def write_columns(path: Path, columns: Mapping[str, NDArray[np.float64]]) -> Path:
    """Write columns of equal length as CSV, by heading, whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        writer.writerow([repr(float(value)) for value in row])
    return write_text(path, stream.getvalue())


def write_text(path: Path, text: str) -> Path:
    """Write a text file, whole or not at all."""
    write_atomically(path, text.encode())
    return path


def write_figure(path: Path, figure: Any) -> Path:
    """Write a matplotlib Figure in the format of the file's ending, whole or not at all."""
    stream = io.BytesIO()
    figure.savefig(stream, format=path.suffix.lstrip("."))
    write_atomically(path, stream.getvalue())
    return path
