"""Orders of a scene: how much of torques, speeds and forces swings how often a turn of link 1, or a pulse.

The scene is run, and what is recorded over time is resampled in equal steps of the angle, so that a machine
that runs up has the same lines as one at a steady speed. Sources: K. R. Fyfe and E. D. S. Munck, Analysis of
computed order tracking, Mechanical Systems and Signal Processing 11 (1997) 187-205; averages over windows
that overlap: P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70-73.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline

from ..common.errors import Refused, must_be
from ..common.files import write_text
from ..common.terminal import Progress
from ..contract.variables import BY_NAME
from ..harness.results import write_columns
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
# what is looked at where nothing is asked for
SIGNALS = (
    *("input_torque", "output_torque", "input_speed", "omega_out"),
    *("shaking_force_x", "shaking_force_y", "shaking_force_z"),
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


class Line(NamedTuple):
    """A line of a spectrum.

    Attributes:
        order: cycles a turn (a pulse). amplitude: RMS average over the windows, in the unit of the signal.
        greatest: amplitude in the window where it is greatest. speed: of link 1 there, rad/s.
        low, high: orders between which it bends with the speed ratio; of a straight line, order.
    """

    order: float
    amplitude: float
    greatest: float
    speed: float
    low: float
    high: float


@dataclass(frozen=True)
class Orders:
    """Spectra over orders; n orders, m windows.

    Attributes:
        of: what an order is counted over, LINK1 or PULSES. turns: of that in a window.
        order: cycles a turn (a pulse), shape (n,).
        amplitude: of each signal in its unit, RMS average over the windows, shape (n,); mean, trend apart.
        time, speed: at the middle of each window, s, and mean speed of link 1 in it, rad/s, shape (m,).
        ratio: turns of the drive a turn (a pulse) in each window, shape (m,): with it lines bend.
        waterfall: amplitude in each window, shape (m, n). units: of the signals.
    """

    of: str
    turns: float
    order: Array
    amplitude: dict[str, Array]
    time: Array
    speed: Array
    ratio: Array
    waterfall: dict[str, Array]
    units: dict[str, str]
    # lines that were looked for, by how many of each signal: picture, table and files ask for the same
    _known: dict[int, dict[str, list[Line]]] = field(default_factory=dict, init=False, repr=False)

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

    def lines(self, number: int = 5) -> dict[str, dict[str, str]]:
        """The largest lines as text, by signal and order."""
        found: dict[str, dict[str, str]] = {}
        for name, lines in self.largest(number).items():
            unit, rows = self.units[name], found.setdefault(name, {})
            for line in lines:
                several = f"{line.low:.4g} to {line.high:.4g}"
                order = f"{line.order:.4g}" if line.low == line.high else several
                most = f"most at {line.speed:.4g} rad/s: {line.greatest:.4g} {unit}"
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
            found, _ = self._along(name, bent, 0.5 / self.turns)
            bends = np.ptp(bent) > HALF_LOBE / self.turns and bent.min() > HALF_LOBE / self.turns
            if bends and _rms(found) > most:
                track, heights, amplitude, most = bent, found, _rms(found), _rms(found)
        at = int(np.argmax(heights))
        low, high, greatest = float(track.min()), float(track.max()), float(heights[at])
        return Line(float(track[at]), amplitude, greatest, float(self.speed[at]), low, high), track, at

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
        windows = {"time": self.time, "speed": self.speed}
        rows = {name: np.repeat(values, orders.size) for name, values in windows.items()}
        rows["order"] = np.tile(orders, self.time.size)
        rows |= {name: values[:, coarse].ravel() for name, values in self.waterfall.items()}
        units = {**self.units, "time": "s", "speed": "rad/s"}
        text = json.dumps(self.as_dict(), indent=2) + "\n"
        return {
            "orders": write_columns(folder / "orders.csv", {"order": self.order, **self.amplitude}, units),
            "waterfall": write_columns(folder / "waterfall.csv", rows, units),
            "summary": write_text(folder / "summary.json", text),
        }


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
    waterfall = {}
    for name in names:
        values = CubicSpline(turned - turned[0], table[name])(angle)
        order, middle, power = signal.spectrogram(values, **options)
        amplitude = np.sqrt(2.0 * power.T[:, order <= highest])
        amplitude[amplitude < rounding(table, name)] = 0.0
        waterfall[name] = amplitude
    edges = middle[:, None] + 0.5 * size / samples * np.array([-1.0, 0.0, 1.0])
    begin, time, end = np.interp(edges, turned - turned[0], table.time).T
    turned1 = cumulative_trapezoid(table["input_speed"], table.time, initial=0.0)
    angles = np.interp([begin, end], table.time, turned1)
    driven = np.interp([begin, end], table.time, turned if drive is None else drive)
    return Orders(
        of,
        per_window,
        order[order <= highest],
        {name: np.sqrt(np.mean(rows**2, axis=0)) for name, rows in waterfall.items()},
        time,
        (angles[1] - angles[0]) / (end - begin),
        (driven[1] - driven[0]) / np.ptp(edges[:, ::2], axis=1),
        waterfall,
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
    module = Module("plain")
    module.check(**parameters)
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, math.tau * turns, 720 * turns, endpoint=False)
    slopes = [reduced_inertia(module.derived, float(q))[1] for q in angles]  # type: ignore[no-untyped-call]
    rising = np.array(slopes) > 0.0
    return float(np.sum(rising & ~np.roll(rising, 1))) / turns


def orders(
    scene: Scene | Path | str,
    fmu_path: Path | str | None = None,
    *,
    of: str = LINK1,
    signals: Sequence[str] | None = None,
    highest: float | None = None,
    turns: float | None = None,
    begin: float = 0.0,
    end: float | None = None,
    progress: Progress | None = None,
    record: Result | None = None,
) -> Orders:
    """Run a scene and find the orders of its signals.

    Args:
        scene: a scene or its file.
        fmu_path: the FMU of the module; None for that of the package.
        of: "link1" or "pulses".
        signals: names of outputs, locals or signals of the loop; without them those of SIGNALS that swing.
        highest, turns: as of spectra.
        begin, end: of the part of the run that is looked at, s.
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
    if not 0.0 <= begin < last <= scene.run.stop_time:
        limits = f"in order and within 0 to {scene.run.stop_time:g} s"
        raise Refused(must_be("times", limits, f"{begin:g} to {last:g} s"))
    looked = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    wanted = list(dict.fromkeys([*looked, "input_speed", *ANGLES]))
    scene = scene.replaced(run={"outputs": wanted})

    def within(time: Array) -> NDArray[np.bool_]:
        return (time >= begin - 1e-9) & (time <= last + 1e-9)

    # what is sure to be refused after the run is refused now: by the speed that is given, else by first steps
    step, given = scene.run.communication_step, scene.drive.prescribed().get("omega1")
    if of == LINK1 and given is not None and not scene.parameters().get("input_hold"):
        times = communication_points(scene.run.stop_time, step)
        times = times[within(times)]
        turned = np.cumsum([evaluate(given, at) for at in times]) * step / math.tau
        turned = np.append(0.0, turned[:-1])  # the speed is held over a step
        turned *= math.copysign(1.0, turned[-1])
        highest_order(times, turned, highest)
        turns_of_window(turned, of, turns)
    elif record is None and begin == 0.0 and TRIED * step < last:
        table = run_scene(scene.replaced(run={"stop_time": TRIED * step}), fmu_path).record
        highest_order(table.time, _turned(table, of, scene), highest)
    record = run_scene(scene, fmu_path, progress).record if record is None else record
    part = within(record.time)
    table = Result({name: values[part] for name, values in record.columns.items()}, record.units)
    turned = _turned(table, of, scene)
    swinging = [name for name in looked if np.ptp(table[name]) > rounding(table, name)]
    if not swinging:
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
