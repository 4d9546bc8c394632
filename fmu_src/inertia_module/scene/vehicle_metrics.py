"""Metrics of a vehicle in a run: acceleration times, tractive force, distance and tolerance of a cycle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..driveline.cycles import KILOMETRE_PER_HOUR, TIME_TOLERANCE, Cycle
from ..fmi.simulate import Result
from .loads import VehicleLoad
from .quantity import Quantity

# prefix of the names of acceleration times; the speed follows
TIME_TO = "time_to_"


def work(table: Result, torque: str) -> NDArray[np.float64]:
    """Return the work of a torque on the load up to each row, J, shape (n,).

    Args:
        table: Record of the run, n rows.
        torque: Name of the column of the torque, which is constant in each step.
    """
    mean_speed = 0.5 * (table["load_speed"][1:] + table["load_speed"][:-1])
    increments = table[torque][:-1] * mean_speed * np.diff(table.time)
    return np.concatenate([[0.0], np.cumsum(increments)])


def time_to_name(speed: float) -> str:
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
    at the rearmost position, so motion before rolling back does not count.

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
    """Return the acceleration time to each speed, from launch_time on.

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
            times[time_to_name(speed)] = Quantity(time, "s")
        elif vehicle_speed[0] >= speed:
            remarks[time_to_name(speed)] = f"not available (the run starts at {in_kmh[0]:.4g} km/h)"
        else:
            remarks[time_to_name(speed)] = f"not reached (maximum {in_kmh.max():.4g} km/h)"
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


def grip_metrics(table: Result, load: VehicleLoad) -> tuple[dict[str, Quantity], dict[str, str]]:
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


def vehicle_metrics(table: Result) -> dict[str, Quantity]:
    """Return distance, maximum speed and energies of the resistances and the brake, by name.

    Args:
        table: Record of the run, with the signals of the vehicle.
    """
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
    is_long = time[ends] - time[begins] > TIME_TOLERANCE + 1e-9
    if not is_long.any():
        return remarks
    rows = np.concatenate([np.arange(*pair) for pair in zip(begins[is_long], ends[is_long], strict=True)])
    worst = rows[np.argmax(np.abs(excess[rows]))]
    deviation = float(table["vehicle_speed"][worst] - cycle.speed_at(time[worst])) / KILOMETRE_PER_HOUR
    occasions = "once, at" if is_long.sum() == 1 else f"{is_long.sum()} times, first at"
    remarks["vehicle_speed"] = (
        f"does not follow {cycle.name}: out of tolerance for more than {TIME_TOLERANCE:g} s at a time"
        f" ({occasions} {time[begins[is_long][0]]:.6g} s); largest deviation {abs(deviation):.3g} km/h too"
        f" {'fast' if deviation > 0.0 else 'slow'} at {time[worst]:.6g} s"
    )
    return remarks
