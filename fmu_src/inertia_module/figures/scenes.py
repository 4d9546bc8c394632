"""The plot of a scene that answers its question at a glance."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from ..harness.simulate import Result
from ..loops.cycles import KILOMETRE_PER_HOUR, Cycle
from ..scene import SceneResult
from ..scene.summary import input_speed, work

# 1200 x 900 pixels
SIZE = (12.0, 9.0)
DPI = 100
PULSES_SHOWN = 4
# a weighted mean over this time, s, shows the drive behind the pulses
SMOOTHING = 1.0

Array = NDArray[np.float64]


def scene_figure(result: SceneResult) -> Figure:
    """The figure of a scene: how a cycle was followed, or how the pulses drive the shaft.

    Args:
        result: of run_scene.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels; save it with figure.savefig(path).
    """
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    figure.suptitle(result.scene.title, fontsize=15, fontweight="bold")
    if result.scene.controller is not None and "vehicle_speed" in result.record:
        _driving_panels(figure, result)
    else:
        _pulse_panels(figure, result)
    return figure


def _dress(axes: Axes, label: str) -> None:
    """Label, grid and, above the panel where it hides nothing, legend."""
    axes.set_ylabel(label)
    axes.grid(alpha=0.25)
    axes.margins(x=0.0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=6,
            fontsize=9,
            frameon=False,
            borderpad=0.1,
            columnspacing=1.2,
        )


def _headline(axes: Axes, text: str) -> None:
    """A line above the legend of a panel."""
    axes.set_title(text, loc="left", fontsize=11, pad=22)


def _energy_unit(*energies: Array) -> tuple[float, str]:
    largest = max(float(np.abs(energy).max()) for energy in energies)
    return (1e3, "kJ") if largest > 2e3 else (1.0, "J")


def pulse_starts(table: Result) -> NDArray[np.int64]:
    """Rows at which a torque pulse on the output shaft begins, as far as the rows show."""
    driving = table["output_torque_mean"] > 0.0
    return np.flatnonzero(~driving[:-1] & driving[1:]).astype(np.int64)


# --- pulses ---


def end_of_run(table: Result) -> tuple[int, str]:
    """First row of a close-up of the end, and what it shows: the last pulses, or what came after them."""
    starts = pulse_starts(table)
    if starts.size < PULSES_SHOWN:
        return int(0.9 * len(table)), "the end"
    driving, time = table["output_torque_mean"] > 0.0, table.time
    first, last = int(starts[-PULSES_SHOWN]), int(np.flatnonzero(driving[1:] != driving[:-1])[-1])
    if time[-1] - time[last] > time[starts[-1]] - time[first]:
        what = "lock-up" if driving[-1] else "no more pulses"
        return first, f"{what} from {time[last]:.4g} s on"
    return first, f"the last {PULSES_SHOWN} pulses"


def _pulse_panels(figure: Figure, result: SceneResult) -> None:
    """Left the whole run, right its end."""
    table, numbers = result.record, result.summary
    first, shown = end_of_run(table)
    accelerated = "imbalance_acceleration" in table
    grid = figure.subplots(4 if accelerated else 3, 2, sharex="col", width_ratios=(3, 2))
    whole, close = slice(None), slice(first, None)
    for column, rows in ((0, whole), (1, close)):
        panels = list(grid[:, column])
        _speeds(panels[0], table, rows, zoomed=column == 1)
        _torques(panels[1], table, rows, zoomed=column == 1)
        if accelerated:
            _acceleration(panels[2], table, rows)
        _energies(panels[-1], table, rows)
        panels[-1].set_xlabel("time [s]")
        for panel in panels[:2] if column == 0 else ():
            panel.axvspan(table.time[first], table.time[-1], color=ORANGE, alpha=0.12, linewidth=0)
    _headline(
        grid[0, 0],
        f"whole run: output shaft at {numbers['omega_out_final']:.4g} rad/s after"
        f" {numbers['simulated_time']:g} s, mean torque {numbers['output_torque_mean']:.3g} N·m",
    )
    _headline(grid[0, 1], f"{shown} ({numbers['contact_switches']:.0f} switches in all)")


def _speeds(axes: Axes, table: Result, rows: slice, zoomed: bool) -> None:
    """Close up without the input, which would press the others flat."""
    time = table.time[rows]
    if not zoomed:
        axes.plot(time, input_speed(table)[rows], color=BLACK, linewidth=1.2, label="input ω1")
    axes.plot(time, table["omega2"][rows], color=SKY, linewidth=1.0, label="link 2 ω2")
    axes.plot(time, table["omega_out"][rows], color=VERMILION, linewidth=2.0, label="output shaft")
    if "reference" in table and table.units["reference"] == "rad/s":
        axes.plot(time, table["reference"][rows], "--", color=GREEN, linewidth=1.2, label="reference")
    _dress(axes, "speed [rad/s]")


def _mean_over_pulses(table: Result) -> tuple[Array, Array]:
    """Mean output torque from the beginning of each pulse to that of the next: (edges, means)."""
    starts = pulse_starts(table)
    impulse = np.concatenate([[0.0], np.cumsum(table["output_torque_mean"][1:] * np.diff(table.time))])
    edges = table.time[starts]
    return edges, np.diff(impulse[starts]) / np.diff(edges)


def _torques(axes: Axes, table: Result, rows: slice, zoomed: bool) -> None:
    """In the whole run the means, close up what happens at each instant (if recorded)."""
    time = table.time[rows]
    if zoomed and {"output_torque", "housing_torque", "input_torque"} <= set(table.names):
        axes.plot(time, table["input_torque"][rows], color=BLACK, linewidth=1.0, label="input")
        axes.fill_between(time, table["output_torque"][rows], color=VERMILION, alpha=0.35, linewidth=0)
        axes.plot(
            time, table["output_torque"][rows], color=VERMILION, linewidth=1.5, label="output freewheel"
        )
        axes.plot(time, table["housing_torque"][rows], color=BLUE, linewidth=1.5, label="housing freewheel")
        _dress(axes, "torque [N·m]")
        return
    torque = table["output_torque_mean"][rows]
    axes.fill_between(
        time, torque, step="pre", color=VERMILION, alpha=0.4, linewidth=0, label="output, step mean"
    )
    edges, means = _mean_over_pulses(table)
    if means.size and not zoomed:
        axes.stairs(means, edges, baseline=None, color=BLACK, linewidth=1.8, label="mean from pulse to pulse")
    axes.plot(time, table["load_torque"][rows], "--", color=GREEN, linewidth=1.5, label="load")
    if "drive_torque" in table:
        axes.plot(time, table["drive_torque"][rows], color=BLUE, linewidth=1.5, label="drive")
    _dress(axes, "torque [N·m]")


def _acceleration(axes: Axes, table: Result, rows: slice) -> None:
    acceleration = table["imbalance_acceleration"][rows] / 1e3
    axes.plot(table.time[rows], acceleration, color=PURPLE, linewidth=0.9, label="imbalance")
    axes.set_ylim(bottom=0.0)
    _dress(axes, "acceleration [km/s²]")


def _energies(axes: Axes, table: Result, rows: slice) -> None:
    given, taken = table["energy_in"], table["energy_out"]
    gained = table["energy_stored"] - table["energy_stored"][0]
    factor, unit = _energy_unit(given, taken, gained)
    time = table.time[rows]
    axes.plot(time, given[rows] / factor, color=BLACK, linewidth=1.5, label="in")
    axes.plot(time, taken[rows] / factor, color=GREEN, linewidth=1.5, label="out to the load")
    axes.plot(time, gained[rows] / factor, color=BLUE, linewidth=1.5, label="gain of stored")
    _dress(axes, f"energy [{unit}]")


# --- driving ---


def _driving_panels(figure: Figure, result: SceneResult) -> None:
    """Speed in its band, speeds of the module, torques, energy: one below the other."""
    table, numbers = result.record, result.summary
    panels = figure.subplots(4, 1, sharex=True, height_ratios=(1.6, 1, 1, 1.2))
    _followed_speed(panels[0], table, result.scene.cycle)
    outside = (
        f"out of tolerance {numbers['time_out_of_tolerance']:.2f} s of {numbers['simulated_time']:g} s, "
        if result.scene.cycle is not None
        else ""
    )
    _headline(
        panels[0],
        f"{outside}error {numbers['tracking_error_rms']:.2f} km/h rms and"
        f" {numbers['tracking_error_maximum']:.2f} km/h at most",
    )
    _module_speeds(panels[1], table)
    _mean_torques(panels[2], table)
    _energy_shares(panels[3], table)
    panels[3].set_xlabel("time [s]")


def _followed_speed(axes: Axes, table: Result, cycle: Cycle | None) -> None:
    scale = 1.0 / KILOMETRE_PER_HOUR
    if cycle is not None:
        lower, upper = cycle.tolerance_band(table.time)
        band = axes.fill_between(
            table.time, lower * scale, upper * scale, color=GREEN, alpha=0.25, linewidth=0
        )
        band.set_label("tolerance ±2 km/h, ±1 s")
    wanted = cycle.name if cycle is not None else "reference"
    axes.plot(table.time, table["reference"] * scale, "--", color=BLACK, linewidth=1.2, label=wanted)
    axes.plot(table.time, table["vehicle_speed"] * scale, color=VERMILION, linewidth=1.6, label="vehicle")
    axes.set_ylim(bottom=0.0)
    _dress(axes, "speed [km/h]")


def _module_speeds(axes: Axes, table: Result) -> None:
    label = "input ω1 (commanded)" if "omega1" in table else "input ω1"
    axes.plot(table.time, input_speed(table), color=BLACK, linewidth=1.2, label=label)
    axes.plot(table.time, table["omega_out"], color=VERMILION, linewidth=1.6, label="output shaft")
    axes.set_ylim(bottom=0.0)
    _dress(axes, "speed [rad/s]")


def smooth(table: Result, name: str, window: float = SMOOTHING) -> Array:
    """Mean of a column over a Hann window, s, around each row (cut off at the ends)."""
    rows = round(window / float(table.time[1] - table.time[0]))
    weights = np.hanning(min(max(rows, 1), len(table)) + 2)[1:-1]
    total = np.convolve(table[name], weights, mode="same")
    return total / np.convolve(np.ones(len(table)), weights, mode="same")


def _mean_torques(axes: Axes, table: Result) -> None:
    axes.fill_between(
        table.time, table["output_torque_mean"], color=VERMILION, alpha=0.25, linewidth=0, step="pre"
    )
    axes.plot(table.time, smooth(table, "output_torque_mean"), color=VERMILION, linewidth=1.6, label="output")
    axes.plot(table.time, smooth(table, "input_torque_mean"), color=BLACK, linewidth=1.2, label="input")
    axes.plot(table.time, -smooth(table, "brake_torque"), color=BLUE, linewidth=1.6, label="brake")
    highest = float(np.quantile(table["output_torque_mean"], 0.995))
    lowest = float(smooth(table, "brake_torque").max())
    axes.set_ylim(-1.15 * lowest - 5.0, 1.15 * highest + 5.0)
    _dress(axes, "torque [N·m]")


def _energy_shares(axes: Axes, table: Result) -> None:
    """Where the energy of the input went, up to each moment."""
    parts = {
        "brake": (work(table, "brake_torque"), BLUE),
        "rolling": (work(table, "rolling_torque"), ORANGE),
        "air drag": (work(table, "drag_torque"), SKY),
        "slope": (work(table, "slope_torque"), GREEN),
    }
    parts = {name: part for name, part in parts.items() if np.abs(part[0]).max() > 0.0}
    # module, car and, if it is elastic, the coupling between them
    parts["in motion"] = (table["energy_in"] - sum(energy for energy, _ in parts.values()), PURPLE)
    factor, unit = _energy_unit(table["energy_in"])
    shares = [energy / factor for energy, _ in parts.values()]
    colours = [colour for _, colour in parts.values()]
    axes.stackplot(table.time, *shares, labels=list(parts), colors=colours, alpha=0.75, linewidth=0)
    axes.plot(table.time, table["energy_in"] / factor, color=BLACK, linewidth=1.5, label="input")
    _dress(axes, f"energy [{unit}]")
