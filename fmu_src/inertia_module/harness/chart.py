"""Torque converter chart of a mechanism: torque, efficiency and ripple over the speed ratio (as SAE J643).

Without losses everything goes with the square of the input speed as well: one chart, of the map of fidelity
`averaged`, holds for all speeds. With losses it is that of one input speed, and a map tells more of them.
These are made of steady pulses at a speed ratio, of the rigid module with its output shaft held by a large
inertia: means over whole periods of the drive, with all losses in them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ..common.equality import ByContent
from ..common.errors import Refused, must_be
from ..common.units import factor_between
from ..contract.variables import BY_NAME
from ..kernel import codes
from ..kernel.averaged import rates as average_rates
from ..kernel.inertia import reduced_inertia
from ..memory import Module
from .results import write_columns, write_mat, write_rows
from .simulate import Progress

Array = NDArray[np.float64]

# --- steady pulses ---

# the shaft's inertia over that of the imbalances: in a period its speed changes by some 1e-7 of omega1
HELD = 1e8
# turns of the drive to average over: whole periods of the motion, or where that is long most of it
FEWEST_TURNS, MOST_TURNS = 10, 100
# turns of link 1 after which link 2 has reached its speed where the shaft overruns link 1
SETTLING_TURNS = 200
# of the time of a period, which only decides what little of a pulse is missed at its end
TIME_ERROR = 1e-8
# what the start leaves behind is gone where link 2, as many turns later, is as fast within this share of
# omega1; so often this is tried from rest, and then from the speed of the shaft
STEADY = 1e-5
TRIES = 5
# drive angles at which lock-up is looked at
ANGLES = 3000
# in the time that the drive takes for a turn where link 2 is held
SAMPLES = 60


class SteadyPulses(NamedTuple):
    """Means over whole periods of the drive.

    Attributes:
        output_torque: what the load takes, N m, below 0 where the shaft would have to be driven.
        input_torque: M1, N m.
        efficiency: power to the load over power in; 0 where nothing comes out.
        link2_ratio: mean speed of link 2 over that of link 1, magnitudes.
        ripple: RMS of the torque in the output freewheel about its mean, N m. peak: its largest, N m.
        bearing_force: the largest on the bearing of a satellite, N. loss: power lost, W.
        housing_engagements, output_engagements: of the freewheels, a turn of link 1.
        housing_peak: largest torque in the housing freewheel, N m. housing_slip, output_slip: largest
            overrunning speeds of the freewheels, rad/s.
    """

    output_torque: float
    input_torque: float
    efficiency: float
    link2_ratio: float
    ripple: float
    peak: float
    bearing_force: float
    loss: float
    housing_engagements: float
    output_engagements: float
    housing_peak: float
    housing_slip: float
    output_slip: float


class SteadyMachine:
    """A mechanism whose output shaft is held at a speed.

    Args:
        parameters: of the module by name, those that differ from the defaults; as in Module.set.

    Attributes:
        module: the mechanism, started. ideal: True without losses, weight, play and wind-up: torques are
            proportional to omega1^2.

    Raises:
        Refused: the parameters cannot be; by its methods, a freewheel is missing.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        given = {"fidelity": "rigid", "drive": "speed", "method": "event", "input_hold": "zero_order"}
        zeros = dict.fromkeys(("max_step", "omega2_start", "omega_out_start", "drive_angle_start"), 0.0)
        self._values: dict[str, float | str] = {**parameters, **given, **zeros}
        self.module = module = self._started(1.0, 0.0)
        self._derived = d = module.derived
        self.ideal = d.viscous == 0.0 and d.losses == 0.0
        period = int(d.period_turns)
        self._turns = min(period * math.ceil(FEWEST_TURNS / period), MOST_TURNS)
        self._tries = TRIES if self._turns % period == 0 else 1
        self._values["output_inertia"] = HELD * (2.0 * module["energy_stored"] + module["link2_inertia"])

    def _started(self, omega1: float, omega_out: float, omega2: float = 0.0) -> Module:
        speeds = {"omega1": omega1, "omega2_start": omega2, "omega_out_start": omega_out}
        return Module().start(**{**self._values, **speeds, "load_torque": 0.0})

    def check_freewheels(self) -> None:
        """Refuse a mechanism that lacks a freewheel: it has no mean torque."""
        housing, output = (self.module[f"{name}_freewheel"] for name in ("housing", "output"))
        if housing * output == 0.0:
            both = f"{housing:g} and {output:g}"
            demand = must_be("each of housing_freewheel and output_freewheel", "1", both)
            raise Refused(f"{demand}: without both freewheels there is no mean torque")

    def at(self, omega1: float, ratio: float) -> SteadyPulses:
        """Compute the steady pulses at omega1, rad/s, not 0, and a ratio to it of the output from 0 to 1."""
        return self._settled(omega1, ratio)[1]

    def samples(self, names: Sequence[str], omega1: float, ratio: float) -> Array:
        """Sample outputs in steady pulses, SAMPLES in the time of a turn of the drive where link 2 is held.

        The rows, shape (m, names), are over the turns of a mean.
        """
        (module, _), found = self._settled(omega1, ratio), []
        turn, begun = math.tau / (self._derived.k * abs(omega1)), _drive_angle(module)
        while abs(_drive_angle(module) - begun) < self._turns * math.tau:
            module.advance(turn / SAMPLES)
            found.append(module.read(names))
        return np.array(found)

    def _settled(self, omega1: float, ratio: float) -> tuple[Module, SteadyPulses]:
        """Run until the means are steady or TRIES are over; module and means."""
        self.check_freewheels()
        speed = ratio * abs(omega1)
        for start in (0.0, speed):
            module = self._started(omega1, speed, start)
            # what the start leaves behind is mostly gone after this
            module.advance(self._times(omega1, ratio)[1])
            for _ in range(self._tries):
                omega2 = module["omega2"]
                pulses = self._over_turns(module, omega1, ratio)
                if self._tries == 1 or abs(module["omega2"] - omega2) <= STEADY * abs(omega1):
                    return module, pulses
        return module, pulses

    def _times(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Shortest and longest time that the turns of a mean can take, s."""
        slowest = self._turns * math.tau / (self._derived.k * abs(omega1))
        # link 2 turns between 0 and the speed of the shaft
        moved = 1.0 - ratio if omega1 > 0.0 else 1.0 + ratio
        return 0.999 * slowest / max(moved, 1.0), 1.001 * slowest / min(moved, 1.0)

    def _over_turns(self, module: Module, omega1: float, ratio: float) -> SteadyPulses:
        """Run on over the next turns and return the means over them."""
        between = self._times(omega1, ratio)
        begun, angle = module.save(), _drive_angle(module)
        counted = ("energy_in", "energy_lost", "housing_engagements", "output_engagements")
        before = module.read(counted)

        def missing(time: float) -> float:
            module.restore(begun)
            module.advance(time)
            return abs(_drive_angle(module) - angle) - self._turns * math.tau

        time = brentq(missing, *between, rtol=TIME_ERROR)
        missing(time)
        taken, lost, *engaged = np.subtract(module.read(counted), before).tolist()
        speed, turned = module["omega_out"], abs(omega1) * time / math.tau  # of link 1
        return SteadyPulses(
            module["output_torque_mean"] - module["output_friction"] * speed,
            math.copysign(1.0, omega1) * module["input_torque_mean"],
            min(max(1.0 - lost / taken, 0.0), 1.0) if taken > 0.0 else 0.0,
            abs(1.0 - self._turns / (self._derived.k * turned)),
            module["torque_ripple"],
            module["torque_peak"],
            module["satellite_force_peak"],
            lost / time,
            *(number / turned for number in engaged),
            *module.read(("housing_torque_peak", "housing_slip_peak", "output_slip_peak")),
        )

    def coasting(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Compute mean torques of friction on load and link 1, N m, where the shaft overruns it."""
        module = self._started(omega1, ratio * abs(omega1))
        module.advance(SETTLING_TURNS * math.tau / abs(omega1))
        module.advance(MOST_TURNS * math.tau / abs(omega1))
        braked = module["output_torque_mean"] - module["output_friction"] * module["omega_out"]
        return braked, math.copysign(1.0, omega1) * module["input_torque_mean"]

    def lock_up_torque(self, omega1: float) -> float:
        """Find the largest load torque, N m, at which the drive stays at rest in link 1, without stiction.

        That of the imbalances, - k I' omega1^2 / 2, less the viscous friction of link 2 and output shaft.
        """
        d, angles = self._derived, (n / ANGLES * self._turns * math.tau for n in range(ANGLES))
        slope: float = min(reduced_inertia(d, q)[1] for q in angles)  # type: ignore[no-untyped-call]
        held: float = -0.5 * d.k * slope * omega1**2 - (d.b2 + d.b3) * abs(omega1)
        return max(held, 0.0)


def _drive_angle(module: Module) -> float:
    return module["drive_angle"] + math.tau * module["drive_turns"]


# --- charts ---

NOMINAL_SPEED: float = BY_NAME["omega1"].nominal or 1.0
# points between the first and the last ratio of the map, besides its knots
POINTS = 200
# ratios at which a mechanism with losses is measured, and speeds of its map up to the one given
RATIOS = np.linspace(0.0, 0.98, 29)
MAP_SPEEDS = np.geomspace(0.1, 1.0, 8)
# of a converter table: the largest torque ratio, and the least input torque over its largest
LARGEST_TORQUE_RATIO, LEAST_SHARE = 50.0, 1e-4
# speed ratios of its coast side, over 1 or what the chart ends with above that
COAST = np.array([1.01, 1.1, 1.25, 1.5, 2.0])

ENGAGEMENTS = ("housing_engagements", "output_engagements")
_TORQUES = ("output_torque", "input_torque", "ripple", "peak", "lock_up_torque")
# of maps and converter tables; their other columns are pure numbers
UNITS = {**dict.fromkeys(_TORQUES, "N.m"), "loss": "W", "capacity_factor": "rad/s/(N.m)^0.5"}
# columns of a map, as of SteadyPulses
MAPPED = ("input_torque", "output_torque", "loss", "efficiency", "ripple")
VECTO_HEADINGS = ("Speed Ratio", "Torque Ratio", "Input Torque at reference rpm")


@dataclass(frozen=True, eq=False)
class TorqueConverterChart(ByContent):
    """Means over the speed ratio as of SteadyPulses, torques over omega1 squared, N m s^2; shapes (n,).

    Attributes:
        speed_ratio: output over input speed, magnitudes, rising from 0.
        lock_up_torque: largest load torque that lock-up at ratio 1 holds, without stiction, N m s^2, the
            same in all rows; 0 where it is not reached.
        housing_engagements, output_engagements: in lock-up those just before it; None where they were not
            asked for.
    """

    speed_ratio: Array
    output_torque: Array
    input_torque: Array
    efficiency: Array
    link2_ratio: Array
    ripple: Array
    peak: Array
    lock_up_torque: Array
    housing_engagements: Array | None = None
    output_engagements: Array | None = None

    @property
    def stall_torque(self) -> float:
        """Mean output torque at rest over omega1 squared, N m s^2."""
        return float(self.output_torque[0])

    @property
    def lossless(self) -> bool:
        """Tell whether the efficiency is 1 at all ratios."""
        return bool((self.efficiency == 1.0).all())

    @property
    def end_ratio(self) -> float:
        """Speed ratio above which no torque is transmitted; 1 with lock-up, also beyond the last row."""
        return 1.0 if self.lock_up_torque[0] > 0.0 else float(self.speed_ratio[-1])

    def summary(
        self, omega1: float | None = None, indexing: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Characteristic numbers of the chart, for comparing mechanisms.

        Args:
            omega1: speed of the input, rad/s; without it torques are over its square, engagements over turns.
            indexing: largest indexing frequency, Hz, of freewheels (housing, output) that have one. With it
                there is the input speed, rad/s, up to which none engages more often at any ratio.
        """
        numbers = {
            "stall_torque": self.stall_torque,
            "least_torque": float(self.output_torque.min()),
            "least_torque_ratio": float(self.speed_ratio[np.argmin(self.output_torque)]),
            "end_ratio": self.end_ratio,
            "lock_up_torque": float(self.lock_up_torque[0]),
            "efficiency_maximum": float(self.efficiency.max()),
            "efficiency_maximum_ratio": float(self.speed_ratio[np.argmax(self.efficiency)]),
            "stall_peak_over_mean": float(self.peak[0] / self.stall_torque) if self.stall_torque else 0.0,
        }
        if self.output_engagements is not None:
            most = {name: float(getattr(self, name).max()) for name in ENGAGEMENTS}
            numbers |= {f"{name}_maximum": value for name, value in most.items()}
            shares = [most[f"{name}_engagements"] / limit for name, limit in (indexing or {}).items()]
            numbers |= {"indexing_speed": math.tau / max(shares)} if any(shares) else {}
        return {name: _scale(name, omega1)[0] * value for name, value in numbers.items()}

    def units(self, omega1: float | None = None) -> dict[str, str]:
        """Units of the numbers of summary, "" for ratios."""
        return {name: _scale(name, omega1)[1] for name in (*self.summary(), "indexing_speed")}

    def beyond_drive(self, omega1: float, torque: float) -> str:
        """Describe where the mechanism takes more torque than its drive has at a speed.

        Args:
            omega1: speed of link 1, rad/s.
            torque: largest torque of the drive there, N.m.

        Returns:
            A sentence without its subject, or "" if the drive has enough torque at all speed ratios.
        """
        taken = self.input_torque * omega1**2
        if not (taken > torque * (1.0 + 1e-9)).any():
            return ""
        first = float(self.speed_ratio[np.argmax(taken > torque)])
        return (
            f"the mechanism takes up to {taken.max():.4g} N.m at {abs(omega1):.4g} rad/s, the drive has"
            f" {torque:.4g} N.m: from a speed ratio of {first:.2g} on it cannot hold this speed"
        )

    def save(self, path: Path) -> Path:
        """Write as CSV, whole or not at all; the numbers read back are the same doubles."""
        columns = {name: values for name, values in vars(self).items() if values is not None}
        units = {**dict.fromkeys(_TORQUES, "N.m.s2"), **dict.fromkeys(ENGAGEMENTS, "1/rev")}
        return write_columns(path, columns, units)


def _scale(number: str, omega1: float | None) -> tuple[float, str]:
    """Factor of a number of a summary at a speed, rad/s, or at any, and its unit then."""
    if number.endswith("_torque"):
        return (1.0, "N.m.s2") if omega1 is None else (omega1**2, "N.m")
    if number.endswith("_engagements_maximum"):
        return (1.0, "1/rev") if omega1 is None else (abs(omega1) / math.tau, "Hz")
    return 1.0, "rad/s" if number == "indexing_speed" else ""


def steady_map(machine: SteadyMachine, omega1: float, progress: Progress) -> dict[str, Array]:
    """Map of a mechanism from a tenth of an input speed, rad/s, not 0, up to that.

    Columns by name: omega1, rad/s, shape (m,), speed_ratio, shape (n,), and those MAPPED, shape (m, n).
    """
    speeds, rows = omega1 * MAP_SPEEDS, []
    for speed in speeds:
        rows.append(_over_ratios(machine, speed))
        progress(len(rows) / speeds.size)
    columns = {name: np.array([row[name] for row in rows]) for name in MAPPED}
    return {"omega1": speeds, "speed_ratio": RATIOS, **columns}


def save_map(found: Mapping[str, Array], stem: Path, unit: str = "rad/s", tables: bool = False) -> list[Path]:
    """Write a map as stem.csv, a row for each speed and ratio, whole or not at all.

    Args:
        unit: of the speeds. tables: whether stem_COLUMN.csv, a row for each ratio and a column for each
            speed, and stem.mat, a struct map, are written too.
    """
    speeds, ratios = found["omega1"] * factor_between("rad/s", unit), found["speed_ratio"]
    units = {"omega1": unit, **UNITS}
    grid = dict(zip(("omega1", "speed_ratio"), np.meshgrid(speeds, ratios, indexing="ij"), strict=True))
    long = {name: values.ravel() for name, values in {**found, **grid}.items()}
    files = [write_columns(Path(f"{stem}.csv"), long, units)]
    if not tables:
        return files
    for name in MAPPED:
        rows = zip(speeds, found[name], strict=True)
        wide = {f"{name} at {speed:.6g} {unit}": row for speed, row in rows}
        of_wide = dict.fromkeys(wide, units.get(name, ""))
        files.append(write_columns(Path(f"{stem}_{name}.csv"), {"speed_ratio": ratios, **wide}, of_wide))
    return [*files, write_mat(Path(f"{stem}.mat"), "map", {**found, "omega1": speeds}, units)]


def _over_ratios(machine: SteadyMachine, omega1: float) -> dict[str, Array]:
    """Steady pulses at a speed, rad/s, and RATIOS: fields of SteadyPulses by name, shape (n,)."""
    found = np.array([machine.at(omega1, ratio) for ratio in RATIOS])
    return dict(zip(SteadyPulses._fields, found.T, strict=True))


def torque_converter_chart(
    parameters: Mapping[str, float | str],
    omega1: float = NOMINAL_SPEED,
    engagements: bool = False,
) -> TorqueConverterChart:
    """The chart of a mechanism.

    Args:
        parameters: of the module by name, those that differ from the defaults; as in Module.set.
        omega1: input speed at which a mechanism with losses is measured, rad/s, not 0; without losses the
            chart is that of all speeds of this sign (backwards the torque is another).
        engagements: whether those of the freewheels are wanted, which cost more than all else without losses.

    Raises:
        Refused: the parameters cannot be, or there is no mean torque (a freewheel is missing).
    """
    machine = SteadyMachine(parameters)
    machine.check_freewheels()
    if machine.ideal:
        chart = _chart_of_map(parameters, omega1 < 0.0)
        found = _over_ratios(machine, omega1) if engagements else {}
        columns = {name: np.interp(chart.speed_ratio, RATIOS, found[name]) for name in ENGAGEMENTS if found}
        return replace(chart, **columns)
    # with losses, up to the last ratio at which the load gets a torque
    found = _over_ratios(machine, omega1)
    number = max(np.flatnonzero(found["output_torque"] > 0.0), default=0) + 1
    locks = omega1 > 0.0 and number == RATIOS.size
    found["lock_up_torque"] = np.full(RATIOS.size, machine.lock_up_torque(omega1) if locks else 0.0)
    columns = {name: found[name][:number] / omega1**2 for name in _TORQUES}
    columns |= {name: found[name][:number] for name in ("efficiency", "link2_ratio", *ENGAGEMENTS)}
    return TorqueConverterChart(RATIOS[:number], **columns)


def _chart_of_map(parameters: Mapping[str, float | str], backward: bool) -> TorqueConverterChart:
    """The chart of a mechanism without losses: the map of fidelity averaged."""
    # torques at given speeds, whatever drives the module
    given = {"fidelity": float(codes.AVERAGED), "drive": float(codes.DRIVE_SPEED)}
    module = Module().start(**{**parameters, **given})
    d, x = module.derived, module.state
    side = d.backward if backward else d.forward
    knots = [side.knots[n].ratio for n in range(int(side.count))]
    ratios = np.unique(np.concatenate([knots, np.linspace(0.0, knots[-1], POINTS + 1)]))
    torque, link2, ripple, peak = np.zeros((4, ratios.size))
    for n, ratio in enumerate(ratios):
        x.omega3 = ratio
        found = average_rates.look_up(side, x, 1.0, ratio)  # type: ignore[no-untyped-call]
        torque[n], link2[n] = found
        ripple[n], peak[n] = average_rates.ripple_at(side, x, side.direction)  # type: ignore[no-untyped-call]
    lock = d.map_lock if side.locks else 0.0
    one = np.ones(ratios.size)
    return TorqueConverterChart(ratios, torque, ratios * torque, one, link2, ripple, peak, lock * one)


def converter_table(machine: SteadyMachine, chart: TorqueConverterChart, omega1: float) -> dict[str, Array]:
    """The converter table of a mechanism, whose output torque is right at each ratio (docs/mechanics.md).

    Args:
        chart: of the mechanism at this speed. omega1: speed of the input, rad/s, not 0.

    Returns:
        Columns of shape (n,), all finite: speed_ratio, output over input speed, rising from 0; torque_ratio,
        output over input torque, at most LARGEST_TORQUE_RATIO, negative on a braked shaft; capacity_factor,
        omega1 / sqrt(input torque), rad/s/(N m)^0.5; output_torque and input_torque, means of the mechanism
        itself, N m.

    Raises:
        Refused: no torque is passed at any ratio.
    """
    ratios = COAST * max(1.0, chart.end_ratio)
    coast = np.zeros((ratios.size, 2))
    if not machine.ideal:
        coast = np.array([machine.coasting(omega1, ratio) for ratio in ratios])
    square = omega1 * omega1
    passed = np.concatenate([square * chart.output_torque, coast[:, 0]])
    taken = np.concatenate([square * chart.input_torque, coast[:, 1]])
    greatest = float(taken.max())
    if not greatest > 0.0:
        raise Refused(f"a converter table requires torque; the mechanism transmits none at {omega1:g} rad/s")
    given = np.maximum(taken, np.maximum(passed / LARGEST_TORQUE_RATIO, LEAST_SHARE * greatest))
    return {
        "speed_ratio": np.concatenate([chart.speed_ratio, ratios]),
        "torque_ratio": passed / given,
        "capacity_factor": abs(omega1) / np.sqrt(given),
        "output_torque": passed,
        "input_torque": taken,
    }


def save_converter(table: Mapping[str, Array], omega1: float, stem: Path) -> list[Path]:
    """Write a converter table at omega1, rad/s, to stem.csv, .mat and .vtcc, each whole or not at all.

    The MAT file holds a struct converter with units. The .vtcc is that of VECTO, whose input torque at the
    reference speed, omega1, has a sign: it is below 0 where the shaft drives link 1.
    """
    passed, taken = table["output_torque"], table["input_torque"]
    least = np.maximum(np.abs(passed) / LARGEST_TORQUE_RATIO, LEAST_SHARE * taken.max())
    given = np.copysign(np.maximum(np.abs(taken), least), taken)
    rows = zip(*(part.tolist() for part in (table["speed_ratio"], passed / given, given)), strict=True)
    units = {"omega1": "rad/s", **UNITS}
    return [
        write_columns(Path(f"{stem}.csv"), table, units),
        write_mat(Path(f"{stem}.mat"), "converter", {"omega1": omega1, **table}, units),
        write_rows(Path(f"{stem}.vtcc"), VECTO_HEADINGS, rows),
    ]
