"""Figures of charts, sweeps, designs, fits and order analyses."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from ..analysis.converter_chart import NOMINAL_SPEED, TorqueConverterChart
from ..common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, styled
from ..common.deprecated import renamed_arguments
from ..common.units import factor_between, printed_unit
from ..studies.axes import Axis
from ..studies.design_result import DesignResult
from ..studies.design_specification import metric_text
from ..studies.evaluation import Row
from ..studies.fit_result import FitResult
from ..studies.order_result import BASES, Orders
from ..studies.parameter_sweep import SweepResult, varies
from .panels import MAX_LINEAR_RATIO, SIZE, Array, add_label_and_legend, label_with_unit, new_figure

# --- torque converter charts, one curve per mechanism ---

COLOURS = (VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY, BLACK)
MAX_TORQUE_RATIO = 6.0
# efficiencies of the contour lines
EFFICIENCY_LEVELS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0)
# title and label of the panels of a chart; the last two panels require engagements
PANELS = (
    ("torque ratio", "output torque / input torque"),
    ("mean output torque; bar: lock-up torque", "torque [N·m]"),
    ("mean input torque", "torque [N·m]"),
    ("output torque ripple, RMS over mean", "ripple"),
    ("engagements: output, housing (dashed), limit (dotted)", "frequency [Hz]"),
    ("maximum output freewheel torque", "torque [N·m]"),
)


@styled()
def chart_figure(
    charts: Mapping[str, TorqueConverterChart],
    maps: Mapping[str, Mapping[str, Array]] | None = None,
    speed_unit: str = "rad/s",
    allowed: Mapping[str, float] = MappingProxyType({}),
    omega1: float | None = None,
) -> Figure:
    """Draw torque ratio and efficiency, output and input torque, ripple and engagements over the speed ratio.

    Args:
        charts: Charts by the names in the legend.
        maps: Results of steady_map by name, for efficiency maps.
        speed_unit: Unit of the input speed.
        allowed: Maximum engagements of a freewheel per revolution of the input, by chart.
        omega1: Input speed of torques and frequencies, rad/s; None for NOMINAL_SPEED.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels, half as high again for engagements and for maps.
    """
    has_engagements = any(chart.output_engagements is not None for chart in charts.values())
    speed = NOMINAL_SPEED if omega1 is None else omega1
    at = f"{speed * factor_between('rad/s', speed_unit):.5g} {speed_unit}"
    rows, maps = 2 + has_engagements, maps or {}
    map_rows = -(-len(maps) // 2)
    figure = new_figure(f"Torque converter chart at {at}", 0.5 * (rows + map_rows) * SIZE[1])
    panels = figure.subplots(rows + map_rows, 2).flatten().tolist()
    chart_panels, map_panels = panels[: 2 * rows], panels[2 * rows :]
    for axes, (title, label) in zip(chart_panels, PANELS, strict=False):
        axes.set_title(title)
        axes.set_ylabel(label)
    for axes in chart_panels[1:]:
        axes.sharex(chart_panels[0])
    _draw_charts(chart_panels, charts, speed, allowed)
    for axes, (name, steady_map) in zip(map_panels, maps.items(), strict=False):
        axes.set_title(f"efficiency of {name}")
        _draw_efficiency(axes, steady_map, speed_unit)
    if len(maps) % 2:  # the last map fills its row
        map_panels[-1].remove()
        grid = map_panels[-2].get_gridspec()
        map_panels[-2].set_subplotspec(grid[-1, :])
    return figure


def _draw_charts(
    panels: Sequence[Axes],
    charts: Mapping[str, TorqueConverterChart],
    omega1: float,
    allowed: Mapping[str, float],
) -> None:
    """Draw the curves of charts.

    Args:
        panels: Panels in the order of PANELS; the last two are optional.
        charts: Charts by the names in the legend.
        omega1: Input speed of torques and frequencies, rad/s.
        allowed: Maximum engagements of a freewheel per revolution of the input, by chart.
    """
    ratio, output, input_torque, ripple, *duty = panels
    torque_factor, frequency_factor = omega1**2, abs(omega1) / math.tau
    efficiency = None
    if all(chart.lossless for chart in charts.values()):
        ratio.set_title(f"{PANELS[0][0]}, no losses")
    else:
        ratio.set_title(f"{PANELS[0][0]}, efficiency (dashed)")
        efficiency = ratio.twinx()
        efficiency.grid(visible=False)
        efficiency.spines["right"].set_visible(True)
        efficiency.set_ylim(0.0, 100.0)
        efficiency.set_ylabel("efficiency [%]")
    for number, (name, chart) in enumerate(charts.items()):
        colour = COLOURS[number % len(COLOURS)]
        speed, torque = chart.speed_ratio, chart.output_torque
        # Torque ratio and ripple are drawn only within a limited range.
        in_range = chart.input_torque * MAX_TORQUE_RATIO > torque
        has_torque = torque > 1e-3 * max(chart.stall_torque, 1e-300)
        ratio.plot(speed[in_range], torque[in_range] / chart.input_torque[in_range], color=colour, label=name)
        if efficiency is not None:
            efficiency.plot(speed, 100.0 * chart.efficiency, "--", color=colour)
        output.plot(speed, torque_factor * torque, color=colour)
        if chart.lock_up_torque[0] > 0.0:
            bar = [0.0, torque_factor * chart.lock_up_torque[0]]
            output.plot([1.0, 1.0], bar, color=colour, linewidth=3.0, alpha=0.5)
        input_torque.plot(speed, torque_factor * chart.input_torque, color=colour)
        ripple.plot(speed[has_torque], chart.ripple[has_torque] / torque[has_torque], color=colour)
        if chart.output_engagements is not None and chart.housing_engagements is not None:
            duty[0].plot(speed, frequency_factor * chart.output_engagements, color=colour)
            duty[0].plot(speed, frequency_factor * chart.housing_engagements, "--", color=colour)
            duty[1].plot(speed, torque_factor * chart.peak, color=colour)
            if name in allowed:
                duty[0].axhline(frequency_factor * allowed[name], color=colour, linestyle=":")
    for axes in panels:
        axes.set_ylim(bottom=0.0)
    ratio.set_ylim(0.0, MAX_TORQUE_RATIO)
    for axes in panels[-2:]:
        axes.set_xlabel("speed ratio, output / input")
    if len(charts) > 1:
        ratio.figure.legend(*ratio.get_legend_handles_labels(), loc="outside lower center", ncols=4)


def _draw_efficiency(axes: Axes, steady_map: Mapping[str, Array], unit: str) -> None:
    """Draw lines of equal efficiency over speed ratio and input speed."""
    ratios, efficiency = steady_map["speed_ratio"], steady_map["efficiency"]
    end = max(np.flatnonzero(efficiency.any(axis=0)), default=0) + 1
    speeds = np.abs(steady_map["omega1"]) * factor_between("rad/s", unit)
    curves = ratios, speeds, efficiency, EFFICIENCY_LEVELS
    contours = axes.contourf(*curves, cmap="viridis")
    axes.clabel(axes.contour(*curves, colors="white", linewidths=0.6), fontsize=8)
    axes.figure.colorbar(contours, ax=axes, label="efficiency")
    axes.grid(visible=False)
    axes.set_xlim(0.0, ratios[min(end, ratios.size - 1)])
    axes.set_xlabel("speed ratio, output / input")
    axes.set_ylabel(f"input speed [{unit}]")


# --- sweeps ---

# metrics of the default selection, if they vary
USUAL = ("efficiency", "omega_out_final", "output_torque_mean", "input_torque_mean", "satellite_force_peak")
MAX_METRICS = 3


@renamed_arguments(values="metrics")
@styled()
def sweep_figure(sweep: SweepResult, metrics: Sequence[str] = ()) -> Figure:
    """Draw a sweep: maps over two keys, otherwise each metric over each key.

    Args:
        sweep: Result of the sweep.
        metrics: Names of metrics; without names up to MAX_METRICS metrics that vary.

    Raises:
        ParameterError: The sweep has no metric of this name.
    """
    names = list(metrics)
    if not names:
        candidates = sorted(sweep.metrics, key=lambda name: name not in USUAL)
        names = [name for name in candidates if varies(sweep.metric(name))][:MAX_METRICS]
    rows, columns = max(len(names), 1), 1 if len(sweep.axes) == 2 else len(sweep.axes)
    picture = new_figure(height=1.0 + 2.8 * rows, width=max(9.0, 3.0 * columns))
    panels = picture.subplots(rows, columns, sharey="row", squeeze=False)
    for row, name in zip(panels, names, strict=False):
        values, label = sweep.metric(name), label_with_unit(name, sweep.units.get(name, ""))
        if len(sweep.axes) == 2:
            _draw_map(row[0], sweep, values, label)
            continue
        row[0].set_ylabel(label)
        for panel, axis in zip(row, sweep.axes, strict=True):
            places = _axis_values(sweep, axis)
            order = np.argsort(places, kind="stable")
            panel.plot(places[order], values[order], ".-" if columns == 1 else ".", linewidth=1.2)
            _set_scale(panel, sweep, axis, "x")
    return picture


def _axis_values(sweep: SweepResult, axis: Axis) -> NDArray[Any]:
    """Return the values of the samples on an axis: numbers, or names, which matplotlib spaces equally."""
    return np.array([row.point[axis.name] for row in sweep.rows])


def _set_scale(panel: Axes, sweep: SweepResult, axis: Axis, side: str) -> None:
    """Set label and scale of one side, x or y, of a panel for an axis of the sweep."""
    getattr(panel, f"set_{side}label")(label_with_unit(axis.name, sweep.units.get(axis.name, "")))
    if axis.logarithmic:
        getattr(panel, f"set_{side}scale")("log")


def _draw_map(panel: Axes, sweep: SweepResult, values: Array, label: str) -> None:
    """Draw a grid as a map, other samples as dots; failed samples stay white."""
    x, y = (_axis_values(sweep, axis) for axis in sweep.axes)
    across, up = np.unique(x), np.unique(y)
    if across.size * up.size == values.size:
        table = np.full((up.size, across.size), np.nan)
        table[np.searchsorted(up, y), np.searchsorted(across, x)] = values
        artist: Any = panel.pcolormesh(across, up, table, shading="nearest")
        panel.grid(visible=False)
    else:
        artist = panel.scatter(x, y, c=values, s=14)
    panel.figure.colorbar(artist, ax=panel, label=label)
    for axis, side in zip(sweep.axes, "xy", strict=True):
        _set_scale(panel, sweep, axis, side)


# --- designs ---


# limits of an axis: range of the Pareto front, at least this fraction of its value, widened by the margin
MIN_RANGE, MARGIN = 0.01, 0.25
# approximate height of a large panel and of a line, points; distance of neighbouring dots over the width
PANEL_HEIGHT, LINE_HEIGHT, NEIGHBOUR = 345.0, 15.0, 0.15


@styled()
def design_figure(result: DesignResult) -> Figure:
    """Draw a design: a single goal over the number of the design, or the other goals over the first.

    The large panels show the region of the Pareto front, the small panels all designs. A table below has
    the goals of the numbered designs.

    Args:
        result: Result of design.
    """
    names = list(result.judge.spec.goals)
    across, up = (None, names) if len(names) == 1 else (names[0], names[1:])
    table_height = 0.6 + 0.3 * len(result.finalists)
    picture = new_figure(result.judge.spec.title, 1.0 + 5.0 * len(up) + table_height)
    heights = [*(5.0 for _ in up), table_height]
    grid = picture.add_gridspec(len(heights), 2, width_ratios=(3, 1), height_ratios=heights)
    for row, name in enumerate(up):
        front, overview = (picture.add_subplot(grid[row, column]) for column in (0, 1))
        _draw_goals(front, result, across, name)
        _zoom(front, result, across, name)
        _draw_goals(overview, result, across, name, markersize=2.0)
        x, y = _coordinates(result, result.rows, across, name)
        _use_log_scale(overview.set_yscale, overview.yaxis, y)
        if across is not None:
            _use_log_scale(overview.set_xscale, overview.xaxis, x)
        (left, right), (low, high) = front.get_xlim(), front.get_ylim()
        overview.plot(
            [left, right, right, left, left], [low, low, high, high, low], color=GREY, linewidth=0.8
        )
        overview.set_title("all designs")
        add_label_and_legend(front, label_with_unit(name, result.judge.unit(name)))
        front.set_xlabel(
            "design number" if across is None else label_with_unit(across, result.judge.unit(across))
        )
    if result.finalists:
        _design_table(picture.add_subplot(grid[-1, :]), result, names)
    return picture


def _coordinates(
    result: DesignResult, rows: Sequence[Row], across: str | None, up: str
) -> tuple[Array, Array]:
    """Return the coordinates of designs, shape (n,) each; NaN for missing metrics."""
    place = {str(row.point): n for n, row in enumerate(result.rows, 1)}
    x = [place[str(row.point)] if across is None else row.metrics.get(across, np.nan) for row in rows]
    return np.array(x, dtype=float), np.array([row.metrics.get(up, np.nan) for row in rows], dtype=float)


def _draw_goals(
    panel: Axes, result: DesignResult, across: str | None, up: str, markersize: float = 5.0
) -> None:
    """Draw one goal over another, or over the number of the design."""
    points = partial(_coordinates, result, across=across, up=up)
    margin = result.judge.spec.search.margin
    meets = [result.judge.meets(row, margin) for row in result.rows]
    limits = f"with a margin of {100.0 * margin:.3g} %" if margin else "without a margin"
    groups = (("violates a limit", False, "0.8"), (f"satisfies all limits {limits}", True, SKY))
    for label, is_group, colour in groups:
        rows = [row for row, is_valid in zip(result.rows, meets, strict=True) if is_valid is is_group]
        panel.plot(*points(rows), ".", color=colour, markersize=markersize, label=label)
    style = "*" if across is None else "-"
    x, y = points(result.front)
    order = np.argsort(x)
    panel.plot(x[order], y[order], style, color=BLACK, linewidth=1.0, markersize=9, label="Pareto front")
    for finalist in result.finalists:
        is_valid = result.judge.meets(finalist.checked)
        marker, colour = ("o", GREEN) if is_valid else ("x", VERMILION)
        panel.plot(*points([finalist.checked]), marker, color=colour, markersize=1.6 * markersize)
    panel.plot([], [], "o", color=GREEN, label=f"verified ({result.judge.spec.search.check})")


def _zoom(panel: Axes, result: DesignResult, across: str | None, up: str) -> None:
    """Limit a panel to the Pareto front and the verified designs, and number these designs."""
    finalists = [finalist.checked for finalist in result.finalists]
    x, y = _coordinates(result, [*result.front, *finalists] or result.rows, across, up)
    if not np.isfinite(x + y).any():  # a missing metric, such as a speed that is not reached
        x, y = _coordinates(result, result.rows, across, up)
    is_finite = np.isfinite(x + y)
    if not is_finite.any():
        return
    for set_limits, values in ((panel.set_xlim, x[is_finite]), (panel.set_ylim, y[is_finite])):
        low, high = float(values.min()), float(values.max())
        margin = MARGIN * max(high - low, MIN_RANGE * max(abs(low), abs(high)))
        set_limits(low - margin, high + margin)
    places = np.column_stack(_coordinates(result, finalists, across, up))
    labels = [finalist.file.stem.rpartition("_")[2] for finalist in result.finalists]
    pairs = zip(labels, places.tolist(), strict=True)
    _number_dots(panel, {label: (x, y) for label, (x, y) in pairs if np.isfinite(x + y)})


def _number_dots(panel: Axes, places: Mapping[str, tuple[float, float]]) -> None:
    """Label dots, each with a line to its label.

    Args:
        panel: Panel with its final limits.
        places: Coordinates of the dots by label.
    """
    corner, opposite = np.transpose([panel.get_xlim(), panel.get_ylim()])
    previous: list[tuple[float, float]] = []
    # From the lowest dot upward, each label is at least one line above the labels of neighbouring dots.
    for label, place in sorted(places.items(), key=lambda item: item[1][1]):
        across_fraction, up_fraction = (np.array(place) - corner) / (opposite - corner)
        own_height = height = up_fraction * PANEL_HEIGHT
        for fraction, below in previous:
            if abs(fraction - across_fraction) < NEIGHBOUR:
                height = max(height, below + LINE_HEIGHT)
        previous.append((across_fraction, height))
        panel.annotate(
            label,
            place,
            xytext=(28, height - own_height),
            textcoords="offset points",
            va="center",
            fontweight="bold",
            arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.8},
        )


def _design_table(panel: Axes, result: DesignResult, names: Sequence[str]) -> None:
    """Draw the table of the verified designs: number, goals, limits."""
    panel.set_axis_off()
    rows = []
    for finalist in result.finalists:
        values = [metric_text(finalist.checked, name) for name in names]
        limits = "satisfied" if result.judge.meets(finalist.checked) else "violated"
        rows.append([finalist.file.stem.rpartition("_")[2], *values, limits])
    headings = ["design", *(label_with_unit(name, result.judge.unit(name)) for name in names), "limits"]
    table = panel.table(rows, colLabels=headings, loc="center", cellLoc="center", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(10)
    table.scale(1.0, 1.3)


def _use_log_scale(set_scale: Callable[[str], None], axis: Any, values: Array) -> None:
    """Make an axis of more than a decade logarithmic, because the first designs are far from the best."""
    if (values < 0.0).any():
        set_scale("symlog")
        return
    positive = values[values > 0.0]
    if not positive.size or positive.max() < MAX_LINEAR_RATIO * positive.min():
        return
    set_scale("log")
    axis.set_major_formatter("{x:g}")
    axis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    axis.set_minor_formatter(NullFormatter())


# --- fits ---

# half width of the band with 95 % of normally distributed noise, in standard deviations
BAND_95 = 1.96


@styled()
def fit_figure(result: FitResult) -> Figure:
    """Draw measured and computed values over time, and residuals over noise with a band of 95 %.

    Args:
        result: Result of fit.
    """
    data, table = result.measurement, result.table()
    figure = new_figure(result.scene.title, 1.0 + 4.0 * len(data.columns))
    panels = figure.subplots(2 * len(data.columns), 1, sharex=True, height_ratios=(2, 1) * len(data.columns))
    for n, name in enumerate(data.columns):
        curves, residuals = panels[2 * n : 2 * n + 2]
        is_used, time = data.counted[:, n], table.time
        curves.plot(time, table[f"{name}_measured"], ".", color=GREY, markersize=4, label="measured")
        curves.plot(time, table[f"{name}_computed"], color=VERMILION, linewidth=1.2, label="computed")
        add_label_and_legend(curves, label_with_unit(name, data.table.units.get(name, "")))
        curves.margins(x=0.01)
        normalised = table[f"{name}_residual"] / data.noise.get(name, result.noise[name])
        residuals.axhspan(-BAND_95, BAND_95, color=BLUE, alpha=0.12)
        residuals.plot(time[is_used], normalised[is_used], ".", color=BLUE, markersize=4)
        add_label_and_legend(residuals, "residual / noise")
        residuals.margins(x=0.01)
    panels[-1].set_xlabel("time [s]")
    return figure


# --- orders ---

# number of labelled lines in a panel
N_LABELLED = 3
# signals share a row if their amplitudes differ by less than this fraction of the maximum
SAME_RTOL = 0.01
# a signal without oscillation: amplitudes from this order on are below this fraction of its maximum
MIN_ORDER, MIN_FRACTION = 0.5, 0.02


@styled()
def order_figure(result: Orders, title: str, in_hz: bool = False, speed_unit: str = "rad/s") -> Figure:
    """Draw the spectrum of each signal and its waterfall, over the speed in a run-up, otherwise over time.

    Signals without oscillation are omitted. Signals with equal amplitudes share a row.

    Args:
        result: Result of orders.
        title: Title of the figure.
        in_hz: True for waterfalls over Hz and rpm instead of orders.
        speed_unit: Unit of the speed of link 1 in waterfalls over orders.
    """
    rows = oscillating_signals(result)
    figure = new_figure(title, 1.2 + 2.6 * max(len(rows), 1))
    if not rows:
        figure.text(0.5, 0.5, "all signals are constant", ha="center")
        return figure
    panels = figure.subplots(len(rows), 2, sharex="col" if in_hz else "all", squeeze=False)
    for (left, right), (name, label) in zip(panels, rows.items(), strict=True):
        lines = label_with_unit(label, result.units[name]).replace(", ", ",\n")
        _draw_spectrum(left, result, name, lines)
        mesh = _draw_waterfall(right, result, name, in_hz, "rpm" if in_hz else speed_unit)
        if mesh is not None:
            figure.colorbar(mesh, ax=right, label=f"amplitude [{printed_unit(result.units[name])}]")
    for axes, in_order in zip(panels[-1], (True, not in_hz), strict=True):
        axes.set_xlim(0.0, result.highest * (1.0 if in_order else float(result.rate.max())))
        axes.set_xlabel(f"order [cycles per {BASES[result.of]}]" if in_order else "frequency [Hz]")
    return figure


def oscillating_signals(result: Orders) -> dict[str, str]:
    """Return the oscillating signals without duplicates, each with the names of all equal signals.

    Signals without oscillation are omitted. Signals are equal if their amplitudes are.

    Args:
        result: Result of orders.
    """
    labels: dict[str, list[str]] = {}
    for name, amplitude in result.amplitude.items():
        maximum = float(amplitude.max())
        oscillation = float(amplitude[result.order >= MIN_ORDER].max(initial=0.0))
        if oscillation <= MIN_FRACTION * maximum:
            continue
        equal_signals = (
            other
            for other in labels
            if np.allclose(result.amplitude[other], amplitude, rtol=0.0, atol=SAME_RTOL * maximum)
        )
        labels.setdefault(next(equal_signals, name), []).append(name.replace("_", " "))
    return {name: ", ".join(names) for name, names in labels.items()}


def _draw_spectrum(axes: Axes, result: Orders, name: str, label: str) -> None:
    """Draw the mean spectrum of a signal and label the orders of its main lines."""
    amplitude = result.amplitude[name]
    axes.plot(result.order, amplitude, color=VERMILION, linewidth=1.2)
    for line in result.largest(N_LABELLED)[name]:
        low, high = np.searchsorted(result.order, (line.low, line.high))
        first = max(low - 1, 0)
        top = first + int(amplitude[first : high + 1].argmax())
        axes.annotate(
            f"{line.order:.4g}",
            (result.order[top], amplitude[top]),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=9,
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.7},
        )
    axes.set_ylim(0.0, 1.2 * float(amplitude.max()))
    add_label_and_legend(axes, label)


def _draw_waterfall(axes: Axes, result: Orders, name: str, in_hz: bool, speed_unit: str) -> Any:
    """Draw the amplitudes of a signal in each window; return None if there is only one window."""
    over, label = result.time, "time [s]"
    if result.time.size > 1 and (np.diff(result.speed) > 1e-3 * result.speed[0]).all():
        over, label = result.speed * factor_between("rad/s", speed_unit), f"speed of link 1 [{speed_unit}]"
    axes.set_ylabel(label)
    if over.size < 2:
        axes.text(0.5, 0.5, "one window", ha="center", transform=axes.transAxes)
        return None
    maximum = float(result.waterfall[name].max())
    norm = LogNorm(1e-3 * maximum, maximum, clip=True)
    across = result.frequency if in_hz else result.order
    axes.grid(visible=False)
    return axes.pcolormesh(across, over, result.waterfall[name], norm=norm, cmap="viridis", shading="nearest")
