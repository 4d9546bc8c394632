"""Orders of a scene: how much of torques, speeds and forces swings how often a turn of link 1, or a pulse.

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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline

from ..common.errors import Refused, must_be
from ..common.extras import library
from ..common.files import write_atomically, write_text
from ..common.terminal import Progress
from ..common.units import factor_between
from ..contract.variables import BY_NAME
from ..harness.results import write_columns, write_mat
from ..harness.simulate import Result, communication_points
from ..kernel.codes import AVERAGED
from ..kernel.inertia import reduced_inertia
from ..loops.sources import evaluate
from ..memory import Module
from ..scene import Scene, run_scene
from .evaluation import read

Array = NDArray[np.float64]

# what an order is counted over
LINK1, PULSES = "link1", "pulses"
BASES = {LINK1: "turn of link 1", PULSES: "pulse"}
# what pulses follow from; an angle comes without whole turns, and these
DRIVE = "drive"
ANGLES = ("input_angle", "input_turns", "drive_angle", "drive_turns")
# steps that are tried before the run
TRIED = 20
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
WINDOW = "hann"
# a spectrum is drawn out to so many times the points, so that a line between two of them is not missed
PADDING = 4
# half the width of a line, in 1 / turns of the window, and the height of what the window makes beside it
HALF_LOBE, SIDE_LOBE = 2, 0.05
# a line that bends is looked for so far beside itself, relative
BESIDE = 0.03
# so many places for each line wanted are looked at, for a bending one takes several
SEARCHED = 4
# a line bends if along its bend there is so many times more of the signal than along its order
BENDING = 1.1
# turns (or pulses) in a window: at most where nothing is asked for, and at least
TURNS, LEAST_TURNS = 32.0, 4.0
# below this share of its largest or its nominal value a signal is rounding, and what is beyond a limit
ROUNDING = 1e-8
# units of a UFF file, and what all its amplitudes have in common: over orders, speed on the z axis
UFF_UNITS: dict[str, Any] = {"type": 164, "units_code": 1, "units_description": "SI", "temp_mode": 1}
UFF_UNITS |= {"length": 1.0, "force": 1.0, "temp": 1.0, "temp_offset": 273.15}
UFF_LINES: dict[str, Any] = {"type": 58, "func_type": 0, "ref_node": 0, "ref_dir": 0}
UFF_LINES |= {"abscissa_spec_data_type": 20, "abscissa_spacing": 1, "orddenom_spec_data_type": 0}
UFF_LINES |= {"z_axis_spec_data_type": 19, "z_axis_axis_lab": "speed", "z_axis_axis_units_lab": "rpm"}
# of the axes in files
UNITS = {"time": "s", "speed": "rad/s", "rpm": "rpm", "frequency": "Hz"}


class Line(NamedTuple):
    """A line of a spectrum.

    Attributes:
        order: cycles a turn (a pulse). amplitude: RMS average over the windows, in the unit of the signal.
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


@dataclass(frozen=True)
class Orders:
    """Spectra over orders; n orders, m windows.

    Attributes:
        of: what an order is counted over, LINK1 or PULSES. turns: of that in a window.
        order: cycles a turn (a pulse), shape (n,).
        time, speed: at the middle of each window, s, and mean speed of link 1 in it, rad/s, shape (m,).
        rate: turns (pulses) a second in each window, Hz: of order 1, shape (m,).
        ratio: turns of the drive a turn (a pulse) in each window, shape (m,): with it lines bend.
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
    # lines that were looked for, by how many of each signal: picture, table and files ask for the same
    _known: dict[int, dict[str, list[Line]]] = field(default_factory=dict, init=False, repr=False)

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
        window = signal.get_window(WINDOW, 4096)
        bandwidth = window.size * np.sum(window**2) / np.sum(window) ** 2  # of noise, in bins
        return math.sqrt(0.5 * float(np.sum(self.amplitude[name] ** 2)) / (PADDING * bandwidth))

    def largest(self, number: int = 5) -> dict[str, list[Line]]:
        """The largest lines of each signal, the largest first."""
        if number not in self._known:
            self._known[number] = {name: self._lines(name, number) for name in self.amplitude}
        return self._known[number]

    def lines(self, number: int = 5, hz: bool = False) -> dict[str, dict[str, str]]:
        """The largest lines as text, by signal and order; hz: speeds in rpm, with the frequency."""
        rpm = factor_between("rad/s", "rpm")
        found: dict[str, dict[str, str]] = {}
        for name, lines in self.largest(number).items():
            unit, rows = self.units[name], found.setdefault(name, {})
            for line in lines:
                several = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else several
                place = f"{line.speed:.4g} rad/s"
                if hz:
                    place = f"{line.speed * rpm:.4g} rpm, {line.frequency:.4g} Hz"
                most = f"most at {place}: {line.greatest:.4g} {unit}"
                rows[f"order {order}"] = f"{line.amplitude:.4g} {unit}, {most}"
        return found

    @property
    def bends(self) -> bool:
        """Tell whether lines bend that are straight over pulses."""
        return any(line.low < line.high for lines in self.largest().values() for line in lines)

    def _lines(self, name: str, number: int) -> list[Line]:
        """The largest lines of a signal; all places that a bending one passes are one line."""
        found: list[tuple[Line, Array, int]] = []
        for place in self._places(self.amplitude[name])[: SEARCHED * number]:
            order = float(self.order[place])
            straight = self._along(name, np.full(self.ratio.size, order), 0.5 / self.turns)[0]
            window = int(np.argmax(straight))
            if any(one.low < one.high and self._meets(along, order, window) for one, along, _ in found):
                continue  # a line that bends passes here
            line, track, at = self._line(name, place)
            if line.low < line.high:
                near = [one for one, along, _ in found if self._meets(along, track[at], at)]
                if any(one.amplitude >= line.amplitude for one in near):
                    continue
                found = [one for one in found if not self._meets(track, one[0].order, one[2])]
            found.append((line, track, at))
        lines = sorted((line for line, _, _ in found), key=lambda line: -line.amplitude)
        return lines[:number]

    def _meets(self, track: Array, order: float, window: int) -> bool:
        """Tell whether a line of these orders is as near to an order in a window as the window can tell."""
        return abs(order - float(track[window])) <= 2 * HALF_LOBE / self.turns

    def _places(self, amplitude: Array) -> list[int]:
        """Find the lines of a spectrum, the largest first; without side lobes and trend."""
        found: list[int] = []
        places, _ = signal.find_peaks(amplitude, distance=HALF_LOBE * PADDING)
        for place in places[np.argsort(amplitude[places])[::-1]].tolist():
            near = (larger for larger in found if abs(place - larger) <= 2 * HALF_LOBE * PADDING)
            if self.order[place] * self.turns >= HALF_LOBE and all(
                amplitude[place] > SIDE_LOBE * amplitude[larger] for larger in near
            ):
                found.append(place)
        return found

    def _along(self, name: str, track: Array, reach: float) -> tuple[Array, Array]:
        """Amplitude and order, in each window, of a line whose order in it is known within a reach."""
        beside = np.abs(self.order - track[:, None]) <= reach
        places = np.where(beside, self.waterfall[name], -1.0).argmax(axis=1)
        return self.waterfall[name][np.arange(places.size), places], self.order[places]

    def _line(self, name: str, place: int) -> tuple[Line, Array, int]:
        """The line at a place of a spectrum, its order in each window, and the window where it is greatest.

        It bends with the drive, alone or on top of a turn of link 1, where more of the signal is along that.
        """
        order, amplitude = float(self.order[place]), float(self.amplitude[name][place])
        track = np.full(self.ratio.size, order)
        heights, orders = self._along(name, track, max(BESIDE * order, 1.0 / self.turns))
        window = int(np.argmax(heights))
        share, there = self.ratio / self.ratio[window], float(orders[window])
        most = BENDING * _rms(self._along(name, track, 0.5 / self.turns)[0])
        for turning in (0.0, 1.0, -1.0):
            bent = (there - turning) * share + turning
            found, near = self._along(name, bent, 0.5 / self.turns)
            bends = np.ptp(bent) > HALF_LOBE / self.turns and bent.min() > HALF_LOBE / self.turns
            if bends and _rms(found) > most:
                track, heights, orders, amplitude, most = bent, found, near, _rms(found), _rms(found)
        at = int(np.argmax(heights))
        largest = self.spectrum[name][at, np.searchsorted(self.order, orders[at])]
        values = (track[at], amplitude, heights[at], self.speed[at], track.min(), track.max())
        return Line(*map(float, (*values, self.rate[at] * track[at], np.angle(largest)))), track, at

    def as_dict(self) -> dict[str, Any]:
        """The largest orders of each signal, for machines."""
        return {
            "of": BASES[self.of],
            "turns": self.turns,
            "windows": self.time.size,
            "bends": self.bends,
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
        sets, common = [UFF_UNITS], {**UFF_LINES, "x": self.order, "id2": f"cycles a {BASES[self.of]}"}
        for node, (name, rows) in enumerate(self.spectrum.items(), 1):
            # directions of forces are 1 to 3, of moments 4 to 6
            component = re.search("_(force|moment)_([xyz])$", name)
            side = "xyz".index(component[2]) + (1 if component[1] == "force" else 4) if component else 0
            one = {**common, "id1": name, "rsp_node": node, "rsp_dir": side}
            one |= {"ordinate_axis_lab": name[:20], "ordinate_axis_units_lab": self.units[name] or "NONE"}
            for row, time, rpm in zip(rows, self.time, self.rpm, strict=True):
                sets.append({**one, "id3": f"at {time:g} s", "data": row, "z_axis_value": rpm})
        with tempfile.TemporaryDirectory() as folder:
            whole = Path(folder) / "orders.uff"
            library("pyuff", "jobs").UFF(str(whole)).write_sets(sets, "overwrite")
            write_atomically(path, whole.read_bytes())
        return path


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


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
        table: of the signals over time, with input_speed, r rows. turned: turns (pulses) up to each row,
            rising, shape (r,). names: of the signals.
        of: what turned counts. highest: order; by default the highest that the rows show.
        turns: in a window; windows overlap by half. By default a quarter of all there are, at most TURNS.
        drive: turns of it up to each row, where lines that bend with it are to be found.

    Raises:
        Refused: turned does not rise, is too little for a window, or rows are too far apart.
    """
    highest, per_window = highest_order(table.time, turned, highest), turns_of_window(turned, of, turns)
    steps = np.diff(turned)
    samples = math.ceil(1.0 / max(float(steps.min()), float(steps.max()) / FINEST))
    size = round(per_window * samples)
    angle = np.arange(math.floor((turned[-1] - turned[0]) * samples) + 1) / samples
    options: dict[str, Any] = {"fs": samples, "window": WINDOW, "nperseg": size, "noverlap": size // 2}
    options |= {"nfft": PADDING * size, "detrend": "linear", "scaling": "spectrum"}
    spectrum = {}
    for name in names:
        values = CubicSpline(turned - turned[0], table[name])(angle)
        order, middle, half = signal.spectrogram(values, mode="complex", **options)
        order = order[order <= highest]
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
        of,
        per_window,
        order,
        time,
        (angles[1] - angles[0]) / (end - begin),
        np.ptp(edges[:, ::2], axis=1) / (end - begin),
        (driven[1] - driven[0]) / np.ptp(edges[:, ::2], axis=1),
        spectrum,
        {name: table.units.get(name, "") for name in names},
    )


def turns_of_window(turned: Array, of: str, turns: float | None) -> float:
    """Turns in a window, as asked for or as there are; see spectra."""
    all_turns = float(turned[-1] - turned[0])
    per_window = min(TURNS, max(LEAST_TURNS, all_turns / 4.0)) if turns is None else turns
    if not LEAST_TURNS <= per_window <= all_turns:
        counted = f"of {LEAST_TURNS:g} to the {all_turns:.4g} (each a {BASES[of]}) that there are"
        raise Refused(must_be("turns of a window", counted, f"{per_window:.4g}"))
    return per_window


def highest_order(time: Array, turned: Array, highest: float | None) -> float:
    """The highest order, as asked for or as the rows allow; see spectra."""
    still = np.flatnonzero(np.diff(turned) <= 0.0)
    if still.size:
        raise Refused(
            f"the angle that orders are counted over must rise, does not at {time[still[0]]:g} s: choose"
            " other times"
        )
    shown = 1.0 / (RECORDED * float(np.diff(turned).max()))
    if highest is not None and not 0.0 < highest <= shown * (1.0 + ROUNDING):
        raise Refused(
            f"highest order must be above 0 and at most {shown:.4g}, is {highest:g}: with a shorter"
            " run.communication_step there are higher ones"
        )
    return shown if highest is None else highest


def rounding(table: Result, name: str) -> float:
    """Amplitude of a signal that is no more than rounding, in its unit."""
    nominal = BY_NAME[name].nominal if name in BY_NAME else None
    return ROUNDING * max(float(np.abs(table[name]).max()), nominal or 0.0)


def pulses_a_turn(parameters: Mapping[str, float]) -> float:
    """Pulses a turn of the drive angle q, mean over its period: how often the reduced inertia I(q) begins to
    rise, for its slope is what pushes link 2.

    Args:
        parameters: of the module, those that differ from the defaults.
    """
    module = _module(parameters)
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, math.tau * turns, 720 * turns, endpoint=False)
    slopes = [reduced_inertia(module.derived, float(q))[1] for q in angles]  # type: ignore[no-untyped-call]
    rising = np.array(slopes) > 0.0
    return float(np.sum(rising & ~np.roll(rising, 1))) / turns


def _module(parameters: Mapping[str, float]) -> Module:
    """The module with these parameters, by which its constants are read."""
    module = Module("plain")
    module.check(**parameters)
    return module


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
        of: "link1" or "pulses".
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
        raise Refused(
            "fidelity must be kinematic, rigid or elastic for orders, is averaged: it has no pulses"
        )
    last = scene.run.stop_time if end is None else end
    first = begin or 0.0
    if not 0.0 <= first < last <= scene.run.stop_time:
        limits = f"in order and within 0 to {scene.run.stop_time:g} s"
        raise Refused(must_be("times", limits, f"{first:g} to {last:g} s"))
    looked = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    wanted = dict.fromkeys([*(BEARING.get(name, name) for name in looked), "input_speed", *ANGLES])
    scene = scene.replaced(run={"outputs": list(wanted)})

    def within(time: Array, turned: Array) -> slice:
        """Rows that are looked at: without the rest that they begin with, if no begin is given."""
        low, high = np.searchsorted(time, (first - 1e-9, last + 1e-9))
        turning = np.diff(turned[low:high]) != 0.0
        return slice(low + (int(np.argmax(turning)) if begin is None else 0), high)

    # what is sure to be refused after the run is refused now: by the speed that is given, else by first steps
    step, given = scene.run.communication_step, scene.prescribed.get("omega1")
    if of == LINK1 and given is not None and not scene.parameters().get("input_hold"):
        times = communication_points(scene.run.stop_time, step)
        turned = np.cumsum([evaluate(given, at) for at in times]) * step / math.tau
        turned = np.append(0.0, turned[:-1])  # the speed is held over a step
        part = within(times, turned)
        turned = turned[part] * math.copysign(1.0, turned[part][-1] - turned[part][0])
        highest_order(times[part], turned, highest)
        turns_of_window(turned, of, turns)
    elif record is None and first == 0.0 and TRIED * step < last:
        table = run_scene(scene.replaced(run={"stop_time": TRIED * step}), fmu_path).record
        turned = _turned(table, of, scene)
        part = within(table.time, turned)
        if begin is not None or np.ptp(turned) > 0.0:
            highest_order(table.time[part], turned[part], highest)
    record = run_scene(scene, fmu_path, progress).record if record is None else record
    part = within(record.time, _turned(record, of, scene))
    columns, units = {name: values[part] for name, values in record.columns.items()}, dict(record.units)
    for name in set(looked) & set(BEARING):
        columns[name] = -_module(scene.parameters())["imbalance_mass"] * columns[BEARING[name]]
        units[name] = "N"
    table = Result(columns, units)
    turned = _turned(table, of, scene)
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging and signals is None:
        raise Refused(f"signals must swing, of {', '.join(looked)} none does")
    drive = _turned(table, DRIVE, scene)
    names = swinging if signals is None else looked
    return spectra(table, turned, names, of, highest, turns, drive)


def _turned(table: Result, of: str, scene: Scene) -> Array:
    """Turns of link 1, of the drive, or pulses, up to each row, counted the way it turns."""
    angle, whole = ANGLES[:2] if of == LINK1 else ANGLES[2:]
    turned = table[angle] / math.tau + table[whole]
    each = pulses_a_turn(scene.parameters()) if of == PULSES else 1.0
    return each * math.copysign(1.0, turned[-1] - turned[0]) * turned
