"""Pictures of torque converter charts, one curve a mechanism."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure, SubFigure

from ..common.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from ..harness.chart import EfficiencyMap, TorqueConverterChart
from .panels import SIZE, plain, sheet

COLOURS = (VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY, BLACK)
LARGEST_TORQUE_RATIO = 6.0
# of the lines of equal efficiency
LEVELS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0)


def chart_figure(
    charts: Mapping[str, TorqueConverterChart], maps: Mapping[str, EfficiencyMap] | None = None
) -> Figure:
    """Draw torque ratio and efficiency, output and input torque, capacity and ripple over the speed ratio.

    Args:
        charts: by the names for the legend. maps: of the efficiency of those with losses.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels, with maps higher by half.
    """
    figure = sheet("Torque converter chart")
    upper: Figure | SubFigure = figure
    if maps:
        figure.set_figheight(1.5 * SIZE[1])
        parts = figure.subfigures(2, 1, squeeze=False, height_ratios=(2, 1))
        upper, below = parts[0, 0], parts[1, 0].subplots(1, len(maps), squeeze=False)
        for axes, (name, found) in zip(below.flat, maps.items(), strict=True):
            # lines of equal efficiency
            speeds = np.abs(found.omega1)
            end = max(np.flatnonzero(found.efficiency.any(axis=0)), default=0) + 1
            curves = found.speed_ratio, speeds, found.efficiency, LEVELS
            filled = axes.contourf(*curves, cmap="viridis")
            axes.clabel(axes.contour(*curves, colors="white", linewidths=0.6), fontsize=8)
            axes.set_xlim(0.0, found.speed_ratio[min(end, found.speed_ratio.size - 1)])
            axes.figure.colorbar(filled, ax=axes)
            axes.set_title(f"efficiency of {name}", loc="left", fontsize=11)
            axes.set_xlabel("speed ratio, output / input")
            axes.set_ylabel("input speed [rad/s]")
    panels = upper.subplots(2, 2, sharex=True)
    ratio, output, taken, ripple = panels.flat
    for number, (name, chart) in enumerate(charts.items()):
        colour = COLOURS[number % len(COLOURS)]
        speed, torque = chart.speed_ratio, chart.output_torque
        # torque ratio and ripple where they are not too steep
        gentle = chart.input_torque * LARGEST_TORQUE_RATIO > torque
        passing = torque > 1e-3 * max(chart.stall_torque, 1e-300)
        ratio.plot(speed[gentle], torque[gentle] / chart.input_torque[gentle], color=colour, label=name)
        ratio.plot(speed, chart.efficiency, "--", color=colour)
        output.plot(speed, torque, color=colour, label=name)
        if chart.lock_up_torque[0] > 0.0:
            output.plot([1.0, 1.0], [0.0, chart.lock_up_torque[0]], color=colour, linewidth=3.0, alpha=0.5)
        taken.plot(speed, chart.input_torque, color=colour, label=name)
        ripple.plot(speed[passing], chart.ripple[passing] / torque[passing], color=colour, label=name)
    first = "torque ratio, and efficiency (broken line)" if maps else "torque ratio (no losses: efficiency 1)"
    for axes, title, unit in (
        (ratio, first, ""),
        (output, "mean output torque / ω1²; bar: lock-up holds up to", "N·m·s²"),
        (taken, "mean input torque / ω1² (what the drive has to give)", "N·m·s²"),
        (ripple, "RMS ripple over mean output torque", "-"),
    ):
        axes.set_title(title, loc="left", fontsize=11)
        axes.set_ylabel(unit)
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=9, frameon=False)
        plain(axes)
    ratio.set_ylim(0.0, LARGEST_TORQUE_RATIO)
    for axes in panels[1]:
        axes.set_xlabel("speed ratio, output / input")
    return figure
