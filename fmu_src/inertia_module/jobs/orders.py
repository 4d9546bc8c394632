"""Orders of a scene: how much of torques, speeds and forces swings how often a turn of link 1 or the drive.

The scene is run, and what is recorded over time is resampled in equal steps of the angle, so that a machine
that runs up has the same lines as one at a steady speed. Sources: K. R. Fyfe and E. D. S. Munck, Analysis of
computed order tracking, Mechanical Systems and Signal Processing 11 (1997) 187-205; averages over windows
that overlap: P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70-73; sampling and
leakage: A. Brandt, Noise and Vibration Analysis, Wiley 2011, chapters 3, 9 and 12.
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
from ..harness.simulate import Fmu, Result
from ..kernel.codes import AVERAGED, DRIVE_SPEED
from ..loops import ClosedLoop
from ..loops.sources import Sources
from ..memory import Module
from ..scene import Scene
from ..scene.run import start_of
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
# half the width of the main lobe of the Hann window, in 1 / turns of the window
HALF_LOBE = 2
# side lobes within twice that width reach this share of the line, because its speed and height change
SIDE_LOBE = 0.05
# side lobes beyond it reach this multiple of the side lobes of a constant sine
LEAKAGE_FACTOR = 4.0
# harmonics of a torque with jumps fall as 1 / n: aliases of harmonics from 50 on stay below 2 % of the first
ALIASED_HARMONIC = 50.0
MIN_SHARE = 1.0 / ALIASED_HARMONIC
# harmonics of the pulses up to the default maximum order
HARMONICS = 5.0
# communication points of a run for orders
MAX_ROWS = 2_000_000
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


class _Candidate(NamedTuple):
    """A peak of a mean spectrum: its line, the window of its maximum, its family of tracks, and its track."""

    line: Line
    window: int
    family: int
    track: Array


def leakage(distance: float) -> float:
    """Return the largest spectrum of the Hann window around a distance from a sine of amplitude 1.

    Args:
        distance: from the sine, in 1 / length of the window; within the main lobe it is 1.
    """
    return 1.0 / (math.pi * distance * (distance**2 - 1.0)) if distance > HALF_LOBE else 1.0


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
        highest: maximum order of the lines; the spectra extend beyond it by half the width of a line.
        step: s, longest distance of the communication points that were recorded.
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
        up_to_highest = self.amplitude[name][self.order <= self.highest * (1.0 + ROUNDING)]
        return math.sqrt(0.5 * float(np.sum(up_to_highest**2)) / (PADDING * BANDWIDTH))

    def largest(self, number: int = 5) -> dict[str, list[Line]]:
        """The largest lines of each signal, the largest first."""
        return {name: found[:number] for name, found in self._lines.items()}

    @cached_property
    def _lines(self) -> dict[str, list[Line]]:
        """All lines of each signal: picture, table and files ask for them."""
        return {name: self._lines_of(name) for name in self.spectrum}

    def lines(
        self, number: int = 5, hz: bool = False, speed_unit: str = "rad/s"
    ) -> dict[str, dict[str, str]]:
        """Write the largest lines as text, by signal and order.

        Args:
            number: of lines of each signal.
            hz: True to add the frequency, and to write speeds in rpm.
            speed_unit: unit of the speeds of link 1.
        """
        unit_of_speed = "rpm" if hz else speed_unit
        factor = factor_between("rad/s", unit_of_speed)
        texts: dict[str, dict[str, str]] = {}
        for name, lines in self.largest(number).items():
            unit, rows = self.units[name], texts.setdefault(name, {})
            for line in lines:
                several = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else several
                place = f"{line.speed * factor:.4g} {unit_of_speed}"
                place += f", {line.frequency:.4g} Hz" if hz else ""
                maximum = f"maximum {line.greatest:.4g} {unit} at {place}"
                rows[f"order {order}"] = f"{line.amplitude:.4g} {unit}, {maximum}"
        return texts

    def _lines_of(self, name: str) -> list[Line]:
        """Return the lines of a signal, the largest first.

        A line is constant, or shifts with the pinion shaft, alone or on top of a turn of link 1. Each peak is
        followed along all of these tracks and belongs to the track with the largest amplitude. Peaks that a
        larger line or the trend explains by leakage of the window, and lines below MIN_SHARE of the largest
        one, which may be aliases, are left out.
        """
        candidates = self._candidates(name)
        candidates.sort(key=lambda one: one.line.amplitude / (BENDING if one.family else 1.0), reverse=True)
        lines = list[_Candidate]()
        for one in candidates:
            if not any(self._explains(larger, one) for larger in lines):
                lines.append(one)
        listed = [
            one.line
            for one in lines
            if one.line.order > self._near * (1.0 + ROUNDING)
            and one.line.order <= self.highest + 0.5 * self.order[1]
        ]
        largest = max((line.amplitude for line in listed), default=0.0)
        return sorted(
            (line for line in listed if line.amplitude >= MIN_SHARE * largest),
            key=lambda line: -line.amplitude,
        )

    @property
    def _near(self) -> float:
        """Distance of two lines that the window separates, in orders; below it there is only the trend."""
        return 2 * HALF_LOBE / self.turns

    def _candidates(self, name: str) -> list[_Candidate]:
        """Return the peaks of the mean spectrum of a signal along each family of tracks."""
        rows, near = self.waterfall[name], self._near
        candidates = list[_Candidate]()
        ratio = self.ratio[:, None] / (self.ratio.mean() or 1.0)  # in lock-up the drive stands still
        for family, (turn, bend) in enumerate([(0.0, ratio**0), (0.0, ratio), (1.0, ratio), (-1.0, ratio)]):
            tracks = turn + (self.order - turn) * bend
            pairs = zip(tracks, rows, strict=True)
            heights = [np.interp(track, self.order, row, right=0.0) for track, row in pairs]
            amplitude = np.sqrt(np.mean(np.square(heights), axis=0))
            places, _ = signal.find_peaks(amplitude, distance=HALF_LOBE * PADDING)
            for track in tracks.T[places]:
                if track.min() >= 0.0 and (family == 0 or np.ptp(track) > 0.5 * near):
                    candidates.append(_Candidate(*self._line(name, track), family, track))
        return candidates

    def _explains(self, larger: _Candidate, other: _Candidate) -> bool:
        """Return True if a peak is leakage of a larger one, or a part of the same line.

        Args:
            larger: peak with the larger amplitude.
            other: peak that may be a side lobe.
        """
        centre, height = float(larger.track[other.window]), larger.line.amplitude
        if larger.line.order <= self._near * (1.0 + ROUNDING):  # the trend: a line of order 0
            centre, height = 0.0, height / min(leakage(centre * self.turns), 1.0)
        distance = abs(centre - other.line.order)
        if distance <= self._near:
            return other.family != larger.family or other.line.amplitude <= SIDE_LOBE * height
        return other.line.amplitude <= LEAKAGE_FACTOR * leakage(distance * self.turns) * height

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
        table: of the signals over time, with input_speed, r rows.
        turned: turns up to each row, rising, shape (r,).
        names: of the signals.
        of: what turned counts, LINK1 or DRIVE.
        highest: maximum order; by default the highest that the rows show.
        turns: in a window; windows overlap by half. By default a quarter of all there are, at most TURNS.
        drive: turns of the pinion shaft up to each row, for lines that shift with it.

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
    limit = shown if highest is None else highest
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
        order = order[order <= limit + HALF_LOBE / per_window]
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
        highest=limit,
        step=float(np.diff(table.time).max()),
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
        highest: maximum order; by default HARMONICS harmonics of the pulses. Where the steps of the scene are
            too long for it, the module is run in shorter ones; drive, load and controller keep theirs.
        turns: as of spectra.
        begin: of the part of the run that is looked at, s; by default where it turns.
        end: likewise; by default that of the run.
        progress: told how much of the run is done (0 to 1).
        record: of a run of the scene, with these signals, input_speed and ANGLES, if there is one already; it
            is used if its steps are short enough.

    Raises:
        SceneError: the scene cannot be, or has no such signal.
        Refused: as spectra; fidelity averaged, which has no pulses; times not in order; a signal that the
            scene computes too seldom.
    """
    if of not in BASES:
        raise Refused(must_be("of (reference angle)", " or ".join(BASES), repr(of)))
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
    outputs = dict.fromkeys([*(BEARING.get(name, name) for name in looked), "input_speed", *ANGLES])
    scene = scene.replaced(run={"outputs": list(outputs)})
    recorder = _Recorder(scene, fmu_path, first, last, progress)
    record = recorder.record() if record is None else record
    first_row = recorder.first_row(record, of if begin is None else None)
    sampling = _sampling(scene, recorder.part(record, first_row), of, highest)
    substeps = recorder.substeps(sampling, looked)
    if substeps > 1:
        record = recorder.record(substeps)
        first_row = recorder.first_row(record, of if begin is None else None)
    mass = scene.parameters().get("imbalance_mass", BY_NAME["imbalance_mass"].start or 0.0)
    forces = {name: -mass * record[BEARING[name]] for name in looked if name in BEARING}
    whole = Result(record.columns | forces, record.units | dict.fromkeys(forces, "N"))
    table = recorder.part(whole, first_row)
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging and signals is None:
        raise Refused(f"all signals are constant: {', '.join(looked)}")
    names = swinging if signals is None else looked
    return spectra(table, _turned(table, of), names, of, sampling.highest, turns, _turned(table, DRIVE))


class _Sampling(NamedTuple):
    """Maximum order, and the longest step, s, that records it without aliases."""

    highest: float
    step: float


def _sampling(scene: Scene, table: Result, of: str, highest: float | None) -> _Sampling:
    """Choose the maximum order and the sampling from the fastest pulses of a run.

    Nyquist's condition, with a margin, holds for the maximum order. Pulses have jumps, hence no highest
    harmonic: harmonics below ALIASED_HARMONIC must not fold down to the maximum order.

    Args:
        scene: the scene.
        table: of its run, with the columns ANGLES.
        of: LINK1 or DRIVE.
        highest: maximum order; None for HARMONICS harmonics of the pulses.
    """
    rate, turning = (_fastest(table, base) for base in (of, DRIVE))
    module = Module("plain")
    module.check(**scene.parameters())
    d = module.derived
    # orders of the pinion shaft: 1 of a planar module; 2, s and their sum of a bevel module
    pulses = 1.0 if d.planar else 2.0 + d.s
    limit = HARMONICS * pulses * (d.k if of == LINK1 else 1.0) if highest is None else highest
    if not (math.isfinite(limit) and limit > 0.0):
        raise Refused(must_be("highest (maximum order)", "above 0", f"{limit:g}"))
    sampling = max(RECORDED * limit * rate, limit * rate + ALIASED_HARMONIC * pulses * turning)
    return _Sampling(limit, 1.0 / sampling if sampling > 0.0 else math.inf)


def _fastest(table: Result, of: str) -> float:
    """Return the largest number of turns a second between two rows."""
    return float(np.abs(np.diff(_turned(table, of)) / np.diff(table.time)).max())


class _Recorder(NamedTuple):
    """Runs of a scene up to the end of a time range.

    Attributes:
        scene: the scene, with the outputs to record.
        fmu_path: the FMU of the module; None for that of the package.
        first, last: time range, s.
        progress: called with the share of a run that is done, 0 to 1.
    """

    scene: Scene
    fmu_path: Path | str | None
    first: float
    last: float
    progress: Progress | None

    def record(self, substeps: int = 1) -> Result:
        """Run the scene and record its outputs.

        Args:
            substeps: rows of a communication step; drive, load and controller keep the step of the scene.
        """
        step = self.scene.run.communication_step
        stop = min(self.scene.run.stop_time, math.ceil(self.last / step - ROUNDING) * step)
        values, inputs = start_of(self.scene)
        with Fmu(self.fmu_path, values, inputs, stop_time=stop) as fmu:
            loop = ClosedLoop(fmu, self.scene.surroundings, self.scene.run.outputs, self.scene.signal_units)
            return loop.run(stop, self.progress, substeps)

    def first_row(self, record: Result, of: str | None) -> int:
        """Return the first row of the time range.

        Args:
            record: of a run.
            of: LINK1 or DRIVE to leave out the time before it begins to turn, or None.
        """
        low, high = np.searchsorted(record.time, (self.first - 1e-9, self.last + 1e-9))
        return int(low) + (int(np.argmax(np.diff(_turned(record, of)[low:high]) != 0.0)) if of else 0)

    def part(self, record: Result, first_row: int) -> Result:
        """Return the rows of the time range from a row on."""
        end = int(np.searchsorted(record.time, self.last + 1e-9))
        return Result({name: values[first_row:end] for name, values in record.columns.items()}, record.units)

    def substeps(self, sampling: _Sampling, names: Sequence[str]) -> int:
        """Return the number of rows a communication step that a sampling needs.

        Args:
            sampling: maximum order and longest distance of the rows.
            names: signals to analyse.

        Raises:
            Refused: a run would be too long, or the scene computes a signal only once a step.
        """
        step = self.scene.run.communication_step
        number = math.ceil(step / sampling.step - ROUNDING)
        if number <= 1:
            return 1
        most = MAX_ROWS * sampling.step
        if self.last > most:
            raise Refused(
                f"orders up to {sampling.highest:.4g} need steps of {_step_text(sampling.step)}, more than"
                f" {MAX_ROWS:,} in {self.last:g} s; lower highest, or end the time range before {most:.3g} s"
            )
        surroundings, parameters = self.scene.surroundings, self.scene.parameters()
        if isinstance(surroundings, Sources):
            return number
        held = [name for name in names if name in surroundings.output_labels]
        if parameters.get("input_hold", 0.0) and parameters.get("drive", DRIVE_SPEED) == DRIVE_SPEED:
            held.append("omega1 with mechanism.input_hold = linear")
        if held:
            raise Refused(
                f"orders up to {sampling.highest:.4g} need run.communication_step ="
                f" {_step_text(0.9 * sampling.step)} or less (got {step:g} s): the scene computes"
                f" {', '.join(held)} once per communication step"
            )
        return number


def _step_text(step: float) -> str:
    """Write a step, rounded down to two digits."""
    digits = 10.0 ** (math.floor(math.log10(step)) - 1)
    return f"{math.floor(step / digits) * digits * 1e3:.3g} ms"


def _turned(table: Result, of: str) -> Array:
    """Turns of link 1 or of the drive up to each row, counted the way it turns."""
    angle, whole = ANGLES[:2] if of == LINK1 else ANGLES[2:]
    turned = table[angle] / math.tau + table[whole]
    return math.copysign(1.0, turned[-1] - turned[0]) * turned
