"""Torque converter chart of a mechanism: torque, efficiency and ripple over the speed ratio (as SAE J643).

Without losses all torques scale with the square of the input speed: one chart, made from the map of fidelity
`averaged`, is valid for all speeds. With losses a chart is valid for one input speed, and a map contains
several speeds. Then the charts contain means over whole periods of the pinion shaft, including all losses.
The rigid module runs at a constant speed ratio, because a large inertia holds the speed of its output shaft.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.deprecated import renamed_names
from ..common.equality import ByContent
from ..common.errors import ParameterError, must_be
from ..common.units import factor_between
from ..fmi.results import write_columns, write_mat, write_rows
from ..fmi.simulate import Progress
from ..interface.variables import BY_NAME
from ..kernel.inertia import reduced_inertia
from ..model import Module

Array = NDArray[np.float64]

# --- steady pulses ---

# inertia of the output shaft relative to the mechanism: its speed changes by about 1e-7 omega1 in a period
HOLD_INERTIA_FACTOR = 1e8
# revolutions of the pinion shaft in a mean: whole periods, or the maximum if the period is longer
MIN_TURNS, MAX_TURNS = 10, 100
# speed ratio instead of 0: the output freewheel overruns between pulses
MIN_RATIO = 1e-9
# revolutions of link 1 until link 2 reaches its final speed, if the shaft overruns link 1
SETTLING_TURNS = 200
# number of pinion-shaft angles at which the lock-up torque is evaluated
ANGLES = 3000
# samples in the duration of one revolution of the pinion shaft while link 2 is at rest
SAMPLES = 60


class SteadyPulses(NamedTuple):
    """Means over whole periods of the pinion shaft.

    Attributes:
        output_torque: mean torque on the load, N m; negative if the load must drive the shaft.
        input_torque: mean of M1, N m.
        efficiency: output power relative to input power; 0 without output power.
        link2_ratio: mean speed of link 2 relative to link 1, magnitudes.
        ripple: RMS of the output freewheel torque about its mean, N m.
        peak: maximum output freewheel torque, N m.
        bearing_force: maximum force on the bearing of a satellite, N.
        loss: mean power loss, W.
        housing_engagements: engagements of the housing freewheel per revolution of link 1.
        output_engagements: engagements of the output freewheel per revolution of link 1.
        housing_peak: maximum housing freewheel torque, N m.
        housing_slip: maximum overrunning speed of the housing freewheel, rad/s.
        output_slip: maximum overrunning speed of the output freewheel, rad/s.
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
    """A mechanism with a constant speed of its output shaft.

    Args:
        parameters: parameters of the module by name that differ from the defaults, as in Module.set.

    Attributes:
        module: the mechanism, started.
        ideal: True without losses, gravity, engagement angles and wind-up. Then torques are proportional to
            omega1^2.

    Raises:
        ParameterError: the parameters are invalid. The methods raise it if a freewheel is missing.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        modes = {"fidelity": "rigid", "drive": "speed", "method": "event", "input_hold": "zero_order"}
        zeros = dict.fromkeys(("max_step", "omega2_start", "omega_out_start", "drive_angle_start"), 0.0)
        self._values: dict[str, float | str] = {**parameters, **modes, **zeros}
        self.module = module = Module().start(**self._set(1.0, 0.0))
        self._derived = d = module.derived
        self.ideal = d.viscous == 0.0 and d.losses == 0.0
        period = int(d.period_turns)
        self._turns = min(period * math.ceil(MIN_TURNS / period), MAX_TURNS)
        inertia = HOLD_INERTIA_FACTOR * (2.0 * module["energy_stored"] + module["link2_inertia"])
        self._values["output_inertia"] = min(inertia, BY_NAME["output_inertia"].ends[1])

    def _set(self, omega1: float, ratio: float) -> dict[str, float | str]:
        """Return the values of the module at an input speed, rad/s, and a speed ratio."""
        return {
            **self._values,
            "omega1": omega1,
            "omega2_start": 0.0,
            "omega_out_start": ratio * abs(omega1),
            "load_torque": 0.0,
        }

    def check_freewheels(self) -> None:
        """Reject a mechanism without one of the freewheels: it has no mean torque.

        Raises:
            ParameterError: a freewheel is missing.
        """
        housing, output = (self.module[f"{name}_freewheel"] for name in ("housing", "output"))
        if housing * output == 0.0:
            both = f"{housing:g} and {output:g}"
            demand = must_be("each of housing_freewheel and output_freewheel", "1", both)
            raise ParameterError(f"{demand}: without both freewheels there is no mean torque")

    def at(self, omega1: float, ratio: float) -> SteadyPulses:
        """Compute the means of the steady motion.

        Args:
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, 0 to 1.
        """
        module = self._steady(omega1, ratio)
        time, loss, work = module.state.length, module["energy_lost"], module["energy_in"]
        turns = abs(omega1) * time / math.tau  # of link 1
        return SteadyPulses(
            module["output_torque_mean"] - module["output_friction"] * module["omega_out"],
            math.copysign(1.0, omega1) * module["input_torque_mean"],
            min(max(1.0 - loss / work, 0.0), 1.0) if work > 0.0 else 0.0,
            abs(1.0 - self._turns / (self._derived.k * turns)),
            module["torque_ripple"],
            module["torque_peak"],
            module["satellite_force_peak"],
            loss / time,
            module["housing_engagements"] / turns,
            module["output_engagements"] / turns,
            *module.read(("housing_torque_peak", "housing_slip_peak", "output_slip_peak")),
        )

    def samples(self, names: Sequence[str], omega1: float, ratio: float) -> Array:
        """Sample outputs in steady motion over the revolutions of a mean.

        The interval is 1 / SAMPLES of a revolution of the pinion shaft while link 2 is at rest.

        Args:
            names: names of outputs.
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, 0 to 1.

        Returns:
            Samples, shape (samples, names).
        """
        module, rows = self._steady(omega1, ratio), []
        turn, start = math.tau / (self._derived.k * abs(omega1)), _drive_angle(module)
        while abs(_drive_angle(module) - start) < self._turns * math.tau:
            module.advance(turn / SAMPLES)
            rows.append(module.read(names))
        return np.array(rows)

    def _steady(self, omega1: float, ratio: float) -> Module:
        """Return the module in its periodic orbit at an input speed, rad/s, and a speed ratio."""
        self.check_freewheels()
        return Module().start_steady(self._turns * math.tau, **self._set(omega1, max(ratio, MIN_RATIO)))

    def coasting(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Compute the mean friction torques on the load and on link 1, N m, if the shaft overruns link 1.

        Args:
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, above 1.
        """
        module = Module().start(**self._set(omega1, ratio))
        module.advance(SETTLING_TURNS * math.tau / abs(omega1))
        module.advance(MAX_TURNS * math.tau / abs(omega1))
        output = module["output_torque_mean"] - module["output_friction"] * module["omega_out"]
        return output, math.copysign(1.0, omega1) * module["input_torque_mean"]

    def lock_up_torque(self, omega1: float) -> float:
        """Compute the maximum load torque in lock-up, N m, without stiction.

        In lock-up the pinion shaft is at rest relative to link 1. The torque is the maximum torque of the
        unbalanced masses, - k I' omega1^2 / 2, minus the viscous friction of link 2 and output shaft.

        Args:
            omega1: speed of link 1, rad/s.
        """
        d, angles = self._derived, (n / ANGLES * self._turns * math.tau for n in range(ANGLES))
        slope: float = min(reduced_inertia(d, q)[1] for q in angles)
        torque: float = -0.5 * d.k * slope * omega1**2 - (d.b2 + d.b3) * abs(omega1)
        return max(torque, 0.0)


def _drive_angle(module: Module) -> float:
    return module["drive_angle"] + math.tau * module["drive_turns"]


# --- charts ---

NOMINAL_SPEED: float = BY_NAME["omega1"].nominal or 1.0
# points between the first and the last ratio of the map, in addition to its knots
POINTS = 200
# speed ratios of the chart of a mechanism with losses
RATIOS = np.linspace(0.0, 0.98, 29)
# input speeds of a map, relative to its maximum speed
MAP_SPEEDS = np.geomspace(0.1, 1.0, 8)
# limits of a converter table: maximum torque ratio, and minimum input torque relative to its maximum
LARGEST_TORQUE_RATIO, MIN_TORQUE_SHARE = 50.0, 1e-4
# speed ratios of the coast side of a converter table, relative to 1 or to the end ratio above 1
COAST = np.array([1.01, 1.1, 1.25, 1.5, 2.0])

ENGAGEMENTS = ("housing_engagements", "output_engagements")
_TORQUES = ("output_torque", "input_torque", "ripple", "peak", "lock_up_torque")
# units of the columns of maps and converter tables; other columns are pure numbers
UNITS = {**dict.fromkeys(_TORQUES, "N.m"), "loss": "W", "capacity_factor": "rad/s/(N.m)^0.5"}
# columns of a map: fields of SteadyPulses
MAPPED = ("input_torque", "output_torque", "loss", "efficiency", "ripple")
VECTO_HEADINGS = ("Speed Ratio", "Torque Ratio", "Input Torque at reference rpm")


@dataclass(frozen=True, eq=False, repr=False)
class TorqueConverterChart(ByContent):
    """Means over the speed ratio, shape (n,) each; torques are divided by omega1^2.

    Attributes:
        speed_ratio: output speed relative to input speed, magnitudes, increasing from 0.
        output_torque: mean torque on the load, N m s^2.
        input_torque: mean of M1, N m s^2.
        efficiency: output power relative to input power.
        link2_ratio: mean speed of link 2 relative to link 1, magnitudes.
        ripple: RMS of the output freewheel torque about its mean, N m s^2.
        peak: maximum output freewheel torque, N m s^2.
        lock_up_torque: maximum load torque in lock-up at speed ratio 1, without stiction, N m s^2, the same
            in all rows; 0 without lock-up.
        housing_engagements: engagements of the housing freewheel per revolution of link 1, or None; in
            lock-up the number at a slightly lower speed ratio.
        output_engagements: engagements of the output freewheel, like housing_engagements.
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

    def __repr__(self) -> str:
        ratios = f"{self.speed_ratio.size} speed ratios 0…{self.speed_ratio[-1]:.3g}"
        return f"TorqueConverterChart({ratios}, stall torque {self.stall_torque:.4g} N m s²)"

    @property
    def stall_torque(self) -> float:
        """Mean output torque at stall divided by omega1^2, N m s^2."""
        return float(self.output_torque[0])

    @property
    def lossless(self) -> bool:
        """True if the efficiency is 1 at all speed ratios."""
        return bool((self.efficiency == 1.0).all())

    @property
    def end_ratio(self) -> float:
        """Maximum speed ratio with torque; 1 with lock-up, which can be beyond the last row."""
        return 1.0 if self.lock_up_torque[0] > 0.0 else float(self.speed_ratio[-1])

    def summary(
        self, omega1: float | None = None, indexing: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Return characteristic numbers of the chart by name, for the comparison of mechanisms.

        Args:
            omega1: input speed, rad/s; if None, torques are divided by omega1^2 and engagements are per
                revolution.
            indexing: maximum indexing frequency, Hz, by freewheel (housing, output). It adds indexing_speed,
                the maximum input speed, rad/s, at which no freewheel exceeds its frequency at any ratio.
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
            maxima = {name: float(getattr(self, name).max()) for name in ENGAGEMENTS}
            numbers |= {f"{name}_maximum": value for name, value in maxima.items()}
            shares = [maxima[f"{name}_engagements"] / limit for name, limit in (indexing or {}).items()]
            numbers |= {"indexing_speed": math.tau / max(shares)} if any(shares) else {}
        return {name: _scale(name, omega1)[0] * value for name, value in numbers.items()}

    def units(self, omega1: float | None = None) -> dict[str, str]:
        """Return the units of the numbers in summary by name, "" for ratios.

        Args:
            omega1: input speed, rad/s, or None, as in summary.
        """
        return {name: _scale(name, omega1)[1] for name in (*self.summary(), "indexing_speed")}

    def beyond_drive(self, omega1: float, torque: float) -> str:
        """Describe the speed ratios at which the mechanism requires more torque than its drive provides.

        Args:
            omega1: speed of link 1, rad/s.
            torque: maximum torque of the drive at this speed, N.m.

        Returns:
            A sentence without its subject, or "" if the torque is sufficient at all speed ratios.
        """
        required = self.input_torque * omega1**2
        if not (required > torque * (1.0 + 1e-9)).any():
            return ""
        first = float(self.speed_ratio[np.argmax(required > torque)])
        return (
            f"the mechanism takes up to {required.max():.4g} N.m at {abs(omega1):.4g} rad/s, the drive has"
            f" {torque:.4g} N.m: from a speed ratio of {first:.2g} on it cannot hold this speed"
        )

    def save(self, path: Path) -> Path:
        """Write the chart as CSV atomically, with the digits that give the same doubles; return the path.

        Args:
            path: path of the file.
        """
        columns = {name: values for name, values in vars(self).items() if values is not None}
        units = {**dict.fromkeys(_TORQUES, "N.m.s2"), **dict.fromkeys(ENGAGEMENTS, "1/rev")}
        return write_columns(path, columns, units)


def _scale(number: str, omega1: float | None) -> tuple[float, str]:
    """Return factor and unit of a number of the summary at an input speed, rad/s, or without speed (None)."""
    if number.endswith("_torque"):
        return (1.0, "N.m.s2") if omega1 is None else (omega1**2, "N.m")
    if number.endswith("_engagements_maximum"):
        return (1.0, "1/rev") if omega1 is None else (abs(omega1) / math.tau, "Hz")
    return 1.0, "rad/s" if number == "indexing_speed" else ""


def steady_map(machine: SteadyMachine, omega1: float, progress: Progress) -> dict[str, Array]:
    """Compute the map of a mechanism from a tenth of an input speed up to this speed.

    Args:
        machine: the mechanism.
        omega1: maximum input speed, rad/s, not 0.
        progress: function that receives the completed share, 0 to 1.

    Returns:
        Columns by name: omega1, rad/s, shape (m,), speed_ratio, shape (n,), and MAPPED, shape (m, n).
    """
    speeds, rows = omega1 * MAP_SPEEDS, []
    for speed in speeds:
        rows.append(_over_ratios(machine, speed))
        progress(len(rows) / speeds.size)
    columns = {name: np.array([row[name] for row in rows]) for name in MAPPED}
    return {"omega1": speeds, "speed_ratio": RATIOS, **columns}


def save_map(
    columns: Mapping[str, Array], stem: Path, unit: str = "rad/s", tables: bool = False
) -> list[Path]:
    """Write a map as stem.csv, with a row for each speed and ratio; files are written atomically.

    Args:
        columns: result of steady_map.
        stem: path of the files without their endings.
        unit: unit of the speeds.
        tables: True to write also stem_COLUMN.csv, with a row for each ratio and a column for each speed,
            and stem.mat with a struct map.

    Returns:
        Paths of the files.
    """
    speeds, ratios = columns["omega1"] * factor_between("rad/s", unit), columns["speed_ratio"]
    units = {"omega1": unit, **UNITS}
    grid = dict(zip(("omega1", "speed_ratio"), np.meshgrid(speeds, ratios, indexing="ij"), strict=True))
    long = {name: values.ravel() for name, values in {**columns, **grid}.items()}
    files = [write_columns(Path(f"{stem}.csv"), long, units)]
    if not tables:
        return files
    for name in MAPPED:
        rows = zip(speeds, columns[name], strict=True)
        wide = {f"{name} at {speed:.6g} {unit}": row for speed, row in rows}
        of_wide = dict.fromkeys(wide, units.get(name, ""))
        files.append(write_columns(Path(f"{stem}_{name}.csv"), {"speed_ratio": ratios, **wide}, of_wide))
    return [*files, write_mat(Path(f"{stem}.mat"), "map", {**columns, "omega1": speeds}, units)]


def _over_ratios(machine: SteadyMachine, omega1: float) -> dict[str, Array]:
    """Return the fields of SteadyPulses by name over RATIOS, shape (n,), at a speed, rad/s."""
    rows = np.array([machine.at(omega1, ratio) for ratio in RATIOS])
    return dict(zip(SteadyPulses._fields, rows.T, strict=True))


def compute_chart(
    parameters: Mapping[str, float | str],
    omega1: float = NOMINAL_SPEED,
    engagements: bool = False,
) -> TorqueConverterChart:
    """Compute the torque converter chart of a mechanism.

    Args:
        parameters: parameters of the module by name that differ from the defaults, as in Module.set.
        omega1: input speed, rad/s, not 0. Without losses the chart is valid for all speeds with this sign;
            backward rotation gives another torque.
        engagements: True to count the engagements of the freewheels; without losses this is the most
            expensive part.

    Raises:
        ParameterError: the parameters are invalid, or there is no mean torque because a freewheel is missing.
    """
    machine = SteadyMachine(parameters)
    machine.check_freewheels()
    if machine.ideal:
        chart = _chart_of_map(parameters, omega1 < 0.0)
        means = _over_ratios(machine, omega1) if engagements else {}
        columns = {name: np.interp(chart.speed_ratio, RATIOS, means[name]) for name in ENGAGEMENTS if means}
        return replace(chart, **columns)
    # a chart with losses ends at the last ratio with a positive output torque
    means = _over_ratios(machine, omega1)
    number = max(np.flatnonzero(means["output_torque"] > 0.0), default=0) + 1
    locks = omega1 > 0.0 and number == RATIOS.size
    means["lock_up_torque"] = np.full(RATIOS.size, machine.lock_up_torque(omega1) if locks else 0.0)
    columns = {name: means[name][:number] / omega1**2 for name in _TORQUES}
    columns |= {name: means[name][:number] for name in ("efficiency", "link2_ratio", *ENGAGEMENTS)}
    return TorqueConverterChart(RATIOS[:number], **columns)


def _chart_of_map(parameters: Mapping[str, float | str], backward: bool) -> TorqueConverterChart:
    """Return the chart of a mechanism without losses, made from the map of fidelity averaged."""
    # the map contains torques over speeds; it does not depend on the kind of drive
    modes = {**parameters, "fidelity": "averaged", "drive": "speed", "load_torque": 0.0}
    modes |= {"omega1": -1.0 if backward else 1.0, "omega2_start": 0.0, "omega_out_start": 0.0}
    d = Module().start(**modes).derived
    side = d.backward if backward else d.forward
    ratios = np.linspace(0.0, side.end, POINTS + 1)
    # at the last ratio the shaft overruns
    modules = [Module().start(**modes | {"omega_out_start": float(ratio)}) for ratio in ratios[:-1]]
    names = ("output_torque", "omega2", "torque_ripple", "torque_peak")
    columns = np.array([module.read(names) for module in modules])
    torque, link2, ripple, peak = np.vstack([columns, columns[-1]]).T
    lock = d.map_lock if side.locks else 0.0
    ones = np.ones(ratios.size)
    return TorqueConverterChart(ratios, torque, ratios * torque, ones, link2, ripple, peak, lock * ones)


def converter_table(machine: SteadyMachine, chart: TorqueConverterChart, omega1: float) -> dict[str, Array]:
    """Compute the converter table of a mechanism.

    The output torque of the table is exact at each ratio (chart.md).

    Args:
        machine: the mechanism.
        chart: chart of the mechanism at this speed.
        omega1: input speed, rad/s, not 0.

    Returns:
        Finite columns by name, shape (n,) each: speed_ratio, output speed relative to input speed, increasing
        from 0; torque_ratio, output torque relative to input torque, limited to LARGEST_TORQUE_RATIO,
        negative if the mechanism brakes the shaft; capacity_factor, omega1 / sqrt(input torque),
        rad/s/(N m)^0.5; output_torque and input_torque, means of the mechanism itself, N m.

    Raises:
        ParameterError: the mechanism transmits no torque at any ratio.
    """
    ratios = COAST * max(1.0, chart.end_ratio)
    coast = np.zeros((ratios.size, 2))
    if not machine.ideal:
        coast = np.array([machine.coasting(omega1, ratio) for ratio in ratios])
    square = omega1 * omega1
    output = np.concatenate([square * chart.output_torque, coast[:, 0]])
    input_torque = np.concatenate([square * chart.input_torque, coast[:, 1]])
    maximum = float(input_torque.max())
    if not maximum > 0.0:
        raise ParameterError(
            f"a converter table requires torque; the mechanism transmits none at {omega1:g} rad/s"
        )
    minimum = np.maximum(output / LARGEST_TORQUE_RATIO, MIN_TORQUE_SHARE * maximum)
    limited = np.maximum(input_torque, minimum)
    return {
        "speed_ratio": np.concatenate([chart.speed_ratio, ratios]),
        "torque_ratio": output / limited,
        "capacity_factor": abs(omega1) / np.sqrt(limited),
        "output_torque": output,
        "input_torque": input_torque,
    }


def save_converter(table: Mapping[str, Array], omega1: float, stem: Path) -> list[Path]:
    """Write a converter table to stem.csv, stem.mat and stem.vtcc, each atomically.

    The MAT file contains a struct converter with units. The .vtcc file is for VECTO. Its input torque at the
    reference speed omega1 has a sign: it is negative if the shaft drives link 1.

    Args:
        table: result of converter_table.
        omega1: input speed, rad/s.
        stem: path of the files without their endings.

    Returns:
        Paths of the files.
    """
    output, input_torque = table["output_torque"], table["input_torque"]
    minimum = np.maximum(np.abs(output) / LARGEST_TORQUE_RATIO, MIN_TORQUE_SHARE * input_torque.max())
    limited = np.copysign(np.maximum(np.abs(input_torque), minimum), input_torque)
    columns = (table["speed_ratio"], output / limited, limited)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    units = {"omega1": "rad/s", **UNITS}
    return [
        write_columns(Path(f"{stem}.csv"), table, units),
        write_mat(Path(f"{stem}.mat"), "converter", {"omega1": omega1, **table}, units),
        write_rows(Path(f"{stem}.vtcc"), VECTO_HEADINGS, rows),
    ]


__getattr__ = renamed_names(__name__, torque_converter_chart="compute_chart")
