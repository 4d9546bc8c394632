"""Order analysis of a scene: amplitudes of torques, speeds and forces over cycles per revolution.

The scene is run, and its record over time is resampled in equal steps of the angle of link 1 or of the pinion
shaft. A run-up then has the same lines as a steady speed. Sources: K. R. Fyfe and E. D. S. Munck, Analysis of
computed order tracking, Mechanical Systems and Signal Processing 11 (1997) 187-205; averages over overlapping
windows: P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70-73; sampling and leakage:
    A.
Brandt, Noise and Vibration Analysis, Wiley 2011, chapters 3, 9 and 12.
"""

from __future__ import annotations

import json
import math
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

from ..common.deprecated import renamed_arguments
from ..common.equality import ByContent
from ..common.errors import ParameterError, listed, must_be
from ..common.files import write_text
from ..common.terminal import Progress
from ..common.units import factor_between
from ..driveline import ClosedLoop
from ..driveline.sources import Sources
from ..fmi.results import write_columns, write_mat
from ..fmi.simulate import Fmu, Result
from ..interface.variables import BY_NAME
from ..kernel.codes import AVERAGED, DRIVE_SPEED
from ..model import Module
from ..scene import Scene
from ..scene.run import start_of
from .evaluation import read

Array = NDArray[np.float64]

# reference angles of orders
LINK1, DRIVE = "link1", "drive_angle"
BASES = {LINK1: "revolution of link 1", DRIVE: "revolution of the pinion shaft"}
# angle within a revolution, and number of revolutions, of link 1 and of the pinion shaft
ANGLES = ("input_angle", "input_turns", "drive_angle", "drive_turns")
# components of the force of unbalanced mass 0 on its bearing, and the accelerations that cause them
BEARING = {f"satellite_force_{axis}": f"imbalance_acceleration_{axis}" for axis in "xyz"}
# default signals
SIGNALS = (
    *("input_torque", "output_torque", "input_speed", "omega_out"),
    *("shaking_force_x", "shaking_force_y", "shaking_force_z", *BEARING),
)
# recorded points per cycle of the maximum order (Nyquist minimum: 2)
POINTS_PER_CYCLE = 2.56
# Resampling uses the sampling at the minimum speed, because coarser sampling would cause aliases. This is the
# maximum ratio to the sampling at the maximum speed.
MAX_REFINEMENT = 10.0
# window, and its noise bandwidth in 1 / revolutions
WINDOW, BANDWIDTH = "hann", 1.5
# Zero padding factor of spectra, so that lines between two points are visible.
PADDING = 4
# half width of the main lobe of the Hann window, in 1 / revolutions of the window
HALF_LOBE = 2
# Side lobes within twice this width reach this fraction of the line, because speed and amplitude change.
SIDE_LOBE = 0.05
# More distant side lobes reach this multiple of the side lobes of a constant sine.
LEAKAGE_FACTOR = 4.0
# Harmonics of a torque with jumps decrease as 1 / n, so aliases from n = 50 stay below 2 % of the first.
ALIASED_HARMONIC = 50.0
MIN_SHARE = 1.0 / ALIASED_HARMONIC
# harmonics of the pulses up to the default maximum order
HARMONICS = 5.0
# maximum number of communication points of a run for orders
MAX_ROWS = 2_000_000
# minimum ratio of the amplitude along a shifting line to the amplitude along a constant order
SHIFT_FACTOR = 1.1
# default maximum and absolute minimum of the revolutions in a window
TURNS, MIN_TURNS = 32.0, 4.0
# relative round-off of a signal (of its maximum or nominal value) and of limits
ROUNDING = 1e-8
# units of the axes in files
UNITS = {"time": "s", "speed": "rad/s", "rpm": "rpm", "frequency": "Hz"}


class Line(NamedTuple):
    """Order line of a spectrum.

    Attributes:
        order: Order in the window of the maximum, cycles per revolution.
        amplitude: RMS average over the windows, in the unit of the signal.
        greatest: Maximum amplitude of all windows.
        speed: Speed of link 1 in the window of the maximum, rad/s.
        low: Minimum order of a line that shifts with the speed ratio, otherwise the order.
        high: Maximum order of such a line, otherwise the order.
        frequency: Frequency in the window of the maximum, Hz.
        phase: Phase in the window of the maximum, rad, as in Orders.
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
    """Peak of a mean spectrum.

    Attributes:
        line: Line of the peak.
        window: Window of its maximum.
        family: Family of its track: 0 for constant orders, 1 to 3 for orders that shift with the pinion
            shaft.
        track: Order in each window.
    """

    line: Line
    window: int
    family: int
    track: Array


def leakage(distance: float) -> float:
    """Return the maximum spectrum of the Hann window near a distance from a sine of amplitude 1.

    Args:
        distance: Distance from the sine, in 1 / length of the window. Within the main lobe the result is 1.
    """
    return 1.0 / (math.pi * distance * (distance**2 - 1.0)) if distance > HALF_LOBE else 1.0


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
        return {name: self._lines_of(name) for name in self.spectrum}

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
            unit, rows = self.units[name], texts.setdefault(name, {})
            for line in lines:
                span = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else span
                place = f"{line.speed * factor:.4g} {unit_of_speed}"
                place += f", {line.frequency:.4g} Hz" if hz else ""
                maximum = f"maximum {line.greatest:.4g} {unit} at {place}"
                rows[f"order {order}"] = f"{line.amplitude:.4g} {unit}, {maximum}"
        return texts

    def _lines_of(self, name: str) -> list[Line]:
        """Return the lines of a signal in descending order of amplitude.

        A line is constant, or shifts with the pinion shaft, alone or added to a revolution of link 1. Each
        peak is evaluated along all of these tracks and belongs to the track with the maximum amplitude. Peaks
        that are leakage of a larger line or of the trend are omitted. Lines below MIN_SHARE of the maximum,
        which can be aliases, are also omitted.
        """
        candidates = self._candidates(name)
        candidates.sort(
            key=lambda peak: peak.line.amplitude / (SHIFT_FACTOR if peak.family else 1.0), reverse=True
        )
        lines = list[_Candidate]()
        for peak in candidates:
            if not any(self._explains(larger, peak) for larger in lines):
                lines.append(peak)
        in_range = [
            peak.line
            for peak in lines
            if peak.line.order > self._resolution * (1.0 + ROUNDING)
            and peak.line.order <= self.highest + 0.5 * self.order[1]
        ]
        maximum = max((line.amplitude for line in in_range), default=0.0)
        return sorted(
            (line for line in in_range if line.amplitude >= MIN_SHARE * maximum),
            key=lambda line: -line.amplitude,
        )

    @property
    def _resolution(self) -> float:
        """Return the minimum distance of separate lines, in orders; lower orders are the trend."""
        return 2 * HALF_LOBE / self.turns

    def _candidates(self, name: str) -> list[_Candidate]:
        """Return the peaks of the mean spectrum of a signal along each family of tracks."""
        rows, resolution = self.waterfall[name], self._resolution
        candidates = list[_Candidate]()
        ratio = self.ratio[:, None] / (self.ratio.mean() or 1.0)  # the pinion shaft is at rest in lock-up
        for family, (offset, factor) in enumerate(
            [(0.0, ratio**0), (0.0, ratio), (1.0, ratio), (-1.0, ratio)]
        ):
            tracks = offset + (self.order - offset) * factor
            pairs = zip(tracks, rows, strict=True)
            heights = [np.interp(track, self.order, row, right=0.0) for track, row in pairs]
            amplitude = np.sqrt(np.mean(np.square(heights), axis=0))
            places, _ = signal.find_peaks(amplitude, distance=HALF_LOBE * PADDING)
            for track in tracks.T[places]:
                if track.min() >= 0.0 and (family == 0 or np.ptp(track) > 0.5 * resolution):
                    candidates.append(_Candidate(*self._line(name, track), family, track))
        return candidates

    def _explains(self, larger: _Candidate, other: _Candidate) -> bool:
        """Return True if a peak is leakage of a larger peak, or part of the same line.

        Args:
            larger: Peak with the larger amplitude.
            other: Possible side lobe.
        """
        centre, height = float(larger.track[other.window]), larger.line.amplitude
        if larger.line.order <= self._resolution * (1.0 + ROUNDING):  # the trend is a line of order 0
            centre, height = 0.0, height / min(leakage(centre * self.turns), 1.0)
        distance = abs(centre - other.line.order)
        if distance <= self._resolution:
            return other.family != larger.family or other.line.amplitude <= SIDE_LOBE * height
        return other.line.amplitude <= LEAKAGE_FACTOR * leakage(distance * self.turns) * height

    def _line(self, name: str, track: Array) -> tuple[Line, int]:
        """Return the line along a track, from the closest points of the spectrum, and its window.

        Args:
            name: Name of the signal.
            track: Order in each window, shape (m,).
        """
        places = np.add(np.rint(track[:, None] / self.order[1]), [-1, 0, 1]).astype(int)
        neighbours = np.take_along_axis(self.spectrum[name], places.clip(0, self.order.size - 1), axis=1)
        peaks = neighbours[np.arange(track.size), np.abs(neighbours).argmax(axis=1)]
        amplitudes = np.abs(peaks if np.ptp(track) > 0.0 else neighbours[:, 1])
        at = int(np.abs(peaks).argmax())
        line = Line(
            order=float(track[at]),
            amplitude=float(np.sqrt(np.mean(amplitudes**2))),
            greatest=float(np.abs(peaks[at])),
            speed=float(self.speed[at]),
            low=float(track.min()),
            high=float(track.max()),
            frequency=float(self.rate[at] * track[at]),
            phase=float(np.angle(peaks[at])),
        )
        return line, at

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


def spectra(
    table: Result,
    turned: Array,
    names: Sequence[str],
    of: str = LINK1,
    highest: float | None = None,
    turns: float | None = None,
    drive: Array | None = None,
) -> Orders:
    """Compute the order spectra of recorded signals.

    Args:
        table: Record of the signals and input_speed, r rows.
        turned: Revolutions up to each row, increasing, shape (r,).
        names: Names of the signals.
        of: Reference angle of turned, LINK1 or DRIVE.
        highest: Maximum order; None for the maximum that the rows resolve.
        turns: Revolutions in a window; None for a quarter of all revolutions, between MIN_TURNS and TURNS.
            Windows overlap by half.
        drive: Revolutions of the pinion shaft up to each row, for lines that shift with it.

    Raises:
        ParameterError: turned does not increase or is too short for a window, or the rows are too far apart.
    """
    steps, all_turns = np.diff(turned), float(turned[-1] - turned[0])
    constant_rows = np.flatnonzero(steps <= 0.0)
    if constant_rows.size:
        at = f"constant or decreasing at {table.time[constant_rows[0]]:g} s"
        raise ParameterError(
            f"{must_be('the angle that orders refer to', 'increasing', at)}; choose another time range"
        )
    resolved = 1.0 / (POINTS_PER_CYCLE * float(steps.max()))
    if highest is not None and not 0.0 < highest <= resolved * (1.0 + ROUNDING):
        demand = must_be("highest (maximum order)", f"above 0 and at most {resolved:.4g}", f"{highest:g}")
        raise ParameterError(f"{demand}; a shorter run.communication_step allows higher orders")
    limit = resolved if highest is None else highest
    per_window = min(TURNS, max(MIN_TURNS, all_turns / 4.0)) if turns is None else turns
    if not MIN_TURNS <= per_window <= all_turns:
        allowed = f"at least {MIN_TURNS:g} and at most {all_turns:.4g} (1 turn = 1 {BASES[of]})"
        raise ParameterError(must_be("turns (window length)", allowed, f"{per_window:.4g}"))
    samples = math.ceil(1.0 / max(float(steps.min()), float(steps.max()) / MAX_REFINEMENT))
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
        # Half of a line is at its negative order. Phases refer to angle 0, not to the start of the window.
        amplitudes = np.where(order > 0.0, 2.0, math.sqrt(2.0)) * half.T[:, : order.size]
        amplitudes *= np.exp(-2j * math.pi * (turned[0] + edges[:, :1]) * order)
        amplitudes[np.abs(amplitudes) < rounding(table, name)] = 0.0
        spectrum[name] = amplitudes
    begin, time, end = np.interp(edges, turned - turned[0], table.time).T
    link1_angle = cumulative_trapezoid(table["input_speed"], table.time, initial=0.0)
    angles = np.interp([begin, end], table.time, link1_angle)
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
    """Return the amplitude of round-off of a signal, in its unit.

    Args:
        table: Record of the signal.
        name: Name of the signal.
    """
    nominal = BY_NAME[name].nominal if name in BY_NAME else None
    return ROUNDING * max(float(np.abs(table[name]).max()), nominal or 0.0)


@renamed_arguments(fmu_path="fmu")
def orders(
    scene: Scene | Path | str,
    fmu: Path | str | None = None,
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
    """Run a scene and analyse the orders of its signals.

    Args:
        scene: Scene, or path of its file.
        fmu: FMU of the module; None for current_fmu().
        of: Reference angle, "link1" or "drive_angle" (pinion shaft).
        signals: Names of outputs, local variables, signals of the loop, or names in BEARING; None for the
            signals in SIGNALS that are not constant.
        highest: Maximum order; None for HARMONICS harmonics of the pulses. If the communication step of the
            scene is too long for it, the module runs with shorter steps; drive, load and controller keep the
            step of the scene.
        turns: Revolutions in a window, as in spectra.
        begin: Start of the analysed interval, s; None for the first motion.
        end: End of the analysed interval, s; None for the end of the run.
        progress: Function called with the completed fraction of the run, 0 to 1.
        record: Record of the scene with these signals, input_speed and ANGLES, which is used if its steps are
            short enough; None to run the scene.

    Raises:
        SceneError: The scene is invalid, or has no signal of this name.
        ParameterError: Reasons of spectra, fidelity averaged (no pulses), an invalid interval, or a signal
            that the scene computes once per communication step.
    """
    if of not in BASES:
        raise ParameterError(must_be("of (reference angle)", " or ".join(BASES), repr(of)))
    scene, _ = read(scene)
    if scene.parameters().get("fidelity") == AVERAGED:
        demand = must_be("fidelity", "kinematic, rigid or elastic for orders", "averaged")
        raise ParameterError(f"{demand}: this fidelity level has no pulses")
    last = scene.run.stop_time if end is None else end
    first = begin or 0.0
    if not 0.0 <= first < last <= scene.run.stop_time:
        limits = f"increasing and within 0 to {scene.run.stop_time:g} s"
        raise ParameterError(must_be("the time range", limits, f"{first:g} to {last:g} s"))
    selection = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    outputs = dict.fromkeys([*(BEARING.get(name, name) for name in selection), "input_speed", *ANGLES])
    scene = scene.replaced(run={"outputs": list(outputs)})
    recorder = _Recorder(scene, fmu, first, last, progress)
    record = recorder.record() if record is None else record
    first_row = recorder.first_row(record, of if begin is None else None)
    sampling = _sampling(scene, recorder.part(record, first_row), of, highest)
    substeps = recorder.substeps(sampling, selection)
    if substeps > 1:
        record = recorder.record(substeps)
        first_row = recorder.first_row(record, of if begin is None else None)
    mass = scene.parameters().get("imbalance_mass", BY_NAME["imbalance_mass"].start or 0.0)
    forces = {name: -mass * record[BEARING[name]] for name in selection if name in BEARING}
    signals_table = Result(record.columns | forces, record.units | dict.fromkeys(forces, "N"))
    table = recorder.part(signals_table, first_row)
    varying = [name for name in selection if np.ptp(table[name]) > rounding(table, name)]
    if not varying and signals is None:
        raise ParameterError(f"all signals are constant: {', '.join(selection)}")
    names = varying if signals is None else selection
    return spectra(
        table, _revolutions(table, of), names, of, sampling.highest, turns, _revolutions(table, DRIVE)
    )


class _Sampling(NamedTuple):
    """Sampling of an order analysis.

    Attributes:
        highest: Maximum order.
        step: Maximum step without aliases, s.
    """

    highest: float
    step: float


def _sampling(scene: Scene, table: Result, of: str, highest: float | None) -> _Sampling:
    """Choose the maximum order and the sampling from the fastest pulses of a run.

    The maximum order satisfies the Nyquist condition with a margin. Pulses have jumps and therefore no
    maximum harmonic, so aliases of harmonics below ALIASED_HARMONIC must stay above the maximum order.

    Args:
        scene: The scene.
        table: Record of the scene with the columns ANGLES.
        of: Reference angle, LINK1 or DRIVE.
        highest: Maximum order; None for HARMONICS harmonics of the pulses.

    Raises:
        ParameterError: The maximum order is not positive.
    """
    rate, pinion_rate = (_fastest(table, base) for base in (of, DRIVE))
    module = Module("plain")
    module.check(**scene.parameters())
    d = module.derived
    # orders of the pinion shaft: 1 of a planar module; 2, s and their sum of a bevel module
    pulses = 1.0 if d.planar else 2.0 + d.s
    limit = HARMONICS * pulses * (d.k if of == LINK1 else 1.0) if highest is None else highest
    if not (math.isfinite(limit) and limit > 0.0):
        raise ParameterError(must_be("highest (maximum order)", "above 0", f"{limit:g}"))
    sampling = max(POINTS_PER_CYCLE * limit * rate, limit * rate + ALIASED_HARMONIC * pulses * pinion_rate)
    return _Sampling(limit, 1.0 / sampling if sampling > 0.0 else math.inf)


def _fastest(table: Result, of: str) -> float:
    """Return the maximum number of revolutions per second between two rows."""
    return float(np.abs(np.diff(_revolutions(table, of)) / np.diff(table.time)).max())


class _Recorder(NamedTuple):
    """Runs of a scene up to the end of a time range.

    Attributes:
        scene: Scene with the outputs to record.
        fmu: FMU of the module; None for current_fmu().
        first: Start of the time range, s.
        last: End of the time range, s.
        progress: Function called with the completed fraction of a run, 0 to 1.
    """

    scene: Scene
    fmu: Path | str | None
    first: float
    last: float
    progress: Progress | None

    def record(self, substeps: int = 1) -> Result:
        """Run the scene and record its outputs.

        Args:
            substeps: Rows per communication step; drive, load and controller keep the step of the scene.
        """
        step = self.scene.run.communication_step
        stop = min(self.scene.run.stop_time, math.ceil(self.last / step - ROUNDING) * step)
        values, inputs = start_of(self.scene)
        with Fmu(self.fmu, values, inputs, stop_time=stop) as instance:
            loop = ClosedLoop(
                instance, self.scene.surroundings, self.scene.run.outputs, self.scene.signal_units
            )
            return loop.run(stop, self.progress, substeps)

    def first_row(self, record: Result, of: str | None) -> int:
        """Return the first row of the time range.

        Args:
            record: Record of a run.
            of: Reference angle to exclude the time before it begins to rotate, or None.
        """
        low, high = np.searchsorted(record.time, (self.first - 1e-9, self.last + 1e-9))
        return int(low) + (int(np.argmax(np.diff(_revolutions(record, of)[low:high]) != 0.0)) if of else 0)

    def part(self, record: Result, first_row: int) -> Result:
        """Return the rows of the time range from a first row.

        Args:
            record: Record of a run.
            first_row: First row.
        """
        end = int(np.searchsorted(record.time, self.last + 1e-9))
        return Result({name: values[first_row:end] for name, values in record.columns.items()}, record.units)

    def substeps(self, sampling: _Sampling, names: Sequence[str]) -> int:
        """Return the number of rows per communication step for a sampling.

        Args:
            sampling: Maximum order and maximum step.
            names: Names of the analysed signals.

        Raises:
            ParameterError: The run would have too many rows, or the scene computes a signal once per step.
        """
        step = self.scene.run.communication_step
        number = math.ceil(step / sampling.step - ROUNDING)
        if number <= 1:
            return 1
        limit = MAX_ROWS * sampling.step
        if self.last > limit:
            raise ParameterError(
                f"orders up to {sampling.highest:.4g} need steps of {_step_text(sampling.step)}, more than"
                f" {MAX_ROWS:,} in {self.last:g} s; lower highest, or end the time range before {limit:.3g} s"
            )
        surroundings, parameters = self.scene.surroundings, self.scene.parameters()
        if isinstance(surroundings, Sources):
            return number
        once_per_step = [name for name in names if name in surroundings.output_labels]
        if parameters.get("input_hold", 0.0) and parameters.get("drive", DRIVE_SPEED) == DRIVE_SPEED:
            once_per_step.append("omega1 with mechanism.input_hold = linear")
        if once_per_step:
            raise ParameterError(
                f"orders up to {sampling.highest:.4g} need run.communication_step ="
                f" {_step_text(0.9 * sampling.step)} or less (got {step:g} s): the scene computes"
                f" {', '.join(once_per_step)} once per communication step"
            )
        return number


def _step_text(step: float) -> str:
    """Return a step as text, rounded down to two digits."""
    digits = 10.0 ** (math.floor(math.log10(step)) - 1)
    return f"{math.floor(step / digits) * digits * 1e3:.3g} ms"


def _revolutions(table: Result, of: str) -> Array:
    """Return the revolutions of a reference angle up to each row, positive in its direction of rotation."""
    angle, count = ANGLES[:2] if of == LINK1 else ANGLES[2:]
    revolutions = table[angle] / math.tau + table[count]
    return math.copysign(1.0, revolutions[-1] - revolutions[0]) * revolutions
