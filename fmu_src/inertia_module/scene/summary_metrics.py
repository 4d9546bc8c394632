"""Metrics of a run: speeds, torques, energies, forces and tracking errors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..driveline.cycles import KILOMETRE_PER_HOUR, Cycle
from ..fmi.simulate import Result
from ..interface.variables import LOSSES
from .quantity import Quantity
from .vehicle_metrics import out_of_tolerance, vehicle_metrics

# variables of the FMU that the summary and the figure require in addition to the outputs of the scene
SUMMARY_VARIABLES = (
    *("omega2", "omega_out", "input_speed", "input_torque_mean", "output_torque_mean"),
    *("energy_in", "energy_out", "energy_stored", "energy_lost", *LOSSES, "energy_residual"),
    "contact_switches",
    *("housing_engagements", "housing_torque_peak", "housing_slip_peak"),
    *("output_engagements", "torque_peak", "output_slip_peak"),
    "rhs_evaluations",
)


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


def _force_metrics(table: Result) -> dict[str, Quantity]:
    """Return peak and RMS of forces at communication points, and the recorded peak force of the bearing."""
    numbers: dict[str, Quantity] = {}
    for name, values in forces(table).items():
        unit = "N.m" if name == "shaking_moment" else "N"
        numbers[f"{name}_peak"] = Quantity(float(values.max()), unit)
        numbers[f"{name}_rms"] = Quantity(float(np.sqrt(np.mean(values**2))), unit)
    if "satellite_force_peak" in table and table["satellite_force_peak"].any():
        numbers["satellite_force_peak"] = Quantity(float(table["satellite_force_peak"].max()), "N")
    return numbers


def summarise(
    table: Result, cycle: Cycle | None, wall_time: float, also: Mapping[str, Quantity]
) -> dict[str, Quantity]:
    """Return the metrics of a run by name.

    Args:
        table: Record of the run, with all variables in SUMMARY_VARIABLES and the signals of the loop.
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
        **_force_metrics(table),
        **also,
    }
    if "vehicle_speed" in table:
        summary |= vehicle_metrics(table)
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
