"""Figures of scenes: of a module with its losses, of a vehicle in a driving cycle, and of a driven shaft."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, styled
from ..driveline.cycles import KILOMETRE_PER_HOUR, TIME_TOLERANCE, Cycle
from ..fmi.simulate import Result
from ..interface.variables import LOSSES, LOST_TO
from ..scene import Scene, SceneResult
from ..scene.summary_metrics import forces
from ..scene.vehicle_metrics import TIME_TO, work
from .panels import SIZE, SMOOTHING, Array, add_label_and_legend, envelope, headline, new_figure, smooth

# function that draws a table from a row; from row 0 it draws the whole run, else a close-up
Panel = Callable[[Axes, Result, int], None]

CLOSE_UP_PULSES = 4
# number of pulses above which a panel shows the range of oscillating signals, and pulses per bin of the range
MAX_CURVE_PULSES, PULSES_PER_BIN = 60, 2
# maximum number of bins, and minimum number of rows per pulse of curves through coarse rows
MAX_BINS, MIN_ROWS_PER_PULSE = 300, 8
# number of rows of panels above which the figure becomes higher
MAX_PANELS = 4
# Maximum mean number of switches in rows with switches. Above it, lines do not show instantaneous values.
MAX_SWITCHES = 1.1
# maximum averaging time of powers over the duration of the run
MAX_WINDOW_FRACTION = 1.0 / 8.0
# additional column: stored energy minus its initial value
GAIN = "energy_stored_gain"
# label, colour and line style of columns
CURVE_STYLES = {
    "omega1": ("input ω1", BLACK, "-"),
    "input_speed": ("input ω1", BLACK, "-"),
    "omega2": ("link 2 ω2", SKY, "-"),
    "omega_out": ("output shaft", VERMILION, "-"),
    "reference": ("reference", BLACK, "--"),
    "vehicle_speed": ("vehicle", VERMILION, "-"),
    "input_torque": ("input", BLACK, "-"),
    "output_torque_mean": ("output", VERMILION, "-"),
    "input_torque_mean": ("input", BLACK, "-"),
    "brake_torque": ("brake", BLUE, "-"),
    "output_torque": ("output freewheel", VERMILION, "-"),
    "housing_torque": ("housing freewheel", BLUE, "-"),
    "load_torque": ("load", GREEN, "--"),
    "drive_torque": ("drive", BLUE, "-"),
    "satellite_force": ("satellite bearing", PURPLE, "-"),
    "shaking_force": ("mounting", BLUE, "-"),
    "imbalance_acceleration": ("unbalanced mass", PURPLE, "-"),
    "energy_in": ("input", BLACK, "-"),
    "energy_out": ("output", GREEN, "-"),
    GAIN: ("change in stored", BLUE, "-"),
    "energy_lost": ("losses", VERMILION, "-"),
    "hub_speed": ("hub", BLACK, "-"),
    "hub_acceleration": ("hub", BLACK, "-"),
    "driven_acceleration": ("driven mass", VERMILION, "-"),
    "twist": ("twist", PURPLE, "-"),
}
for _name, _colour in zip(LOSSES, (VERMILION, ORANGE, PURPLE, SKY, BLUE, VERMILION), strict=True):
    CURVE_STYLES[_name] = (_name.removeprefix(LOST_TO).replace("_", " "), _colour, "-")
FORCES = ("satellite_force", "shaking_force")
FLOWS = ("energy_in", "energy_out", "energy_lost")
# columns that oscillate with the pulses
OSCILLATING = ("omega2", *FORCES, "imbalance_acceleration")
# units with prefix k for large values
LARGE = ("J", "W", "N", "m/s²")


@styled()
def scene_figure(result: SceneResult, rows: int | None = None) -> Figure:
    """Draw the result of a scene: tracking of a speed, torque pulses, or motion of a driven shaft.

    Args:
        result: Result of run_scene or run_shaft_scene.
        rows: Maximum number of rows of panels; None for all.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels, higher with more than four panels; save it with
        figure.savefig(path).
    """
    figure, scene = new_figure(result.scene.title), result.scene
    gain = result["energy_stored"] - result["energy_stored"][0]
    table = Result(result.columns | forces(result) | {GAIN: gain}, result.units)
    if "hub_speed" in table:
        _shaft_panels(figure, result, table, rows)
    elif isinstance(scene, Scene) and scene.controller is not None and "vehicle_speed" in table:
        _driving_panels(figure, result, table, scene.cycle, rows)
    else:
        _pulse_panels(figure, result, table, rows)
    return figure


def plot(
    axes: Axes, table: Result, names: Iterable[str], quantity: str, unit: str, first: int = 0, **labels: str
) -> None:
    """Draw columns in their CURVE_STYLES with label and legend; missing columns are skipped.

    Large values are in thousands. Columns that oscillate with the pulses are bands from minimum to maximum if
    there are many pulses, and dots if the rows are coarse.

    Args:
        axes: The panel.
        table: The table.
        names: Names of columns.
        quantity: Quantity of the columns, for the label.
        unit: Unit of the columns.
        first: First row.
        labels: Labels of columns by name, instead of the labels in CURVE_STYLES.
    """
    columns = [name for name in names if name in table]
    factor, unit = display_scale(unit, *(table[name] for name in columns))
    time = table.time[first:]
    for name in columns:
        label, colour, line = CURVE_STYLES[name]
        label, values = labels.get(name, label), table[name][first:] / factor
        if name in OSCILLATING and (bins := range_bins(table, first)):
            times, low, high = envelope(time, values, bins)
            axes.fill_between(
                times, low, high, color=colour, alpha=0.4, linewidth=0.5, label=f"{label}, range"
            )
            continue
        look: dict[str, Any] = {"linestyle": line, "linewidth": 1.5}
        if name in OSCILLATING and is_coarse(table):
            is_fine = len(time) >= MIN_ROWS_PER_PULSE * max(pulse_starts(table, first).size, 1)
            look = {
                "marker": ".",
                "markersize": 3.0,
                "linewidth": 0.7,
                "linestyle": "-" if is_fine else "none",
            }
            label = f"{label}, instantaneous"
        axes.plot(time, values, color=colour, label=label, **look)
    add_label_and_legend(axes, f"{quantity} [{unit}]")


def display_scale(unit: str, *values: Array) -> tuple[float, str]:
    """Return divisor and unit for the display of values, with prefix k for large values.

    Args:
        unit: Unit of the values.
        values: Arrays of values.
    """
    maximum = max(float(np.abs(part).max()) for part in values)
    return (1e3, f"k{unit}") if unit in LARGE and maximum > 2e3 else (1.0, unit)


# --- pulses ---


def is_coarse(table: Result) -> bool:
    """Return True if the rows are too far apart for curves of instantaneous values.

    Args:
        table: Record of the run.
    """
    switches = np.diff(table["contact_switches"])
    return bool(switches.sum() > MAX_SWITCHES * np.count_nonzero(switches))


def range_bins(table: Result, first: int) -> int:
    """Return the number of bins of the range of an oscillating signal; 0 if a curve shows it.

    Args:
        table: Record of the run.
        first: First row.
    """
    pulses = int(pulse_starts(table, first).size)
    return min(pulses // PULSES_PER_BIN, MAX_BINS) if pulses > MAX_CURVE_PULSES else 0


def pulse_starts(table: Result, first: int = 0) -> NDArray[np.int64]:
    """Return the rows at which torque pulses on the output shaft begin, counted from the first row.

    Args:
        table: Record of the run.
        first: First row.
    """
    if "output_torque_mean" not in table:
        return np.empty(0, dtype=np.int64)
    driving = table["output_torque_mean"][first:] > 0.0
    return np.flatnonzero(~driving[:-1] & driving[1:]).astype(np.int64)


def end_of_run(table: Result) -> tuple[int, str]:
    """Return the first row of a close-up of the end of a run, and its title.

    The close-up contains the last pulses, or the motion after them.

    Args:
        table: Record of the run.
    """
    starts = pulse_starts(table)
    if starts.size < CLOSE_UP_PULSES:
        return int(0.9 * len(table)), "end of the run"
    driving, time = table["output_torque_mean"] > 0.0, table.time
    first, last = int(starts[-CLOSE_UP_PULSES]), int(np.flatnonzero(driving[1:] != driving[:-1])[-1])
    if time[-1] - time[last] > time[starts[-1]] - time[first]:
        text = "lock-up" if driving[-1] else "no pulses"
        return first, f"{text} from {time[last]:.4g} s"
    return first, f"last {CLOSE_UP_PULSES} pulses"


def _pulse_panels(figure: Figure, result: SceneResult, table: Result, rows: int | None) -> None:
    """Draw the whole run on the left and its end on the right; forces replace the acceleration."""
    numbers = result.summary
    first, close_up = end_of_run(table)
    draw_functions: list[Panel] = [_speeds, _torques]
    if force_names := [name for name in FORCES if name in forces(table)]:
        draw_functions.append(partial(_magnitudes, names=force_names, quantity="force", unit="N"))
    elif "imbalance_acceleration" in table:
        draw_functions.append(
            partial(_magnitudes, names=OSCILLATING[-1:], quantity="acceleration", unit="m/s²")
        )
    if causes := losses(table):
        draw_functions += [
            partial(_powers, names=FLOWS, quantity="power"),
            partial(_powers, names=causes, quantity="losses"),
        ]
    draw_functions = [*draw_functions, _energies][:rows]
    figure.set_figheight(SIZE[1] * max(1.0, len(draw_functions) / MAX_PANELS))
    grid = figure.subplots(len(draw_functions), 2, sharex="col", width_ratios=(3, 2), squeeze=False)
    for draw, (left, right) in zip(draw_functions, grid, strict=True):
        draw(left, table, 0)
        draw(right, table, max(first, 1))
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    for axes in grid[:2, 0]:
        axes.axvspan(table.time[first], table.time[-1], color=ORANGE, alpha=0.12, linewidth=0)
    text = "whole run: output shaft at {omega_out_final:.3g} rad/s after {simulated_time:g} s, "
    # The title contains the first acceleration time of a vehicle.
    for name in [name for name in numbers if name.startswith(TIME_TO)][:1]:
        text += f"{name.removeprefix(TIME_TO).partition('_')[0]} km/h in {numbers[name]:.3g} s, "
    text += "mean {output_torque_mean:.3g} N·m"
    headline(grid[0, 0], text.format_map(numbers))
    headline(grid[0, 1], f"{close_up} ({numbers['contact_switches']:.0f} switching events in total)")


def _speeds(axes: Axes, table: Result, first: int) -> None:
    """Draw the speeds of the links; the close-up excludes the input, whose range would hide the others."""
    reference = "reference" if table.units.get("reference") == "rad/s" else ""
    driven = "" if first else _input(table)
    plot(axes, table, (driven, "omega2", "omega_out", reference), "speed", "rad/s", first)


def _input(table: Result) -> str:
    """Return the column of the speed of link 1, prescribed or computed."""
    return "omega1" if "omega1" in table else "input_speed"


def _torques(axes: Axes, table: Result, first: int) -> None:
    """Draw torques: means in the whole run, instantaneous values in the close-up unless rows are coarse."""
    instants, time = ("input_torque", "output_torque", "housing_torque"), table.time[first:]
    if first and set(instants) <= set(table) and not is_coarse(table):
        axes.fill_between(time, table["output_torque"][first:], color=VERMILION, alpha=0.35, linewidth=0)
        plot(axes, table, instants, "torque", "N·m", first)
        return
    torque = table["output_torque_mean"]
    if bins := range_bins(table, first):
        times, low, high = envelope(time, torque[first:], bins)
        axes.fill_between(times, low, high, color=VERMILION, alpha=0.3, linewidth=0, label="output, range")
    else:
        area = axes.fill_between(time, torque[first:], step="pre", color=VERMILION, alpha=0.4, linewidth=0)
        area.set_label("output, step mean")
    starts = pulse_starts(table)
    if starts.size > 1 and not first:
        impulse = np.concatenate([[0.0], np.cumsum(torque[1:] * np.diff(time))])
        means, edges = np.diff(impulse[starts]) / np.diff(time[starts]), time[starts]
        axes.stairs(means, edges, baseline=None, color=BLACK, linewidth=1.8, label="mean per pulse")
    plot(axes, table, ("load_torque", "drive_torque"), "torque", "N·m", first)


# --- energy, losses and forces ---


def losses(table: Result) -> list[str]:
    """Return the names of the causes of losses that are not zero.

    Args:
        table: Record of the run.
    """
    return [name for name in LOSSES if table[name].any()]


def _energies(axes: Axes, table: Result, first: int, **labels: str) -> None:
    """Draw input energy, output energy, change in stored energy and, unless zero, losses."""
    loss_names = FLOWS[2:] if table["energy_lost"].any() else ()
    plot(axes, table, (*FLOWS[:2], GAIN, *loss_names), "energy", "J", first, **labels)


def _powers(axes: Axes, table: Result, first: int, names: Sequence[str], quantity: str) -> None:
    """Draw the rates of cumulative energies; in the whole run pulses are averaged out."""
    time, rows = table.time[1:], slice(first, None)
    powers = {name: np.diff(table[name]) / np.diff(table.time) for name in names}
    if not first:
        window = min(SMOOTHING, MAX_WINDOW_FRACTION * float(time[-1] - time[0]))
        powers = {name: smooth(time, power, window) for name, power in powers.items()}
        # At the ends the window is truncated within a pulse.
        cut = round(0.5 * window / float(time[1] - time[0]))
        rows = slice(cut, len(time) - cut)
        quantity = f"{quantity}, mean\nover {window:.2g} s"
    columns = {name: values[rows] for name, values in {"time": time, **powers}.items()}
    plot(axes, Result(columns), names, quantity, "W")
    axes.set_ylim(bottom=min(axes.get_ylim()[0], 0.0))


def _magnitudes(
    axes: Axes, table: Result, first: int, names: Sequence[str], quantity: str, unit: str
) -> None:
    """Draw magnitudes of forces, or of the acceleration of the unbalanced mass."""
    plot(axes, table, names, quantity, unit, first)
    axes.set_ylim(bottom=0.0)


# --- driving ---


def _driving_panels(
    figure: Figure, result: SceneResult, table: Result, cycle: Cycle | None, rows: int | None
) -> None:
    """Draw the vehicle speed in its tolerance band, speeds of the module, torques and energies."""
    numbers, causes = result.summary, losses(table)
    input_names, input_label = (_input(table), "omega_out"), "input ω1 (commanded)"
    draw_functions: list[tuple[float, Callable[[Axes], None]]] = [
        (1.6, lambda axes: _tracking(axes, table, cycle)),
        (1.0, lambda axes: plot(axes, table, input_names, "speed", "rad/s", omega1=input_label)),
        (1.0, lambda axes: _mean_torques(axes, table)),
        (1.2, lambda axes: _energy_shares(axes, table)),
    ]
    if causes:
        draw_functions.append((1.0, lambda axes: _powers(axes, table, 0, causes, "losses")))
    heights, functions = zip(*draw_functions[:rows], strict=True)
    figure.set_figheight(SIZE[1] * (1.2 if causes else 1.0))
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0]
    for axes, draw in zip(panels, functions, strict=True):
        draw(axes)
    for axes in panels[1:2]:
        axes.set_ylim(bottom=0.0)
    text = "error {tracking_error_rms:.2f} km/h RMS, {tracking_error_maximum:.2f} km/h maximum"
    if cycle is not None:
        text = "out of tolerance {time_out_of_tolerance:.2f} s of {simulated_time:g} s, " + text
    headline(panels[0], text.format_map(numbers))
    panels[-1].set_xlabel("time [s]")


def _tracking(axes: Axes, table: Result, cycle: Cycle | None) -> None:
    if cycle is not None:
        lower, upper = (bound / KILOMETRE_PER_HOUR for bound in cycle.tolerance_band(table.time))
        band = axes.fill_between(table.time, lower, upper, color=GREEN, alpha=0.25, linewidth=0)
        band.set_label(
            f"tolerance ±{cycle.speed_tolerance / KILOMETRE_PER_HOUR:.3g} km/h, ±{TIME_TOLERANCE:g} s"
        )
    names = ("reference", "vehicle_speed")
    label = cycle.name if cycle is not None else "reference"
    plot(axes, table.converted(dict.fromkeys(names, "km/h")), names, "speed", "km/h", reference=label)
    axes.set_ylim(bottom=0.0)


def _mean_torques(axes: Axes, table: Result) -> None:
    time, torque = table.time, table["output_torque_mean"]
    axes.fill_between(time, torque, color=VERMILION, alpha=0.25, linewidth=0, step="pre")
    names = ("output_torque_mean", "input_torque_mean", "brake_torque")
    means = {name: smooth(time, table[name]) for name in names}
    means["brake_torque"] *= -1.0
    plot(axes, Result({"time": time, **means}), names, "torque", "N·m")
    low, high = float(means["brake_torque"].min()), float(np.quantile(torque, 0.995))
    axes.set_ylim(1.15 * low - 5.0, 1.15 * high + 5.0)


def _energy_shares(axes: Axes, table: Result) -> None:
    """Draw the input energy as a stack of its uses up to each time."""
    parts = {
        "brake": (work(table, "brake_torque"), BLUE),
        "rolling": (work(table, "rolling_torque"), ORANGE),
        "air drag": (work(table, "drag_torque"), SKY),
        "slope": (work(table, "slope_torque"), GREEN),
        "losses": (table["energy_lost"], GREY),
    }
    parts = {name: part for name, part in parts.items() if part[0].any()}
    # kinetic energy of module and vehicle, and elastic energy of a coupling
    parts["kinetic"] = (table["energy_in"] - sum(energy for energy, _ in parts.values()), PURPLE)
    factor, unit = display_scale("J", table["energy_in"])
    shares, colours = zip(*((energy / factor, colour) for energy, colour in parts.values()), strict=True)
    axes.stackplot(table.time, *shares, labels=list(parts), colors=colours, alpha=0.75, linewidth=0)
    axes.plot(table.time, table["energy_in"] / factor, color=BLACK, linewidth=1.5, label="input")
    add_label_and_legend(axes, f"energy [{unit}]")


# --- a shaft alone ---


def _shaft_panels(figure: Figure, result: SceneResult, table: Result, rows: int | None) -> None:
    """Draw speeds and accelerations of hub and driven mass, twist and energies."""
    law = np.gradient(table["hub_speed"], table.time)
    table = Result(table.columns | {"hub_acceleration": law, "twist": 1e3 * table["twist"]})
    accelerations = ("hub_acceleration", "driven_acceleration")
    draw_functions: list[Callable[[Axes], None]] = [
        lambda axes: plot(axes, table, ("hub_speed", "omega_out"), "speed", "rad/s", omega_out="driven mass"),
        lambda axes: plot(axes, table, accelerations, "acceleration", "rad/s²"),
        lambda axes: plot(axes, table, ("twist",), "twist", "mrad"),
        lambda axes: _energies(axes, table, 0, energy_lost="losses minus work of the balancer"),
    ][:rows]
    panels = figure.subplots(len(draw_functions), 1, sharex=True, squeeze=False)[:, 0]
    for axes, draw in zip(panels, draw_functions, strict=True):
        draw(axes)
    panels[-1].set_xlabel("time [s]")
    peak = result.summary["driven_acceleration_peak"]
    headline(panels[0], f"maximum: driven mass {peak:.4g} rad/s², hub {np.abs(law).max():.4g} rad/s²")
