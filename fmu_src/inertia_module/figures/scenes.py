"""Pictures of scenes that answer their question at a glance: of the module and its losses, and of a shaft."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from ..contract.variables import LOSSES, LOST_TO
from ..harness.simulate import Result
from ..loops.cycles import KILOMETRE_PER_HOUR, Cycle
from ..scene import SceneResult
from ..scene.run import TIME_TO, forces, input_speed, work
from .panels import SIZE, SMOOTHING, Array, dress, headline, sheet, smooth

# draws rows of a table: of the whole run, or close up
Panel = Callable[[Axes, Result, slice, bool], None]

PULSES_SHOWN = 4
# more of them one below the other make the figure higher
MOST_PANELS = 4
# switches of freewheels in a row that has any, on average, above which a line does not say what instants did
MOST_SWITCHES = 1.1
# of the losses, in their order
COLOURS = (VERMILION, ORANGE, PURPLE, SKY, BLUE)
# largest share of the run over which its powers are averaged
WINDOW = 1.0 / 8.0
# what swings with the pulses: colours and labels
IMBALANCE = (PURPLE, "imbalance")
FORCES = {"satellite_force": (PURPLE, "on the satellite's bearing"), "shaking_force": (BLUE, "on the mount")}


def scene_figure(result: SceneResult) -> Figure:
    """Draw a scene: how a cycle was followed, how the pulses drive the shaft, or how a shaft alone turns.

    Args:
        result: of run_scene or run_shaft_scene.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels, higher with more than four panels; save it with
        figure.savefig(path).
    """
    figure = sheet(result.scene.title)
    if "hub_speed" in result.record:
        _shaft_panels(figure, result)
    elif result.scene.controller is not None and "vehicle_speed" in result.record:
        _driving_panels(figure, result)
    else:
        _pulse_panels(figure, result)
    return figure


# --- pulses ---


def is_coarse(table: Result) -> bool:
    """Tell whether the rows are too far apart for the pulses: instants make no curve then."""
    switches = np.diff(table["contact_switches"])
    return bool(switches.sum() > MOST_SWITCHES * np.count_nonzero(switches))


def plot_instants(axes: Axes, table: Result, values: Array, rows: slice, label: str, **style: Any) -> None:
    """Draw what swings with the pulses: a line, or dots where the rows are too far apart for one."""
    dots: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2.0} if is_coarse(table) else {}
    shown = f"{label}, at instants" if dots else label
    axes.plot(table.time[rows], values[rows], label=shown, **style, **dots)


def pulse_starts(table: Result) -> NDArray[np.int64]:
    """Rows at which a torque pulse on the output shaft begins, as far as the rows show."""
    driving = table["output_torque_mean"] > 0.0
    return np.flatnonzero(~driving[:-1] & driving[1:]).astype(np.int64)


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
    """Draw left the whole run, right its end; the forces take the place of the acceleration."""
    table, numbers = result.record, result.summary
    first, shown = end_of_run(table)
    drawn: list[Panel] = [_speeds, _torques]
    if not FORCES.keys().isdisjoint(forces(table)) or "imbalance_acceleration" in table:
        drawn.append(_instant_panel)
    if lost := losses(table):
        drawn.append(partial(_power_panel, energies=_flows(table), label="power"))
        drawn.append(partial(_power_panel, energies=lost, label="lost"))
    drawn.append(_energy_panel)
    figure.set_figheight(SIZE[1] * max(1.0, len(drawn) / MOST_PANELS))
    grid = figure.subplots(len(drawn), 2, sharex="col", width_ratios=(3, 2))
    for panels, begin, zoomed in ((grid[:, 0], 0, False), (grid[:, 1], first, True)):
        for axes, draw in zip(panels, drawn, strict=True):
            draw(axes, table, slice(begin, None), zoomed)
        panels[-1].set_xlabel("time [s]")
    for axes in grid[:2, 0]:
        axes.axvspan(table.time[first], table.time[-1], color=ORANGE, alpha=0.12, linewidth=0)
    # the first speed of a vehicle that was asked for and reached, and when
    reached = [
        f"{name.removeprefix(TIME_TO).partition('_')[0]} km/h in {numbers[name]:.3g} s, "
        for name in numbers
        if name.startswith(TIME_TO)
    ]
    headline(
        grid[0, 0],
        f"whole run: output shaft at {numbers['omega_out_final']:.4g} rad/s after"
        f" {numbers['simulated_time']:g} s, {''.join(reached[:1])}"
        f"mean torque {numbers['output_torque_mean']:.3g} N·m",
    )
    headline(grid[0, 1], f"{shown} ({numbers['contact_switches']:.0f} switches in all)")


def _speeds(axes: Axes, table: Result, rows: slice, zoomed: bool) -> None:
    """Speeds of the links; close up without the input, which would press the others flat."""
    time = table.time[rows]
    if not zoomed:
        axes.plot(time, input_speed(table)[rows], color=BLACK, linewidth=1.2, label="input ω1")
    plot_instants(axes, table, table["omega2"], rows, "link 2 ω2", color=SKY, linewidth=1.0)
    axes.plot(time, table["omega_out"][rows], color=VERMILION, linewidth=2.0, label="output shaft")
    if "reference" in table and table.units["reference"] == "rad/s":
        axes.plot(time, table["reference"][rows], "--", color=GREEN, linewidth=1.2, label="reference")
    dress(axes, "speed [rad/s]")


def _torques(axes: Axes, table: Result, rows: slice, zoomed: bool) -> None:
    """Torques: means over the whole run, close up what happens at each instant (if recorded often enough)."""
    time = table.time[rows]
    instants = {"output_torque", "housing_torque", "input_torque"} <= set(table.names)
    if zoomed and instants and not is_coarse(table):
        axes.plot(time, table["input_torque"][rows], color=BLACK, linewidth=1.0, label="input")
        axes.fill_between(time, table["output_torque"][rows], color=VERMILION, alpha=0.35, linewidth=0)
        axes.plot(
            time, table["output_torque"][rows], color=VERMILION, linewidth=1.5, label="output freewheel"
        )
        axes.plot(time, table["housing_torque"][rows], color=BLUE, linewidth=1.5, label="housing freewheel")
        dress(axes, "torque [N·m]")
        return
    torque = table["output_torque_mean"][rows]
    axes.fill_between(
        time, torque, step="pre", color=VERMILION, alpha=0.4, linewidth=0, label="output, step mean"
    )
    starts = pulse_starts(table)
    if starts.size > 1 and not zoomed:
        impulse = np.concatenate([[0.0], np.cumsum(table["output_torque_mean"][1:] * np.diff(table.time))])
        means, edges = np.diff(impulse[starts]) / np.diff(table.time[starts]), table.time[starts]
        axes.stairs(means, edges, baseline=None, color=BLACK, linewidth=1.8, label="mean from pulse to pulse")
    axes.plot(time, table["load_torque"][rows], "--", color=GREEN, linewidth=1.5, label="load")
    if "drive_torque" in table:
        axes.plot(time, table["drive_torque"][rows], color=BLUE, linewidth=1.5, label="drive")
    dress(axes, "torque [N·m]")


# --- energy, losses and forces ---


def in_thousands(unit: str, *values: Array) -> tuple[float, str]:
    """Divisor and unit in which values are shown: with a k where they are large."""
    largest = max(float(np.abs(part).max()) for part in values)
    return (1e3, f"k{unit}") if largest > 2e3 else (1.0, unit)


def plot_all(
    axes: Axes, x: Array, curves: Mapping[str, tuple[Array, str]], unit: str, rows: slice = slice(None)
) -> str:
    """Plot rows of curves with their colours by name, in thousands where they are large; the unit shown."""
    factor, shown = in_thousands(unit, *(values for values, _ in curves.values()))
    for name, (values, colour) in curves.items():
        axes.plot(x[rows], values[rows] / factor, color=colour, linewidth=1.5, label=name)
    return shown


def _flows(table: Result) -> dict[str, tuple[Array, str]]:
    """Energies since the start, J, that go in, out and are lost, each with its colour."""
    return {
        "in": (table["energy_in"], BLACK),
        "out to the load": (table["energy_out"], GREEN),
        "lost": (table["energy_lost"], VERMILION),
    }


def _energy_panel(axes: Axes, table: Result, rows: slice, zoomed: bool, lost: str = "lost") -> None:
    """Energies since the start: in, out, gain of what is stored and, if there is any, what is lost."""
    energies = _flows(table)
    gone = energies.pop("lost")
    energies["gain of stored"] = table["energy_stored"] - table["energy_stored"][0], BLUE
    if gone[0].any():
        energies[lost] = gone
    dress(axes, f"energy [{plot_all(axes, table.time, energies, 'J', rows)}]")


def losses(table: Result) -> dict[str, tuple[Array, str]]:
    """Collect the energy lost since the start, J, and a colour, by cause: of those that lose any."""
    return {
        name.removeprefix(LOST_TO).replace("_", " "): (table[name], COLOURS[n % len(COLOURS)])
        for n, name in enumerate(LOSSES)
        if table[name].any()
    }


def _power_panel(
    axes: Axes,
    table: Result,
    rows: slice,
    zoomed: bool,
    energies: Mapping[str, tuple[Array, str]],
    label: str,
) -> None:
    """Rates of energies since the start, in the whole run without its pulses."""
    time = table.time[1:]
    powers = {name: np.diff(energy) / np.diff(table.time) for name, (energy, _) in energies.items()}
    shown = slice(rows.start, None)
    if not zoomed:
        window = min(SMOOTHING, WINDOW * float(time[-1] - time[0]))
        powers = {name: smooth(time, power, window) for name, power in powers.items()}
        # at the ends the window is cut off within a pulse
        cut = round(0.5 * window / float(time[1] - time[0]))
        shown = slice(cut, len(time) - cut)
    curves = {name: (power[shown], energies[name][1]) for name, power in powers.items()}
    dress(axes, f"{label} [{plot_all(axes, time[shown], curves, 'W')}]")
    axes.set_ylim(bottom=min(axes.get_ylim()[0], 0.0))


def _instant_panel(axes: Axes, table: Result, rows: slice, zoomed: bool) -> None:
    """Magnitudes of the forces that are recorded, else of the acceleration of the imbalance."""
    found = {FORCES[name]: values for name, values in forces(table).items() if name in FORCES}
    what, factor, unit = "acceleration", 1e3, "km/s²"
    if found:
        what, (factor, unit) = "force", in_thousands("N", *found.values())
    for (colour, label), values in (found or {IMBALANCE: table["imbalance_acceleration"]}).items():
        plot_instants(axes, table, values / factor, rows, label, color=colour, linewidth=0.9)
    axes.set_ylim(bottom=0.0)
    dress(axes, f"{what} [{unit}]")


# --- driving ---


def _driving_panels(figure: Figure, result: SceneResult) -> None:
    """Speed in its band, speeds of the module, torques, energy: one below the other."""
    table, numbers = result.record, result.summary
    lossy = bool(losses(table))
    figure.set_figheight(SIZE[1] * (1.2 if lossy else 1.0))
    panels = figure.subplots(4 + lossy, 1, sharex=True, height_ratios=(1.6, 1, 1, 1.2, 1)[: 4 + lossy])
    _followed_speed(panels[0], table, result.scene.cycle)
    outside = (
        f"out of tolerance {numbers['time_out_of_tolerance']:.2f} s of {numbers['simulated_time']:g} s, "
        if result.scene.cycle is not None
        else ""
    )
    headline(
        panels[0],
        f"{outside}error {numbers['tracking_error_rms']:.2f} km/h rms and"
        f" {numbers['tracking_error_maximum']:.2f} km/h at most",
    )
    label = "input ω1 (commanded)" if "omega1" in table else "input ω1"
    panels[1].plot(table.time, input_speed(table), color=BLACK, linewidth=1.2, label=label)
    panels[1].plot(table.time, table["omega_out"], color=VERMILION, linewidth=1.6, label="output shaft")
    panels[1].set_ylim(bottom=0.0)
    dress(panels[1], "speed [rad/s]")
    _mean_torques(panels[2], table)
    _energy_shares(panels[3], table)
    if lossy:
        _power_panel(panels[4], table, slice(0, None), False, losses(table), "lost")
    panels[-1].set_xlabel("time [s]")


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
    dress(axes, "speed [km/h]")


def _mean_torques(axes: Axes, table: Result) -> None:
    time, torque = table.time, table["output_torque_mean"]
    taken, brake = (smooth(time, table[name]) for name in ("input_torque_mean", "brake_torque"))
    axes.fill_between(time, torque, color=VERMILION, alpha=0.25, linewidth=0, step="pre")
    axes.plot(time, smooth(time, torque), color=VERMILION, linewidth=1.6, label="output")
    axes.plot(time, taken, color=BLACK, linewidth=1.2, label="input")
    axes.plot(time, -brake, color=BLUE, linewidth=1.6, label="brake")
    axes.set_ylim(-1.15 * float(brake.max()) - 5.0, 1.15 * float(np.quantile(torque, 0.995)) + 5.0)
    dress(axes, "torque [N·m]")


def _energy_shares(axes: Axes, table: Result) -> None:
    """Shares of the energy of the input, by where it went up to each moment."""
    parts = {
        "brake": (work(table, "brake_torque"), BLUE),
        "rolling": (work(table, "rolling_torque"), ORANGE),
        "air drag": (work(table, "drag_torque"), SKY),
        "slope": (work(table, "slope_torque"), GREEN),
    }
    parts = {name: part for name, part in parts.items() if np.abs(part[0]).max() > 0.0}
    if table["energy_lost"].any():
        parts["lost"] = (table["energy_lost"], GREY)
    # module, car and, if it is elastic, the coupling between them
    parts["in motion"] = (table["energy_in"] - sum(energy for energy, _ in parts.values()), PURPLE)
    factor, unit = in_thousands("J", table["energy_in"])
    shares = [energy / factor for energy, _ in parts.values()]
    colours = [colour for _, colour in parts.values()]
    axes.stackplot(table.time, *shares, labels=list(parts), colors=colours, alpha=0.75, linewidth=0)
    axes.plot(table.time, table["energy_in"] / factor, color=BLACK, linewidth=1.5, label="input")
    dress(axes, f"energy [{unit}]")


# --- a shaft alone ---


def _shaft_panels(figure: Figure, result: SceneResult) -> None:
    """Speeds and accelerations of hub and driven mass, twist and energy, one below the other."""
    table, time = result.record, result.record.time
    panels = figure.subplots(4, 1, sharex=True)
    law = np.gradient(table["hub_speed"], time)
    for axes, hub, mass, label in (
        (panels[0], table["hub_speed"], table["omega_out"], "speed [rad/s]"),
        (panels[1], law, table["driven_acceleration"], "acceleration [rad/s²]"),
    ):
        axes.plot(time, hub, color=BLACK, linewidth=1.2, label="hub")
        axes.plot(time, mass, color=VERMILION, linewidth=1.6, label="driven mass")
        dress(axes, label)
    panels[2].plot(time, 1e3 * table["twist"], color=PURPLE, linewidth=1.6, label="twist")
    dress(panels[2], "twist [mrad]")
    _energy_panel(panels[3], table, slice(None), zoomed=False, lost="lost, less the balancer's work")
    panels[3].set_xlabel("time [s]")
    headline(
        panels[0],
        f"driven mass at most {result.summary['driven_acceleration_peak']:.4g} rad/s²,"
        f" hub {np.abs(law).max():.4g} rad/s²",
    )
