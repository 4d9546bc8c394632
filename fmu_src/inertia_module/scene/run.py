"""Simulation of a scene (an FMU in closed loop with drive, load and controller) and its summary."""

from __future__ import annotations

import base64
import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..common.deprecated import renamed_arguments
from ..common.errors import InertiaModuleError, Named, SceneError
from ..common.terminal import Progress
from ..driveline import ClosedLoop, initial_inputs
from ..driveline.cycles import KILOMETRE_PER_HOUR, TIME_TOLERANCE, Cycle
from ..fmi.instance import RestartedFmu
from ..fmi.results import html_table
from ..fmi.simulate import Fmu, Result
from ..interface.variables import BY_NAME, ENUMERATIONS, LOCAL, LOSSES, OUTPUT
from ..kernel.codes import ELASTIC, RIGID
from .headings import heading
from .keys import scene_time_warnings
from .loads import VehicleLoad
from .reading import as_scene
from .schema import Scene

if TYPE_CHECKING:
    from ..common.colours import Picture
    from ..export.systems import Plan
    from .shaft import ShaftScene


# --- summary: speeds, torques, energies, forces ---

# variables of the FMU that the summary and the figure require in addition to the outputs of the scene
SUMMARISED = (
    *("omega2", "omega_out", "input_speed", "input_torque_mean", "output_torque_mean"),
    *("energy_in", "energy_out", "energy_stored", "energy_lost", *LOSSES, "energy_residual"),
    "contact_switches",
    *("housing_engagements", "housing_torque_peak", "housing_slip_peak"),
    *("output_engagements", "torque_peak", "output_slip_peak"),
    "rhs_evaluations",
)


# prefix of the names of acceleration times; the speed follows
TIME_TO = "time_to_"


class Quantity(NamedTuple):
    """Number with its unit.

    Attributes:
        value: The number.
        unit: Unit; "" for counts and ratios.
    """

    value: float
    unit: str


def _time_mean(table: Result, name: str) -> float:
    """Return the mean over the run of an output whose value in a row is the mean over the step before."""
    steps = np.diff(table.time)
    return float(table[name][1:] @ steps / steps.sum())


def input_speed(table: Result) -> NDArray[np.float64]:
    """Return the speed of link 1, rad/s, shape (n,), either prescribed or computed.

    Args:
        table: Record of the run, n rows.
    """
    return table["omega1"] if "omega1" in table else table["input_speed"]


def energy(table: Result) -> dict[str, Quantity]:
    """Return energies of the run, losses by cause (unless 0), efficiency and the energy residual.

    Args:
        table: Record of the run.
    """
    last = table.last()
    stored_gain = last["energy_stored"] - float(table["energy_stored"][0])
    scale = max(abs(last["energy_in"]), abs(last["energy_out"]), abs(stored_gain))
    # Efficiency is 1 - losses / supply. The supply is energy from the drive, from a driving load and from
    # storage. Energy that is stored at the end is no loss. A balancer can supply more than the losses; then
    # there is no efficiency.
    supply = max(last["energy_in"], 0.0) + max(-last["energy_out"], 0.0) + max(-stored_gain, 0.0)
    has_efficiency = last["energy_lost"] >= 0.0 and supply > 0.0
    efficiency = {"efficiency": Quantity(1.0 - last["energy_lost"] / supply, "")} if has_efficiency else {}
    return {
        "energy_in": Quantity(last["energy_in"], "J"),
        "energy_out": Quantity(last["energy_out"], "J"),
        "energy_stored_gain": Quantity(stored_gain, "J"),
        "energy_lost": Quantity(last["energy_lost"], "J"),
        **{name: Quantity(last[name], "J") for name in LOSSES if last.get(name)},
        **efficiency,
        "energy_residual": Quantity(last["energy_residual"], "J"),
        "energy_residual_relative": Quantity(abs(last["energy_residual"]) / scale if scale else 0.0, ""),
    }


def forces(table: Result) -> dict[str, NDArray[np.float64]]:
    """Return the recorded magnitudes of forces, N, and moments, N m, on bearing and mount, by name.

    Balanced forces are omitted. Round-off leaves 1e-15 of their terms.

    Args:
        table: Record of the run.
    """
    magnitudes = {"satellite_force": table["satellite_force"]} if "satellite_force" in table else {}
    for name in ("shaking_force", "shaking_moment"):
        parts = [f"{name}_{axis}" for axis in "xyz"]
        if all(part in table for part in parts):
            magnitudes[name] = np.sqrt(sum(table[part] ** 2 for part in parts))
    maximum = max((float(values.max()) for values in magnitudes.values()), default=0.0)
    return {name: values for name, values in magnitudes.items() if values.max() > 1e-12 * maximum}


def _forces(table: Result) -> dict[str, Quantity]:
    """Return peak and RMS of forces at communication points, and the recorded peak force of the bearing."""
    numbers: dict[str, Quantity] = {}
    for name, values in forces(table).items():
        unit = "N.m" if name == "shaking_moment" else "N"
        numbers[f"{name}_peak"] = Quantity(float(values.max()), unit)
        numbers[f"{name}_rms"] = Quantity(float(np.sqrt(np.mean(values**2))), unit)
    if "satellite_force_peak" in table and table["satellite_force_peak"].any():
        numbers["satellite_force_peak"] = Quantity(float(table["satellite_force_peak"].max()), "N")
    return numbers


# --- operating loads (duty) of the freewheels ---

FREEWHEELS = ("housing", "output")
# consecutive engagements for the maximum frequency: several, because pulses of a bevel module are irregular
CONSECUTIVE = 10
# Minimum overrun between engagements, rad. During shorter overruns the sprags stay engaged, because they wind
# up by 1 to 3 degrees. Jumps of a piecewise constant speed of link 1 cause such overruns.
MIN_OVERRUN = math.radians(0.1)
# name of the note on a run without freewheel duty
DUTY = "freewheel_duty"


def engagements(table: Result, freewheel: str) -> NDArray[np.float64]:
    """Count engagements up to each row, except after overruns shorter than MIN_OVERRUN.

    The angle of an overrun is an upper bound: the sum of maximum slip times step.

    Args:
        table: Record of the run, n rows.
        freewheel: Name in FREEWHEELS.

    Returns:
        Number of engagements, shape (n,).
    """
    increments = np.diff(table[f"{freewheel}_engagements"])
    rows = np.flatnonzero(increments)
    angles = np.cumsum(table[f"{freewheel}_slip_peak"][1:] * np.diff(table.time))[rows]
    increments[rows[np.diff(angles, prepend=0.0) < MIN_OVERRUN * increments[rows]]] = 0.0
    return np.append(0.0, np.cumsum(increments))


def fastest(time: NDArray[np.float64], count: NDArray[np.float64]) -> float:
    """Return the maximum frequency of CONSECUTIVE consecutive events, Hz.

    Args:
        time: Times, s, shape (n,).
        count: Number of events up to each time, shape (n,).
    """
    rows, number = np.flatnonzero(np.diff(count)), int(count[-1])
    group = min(CONSECUTIVE, number - 1)
    if group < 1:
        return number / float(np.ptp(time))
    points = np.append(rows[0], rows + 1)
    times = np.interp(np.arange(1, number + 1), count[points], time[points])
    return group / float((times[group:] - times[:-group]).min())


# parameter of the stiffness by freewheel
STIFFNESS = {"housing": "housing_stiffness", "output": "freewheel_stiffness"}


def has_impacts(parameters: Mapping[str, float], freewheel: str) -> bool:
    """Return True if a freewheel locks by impacts, because it is rigid and has an engagement angle.

    Args:
        parameters: Parameters of the module, SI, by name.
        freewheel: Name in FREEWHEELS.
    """
    is_rigid = parameters.get("fidelity", RIGID) != ELASTIC or not parameters.get(STIFFNESS[freewheel], 0.0)
    return is_rigid and parameters.get(f"{freewheel}_engagement_angle", 0.0) > 0.0


def impacts(table: Result, freewheel: str, stiffness: float | None) -> dict[str, Quantity]:
    """Return the maximum impact energy of a freewheel and an estimate of the impact torque.

    A rigid impact has an impulse and no finite torque. It dissipates the energy E = J slip^2 / 2 of the
    relative motion, where J is the reduced inertia. A freewheel of stiffness c absorbs the same energy in a
    half sine of the torque, whose maximum is slip sqrt(c J) = sqrt(2 c E).
    E includes all freewheel losses in the communication step, so it is an upper bound.

    Args:
        table: Record of the run.
        freewheel: Name in FREEWHEELS.
        stiffness: Stiffness of the locked freewheel, N.m/rad; None if it is unknown.
    """
    has_engagement = np.diff(table[f"{freewheel}_engagements"]) > 0.0
    lost = np.diff(table["energy_lost_freewheel"])
    energy = float(np.max(lost[has_engagement], initial=0.0))
    numbers = {f"{freewheel}_impact_energy": Quantity(energy, "J")}
    if stiffness is not None:
        torque = math.sqrt(2.0 * stiffness * max(energy, 0.0))
        numbers[f"{freewheel}_impact_torque"] = Quantity(torque, "N.m")
    return numbers


def impact_warnings(scene: Scene, duty: Mapping[str, Quantity]) -> list[str]:
    """Return warnings about impacts that exceed the torque limit of a freewheel or cannot be checked.

    Args:
        scene: The scene.
        duty: Metrics of freewheel_duty.
    """
    texts, stiffness = [], scene.freewheels.of("stiffness")
    for name, limit in scene.freewheels.of("torque").items():
        if f"{name}_impact_energy" not in duty:
            continue
        if name not in stiffness:
            texts.append(
                f"{name} torque peak excludes impacts: a rigid freewheel with an engagement angle has no"
                f" finite torque in them; set freewheels.{name}.stiffness to compare them with the limit,"
                f" {limit:.6g} N.m, or mechanism.{STIFFNESS[name]} at fidelity elastic"
            )
        elif (torque := duty[f"{name}_impact_torque"].value) > limit:
            texts.append(
                f"{name} impact torque is above the limit of the freewheel, {limit:.6g} N.m: {torque:.6g} N.m"
                f" (estimate with {stiffness[name]:.6g} N.m/rad)"
            )
    return texts


def freewheel_duty(
    table: Result, parameters: Mapping[str, float], stiffness: Mapping[str, float] = MappingProxyType({})
) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Return engagement frequencies, maximum torque, maximum slip and impacts of each freewheel.

    Args:
        table: Record of the run.
        parameters: Parameters of the module, SI, by name.
        stiffness: Stiffness of freewheels that are rigid in the run, N.m/rad, by name.

    Returns:
        Metrics, and notes on missing metrics, by name.
    """
    fidelity, metrics = int(parameters.get("fidelity", RIGID)), dict[str, Quantity]()
    for need in BY_NAME["output_engagements"].needs:
        if fidelity in need.lacking:
            level = ENUMERATIONS["Fidelity"][fidelity][0]
            return {}, {DUTY: f"is not available: fidelity {level} {need.reason}"}
    for name, torque in zip(FREEWHEELS, ("housing_torque_peak", "torque_peak"), strict=True):
        if parameters.get(f"{name}_freewheel", 1.0):
            count = engagements(table, name)
            mean = float(count[-1]) / float(np.ptp(table.time))
            metrics[f"{name}_engagement_frequency_mean"] = Quantity(mean, "Hz")
            metrics[f"{name}_engagement_frequency_maximum"] = Quantity(fastest(table.time, count), "Hz")
            metrics[f"{name}_torque_peak"] = Quantity(float(table[torque].max()), "N.m")
            metrics[f"{name}_slip_peak"] = Quantity(float(table[f"{name}_slip_peak"].max()), "rad/s")
            if has_impacts(parameters, name):
                metrics |= impacts(table, name, stiffness.get(name))
    return metrics, {}


# --- summary of a vehicle, complete summary ---


def work(table: Result, torque: str) -> NDArray[np.float64]:
    """Return the work of a torque on the load up to each row, J, shape (n,).

    Args:
        table: Record of the run, n rows.
        torque: Name of the column of the torque, which is constant in each step.
    """
    mean_speed = 0.5 * (table["load_speed"][1:] + table["load_speed"][:-1])
    increments = table[torque][:-1] * mean_speed * np.diff(table.time)
    return np.concatenate([[0.0], np.cumsum(increments)])


def time_to(speed: float) -> str:
    """Return the name of the acceleration time to a speed.

    Args:
        speed: Target speed, m/s.
    """
    return f"{TIME_TO}{speed / KILOMETRE_PER_HOUR:.6g}_kmh"


# Minimum standstill between two launches, s. Shorter stops are between the pulses of one launch.
STANDSTILL = 0.5


def launch_time(time: NDArray[np.float64], speed: NDArray[np.float64]) -> float:
    """Return the time from which the vehicle moves forward in the last launch, s.

    A launch begins with the run or with the last standstill of at least STANDSTILL. The time is the last one
    at the rearmost position, so that motion undone by rolling back does not count.

    Args:
        time: Times, s, shape (n,), up to the row in which the vehicle reaches the target speed.
        speed: Speed of the vehicle, m/s, shape (n,).
    """
    edges = np.flatnonzero(np.diff(speed == 0.0, prepend=False, append=False))
    begins, ends = edges[::2], edges[1::2] - 1
    stops = begins[time[ends] - time[begins] >= STANDSTILL * (1.0 - 1e-9)]
    first = int(stops[-1]) if stops.size else 0
    positions = np.cumsum(0.5 * (speed[first + 1 :] + speed[first:-1]) * np.diff(time[first:]))
    distance = np.append(0.0, positions)
    return float(time[first + distance.size - 1 - int(np.argmin(distance[::-1]))])


def times_to(table: Result, speeds: Sequence[float]) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Return the acceleration time to each speed since launch_time.

    Args:
        table: Record of the run, with the column vehicle_speed.
        speeds: Target speeds, m/s.

    Returns:
        Times, s, and notes on speeds that are not reached, by name.
    """
    times, remarks, vehicle_speed = {}, {}, table["vehicle_speed"]
    in_kmh = vehicle_speed / KILOMETRE_PER_HOUR
    for speed in speeds:
        row = int(np.argmax(vehicle_speed >= speed))
        if row:  # 0 if the speed is never reached, or reached from the start
            pair = slice(row - 1, row + 1)
            begin = launch_time(table.time[: row + 1], vehicle_speed[: row + 1])
            time = float(np.interp(speed, vehicle_speed[pair], table.time[pair]) - begin)
            times[time_to(speed)] = Quantity(time, "s")
        elif vehicle_speed[0] >= speed:
            remarks[time_to(speed)] = f"not available (the run starts at {in_kmh[0]:.4g} km/h)"
        else:
            remarks[time_to(speed)] = f"not reached (maximum {in_kmh.max():.4g} km/h)"
    return times, remarks


# metric of the summary that the grip limits
TRACTIVE_FORCE = "tractive_force_maximum"


def tractive_force(table: Result, load: VehicleLoad) -> NDArray[np.float64]:
    """Return the mean tractive force in each step, N, shape (n - 1,).

    The force accelerates the vehicle and overcomes all resistances. In steps at rest it is 0.

    Args:
        table: Record of the run, n rows.
        load: The vehicle.
    """
    parts = ("rolling_torque", "drag_torque", "slope_torque", "brake_torque")
    ratio = load.final_drive / load.wheel_radius
    resistance = ratio * sum(table[part][:-1] for part in parts)
    speed = table["vehicle_speed"]
    force: NDArray[np.float64] = load.mass * np.diff(speed) / np.diff(table.time) + resistance
    return np.where((speed[1:] != 0.0) | (speed[:-1] != 0.0), force, 0.0)


def grip(table: Result, load: VehicleLoad) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Compare the tractive force with the grip of the driven wheels, which the run does not limit.

    Args:
        table: Record of the run.
        load: The vehicle.

    Returns:
        Maximum tractive force, N, and a note if it exceeds the grip, by name; both empty without a friction
        coefficient.
    """
    if load.grip is None:
        return {}, {}
    force = tractive_force(table, load)
    numbers = {TRACTIVE_FORCE: Quantity(float(force.max()), "N")}
    excess = np.flatnonzero(force > load.grip)
    if not excess.size:
        return numbers, {}
    share = float(np.diff(table.time)[excess].sum())
    first = f"first at {table.time[excess[0]]:.4g} s"
    text = f"is exceeded for {share:.4g} s, {first}: the wheels would slip, the run assumes that they roll"
    return numbers, {"grip": text}


def _vehicle(table: Result) -> dict[str, Quantity]:
    parts = ("rolling", "drag", "slope", "brake")
    energies = {f"energy_{part}": Quantity(float(work(table, f"{part}_torque")[-1]), "J") for part in parts}
    speed = float(table["vehicle_speed"].max()) / KILOMETRE_PER_HOUR
    return {
        "distance": Quantity(float(table["distance"][-1]), "m"),
        "vehicle_speed_maximum": Quantity(speed, "km/h"),
        **energies,
    }


def out_of_tolerance(table: Result, cycle: Cycle) -> NDArray[np.float64]:
    """Return the deviation of the speed from the tolerance band of a cycle.

    Args:
        table: Record of the run, with the column vehicle_speed, n rows.
        cycle: Driving cycle of the vehicle.

    Returns:
        Deviation, m/s, shape (n,): positive above the band, negative below, 0 within.
    """
    speed = table["vehicle_speed"]
    excess: NDArray[np.float64] = speed - np.clip(speed, *cycle.tolerance_band(table.time))
    return excess


def cycle_remarks(table: Result, cycle: Cycle) -> dict[str, str]:
    """Return notes on a cycle that is longer than the run or that the vehicle does not follow, by name.

    The vehicle does not follow a cycle if it is out of tolerance for longer than TIME_TOLERANCE at a time.

    Args:
        table: Record of the run, with the column vehicle_speed.
        cycle: Driving cycle of the vehicle.
    """
    remarks, time, excess = {}, table.time, out_of_tolerance(table, cycle)
    if time[-1] < cycle.duration * (1.0 - 1e-9):
        remarks["stop_time"] = f"is {time[-1]:g} s, but {cycle.name} lasts {cycle.duration:g} s"
    edges = np.flatnonzero(np.diff(excess != 0.0, prepend=False, append=False))
    begins, ends = edges[::2], np.minimum(edges[1::2], len(time) - 1)
    long = time[ends] - time[begins] > TIME_TOLERANCE + 1e-9
    if not long.any():
        return remarks
    rows = np.concatenate([np.arange(*pair) for pair in zip(begins[long], ends[long], strict=True)])
    worst = rows[np.argmax(np.abs(excess[rows]))]
    deviation = float(table["vehicle_speed"][worst] - cycle.speed_at(time[worst])) / KILOMETRE_PER_HOUR
    occasions = "once, at" if long.sum() == 1 else f"{long.sum()} times, first at"
    remarks["vehicle_speed"] = (
        f"does not follow {cycle.name}: out of tolerance for more than {TIME_TOLERANCE:g} s at a time"
        f" ({occasions} {time[begins[long][0]]:.6g} s); largest deviation {abs(deviation):.3g} km/h too"
        f" {'fast' if deviation > 0.0 else 'slow'} at {time[worst]:.6g} s"
    )
    return remarks


def summarise(
    table: Result, cycle: Cycle | None, wall_time: float, also: Mapping[str, Quantity]
) -> dict[str, Quantity]:
    """Return the metrics of a run by name.

    Args:
        table: Record of the run, with all variables in SUMMARISED and the signals of the loop.
        cycle: Driving cycle of the vehicle, or None.
        wall_time: Duration of the computation, s.
        also: More metrics, such as the results of times_to and freewheel_duty.
    """
    duration = float(table.time[-1] - table.time[0])
    summary = {
        "simulated_time": Quantity(duration, "s"),
        "omega1_maximum": Quantity(float(input_speed(table).max()), "rad/s"),
        "omega_out_maximum": Quantity(float(table["omega_out"].max()), "rad/s"),
        "omega_out_final": Quantity(float(table["omega_out"][-1]), "rad/s"),
        "input_torque_mean": Quantity(_time_mean(table, "input_torque_mean"), "N.m"),
        "output_torque_mean": Quantity(_time_mean(table, "output_torque_mean"), "N.m"),
        "output_torque_mean_maximum": Quantity(float(table["output_torque_mean"].max()), "N.m"),
        # Each pulse has several switches.
        "contact_switches": Quantity(float(table["contact_switches"][-1]), ""),
        **energy(table),
        **_forces(table),
        **also,
    }
    if "vehicle_speed" in table:
        summary |= _vehicle(table)
    if "reference" in table:
        measured, factor, unit = "omega_out", 1.0, "rad/s"
        if "vehicle_speed" in table:
            measured, factor, unit = "vehicle_speed", KILOMETRE_PER_HOUR, "km/h"
        error = (table[measured] - table["reference"]) / factor
        summary["tracking_error_rms"] = Quantity(float(np.sqrt(np.mean(error**2))), unit)
        summary["tracking_error_maximum"] = Quantity(float(np.abs(error).max()), unit)
    if cycle is not None:
        # Each row counts for the step after it.
        outside = out_of_tolerance(table, cycle)[:-1] != 0.0
        seconds = float(np.sum(np.diff(table.time)[outside]))
        summary["time_out_of_tolerance"] = Quantity(seconds, "s")
        summary["share_out_of_tolerance"] = Quantity(100.0 * seconds / duration, "%")
    return {
        **summary,
        "rhs_evaluations": Quantity(float(table["rhs_evaluations"][-1]), ""),
        "wall_time": Quantity(wall_time, "s"),
        "real_time_factor": Quantity(duration / wall_time, ""),
    }


# --- runs ---


@dataclass(frozen=True, eq=False, kw_only=True, repr=False, match_args=False)
class SceneResult(Result):
    """Result of a scene, of a module or of a driven shaft alone: a table over time and a summary.

    The columns are the outputs of the scene, the signals of the loop, and more variables that the summary
    requires.

    Attributes:
        columns: Columns by name, shape (n,) each.
        units: Units of the columns, by name.
        origin: None.
        scene: The scene.
        quantities: Metrics with units, by name.
        summary: Values of the metrics, by name.
        metric_units: Units of the metrics, by name; "" for counts and ratios.
        remarks: Notes on missing or doubtful metrics, by name, such as a speed that is not reached.
        limits: Limits in the scene, by metric, in the unit of the metric.
        warnings: Warnings of the FMU, of exceeded limits, and of tables that do not match the run time.
    """

    scene: Scene | ShaftScene
    quantities: dict[str, Quantity]
    remarks: dict[str, str] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"SceneResult({self.scene.title!r}, {self._size_text()})"

    @property
    def table(self) -> Result:
        """Return the table of the outputs of the scene and the signals of the loop."""
        variables = self.scene.VARIABLES.values()
        outputs = {row.name for row in variables if row.causality in (OUTPUT, LOCAL)}
        return self.record.without(outputs - set(self.scene.run.outputs))

    @property
    def record(self) -> Result:
        """Return all columns as a table without the summary."""
        return Result(self.columns, self.units)

    @property
    def summary(self) -> dict[str, float]:
        """Return the values of the metrics by name."""
        values = {name: quantity.value for name, quantity in self.quantities.items()}
        return Named(values, "metric of the summary", self.remarks)

    @property
    def metric_units(self) -> dict[str, str]:
        """Return the units of the metrics by name; "" for counts and ratios."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}

    def as_dict(self) -> dict[str, object]:
        """Return version, title, parameters, summary, units, limits, notes and warnings, for JSON."""
        parameters = self.scene.parameters()
        of_parameters = {name: self.scene.VARIABLES[name].unit for name in parameters}
        return {
            "inertia_module": __version__,
            "title": self.scene.title,
            "parameters": parameters,
            "summary": self.summary,
            "units": of_parameters | self.metric_units,
            "limits": self.limits,
            "remarks": self.remarks,
            "warnings": list(self.warnings),
        }

    def lines(self) -> dict[str, str]:
        """Return the metrics with units and limits, and the notes, as texts by heading."""
        numbers = {name: f"{value:.6g} {unit}".rstrip() for name, (value, unit) in self.quantities.items()}
        for name, limit in self.limits.items():
            numbers[name] += f", limit {limit:.6g}"
        return {heading(name): text for name, text in (numbers | self.remarks).items()}

    def plot(self, *names: str) -> Picture:
        """Plot columns over time, with one panel for each unit, as Result.plot.

        Args:
            names: Names of columns; without names the outputs of the scene and the signals of the loop.
        """
        return super().plot(*(names or self.table.names[1:]))

    def _repr_html_(self) -> str:
        """Return the plot and the summary as HTML, for notebooks."""
        picture = base64.b64encode(self._repr_png_()).decode()
        return f'<img src="data:image/png;base64,{picture}">' + html_table(
            (self.scene.title, ""), self.lines().items()
        )


def start_of(scene: Scene) -> tuple[dict[str, float], dict[str, float]]:
    """Return parameters (with tolerance) and initial inputs of the FMU for a scene, SI, by name.

    Args:
        scene: The scene.

    Raises:
        SceneError: The fidelity of the scene is 'auto'.
    """
    if scene.chooses_fidelity:
        raise SceneError(
            "mechanism.fidelity must be a named level (got 'auto'). Choose one with fidelity.choice.choose."
        )
    values = scene.parameters()
    if scene.accuracy.tolerance is not None:
        values["tolerance"] = scene.accuracy.tolerance
    omega1 = scene.drive.start_speed
    measured = {"omega_out": values.get("omega_out_start", 0.0), "input_speed": omega1 or 0.0}
    inputs = initial_inputs(scene.surroundings, measured)
    return values, inputs if omega1 is None else {**inputs, "omega1": omega1}


def scene_plan(scene: Scene) -> Plan:
    """Plan the export of a scene: the FMUs of its mechanism with their initial values.

    Args:
        scene: The scene.

    Raises:
        SceneError: The scene has elastic freewheels, or its fidelity is 'auto'.
    """
    from ..export.systems import make_plan  # imports the builder of FMUs

    values, inputs = start_of(scene)
    for name in ("housing_stiffness", "freewheel_stiffness"):
        if values.get("fidelity") == ELASTIC and values.get(name, 0.0) > 0.0:
            raise SceneError(
                f"mechanism.{name} must be 0 for an export (got {values[name]:g}). An elastic mechanism is"
                " exported as a rigid module and a shaft. Neither has freewheel compliance."
            )
    return make_plan(scene.title, values, inputs, scene.run.communication_step, scene.run.stop_time)


@renamed_arguments(fmu_path="fmu")
def run_scene(
    scene: Scene | Path | str,
    fmu: Path | str | None = None,
    progress: Progress | None = None,
    also: Iterable[str] = (),
) -> SceneResult:
    """Run a scene with an FMU of the module.

    Args:
        scene: Scene, or path of its file.
        fmu: InertiaModule.fmu, or another FMU with the same variables; None for current_fmu().
        progress: Function called with the completed fraction of the run, 0 to 1.
        also: Names of more outputs and local variables of the FMU to record.

    Raises:
        FmuError: The FMU cannot be loaded, or rejects a value or a step.
        SceneError: The scene is invalid, or its fidelity is 'auto'.
    """
    scene = as_scene(scene)
    values, inputs = start_of(scene)
    with Fmu(fmu, values, inputs, stop_time=scene.run.stop_time) as instance:
        result = _run_on(instance, scene, progress, also)
    return replace(result, remarks={**result.remarks, **above_stall(result, scene.parameters())})


def above_stall(record: Result, parameters: dict[str, float]) -> dict[str, str]:
    """Return a note if the load is above the stall torque and the shaft rests in the last tenth of the run.

    Args:
        record: Record of the run.
        parameters: Parameters of the module, SI, by name.
    """
    end = slice(-max(len(record) // 10, 1), None)
    speed, load = (float(np.mean(values[end])) for values in (input_speed(record), record["load_torque"]))
    has_brake = "brake_torque" in record and record["brake_torque"][end].any()
    revolutions = abs(speed) * float(np.ptp(record.time)) / math.tau
    if has_brake or revolutions < 1.0 or record["omega_out"][end].min() > 1e-6 * abs(speed):
        return {}
    from ..analysis.converter_chart import SteadyMachine  # imports scipy

    try:
        stall = SteadyMachine(parameters).at(speed, 0.0).output_torque
    except InertiaModuleError:  # stall requires both freewheels
        return {}
    above = f"exceeds the stall torque of {stall:.4g} N.m at {speed:.4g} rad/s ({load:.4g} N.m)"
    return {"load_torque": above} if load > stall else {}


class SceneRunner(RestartedFmu):
    """Instance of an FMU with states that runs several scenes; a context manager.

    A run costs a tenth of a run with a new instance. Metrics are bitwise identical to run_scene. Warnings of
    the FMU can be missing, and there is no note of above_stall.
    """

    def run(self, scene: Scene) -> SceneResult:
        """Run a scene.

        Args:
            scene: The scene.

        Raises:
            FmuError: The FMU rejects a value or a step.
            SceneError: The fidelity of the scene is 'auto'.
        """
        return _run_on(self.started(scene), scene)

    def started(self, scene: Scene) -> Fmu:
        """Return the instance, restarted with the initial values of a scene.

        Args:
            scene: The scene.

        Raises:
            FmuError: The FMU rejects a value.
            SceneError: The fidelity of the scene is 'auto'.
        """
        values, inputs = start_of(scene)
        self.restart({**values, **inputs})
        return self


def _run_on(
    fmu: Fmu, scene: Scene, progress: Progress | None = None, also: Iterable[str] = ()
) -> SceneResult:
    """Run a scene with a started FMU."""
    loop = ClosedLoop(fmu, scene.surroundings, [*scene.run.outputs, *SUMMARISED, *also], scene.signal_units)
    start = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    wall_time = time.perf_counter() - start
    speeds = getattr(scene.load, "times_to", ())
    times, remarks = times_to(record, speeds) if speeds else ({}, {})
    if scene.cycle is not None:
        remarks |= cycle_remarks(record, scene.cycle)
    duty, notes = freewheel_duty(record, scene.parameters(), scene.freewheels.of("stiffness"))
    impact = impact_warnings(scene, duty)
    limits = {name: limit for name, limit in scene.freewheels.limits().items() if name in duty}
    if isinstance(scene.load, VehicleLoad) and scene.load.grip is not None:
        numbers, slipping = grip(record, scene.load)
        duty, notes, limits = duty | numbers, notes | slipping, limits | {TRACTIVE_FORCE: scene.load.grip}
    quantities = summarise(record, scene.cycle, wall_time, times | duty)
    exceeded = [
        f"{name.replace('_', ' ')} exceeds its limit of {limit:.6g} {unit}: {duty[name].value:.6g} {unit}"
        for name, limit in limits.items()
        if duty[name].value > limit
        for unit in [duty[name].unit]
    ]
    return SceneResult(
        record.columns,
        record.units,
        scene=scene,
        quantities=quantities,
        remarks=remarks | notes,
        limits=limits,
        warnings=(*fmu.warnings, *exceeded, *impact, *scene_time_warnings(scene, scene.run.stop_time)),
    )
