"""A run in some numbers: speeds, torques, energy, cost, and how well a cycle was followed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..contract.variables import LOSSES
from ..harness.simulate import Result
from ..loops.cycles import KILOMETRE_PER_HOUR, Cycle

# variables of the FMU that the summary and the figure need, whatever outputs the scene wants
SUMMARISED = (
    "omega2",
    "omega_out",
    "input_speed",
    "input_torque_mean",
    "output_torque_mean",
    "energy_in",
    "energy_out",
    "energy_stored",
    "energy_lost",
    *LOSSES,
    "energy_residual",
    "contact_switches",
    "rhs_evaluations",
)


# a time to a speed is called so and the speed; there is one only where the speed is reached
TIME_TO = "time_to_"


class Quantity(NamedTuple):
    """One number of a summary.

    Attributes:
        value: in its unit. unit: "" for counts and ratios.
    """

    value: float
    unit: str


def _time_mean(table: Result, name: str) -> float:
    """Mean of a step mean over the run: the value at a row is the mean over the step before it."""
    steps = np.diff(table.time)
    return float(table[name][1:] @ steps / steps.sum())


def input_speed(table: Result) -> NDArray[np.float64]:
    """Speed of link 1, rad/s: as the drive gives it, else what the drive's torque has made of it."""
    return table["omega1"] if "omega1" in table else table["input_speed"]


def energy(table: Result) -> dict[str, Quantity]:
    """Energies since the start, losses by cause where there are any, efficiency, and how well they add up."""
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


def work(table: Result, torque: str) -> NDArray[np.float64]:
    """Work of a torque on the load, held over each step, up to each row, J."""
    mean_speed = 0.5 * (table["load_speed"][1:] + table["load_speed"][:-1])
    done = table[torque][:-1] * mean_speed * np.diff(table.time)
    return np.concatenate([[0.0], np.cumsum(done)])


def time_to(speed: float) -> str:
    """Name of the time to a speed, m/s."""
    return f"{TIME_TO}{speed / KILOMETRE_PER_HOUR:.6g}_kmh"


def _times_to(table: Result, speeds: Sequence[float]) -> dict[str, Quantity]:
    """Time, s, to each speed, m/s, that is reached: since the car last stood, or the run began."""
    found, vehicle_speed = {}, table["vehicle_speed"]
    for speed in speeds:
        reached = int(np.argmax(vehicle_speed >= speed))
        if reached:  # 0 where it never is, or is from the start
            around = slice(reached - 1, reached + 1)
            stood = np.flatnonzero(vehicle_speed[:reached] <= 0.0)
            begun = table.time[stood[-1] if stood.size else 0]
            time = float(np.interp(speed, vehicle_speed[around], table.time[around]) - begun)
            found[time_to(speed)] = Quantity(time, "s")
    return found


def unreached(table: Result, summary: Mapping[str, Quantity], speeds: Sequence[float]) -> dict[str, str]:
    """Say why the summary has no time to some of the speeds, m/s, by the names of these times."""
    found = {}
    for speed in speeds:
        if (name := time_to(speed)) not in summary:
            begun, fastest = (
                f"{value / KILOMETRE_PER_HOUR:.4g} km/h"
                for value in (table["vehicle_speed"][0], table["vehicle_speed"].max())
            )
            passed = f"is none: the run begins at {begun}"
            found[name] = (
                passed if table["vehicle_speed"][0] >= speed else f"is not reached: {fastest} is the most"
            )
    return found


def _vehicle(table: Result, times_to: Sequence[float]) -> dict[str, Quantity]:
    parts = ("rolling", "drag", "slope", "brake")
    energies = {f"energy_{part}": Quantity(float(work(table, f"{part}_torque")[-1]), "J") for part in parts}
    speed = float(table["vehicle_speed"].max()) / KILOMETRE_PER_HOUR
    return {
        "distance": Quantity(float(table["distance"][-1]), "m"),
        "vehicle_speed_maximum": Quantity(speed, "km/h"),
        **_times_to(table, times_to),
        **energies,
    }


def summarise(
    table: Result,
    measured: str | None,
    cycle: Cycle | None,
    wall_time: float,
    times_to: Sequence[float] = (),
) -> dict[str, Quantity]:
    """Numbers of a run.

    Args:
        table: all of SUMMARISED, and the signals of the loop.
        measured: name of the speed under control, or None. cycle: to be followed, or None.
        wall_time: of the run, s. times_to: speeds of a vehicle to which the time is asked, m/s.
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
    }
    if "vehicle_speed" in table:
        summary |= _vehicle(table, times_to)
    if measured is not None:
        unit = table.units["reference"]
        factor, shown = (KILOMETRE_PER_HOUR, "km/h") if unit == "m/s" else (1.0, unit)
        error = (table[measured] - table["reference"]) / factor
        summary["tracking_error_rms"] = Quantity(float(np.sqrt(np.mean(error**2))), shown)
        summary["tracking_error_maximum"] = Quantity(float(np.abs(error).max()), shown)
    if cycle is not None:
        # each row counts for the step that it begins
        lower, upper = cycle.tolerance_band(table.time)
        speed = table["vehicle_speed"]
        outside = ((speed < lower) | (speed > upper))[:-1]
        seconds = float(np.sum(np.diff(table.time)[outside]))
        summary["time_out_of_tolerance"] = Quantity(seconds, "s")
        summary["share_out_of_tolerance"] = Quantity(100.0 * seconds / simulated, "%")
    return {
        **summary,
        "rhs_evaluations": Quantity(float(table["rhs_evaluations"][-1]), ""),
        "wall_time": Quantity(wall_time, "s"),
        "real_time_factor": Quantity(simulated / wall_time, ""),
    }
