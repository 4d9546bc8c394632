"""Result of an order analysis: order spectra in windows, their lines and files."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.equality import ByContent
from ..common.errors import listed
from ..common.files import write_text
from ..common.units import factor_between, printed_unit
from ..fmi.results import write_columns, write_mat
from .order_lines import BANDWIDTH, PADDING, ROUNDING, Array, Line, lines_of

# reference angles of orders
LINK1, DRIVE = "link1", "drive_angle"
BASES = {LINK1: "revolution of link 1", DRIVE: "revolution of the pinion shaft"}
# units of the axes in files
UNITS = {"time": "s", "speed": "rad/s", "rpm": "rpm", "frequency": "Hz"}


@dataclass(frozen=True, eq=False, repr=False)
class Orders(ByContent):
    """Spectra of signals over n orders in m windows.

    Attributes:
        of: Reference angle, LINK1 or DRIVE.
        turns: Revolutions in a window.
        order: Orders, cycles per revolution, shape (n,).
        time: Time at the middle of each window, s, shape (m,).
        speed: Mean speed of link 1 in each window, rad/s, shape (m,).
        rate: Revolutions per second in each window, the frequency of order 1, Hz, shape (m,).
        ratio: Revolutions of the pinion shaft per revolution of the reference angle, shape (m,). Orders of
            the pinion shaft shift with it.
        spectrum: Complex amplitudes by signal, in its unit, without mean and trend, shape (m, n). A cosine
            has phase 0 if its maximum is at angle 0 of link 1 or of the pinion shaft.
        units: Units by signal.
        highest: Maximum order of the lines; spectra extend beyond it by half the width of a line.
        step: Maximum distance of recorded communication points, s.
    """

    of: str
    turns: float
    order: Array
    time: Array
    speed: Array
    rate: Array
    ratio: Array
    spectrum: dict[str, NDArray[np.complex128]]
    units: dict[str, str]
    highest: float
    step: float

    def __repr__(self) -> str:
        signals = listed(self.spectrum)
        return f"Orders({signals}: up to {self.highest:.4g} per {BASES[self.of]}, {self.time.size} windows)"

    @cached_property
    def waterfall(self) -> dict[str, Array]:
        """Return the amplitudes in each window by signal, shape (m, n)."""
        return {name: np.abs(rows) for name, rows in self.spectrum.items()}

    @cached_property
    def amplitude(self) -> dict[str, Array]:
        """Return the RMS average of the amplitudes over all windows by signal, shape (n,)."""
        return {name: np.sqrt(np.mean(rows**2, axis=0)) for name, rows in self.waterfall.items()}

    @property
    def rpm(self) -> Array:
        """Return the mean speed of link 1 in each window, rpm, shape (m,)."""
        return self.speed * factor_between("rad/s", "rpm")

    @property
    def frequency(self) -> Array:
        """Return the frequency of each order in each window, Hz, shape (m, n)."""
        return self.rate[:, None] * self.order

    def rms(self, name: str) -> float:
        """Return the RMS of all orders up to the maximum order (Parseval's theorem), in its unit.

        Args:
            name: Name of the signal.
        """
        up_to_highest = self.amplitude[name][self.order <= self.highest * (1.0 + ROUNDING)]
        return math.sqrt(0.5 * float(np.sum(up_to_highest**2)) / (PADDING * BANDWIDTH))

    def largest(self, number: int = 5) -> dict[str, list[Line]]:
        """Return the lines with maximum amplitude by signal, in descending order.

        Args:
            number: Maximum number of lines of each signal.
        """
        return {name: lines[:number] for name, lines in self._lines.items()}

    @cached_property
    def _lines(self) -> dict[str, list[Line]]:
        """Return all lines by signal, computed once."""
        return {name: lines_of(self, name) for name in self.spectrum}

    def lines(
        self, number: int = 5, hz: bool = False, speed_unit: str = "rad/s"
    ) -> dict[str, dict[str, str]]:
        """Return the main lines as texts, by signal and order.

        Args:
            number: Maximum number of lines of each signal.
            hz: True to add frequencies, and for speeds in rpm.
            speed_unit: Unit of speeds of link 1.
        """
        unit_of_speed = "rpm" if hz else speed_unit
        factor = factor_between("rad/s", unit_of_speed)
        texts: dict[str, dict[str, str]] = {}
        for name, lines in self.largest(number).items():
            unit, rows = printed_unit(self.units[name]), texts.setdefault(name, {})
            for line in lines:
                span = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else span
                place = f"{line.speed * factor:.4g} {unit_of_speed}"
                place += f", {line.frequency:.4g} Hz" if hz else ""
                maximum = f"maximum {line.greatest:.4g} {unit} at {place}"
                rows[f"order {order}"] = f"{line.amplitude:.4g} {unit}, {maximum}"
        return texts

    def as_dict(self) -> dict[str, object]:
        """Return the main lines of each signal, for JSON."""
        return {
            "of": BASES[self.of],
            "turns": self.turns,
            "highest": self.highest,
            "step": self.step,
            "windows": self.time.size,
            "signals": {
                name: {
                    "unit": self.units.get(name, ""),
                    "rms": self.rms(name),
                    "largest": [line._asdict() for line in lines],
                }
                for name, lines in self.largest().items()
            },
        }

    def write(self, folder: Path) -> dict[str, Path]:
        """Write orders.csv, waterfall.csv (a row per window and order) and summary.json.

        Args:
            folder: Output folder.

        Returns:
            Paths of the files, by kind.
        """
        coarse = slice(None, None, PADDING)
        orders = self.order[coarse]
        windows = {"time": self.time, "speed": self.speed, "rpm": self.rpm}
        rows = {name: np.repeat(values, orders.size) for name, values in windows.items()}
        rows["order"] = np.tile(orders, self.time.size)
        rows["frequency"] = self.frequency[:, coarse].ravel()
        units = {**self.units, **UNITS}
        for name, values in self.spectrum.items():
            rows[name] = self.waterfall[name][:, coarse].ravel()
            rows[f"{name}_phase"] = np.angle(values[:, coarse]).ravel()
            units[f"{name}_phase"] = "rad"
        text = json.dumps(self.as_dict(), indent=2) + "\n"
        return {
            "orders": write_columns(folder / "orders.csv", {"order": self.order, **self.amplitude}, units),
            "waterfall": write_columns(folder / "waterfall.csv", rows, units),
            "summary": write_text(folder / "summary.json", text),
        }

    def write_mat(self, path: Path) -> Path:
        """Write a MAT file (version 5) with a struct ``orders``: axes, and complex amplitudes, shape (m, n).

        Args:
            path: Path of the file.
        """
        axes = {name: getattr(self, name) for name in ("order", *UNITS)}
        return write_mat(path, "orders", {**axes, **self.spectrum}, {**self.units, **UNITS})
