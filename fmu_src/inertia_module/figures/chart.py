"""The torque converter chart as a figure, one curve a mechanism."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..common.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from ..harness.chart import TorqueConverterChart
from .scenes import DPI, SIZE

COLOURS = (VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY, BLACK)
LARGEST_TORQUE_RATIO = 6.0


def chart_figure(charts: Mapping[str, TorqueConverterChart]) -> Figure:
    """Torque ratio and efficiency, output and input torque, capacity and ripple over the speed ratio.

    Args:
        charts: by the names for the legend.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels.
    """
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    figure.suptitle("Torque converter chart", fontsize=15, fontweight="bold")
    panels = figure.subplots(2, 2, sharex=True)
    for number, (name, chart) in enumerate(charts.items()):
        colour = COLOURS[number % len(COLOURS)]
        _ratios(panels[0, 0], chart, colour if len(charts) == 1 else BLACK)
        _output(panels[0, 1], chart, name, colour)
        _input(panels[1, 0], chart, name, colour)
        _ripple(panels[1, 1], chart, name, colour)
    for axes, title in zip(
        panels.flat,
        (
            "torque ratio and efficiency of an ideal module (no losses)",
            "mean output torque / ω1²; bar: lock-up holds up to",
            "mean input torque / ω1² (what the drive has to give)",
            "RMS ripple over mean output torque",
        ),
        strict=True,
    ):
        axes.set_title(title, loc="left", fontsize=11)
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    for axes in (panels[0, 1], panels[1, 0], panels[1, 1]):
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=9, frameon=False)
    for axes in panels[1]:
        axes.set_xlabel("speed ratio, output / input")
    return figure


def _ratios(axes: Axes, chart: TorqueConverterChart, colour: str) -> None:
    shown = chart.speed_ratio > 1.0 / LARGEST_TORQUE_RATIO
    label = None if axes.lines else "torque ratio"
    axes.plot(chart.speed_ratio[shown], 1.0 / chart.speed_ratio[shown], color=colour, label=label)
    label = None if len(axes.lines) > 1 else "efficiency"
    axes.plot(chart.speed_ratio, chart.efficiency, "--", color=GREEN, label=label)
    axes.set_ylim(0.0, LARGEST_TORQUE_RATIO)
    axes.legend(fontsize=9, frameon=False)


def _output(axes: Axes, chart: TorqueConverterChart, name: str, colour: str) -> None:
    axes.plot(chart.speed_ratio, chart.output_torque, color=colour, label=name)
    if chart.lock_up_torque[0] > 0.0:
        axes.plot([1.0, 1.0], [0.0, chart.lock_up_torque[0]], color=colour, linewidth=3.0, alpha=0.5)
    axes.set_ylabel("N·m·s²")


def _input(axes: Axes, chart: TorqueConverterChart, name: str, colour: str) -> None:
    axes.plot(chart.speed_ratio, chart.input_torque, color=colour, label=name)
    axes.set_ylabel("N·m·s²")


def _ripple(axes: Axes, chart: TorqueConverterChart, name: str, colour: str) -> None:
    passing = chart.output_torque > 1e-3 * max(chart.stall_torque, 1e-300)
    share = np.divide(chart.ripple, chart.output_torque, out=np.zeros_like(chart.ripple), where=passing)
    axes.plot(chart.speed_ratio[passing], share[passing], color=colour, label=name)
    axes.set_ylabel("-")
