"""Orders of a scene: how much of torques, speeds and forces swings how often a turn of link 1 or the drive.

The scene is run, and what is recorded over time is resampled in equal steps of the angle, so that a machine
that runs up has the same lines as one at a steady speed. Sources: K. R. Fyfe and E. D. S. Munck, Analysis of
computed order tracking, Mechanical Systems and Signal Processing 11 (1997) 187-205; averages over windows
that overlap: P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70-73.
"""

from __future__ import annotations

import json
import math
import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline

from ..common.equality import ByContent
from ..common.errors import Refused, must_be
from ..common.extras import library
from ..common.files import write_atomically, write_text
from ..common.terminal import Progress
from ..common.units import factor_between
from ..contract.variables import BY_NAME
from ..harness.results import write_columns, write_mat
from ..harness.simulate import Result
from ..kernel.codes import AVERAGED
from ..scene import Scene, run_scene
from .evaluation import read

Array = NDArray[np.float64]

# what an order is counted over
LINK1, DRIVE = "link1", "drive_angle"
BASES = {LINK1: "revolution of link 1", DRIVE: "revolution of the pinion shaft"}
# an angle comes without whole turns, and these
ANGLES = ("input_angle", "input_turns", "drive_angle", "drive_turns")
# components, in the fixed frame, of the force of imbalance 0 on its bearing, which is that mass times
BEARING = {f"satellite_force_{axis}": f"imbalance_acceleration_{axis}" for axis in "xyz"}
# what is looked at where nothing is asked for
SIGNALS = (
    *("input_torque", "output_torque", "input_speed", "omega_out"),
    *("shaking_force_x", "shaking_force_y", "shaking_force_z", *BEARING),
)
# points a cycle of the highest order, where 2 would just do
RECORDED = 2.56
# resampled as finely as recorded at the slowest, for what is left out would fold down, but at most so much
# finer than at the fastest
FINEST = 10.0
# with its bandwidth of noise, in 1 / turns
WINDOW, BANDWIDTH = "hann", 1.5
# a spectrum is drawn out to so many times the points, so that a line between two of them is not missed
PADDING = 4
# half the width of a line, in 1 / turns of the window, and the height of what the window makes beside it
HALF_LOBE, SIDE_LOBE = 2, 0.05
# a line bends if along its bend there is so many times more of the signal than along its order
BENDING = 1.1
# turns in a window: at most where nothing is asked for, and at least
TURNS, LEAST_TURNS = 32.0, 4.0
# below this share of its largest or its nominal value a signal is rounding, and what is beyond a limit
ROUNDING = 1e-8
# units of a UFF file, and what all its amplitudes have in common: over orders, speed on the z axis
UFF_UNITS: dict[str, Any] = {"type": 164, "units_code": 1, "units_description": "SI", "length": 1.0}
UFF_UNITS |= {"force": 1.0, "temp": 1.0, "temp_offset": 273.15}
UFF_LINES: dict[str, Any] = {"type": 58, "func_type": 0, "ref_node": 0, "ref_dir": 0}
UFF_LINES |= {"abscissa_spec_data_type": 20, "abscissa_spacing": 1, "orddenom_spec_data_type": 0}
UFF_LINES |= {"z_axis_spec_data_type": 19, "z_axis_axis_lab": "speed", "z_axis_axis_units_lab": "rpm"}
# of the axes in files
UNITS = {"time": "s", "speed": "rad/s", "rpm": "rpm", "frequency": "Hz"}


class Line(NamedTuple):
    """A line of a spectrum.

    Attributes:
        order: cycles a turn. amplitude: RMS average over the windows, in the unit of the signal.
        greatest: amplitude in the window where it is greatest. speed: of link 1 there, rad/s.
        low, high: orders between which it bends with the speed ratio; of a straight line, order.
        frequency, phase: Hz, and rad as of Orders, where it is greatest.
    """

    order: float
    amplitude: float
    greatest: float
    speed: float
    low: float
    high: float
    frequency: float
    phase: float


@dataclass(frozen=True, eq=False)
class Orders(ByContent):
    """Spectra over orders; n orders, m windows.

    Attributes:
        of: what an order is counted over, LINK1 or DRIVE. turns: of that in a window.
        order: cycles a turn, shape (n,).
        time, speed: at the middle of each window, s, and mean speed of link 1 in it, rad/s, shape (m,).
        rate: turns a second in each window, Hz: of order 1, shape (m,).
        ratio: turns of the drive a turn in each window, shape (m,): with it lines bend.
        spectrum: complex amplitude of each signal in each window, in its unit, shape (m, n); mean and trend
            apart. Phases are those of cosines, 0 with a maximum where the angle of link 1 (the drive) is 0.
        units: of the signals.
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

    @cached_property
    def waterfall(self) -> dict[str, Array]:
        """Amplitude of each signal in each window, shape (m, n)."""
        return {name: np.abs(rows) for name, rows in self.spectrum.items()}

    @cached_property
    def amplitude(self) -> dict[str, Array]:
        """Amplitude of each signal, RMS average over the windows, shape (n,)."""
        return {name: np.sqrt(np.mean(rows**2, axis=0)) for name, rows in self.waterfall.items()}

    @property
    def rpm(self) -> Array:
        """Mean speed of link 1 in each window, rpm, shape (m,)."""
        return self.speed * factor_between("rad/s", "rpm")

    @property
    def frequency(self) -> Array:
        """Frequency of each order in each window, Hz, shape (m, n)."""
        return self.rate[:, None] * self.order

    def rms(self, name: str) -> float:
        """RMS of all that swings up to the highest order, in the unit of the signal (Parseval's theorem)."""
        return math.sqrt(0.5 * float(np.sum(self.amplitude[name] ** 2)) / (PADDING * BANDWIDTH))

    def largest(self, number: int = 5) -> dict[str, list[Line]]:
        """The largest lines of each signal, the largest first."""
        return {name: found[:number] for name, found in self._lines.items()}

    @cached_property
    def _lines(self) -> dict[str, list[Line]]:
        """All lines of each signal: picture, table and files ask for them."""
        return {name: self._found(name) for name in self.spectrum}

    def lines(self, number: int = 5, hz: bool = False) -> dict[str, dict[str, str]]:
        """The largest lines as text, by signal and order; hz: speeds in rpm, with the frequency."""
        found: dict[str, dict[str, str]] = {}
        for name, lines in self.largest(number).items():
            unit, rows = self.units[name], found.setdefault(name, {})
            for line in lines:
                several = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else several
                speed = f"{line.speed * factor_between('rad/s', 'rpm'):.4g} rpm, {line.frequency:.4g} Hz"
                place = speed if hz else f"{line.speed:.4g} rad/s"
                maximum = f"maximum {line.greatest:.4g} {unit} at {place}"
                rows[f"order {order}"] = f"{line.amplitude:.4g} {unit}, {maximum}"
        return found

    def _found(self, name: str) -> list[Line]:
        """The lines of a signal, the largest first.

        They are straight, or bend with the drive, alone or on top of a turn of link 1. Each is seen along
        all of these, and is where there is the most of the signal.
        """
        rows, near = self.waterfall[name], 2 * HALF_LOBE / self.turns
        ratio = self.ratio[:, None] / (self.ratio.mean() or 1.0)  # in lock-up the drive stands still
        found = list[tuple[Line, int, int, Array]]()
        for family, (turn, bend) in enumerate([(0.0, ratio**0), (0.0, ratio), (1.0, ratio), (-1.0, ratio)]):
            tracks = turn + (self.order - turn) * bend
            pairs = zip(tracks, rows, strict=True)
            heights = [np.interp(track, self.order, row, right=0.0) for track, row in pairs]
            amplitude = np.sqrt(np.mean(np.square(heights), axis=0))
            places, _ = signal.find_peaks(amplitude, distance=HALF_LOBE * PADDING)
            for track in tracks.T[places]:
                if track.min() >= 0.5 * near and (family == 0 or np.ptp(track) > 0.5 * near):
                    found.append((*self._line(name, track), family, track))
        kept = list[tuple[Line, int, int, Array]]()
        # a line bends if it is so much more of one
        found.sort(key=lambda one: one[0].amplitude / (BENDING if one[2] else 1.0), reverse=True)
        for line, window, family, track in found:
            larger = [one for one in kept if abs(one[3][window] - line.order) <= near]
            if all(family == one[2] and line.amplitude > SIDE_LOBE * one[0].amplitude for one in larger):
                kept.append((line, window, family, track))
        return sorted((line for line, *_ in kept), key=lambda line: -line.amplitude)

    def _line(self, name: str, track: Array) -> tuple[Line, int]:
        """The line of these orders in the windows, as near as they tell, and the window of its greatest."""
        places = np.add(np.rint(track[:, None] / self.order[1]), [-1, 0, 1]).astype(int)
        beside = np.take_along_axis(self.spectrum[name], places.clip(0, self.order.size - 1), axis=1)
        found = beside[np.arange(track.size), np.abs(beside).argmax(axis=1)]
        told = np.abs(found if np.ptp(track) > 0.0 else beside[:, 1])
        at = int(np.abs(found).argmax())
        line = Line(
            order=float(track[at]),
            amplitude=float(np.sqrt(np.mean(told**2))),
            greatest=float(np.abs(found[at])),
            speed=float(self.speed[at]),
            low=float(track.min()),
            high=float(track.max()),
            frequency=float(self.rate[at] * track[at]),
            phase=float(np.angle(found[at])),
        )
        return line, at

    def as_dict(self) -> dict[str, Any]:
        """The largest orders of each signal, for machines."""
        return {
            "of": BASES[self.of],
            "turns": self.turns,
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
        """Write orders.csv, waterfall.csv (a row for each window and order) and summary.json to a folder."""
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
        """Write a struct orders: its axes, and complex amplitudes by name, shape (m, n); MAT of version 5."""
        axes = {name: getattr(self, name) for name in ("order", *UNITS)}
        return write_mat(path, "orders", {**axes, **self.spectrum}, {**self.units, **UNITS})

    def write_uff(self, path: Path) -> Path:
        """Write as UFF: for each signal and window a data set 58, complex over the orders, rpm on its z axis.

        Raises:
            NotInstalled: there is no pyuff here.
        """
        sets = [UFF_UNITS]
        for node, (name, rows) in enumerate(self.spectrum.items(), 1):
            # directions of forces are 1 to 3, of moments 4 to 6
            component = re.search("_(force|moment)_([xyz])$", name)
            side = "xyz".index(component[2]) + (1 if component[1] == "force" else 4) if component else 0
            one = {**UFF_LINES, "x": self.order, "id1": name, "id2": f"cycles per {BASES[self.of]}"}
            one |= {"rsp_node": node, "rsp_dir": side, "ordinate_axis_lab": name[:20]}
            one["ordinate_axis_units_lab"] = self.units[name] or "NONE"
            for row, time, rpm in zip(rows, self.time, self.rpm, strict=True):
                sets.append({**one, "id3": f"at {time:g} s", "data": row, "z_axis_value": rpm})
        with tempfile.TemporaryDirectory() as folder:
            whole = Path(folder) / "orders.uff"
            library("pyuff", "jobs").UFF(str(whole)).write_sets(sets, "overwrite")
            write_atomically(path, whole.read_bytes())
        return path


def spectra(
    table: Result,
    turned: Array,
    names: Sequence[str],
    of: str = LINK1,
    highest: float | None = None,
    turns: float | None = None,
    drive: Array | None = None,
) -> Orders:
    """Order spectra of recorded signals.

    Args:
        table: of the signals over time, with input_speed, r rows. turned: turns up to each row,
            rising, shape (r,). names: of the signals.
        of: what turned counts. highest: order; by default the highest that the rows show.
        turns: in a window; windows overlap by half. By default a quarter of all there are, at most TURNS.
        drive: turns of it up to each row, where lines that bend with it are to be found.

    Raises:
        Refused: turned does not rise, is too little for a window, or rows are too far apart.
    """
    steps, all_turns = np.diff(turned), float(turned[-1] - turned[0])
    still = np.flatnonzero(steps <= 0.0)
    if still.size:
        at = f"constant or decreasing at {table.time[still[0]]:g} s"
        raise Refused(
            f"{must_be('the angle that orders refer to', 'increasing', at)}; choose another time range"
        )
    shown = 1.0 / (RECORDED * float(steps.max()))
    if highest is not None and not 0.0 < highest <= shown * (1.0 + ROUNDING):
        demand = must_be("highest (maximum order)", f"above 0 and at most {shown:.4g}", f"{highest:g}")
        raise Refused(f"{demand}; a shorter run.communication_step allows higher orders")
    per_window = min(TURNS, max(LEAST_TURNS, all_turns / 4.0)) if turns is None else turns
    if not LEAST_TURNS <= per_window <= all_turns:
        allowed = f"at least {LEAST_TURNS:g} and at most {all_turns:.4g} (1 turn = 1 {BASES[of]})"
        raise Refused(must_be("turns (window length)", allowed, f"{per_window:.4g}"))
    samples = math.ceil(1.0 / max(float(steps.min()), float(steps.max()) / FINEST))
    size = round(per_window * samples)
    angle = np.arange(math.floor(all_turns * samples) + 1) / samples
    options: dict[str, Any] = {"fs": samples, "window": WINDOW, "nperseg": size, "noverlap": size // 2}
    options |= {"nfft": PADDING * size, "detrend": "linear", "scaling": "spectrum"}
    spectrum = {}
    for name in names:
        values = CubicSpline(turned - turned[0], table[name])(angle)
        order, middle, half = signal.spectrogram(values, mode="complex", **options)
        order = order[order <= (shown if highest is None else highest)]
        edges = middle[:, None] + 0.5 * size / samples * np.array([-1.0, 0.0, 1.0])
        # half a line is at its negative order; phases from where the angle is 0, not from the window's begin
        whole = np.where(order > 0.0, 2.0, math.sqrt(2.0)) * half.T[:, : order.size]
        whole *= np.exp(-2j * math.pi * (turned[0] + edges[:, :1]) * order)
        whole[np.abs(whole) < rounding(table, name)] = 0.0
        spectrum[name] = whole
    begin, time, end = np.interp(edges, turned - turned[0], table.time).T
    turned1 = cumulative_trapezoid(table["input_speed"], table.time, initial=0.0)
    angles = np.interp([begin, end], table.time, turned1)
    driven = np.interp([begin, end], table.time, turned if drive is None else drive)
    return Orders(
        of=of,
        turns=per_window,
        order=order,
        time=time,
        speed=(angles[1] - angles[0]) / (end - begin),
        rate=size / samples / (end - begin),
        ratio=(driven[1] - driven[0]) * samples / size,
        spectrum=spectrum,
        units={name: table.units.get(name, "") for name in names},
    )


def rounding(table: Result, name: str) -> float:
    """Amplitude of a signal that is no more than rounding, in its unit."""
    nominal = BY_NAME[name].nominal if name in BY_NAME else None
    return ROUNDING * max(float(np.abs(table[name]).max()), nominal or 0.0)


def orders(
    scene: Scene | Path | str,
    fmu_path: Path | str | None = None,
    *,
    of: str = LINK1,
    signals: Sequence[str] | None = None,
    highest: float | None = None,
    turns: float | None = None,
    begin: float | None = None,
    end: float | None = None,
    progress: Progress | None = None,
    record: Result | None = None,
) -> Orders:
    """Run a scene and find the orders of its signals.

    Args:
        scene: a scene or its file.
        fmu_path: the FMU of the module; None for that of the package.
        of: "link1" or "drive_angle".
        signals: names of outputs, locals or signals of the loop, or of BEARING; without them those of SIGNALS
            that swing.
        highest: as of spectra.
        turns: as of spectra.
        begin: of the part of the run that is looked at, s; by default where it turns.
        end: likewise; by default that of the run.
        progress: told how much of the run is done (0 to 1).
        record: of a run of the scene, with these signals, input_speed and ANGLES, if there is one already.

    Raises:
        SceneError: the scene cannot be, or has no such signal.
        Refused: as spectra; fidelity averaged, which has no pulses; times not in order.
    """
    if of not in BASES:
        raise Refused(must_be("orders", " or ".join(BASES), repr(of)))
    scene, _ = read(scene)
    if scene.parameters().get("fidelity") == AVERAGED:
        demand = must_be("fidelity", "kinematic, rigid or elastic for orders", "averaged")
        raise Refused(f"{demand}: this fidelity level has no pulses")
    last = scene.run.stop_time if end is None else end
    first = begin or 0.0
    if not 0.0 <= first < last <= scene.run.stop_time:
        limits = f"increasing and within 0 to {scene.run.stop_time:g} s"
        raise Refused(must_be("the time range", limits, f"{first:g} to {last:g} s"))
    looked = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    wanted = dict.fromkeys([*(BEARING.get(name, name) for name in looked), "input_speed", *ANGLES])
    scene = scene.replaced(run={"outputs": list(wanted)})
    record = run_scene(scene, fmu_path, progress).record if record is None else record
    mass = scene.parameters().get("imbalance_mass", BY_NAME["imbalance_mass"].start or 0.0)
    forces = {name: -mass * record[BEARING[name]] for name in looked if name in BEARING}
    low, high = np.searchsorted(record.time, (first - 1e-9, last + 1e-9))
    if begin is None:  # without the rest that it begins with
        low += int(np.argmax(np.diff(_turned(record, of)[low:high]) != 0.0))
    columns = {name: values[low:high] for name, values in (record.columns | forces).items()}
    table = Result(columns, record.units | dict.fromkeys(forces, "N"))
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging and signals is None:
        raise Refused(f"all signals are constant: {', '.join(looked)}")
    names = swinging if signals is None else looked
    return spectra(table, _turned(table, of), names, of, highest, turns, _turned(table, DRIVE))


def _turned(table: Result, of: str) -> Array:
    """Turns of link 1 or of the drive up to each row, counted the way it turns."""
    angle, whole = ANGLES[:2] if of == LINK1 else ANGLES[2:]
    turned = table[angle] / math.tau + table[whole]
    return math.copysign(1.0, turned[-1] - turned[0]) * turned
