"""Simulation of a scene: FMU in closed loop with drive, load and controller; result table and summary."""

from __future__ import annotations

import base64
import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..common.equality import ByContent
from ..common.errors import Named, Refused
from ..common.terminal import Progress
from ..contract.variables import BY_NAME, ENUMERATIONS, LOCAL, LOSSES, OUTPUT
from ..harness.fmu import RestartedFmu
from ..harness.results import html_table
from ..harness.simulate import Fmu, Result
from ..kernel.codes import ELASTIC, RIGID
from ..loops import ClosedLoop, initial_inputs
from ..loops.cycles import KILOMETRE_PER_HOUR, TIME_TOLERANCE, Cycle
from .headings import heading
from .keys import SceneError, scene_time_warnings
from .parts import VehicleLoad
from .schema import Scene

if TYPE_CHECKING:
    from ..export.systems import Plan


# --- the summary: speeds, torques, energy, cost, and how well a cycle was followed ---

# variables of the FMU that the summary and the figure need, whatever outputs the scene wants
SUMMARISED = (
    *("omega2", "omega_out", "input_speed", "input_torque_mean", "output_torque_mean"),
    *("energy_in", "energy_out", "energy_stored", "energy_lost", *LOSSES, "energy_residual"),
    "contact_switches",
    *("housing_engagements", "housing_torque_peak", "housing_slip_peak"),
    *("output_engagements", "torque_peak", "output_slip_peak"),
    "rhs_evaluations",
)


# a time to a speed is called so and the speed; there is one only where the speed is reached
TIME_TO = "time_to_"


class Quantity(NamedTuple):
    """One number of a summary in its unit, which is "" for counts and ratios."""

    value: float
    unit: str


def _time_mean(table: Result, name: str) -> float:
    """Mean of a step mean over the run: the value at a row is the mean over the step before it."""
    steps = np.diff(table.time)
    return float(table[name][1:] @ steps / steps.sum())


def input_speed(table: Result) -> NDArray[np.float64]:
    """Speed of link 1, rad/s: prescribed by the drive, or computed where the drive gives a torque."""
    return table["omega1"] if "omega1" in table else table["input_speed"]


def energy(table: Result) -> dict[str, Quantity]:
    """Energies since the start, losses by cause where there are any, efficiency, and the residual."""
    last = table.last()
    stored = last["energy_stored"] - float(table["energy_stored"][0])
    scale = max(abs(last["energy_in"]), abs(last["energy_out"]), abs(stored))
    # the share of all energy put in, by the drive, by a load that drives, by motion used up, that is not
    # lost: what is still stored counts as kept; with a balancer that gives more than is lost there is none
    put_in = max(last["energy_in"], 0.0) + max(-last["energy_out"], 0.0) + max(-stored, 0.0)
    known = last["energy_lost"] >= 0.0 and put_in > 0.0
    efficiency = {"efficiency": Quantity(1.0 - last["energy_lost"] / put_in, "")} if known else {}
    return {
        "energy_in": Quantity(last["energy_in"], "J"),
        "energy_out": Quantity(last["energy_out"], "J"),
        "energy_stored_gain": Quantity(stored, "J"),
        "energy_lost": Quantity(last["energy_lost"], "J"),
        **{name: Quantity(last[name], "J") for name in LOSSES if last.get(name)},
        **efficiency,
        "energy_residual": Quantity(last["energy_residual"], "J"),
        "energy_residual_relative": Quantity(abs(last["energy_residual"]) / scale if scale else 0.0, ""),
    }


def forces(table: Result) -> dict[str, NDArray[np.float64]]:
    """Magnitudes of the forces, N, and moments, N m, that are recorded and known: on bearing and mount.

    Those that balance are left out: rounding leaves 1e-15 of what they are made of.
    """
    found = {"satellite_force": table["satellite_force"]} if "satellite_force" in table else {}
    for name in ("shaking_force", "shaking_moment"):
        parts = [f"{name}_{axis}" for axis in "xyz"]
        if all(part in table for part in parts):
            found[name] = np.sqrt(sum(table[part] ** 2 for part in parts))
    largest = max((float(values.max()) for values in found.values()), default=0.0)
    return {name: values for name, values in found.items() if values.max() > 1e-12 * largest}


def _forces(table: Result) -> dict[str, Quantity]:
    """Peak and RMS at the communication points; of the bearing the peak in between, where recorded."""
    numbers: dict[str, Quantity] = {}
    for name, values in forces(table).items():
        unit = "N.m" if name == "shaking_moment" else "N"
        numbers[f"{name}_peak"] = Quantity(float(values.max()), unit)
        numbers[f"{name}_rms"] = Quantity(float(np.sqrt(np.mean(values**2))), unit)
    if "satellite_force_peak" in table and table["satellite_force_peak"].any():
        numbers["satellite_force_peak"] = Quantity(float(table["satellite_force_peak"].max()), "N")
    return numbers


# --- the duty of the freewheels ---

FREEWHEELS = ("housing", "output")
# engagements in a row that tell the largest frequency: a few pulses, for those of a bevel module are uneven
IN_A_ROW = 10
# rad: through a shorter overrun sprags, which wind up by 1 to 3 degrees, stay engaged; a speed of link 1 that
# is held over each step makes one at each of its jumps
LEAST_OVERRUN = math.radians(0.1)
# name of the remark on a run that does not tell the duty
DUTY = "freewheel_duty"


def engagements(table: Result, freewheel: str) -> NDArray[np.float64]:
    """Count engagements up to each row, shape (n,), but those after overruns of less than LEAST_OVERRUN.

    An overrun is as long as its largest speed in each step says.
    """
    more = np.diff(table[f"{freewheel}_engagements"])
    rows = np.flatnonzero(more)
    turned = np.cumsum(table[f"{freewheel}_slip_peak"][1:] * np.diff(table.time))[rows]
    more[rows[np.diff(turned, prepend=0.0) < LEAST_OVERRUN * more[rows]]] = 0.0
    return np.append(0.0, np.cumsum(more))


def fastest(time: NDArray[np.float64], count: NDArray[np.float64]) -> float:
    """Find the largest frequency, Hz, of IN_A_ROW events in a row, by their count up to each time, s."""
    rows, number = np.flatnonzero(np.diff(count)), int(count[-1])
    together = min(IN_A_ROW, number - 1)
    if together < 1:
        return number / float(np.ptp(time))
    known = np.append(rows[0], rows + 1)
    times = np.interp(np.arange(1, number + 1), count[known], time[known])
    return together / float((times[together:] - times[:-together]).min())


# parameters of the stiffness of both freewheels
STIFFNESS = {"housing": "housing_stiffness", "output": "freewheel_stiffness"}


def has_impacts(parameters: Mapping[str, float], freewheel: str) -> bool:
    """Return True if a freewheel closes by impacts: it is rigid and has an engagement angle."""
    is_rigid = parameters.get("fidelity", RIGID) != ELASTIC or not parameters.get(STIFFNESS[freewheel], 0.0)
    return is_rigid and parameters.get(f"{freewheel}_engagement_angle", 0.0) > 0.0


def impacts(table: Result, freewheel: str, stiffness: float | None) -> dict[str, Quantity]:
    """Return the largest energy of an impact of a freewheel, and the torque that it causes.

    A rigid impact has an impulse and no finite torque. The energy E of the relative motion, half the reduced
    inertia times the square of the slip, is what the module loses in it. A freewheel of stiffness c takes up
    the same energy in half a sine of the torque, whose largest value is slip sqrt(c J) = sqrt(2 c E).
    All losses of freewheels in the communication step count, so that E is an upper bound.

    Args:
        table: of the run.
        freewheel: one of FREEWHEELS.
        stiffness: of the closed freewheel, N.m/rad; None if it is unknown.
    """
    engaged = np.diff(table[f"{freewheel}_engagements"]) > 0.0
    lost = np.diff(table["energy_lost_freewheel"])
    energy = float(np.max(lost[engaged], initial=0.0))
    numbers = {f"{freewheel}_impact_energy": Quantity(energy, "J")}
    if stiffness is not None:
        torque = math.sqrt(2.0 * stiffness * max(energy, 0.0))
        numbers[f"{freewheel}_impact_torque"] = Quantity(torque, "N.m")
    return numbers


def impact_warnings(scene: Scene, duty: Mapping[str, Quantity]) -> list[str]:
    """Return warnings on freewheels whose torque limit the run cannot judge, or whose impacts exceed it.

    Args:
        scene: the scene.
        duty: numbers of freewheel_duty.
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
                f"{name} impact torque is above the limit of the freewheel, {limit:.6g} N.m: {torque:.6g}"
                f" (estimate with {stiffness[name]:.6g} N.m/rad)"
            )
    return texts


def freewheel_duty(
    table: Result, parameters: Mapping[str, float], stiffness: Mapping[str, float] = MappingProxyType({})
) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Find how often each freewheel engages, and the most that it carries and overruns with; else why not.

    Args:
        table: of the run.
        parameters: of the module.
        stiffness: of closed freewheels that are rigid in the run, N.m/rad, by name.
    """
    fidelity, found = int(parameters.get("fidelity", RIGID)), dict[str, Quantity]()
    for need in BY_NAME["output_engagements"].needs:
        if fidelity in need.lacking:
            level = ENUMERATIONS["Fidelity"][fidelity][0]
            return {}, {DUTY: f"is not available: fidelity {level} {need.reason}"}
    for name, torque in zip(FREEWHEELS, ("housing_torque_peak", "torque_peak"), strict=True):
        if parameters.get(f"{name}_freewheel", 1.0):
            count = engagements(table, name)
            mean = float(count[-1]) / float(np.ptp(table.time))
            found[f"{name}_engagement_frequency_mean"] = Quantity(mean, "Hz")
            found[f"{name}_engagement_frequency_maximum"] = Quantity(fastest(table.time, count), "Hz")
            found[f"{name}_torque_peak"] = Quantity(float(table[torque].max()), "N.m")
            found[f"{name}_slip_peak"] = Quantity(float(table[f"{name}_slip_peak"].max()), "rad/s")
            if has_impacts(parameters, name):
                found |= impacts(table, name, stiffness.get(name))
    return found, {}


# --- a vehicle, and the whole summary ---


def work(table: Result, torque: str) -> NDArray[np.float64]:
    """Work of a torque on the load, held over each step, up to each row, J."""
    mean_speed = 0.5 * (table["load_speed"][1:] + table["load_speed"][:-1])
    done = table[torque][:-1] * mean_speed * np.diff(table.time)
    return np.concatenate([[0.0], np.cumsum(done)])


def time_to(speed: float) -> str:
    """Name of the time to a speed, m/s."""
    return f"{TIME_TO}{speed / KILOMETRE_PER_HOUR:.6g}_kmh"


# s: a car that stands for at least so long is launched again; shorter stops are between pulses of one launch
STANDSTILL = 0.5


def launch_time(time: NDArray[np.float64], speed: NDArray[np.float64]) -> float:
    """Return the time, s, of the first motion that is not undone, in the last launch.

    A launch begins with the run or with the last standstill of at least STANDSTILL. Motion is undone if the
    car rolls back to where it began.

    Args:
        time: s, shape (n,).
        speed: of the vehicle, m/s, shape (n,), up to the row at which it is fast enough.
    """
    edges = np.flatnonzero(np.diff(speed == 0.0, prepend=False, append=False))
    begins, ends = edges[::2], edges[1::2] - 1
    stops = begins[time[ends] - time[begins] >= STANDSTILL * (1.0 - 1e-9)]
    first = int(stops[-1]) if stops.size else 0
    moved = np.cumsum(0.5 * (speed[first + 1 :] + speed[first:-1]) * np.diff(time[first:]))
    distance = np.append(0.0, moved)
    return float(time[first + distance.size - 1 - int(np.argmin(distance[::-1]))])


def times_to(table: Result, speeds: Sequence[float]) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Find the time to each speed since launch_time, or the reason why there is none.

    Args:
        table: with the column vehicle_speed.
        speeds: m/s.

    Returns:
        Times, s, and remarks, by name.
    """
    found, remarks, vehicle_speed = {}, {}, table["vehicle_speed"]
    shown = vehicle_speed / KILOMETRE_PER_HOUR
    for speed in speeds:
        reached = int(np.argmax(vehicle_speed >= speed))
        if reached:  # 0 where it never is, or is from the start
            around = slice(reached - 1, reached + 1)
            begin = launch_time(table.time[: reached + 1], vehicle_speed[: reached + 1])
            time = float(np.interp(speed, vehicle_speed[around], table.time[around]) - begin)
            found[time_to(speed)] = Quantity(time, "s")
        elif vehicle_speed[0] >= speed:
            remarks[time_to(speed)] = f"not available (the run starts at {shown[0]:.4g} km/h)"
        else:
            remarks[time_to(speed)] = f"not reached (maximum {shown.max():.4g} km/h)"
    return found, remarks


# name of the number of the summary that the grip limits
TRACTIVE_FORCE = "tractive_force_maximum"


def tractive_force(table: Result, load: VehicleLoad) -> NDArray[np.float64]:
    """Return the mean force of the driven wheels on the vehicle in each step, N, shape (rows - 1,).

    It accelerates the vehicle and overcomes all resistances. It is 0 in steps that begin and end at rest.

    Args:
        table: of a run of the vehicle.
        load: the vehicle.
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
        table: of a run of the vehicle.
        load: the vehicle.

    Returns:
        The largest tractive force, N, and a remark if it exceeds the grip; both empty if the scene gives no
        friction coefficient.
    """
    if load.grip is None:
        return {}, {}
    force = tractive_force(table, load)
    numbers = {TRACTIVE_FORCE: Quantity(float(force.max()), "N")}
    beyond = np.flatnonzero(force > load.grip)
    if not beyond.size:
        return numbers, {}
    share = float(np.diff(table.time)[beyond].sum())
    first = f"first at {table.time[beyond[0]]:.4g} s"
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
    """Return the speed above (positive) or below (negative) the tolerance of a cycle.

    Args:
        table: with the column vehicle_speed, n rows.
        cycle: driving cycle of the vehicle.

    Returns:
        Excess of the speed, m/s, shape (n,); 0 within the tolerance.
    """
    speed = table["vehicle_speed"]
    excess: NDArray[np.float64] = speed - np.clip(speed, *cycle.tolerance_band(table.time))
    return excess


def cycle_remarks(table: Result, cycle: Cycle) -> dict[str, str]:
    """Return remarks on a cycle that is longer than the run or that the vehicle does not follow.

    The vehicle does not follow a cycle if it is out of tolerance for longer than TIME_TOLERANCE at a time.

    Args:
        table: with the column vehicle_speed.
        cycle: driving cycle of the vehicle.
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
    far = float(table["vehicle_speed"][worst] - cycle.speed_at(time[worst])) / KILOMETRE_PER_HOUR
    occasions = "once, at" if long.sum() == 1 else f"{long.sum()} times, first at"
    remarks["vehicle_speed"] = (
        f"does not follow {cycle.name}: out of tolerance for more than {TIME_TOLERANCE:g} s at a time"
        f" ({occasions} {time[begins[long][0]]:.6g} s); largest deviation {abs(far):.3g} km/h too"
        f" {'fast' if far > 0.0 else 'slow'} at {time[worst]:.6g} s"
    )
    return remarks


def summarise(
    table: Result, cycle: Cycle | None, wall_time: float, also: Mapping[str, Quantity]
) -> dict[str, Quantity]:
    """Numbers of a run.

    Args:
        table: all of SUMMARISED, and the signals of the loop.
        cycle: driving cycle of the vehicle, or None.
        wall_time: duration of the computation, s.
        also: more numbers, such as those of times_to and freewheel_duty.
    """
    simulated = float(table.time[-1] - table.time[0])
    summary = {
        "simulated_time": Quantity(simulated, "s"),
        "omega1_maximum": Quantity(float(input_speed(table).max()), "rad/s"),
        "omega_out_maximum": Quantity(float(table["omega_out"].max()), "rad/s"),
        "omega_out_final": Quantity(float(table["omega_out"][-1]), "rad/s"),
        "input_torque_mean": Quantity(_time_mean(table, "input_torque_mean"), "N.m"),
        "output_torque_mean": Quantity(_time_mean(table, "output_torque_mean"), "N.m"),
        "output_torque_mean_maximum": Quantity(float(table["output_torque_mean"].max()), "N.m"),
        # a pulse of the freewheels is some of these
        "contact_switches": Quantity(float(table["contact_switches"][-1]), ""),
        **energy(table),
        **_forces(table),
        **also,
    }
    if "vehicle_speed" in table:
        summary |= _vehicle(table)
    if "reference" in table:
        measured, factor, shown = "omega_out", 1.0, "rad/s"
        if "vehicle_speed" in table:
            measured, factor, shown = "vehicle_speed", KILOMETRE_PER_HOUR, "km/h"
        error = (table[measured] - table["reference"]) / factor
        summary["tracking_error_rms"] = Quantity(float(np.sqrt(np.mean(error**2))), shown)
        summary["tracking_error_maximum"] = Quantity(float(np.abs(error).max()), shown)
    if cycle is not None:
        # each row counts for the step that it begins
        outside = out_of_tolerance(table, cycle)[:-1] != 0.0
        seconds = float(np.sum(np.diff(table.time)[outside]))
        summary["time_out_of_tolerance"] = Quantity(seconds, "s")
        summary["share_out_of_tolerance"] = Quantity(100.0 * seconds / simulated, "%")
    return {
        **summary,
        "rhs_evaluations": Quantity(float(table["rhs_evaluations"][-1]), ""),
        "wall_time": Quantity(wall_time, "s"),
        "real_time_factor": Quantity(simulated / wall_time, ""),
    }


# --- runs ---


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneResult(ByContent):
    """Result of a scene, of a module or of a driven shaft alone.

    Attributes:
        scene: as it was run. record: everything recorded: outputs wanted, outputs summarised, signals of the
            loop. quantities, summary, units: numbers by name; units are "" for counts and ratios.
        remarks: on numbers missing or doubtful, by name: a speed not reached, a load above stall.
        limits: that the scene gives, by the name of the number, in its unit.
        warnings: that the FMU logged, of limits that are passed, and of tables beside the times of the run.
    """

    scene: Any
    record: Result
    quantities: dict[str, Quantity] = field(repr=False)
    remarks: dict[str, str] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def table(self) -> Result:
        """Wanted outputs and the signals of the loop, at each communication point."""
        computed = {one.name for one in self.scene.VARIABLES.values() if one.causality in (OUTPUT, LOCAL)}
        return self.record.without(computed - set(self.scene.run.outputs))

    @property
    def summary(self) -> dict[str, float]:
        """Numbers of the run by name."""
        values = {name: quantity.value for name, quantity in self.quantities.items()}
        return Named(values, "metric of the summary", self.remarks)

    @property
    def units(self) -> dict[str, str]:
        """Units of the numbers of the summary, "" for counts and ratios."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}

    def as_dict(self) -> dict[str, Any]:
        """Version, title of the scene, its parameters, summary, limits and warnings, units, for JSON."""
        parameters = self.scene.parameters()
        of_parameters = {name: self.scene.VARIABLES[name].unit for name in parameters}
        return {
            "inertia_module": __version__,
            "title": self.scene.title,
            "parameters": parameters,
            "summary": self.summary,
            "units": of_parameters | self.units,
            "limits": self.limits,
            "remarks": self.remarks,
            "warnings": list(self.warnings),
        }

    def lines(self) -> dict[str, str]:
        """The summary and the remarks, as text by name."""
        numbers = {name: f"{value:.6g} {unit}".rstrip() for name, (value, unit) in self.quantities.items()}
        for name, limit in self.limits.items():
            numbers[name] += f", limit {limit:.6g}"
        return {heading(name): text for name, text in (numbers | self.remarks).items()}

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self.record[name]

    def __contains__(self, name: object) -> bool:
        return name in self.record

    def to_csv(self, path: Path | str) -> Path:
        """Write the table to a path: see Result.to_csv."""
        return self.table.to_csv(path)

    def to_pandas(self) -> Any:
        """The table as a pandas DataFrame: see Result.to_pandas."""
        return self.table.to_pandas()

    def plot(self, *names: str) -> Any:
        """A matplotlib Figure of the table, or columns of it by names, over time: see Result.plot."""
        return self.table.plot(*names)

    def _repr_png_(self) -> bytes:
        return self.table._repr_png_()

    def _repr_html_(self) -> str:
        """Show the plot and the summary in a notebook."""
        picture = base64.b64encode(self._repr_png_()).decode()
        return f'<img src="data:image/png;base64,{picture}">' + html_table(
            (self.scene.title, ""), self.lines().items()
        )


def start_of(scene: Scene) -> tuple[dict[str, float], dict[str, float]]:
    """Start of a scene, whose fidelity is chosen: parameters, with the tolerance, and inputs of the FMU."""
    if scene.chooses_fidelity:
        raise SceneError(
            "mechanism.fidelity must be a named level (got 'auto'). Choose one with fidelity.trials.choose."
        )
    values = scene.parameters()
    if scene.accuracy.tolerance is not None:
        values["tolerance"] = scene.accuracy.tolerance
    omega1 = scene.drive.start_speed
    measured = {"omega_out": values.get("omega_out_start", 0.0), "input_speed": omega1 or 0.0}
    inputs = initial_inputs(scene.surroundings, measured)
    return values, inputs if omega1 is None else {**inputs, "omega1": omega1}


def scene_plan(scene: Scene) -> Plan:
    """Plan the export of a scene: the FMUs of its mechanism with the values at its start."""
    from ..export.systems import make_plan  # imports the builder of FMUs

    values, inputs = start_of(scene)
    for name in ("housing_stiffness", "freewheel_stiffness"):
        if values.get("fidelity") == ELASTIC and values.get(name, 0.0) > 0.0:
            raise SceneError(
                f"mechanism.{name} must be 0 for an export (got {values[name]:g}). An elastic mechanism is"
                " exported as a rigid module and a shaft. Neither has freewheel compliance."
            )
    return make_plan(scene.title, values, inputs, scene.run.communication_step, scene.run.stop_time)


def run_scene(
    scene: Scene,
    fmu_path: Path | str | None = None,
    progress: Progress | None = None,
    also: Iterable[str] = (),
) -> SceneResult:
    """Run a scene with an FMU of the module.

    Args:
        scene: of load_scene.
        fmu_path: InertiaModule.fmu, or another with its contract; None for that of the package (current_fmu).
        progress: called with the share of the run that is done, 0 to 1.
        also: outputs and locals of the FMU to record besides those that the scene wants.

    Raises:
        FmuError: the FMU cannot be loaded, or refuses a value or a step.
        SceneError: its fidelity is still to be chosen.
    """
    values, inputs = start_of(scene)
    with Fmu(fmu_path, values, inputs, stop_time=scene.run.stop_time) as fmu:
        found = _run_on(fmu, scene, progress, also)
    return replace(found, remarks={**found.remarks, **above_stall(found.record, scene.parameters())})


def above_stall(record: Result, parameters: dict[str, float]) -> dict[str, str]:
    """Remark on a load above the stall torque: the shaft is at rest in the last tenth of the run."""
    end = slice(-max(len(record) // 10, 1), None)
    speed, load = (float(np.mean(values[end])) for values in (input_speed(record), record["load_torque"]))
    braked = "brake_torque" in record and record["brake_torque"][end].any()
    turns = abs(speed) * float(np.ptp(record.time)) / math.tau
    if braked or turns < 1.0 or record["omega_out"][end].min() > 1e-6 * abs(speed):
        return {}
    from ..harness.chart import SteadyMachine  # imports scipy

    try:
        stall = SteadyMachine(parameters).at(speed, 0.0).output_torque
    except Refused:  # without both freewheels there is no stall
        return {}
    above = f"exceeds the stall torque of {stall:.4g} N.m at {speed:.4g} rad/s ({load:.4g} N.m)"
    return {"load_torque": above} if load > stall else {}


class SceneRunner(RestartedFmu):
    """Instance of an FMU with states that runs one scene after the other; a context manager.

    That costs a tenth of what an instance for each run does. The results are those of run_scene, bit for
    bit; but not its warnings.
    """

    def run(self, scene: Scene) -> SceneResult:
        """Run a scene; raises as run_scene."""
        return _run_on(self.started(scene), scene)

    def started(self, scene: Scene) -> Fmu:
        """The instance at the start of a scene; raises as run_scene."""
        values, inputs = start_of(scene)
        self.restart({**values, **inputs})
        return self


def _run_on(
    fmu: Fmu, scene: Scene, progress: Progress | None = None, also: Iterable[str] = ()
) -> SceneResult:
    """Run a scene with a started FMU."""
    loop = ClosedLoop(fmu, scene.surroundings, [*scene.run.outputs, *SUMMARISED, *also], scene.signal_units)
    began = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    wall_time = time.perf_counter() - began
    speeds = getattr(scene.load, "times_to", ())
    times, remarks = times_to(record, speeds) if speeds else ({}, {})
    if scene.cycle is not None:
        remarks |= cycle_remarks(record, scene.cycle)
    duty, unknown = freewheel_duty(record, scene.parameters(), scene.freewheels.of("stiffness"))
    impact = impact_warnings(scene, duty)
    limits = {name: limit for name, limit in scene.freewheels.limits().items() if name in duty}
    if isinstance(scene.load, VehicleLoad) and scene.load.grip is not None:
        numbers, slipping = grip(record, scene.load)
        duty, unknown, limits = duty | numbers, unknown | slipping, limits | {TRACTIVE_FORCE: scene.load.grip}
    quantities = summarise(record, scene.cycle, wall_time, times | duty)
    above = [
        f"{name.replace('_', ' ')} exceeds its limit of {limit:.6g} {duty[name].unit}: {duty[name].value:.6g}"
        for name, limit in limits.items()
        if duty[name].value > limit
    ]
    return SceneResult(
        scene=scene,
        record=record,
        quantities=quantities,
        remarks=remarks | unknown,
        limits=limits,
        warnings=(*fmu.warnings, *above, *impact, *scene_time_warnings(scene, scene.run.stop_time)),
    )
