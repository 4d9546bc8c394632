"""Summary of a run as text: warnings first, then groups of metrics with three digits in the user's units."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.units import factor_between, printed_unit
from ..interface.variables import ENUMERATIONS, LOSSES, LOST_TO
from ..kernel.codes import RIGID
from .freewheel_loads import DUTY_NOTE, FREEWHEELS
from .headings import heading
from .result import SceneResult
from .summary_metrics import input_speed
from .vehicle_metrics import TIME_TO, TRACTIVE_FORCE

# maximum width of the text, characters
WIDTH = 80
# width of the labels of the groups, and space between two items of a group
_LABEL, _GAP = 14, "   "
# speeds below this fraction of the maximum count as rest; a range below this fraction counts as constant
_REST_FACTOR, _RANGE_FACTOR = 1e-6, 1e-3
# backward rotation below this fraction of the maximum output speed is omitted
_BACKWARD_FACTOR = 0.01
# energies below this fraction of the supplied energy are omitted
_NEGLIGIBLE_FACTOR = 1e-4
# energies below this fraction of the stored energy are round-off; without energies also torques below this
# fraction of it
_ENERGY_ROUNDING, _TORQUE_ROUNDING = 1e-8, 1e-4
# display units by unit of a metric, for a scene without units
DISPLAY_UNITS: Mapping[str, str] = {"rad/s": "rpm", "km/h": "km/h", "N.m": "N.m"}
# multiples of a unit, each with the minimum of the largest value
_MULTIPLES = {
    "J": ((1e7, "MJ"), (1e4, "kJ")),
    "N": ((1e4, "kN"),),
    "m": ((1e3, "km"),),
    "s": ((1.0, "s"), (1e-3, "ms"), (0.0, "µs")),
}
_CAUSES = {
    "viscous": "viscous friction",
    "shaft": "shaft damping",
    "journal": "journals",
    "freewheel": "freewheels",
}
_FORCES = {
    "satellite_force": "satellite bearing",
    "shaking_force": "shaking force",
    "shaking_moment": "shaking moment",
}
# columns of the table of freewheels: heading, metric
_PEAK_COLUMNS = {"peak torque": "torque_peak", "overrunning speed": "slip_peak"}
_LIMITED = ("engagement_frequency_maximum", "torque_peak", "slip_peak")


class Summary(NamedTuple):
    """Lines of a summary, each within its width.

    Attributes:
        title: Title of the scene, duration and fidelity.
        warnings: Warnings, each marked by "!"; a long one continues on indented lines.
        body: Groups of metrics.
    """

    title: list[str]
    warnings: list[str]
    body: list[str]


class Scale(NamedTuple):
    """Conversion of values that are printed in one unit.

    Attributes:
        factor: Factor from the unit of the values to the printed unit.
        unit: Printed unit.
    """

    factor: float
    unit: str

    def number(self, value: float) -> str:
        """Return a value as text without its unit.

        Args:
            value: The value.
        """
        return three_digits(value * self.factor)

    def text(self, value: float) -> str:
        """Return a value as text with its unit.

        Args:
            value: The value.
        """
        return f"{self.number(value)} {self.unit}"


def three_digits(value: float) -> str:
    """Return a number with three significant digits, such as "0.180", "18.0", "3130" or "1.36e-10".

    Args:
        value: The number.
    """
    rounded = float(f"{value:.2e}")
    if rounded == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(rounded)))
    return f"{rounded:.{max(2 - exponent, 0)}f}" if -4 < exponent < 6 else f"{rounded:.2e}"


def two_digits(value: float) -> str:
    """Return a number with at most two significant digits, such as "3.2", "24" or "310".

    Args:
        value: The number.
    """
    return f"{float(f'{value:.1e}'):g}"


def wrapped(label: str, items: Sequence[str], width: int = WIDTH) -> list[str]:
    """Return a label and its items as lines; no line without items.

    Args:
        label: Label of the group.
        items: Items; a line break separates two items or, in a longer item, two words.
        width: Maximum width of a line, characters.
    """
    lines: list[str] = []
    for item in items:
        if lines and len(lines[-1]) + len(_GAP) + len(item) <= width:
            lines[-1] += _GAP + item
        else:
            first, others = " " * _LABEL, " " * (_LABEL + 2)
            lines += textwrap.wrap(item, width, initial_indent=first, subsequent_indent=others)
    return [f"  {label}".ljust(_LABEL) + lines[0][_LABEL:], *lines[1:]] if lines else []


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table as lines: the first column left-aligned, the others right-aligned.

    Args:
        rows: Cells of each row; the first row has the headings.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    widths[0] = max(widths[0], _LABEL - len(_GAP))
    return [
        _GAP.join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows
    ]


def _input_text(speed: NDArray[np.float64], scale: Scale, rest: float) -> str:
    """Return the speed of the input shaft, or its range if it varies."""
    low, high = float(speed.min()), float(speed.max())
    if max(-low, high) <= rest:
        return "input at rest"
    is_constant = high - low <= _RANGE_FACTOR * max(-low, high)
    return f"input {scale.text(high)}" if is_constant else f"input {scale.number(low)} to {scale.text(high)}"


def _output_text(speed: NDArray[np.float64], scale: Scale, rest: float) -> str:
    """Return the speed of the output shaft at the end, and its maximum or range if it differs."""
    low, high, end = float(speed.min()), float(speed.max()), float(speed[-1])
    if max(-low, high) <= rest:
        return "output at rest"
    turns_backward = low < -max(rest, _BACKWARD_FACTOR * high)
    extremes = (
        f"{scale.number(low)} to {scale.number(high)}" if turns_backward else f"max {scale.number(high)}"
    )
    if abs(end) <= rest:
        return f"output {extremes} {scale.unit}, at rest at the end"
    text = f"output at the end {scale.text(end)}"
    return text if extremes == f"max {scale.number(end)}" else f"{text} ({extremes})"


class SummaryWriter:
    """Writer of a summary.

    Args:
        result: Result of the run.
        units: Display units, by unit of a metric.
        width: Maximum width of a line, characters.
    """

    def __init__(self, result: SceneResult, units: Mapping[str, str], width: int) -> None:
        self.result, self.units, self.width = result, units, width
        self.metrics = {name: quantity.value for name, quantity in result.quantities.items()}
        self.stored = float(np.abs(result.record["energy_stored"]).max())

    def scale(self, unit: str, *values: float) -> Scale:
        """Return the printed unit of values.

        Args:
            unit: Unit of the values.
            values: The values, which select the multiple of the unit.
        """
        display, largest = self.units.get(unit, unit), max(map(abs, values))
        multiples = _MULTIPLES.get(display, ())
        display = next((multiple for minimum, multiple in multiples if largest >= minimum), display)
        return Scale(factor_between(unit, display), printed_unit(display))

    def text(self, name: str) -> str:
        """Return a metric as text with its unit.

        Args:
            name: Name of the metric.
        """
        value, unit = self.result.quantities[name]
        return self.scale(unit, value).text(value)

    def pair(self, label: str, first: str, kind: str, second: str) -> list[str]:
        """Return an item with two metrics, the second one in brackets; none if both are 0.

        Args:
            label: Label of the item.
            first: Name of the first metric.
            kind: Word before the second metric, such as "max".
            second: Name of the second metric, which has the same unit.
        """
        values = self.metrics[first], self.metrics[second]
        scale = self.scale(self.result.quantities[first].unit, *values)
        text = f"{label} {scale.text(values[0])} ({kind} {scale.number(values[1])})"
        return [text] if any(values) else []

    def title(self) -> list[str]:
        """Return the title of the scene, with the duration and the fidelity at the right end."""
        fidelity = self.result.scene.parameters().get("fidelity", RIGID)
        names = [name for name, number, _ in ENUMERATIONS["Fidelity"] if number == fidelity]
        kind = names[0] if self.is_module else "driven shaft"
        settings = f"{self.metrics['simulated_time']:.6g} s, {kind}"
        lines = textwrap.wrap(self.result.scene.title, self.width) or [""]
        if len(lines[-1]) + len(_GAP) + len(settings) > self.width:
            lines.append("")
        lines[-1] += settings.rjust(self.width - len(lines[-1]))
        return lines

    @property
    def is_module(self) -> bool:
        """Return True for a scene of the module, False for a driven shaft."""
        return "omega_out_final" in self.metrics

    def warnings(self) -> list[str]:
        """Return the warnings and the notes on doubtful results."""
        remarks = self.result.remarks.items()
        notes = [
            f"{heading(name)} {text}"
            for name, text in remarks
            if name != DUTY_NOTE and not name.startswith(TIME_TO)
        ]
        return [
            line
            for text in (*notes, *self.result.warnings)
            for line in textwrap.wrap(
                self.in_display_units(text), self.width, initial_indent="  ! ", subsequent_indent="    "
            )
        ]

    def in_display_units(self, text: str) -> str:
        """Return a text whose speeds and torques are in the display units, with four digits.

        Args:
            text: The text.
        """

        def converted(match: re.Match[str]) -> str:
            scale = self.scale(match[2], 0.0)
            return f"{float(match[1]) * scale.factor:.4g} {scale.unit}"

        text = text.replace("N.m/", "N·m/")
        return re.sub(r"(-?\d[\d.]*(?:e[-+]?\d+)?) (rad/s|N\.m|km/h)(?![\w./])", converted, text)

    def body(self) -> list[str]:
        """Return the lines of all groups."""
        groups: dict[str, Sequence[str]] = {"Peaks": self.shaft_peaks(), "Energy": self.energies()}
        if self.is_module:
            groups = {
                "Speed": self.speeds(),
                "Torque": self.torques(),
                "Energy": self.energies(),
                "Losses": self.losses(),
                "Forces": self.forces(),
                "Impacts": self.impacts(),
                "Vehicle": self.vehicle(),
                "Road load": self.road_load(),
                "Control": self.control(),
            }
        groups["Solved"] = self.solution()
        lines = {label: wrapped(label, items, self.width) for label, items in groups.items()}
        lines["Forces"] = [*lines.get("Forces", []), *self.freewheels()]
        return [line for group in lines.values() for line in group]

    def speeds(self) -> list[str]:
        """Return the speeds of both shafts and their ratio at the end."""
        speed, omega_out = input_speed(self.result.record), self.result.record["omega_out"]
        largest = float(np.abs([speed, omega_out]).max())
        rest, scale = _REST_FACTOR * largest, self.scale("rad/s", largest)
        end, end_out = float(speed[-1]), float(omega_out[-1])
        items = [_input_text(speed, scale, rest), _output_text(omega_out, scale, rest)]
        return items + (
            [f"ratio {three_digits(end_out / end)}"] if min(abs(end), abs(end_out)) > rest else []
        )

    def torques(self) -> list[str]:
        """Return the mean torques of both shafts and the maximum of the output torque."""
        smallest = 0.0 if self.energies() else _TORQUE_ROUNDING * self.stored
        if abs(self.metrics["output_torque_mean_maximum"]) < smallest:
            return []
        peak, kind = "output_torque_peak", "peak"
        if peak not in self.metrics:
            peak, kind = "output_torque_mean_maximum", "max"
        items = self.pair("output mean", "output_torque_mean", kind, peak)
        if self.metrics["input_torque_mean"]:
            items.append(f"input mean {self.text('input_torque_mean')}")
        return items

    def shaft_peaks(self) -> list[str]:
        """Return the maximum magnitudes of a driven shaft."""
        labels = {
            "omega_out_peak": "output speed",
            "driven_acceleration_peak": "acceleration",
            "shaft_torque_peak": "shaft torque",
            "twist_peak": "twist",
        }
        return [f"{label} {self.text(name)}" for name, label in labels.items() if self.metrics.get(name)]

    def energies(self) -> list[str]:
        """Return the energy balance, supply = use, and the efficiency."""
        flows = {
            "input": self.metrics["energy_in"],
            "output": -self.metrics["energy_out"],
            "stored": -self.metrics["energy_stored_gain"],
            "losses": -self.metrics["energy_lost"],
        }
        supply = sum(max(flow, 0.0) for flow in flows.values())
        scale = self.scale("J", supply)
        smallest = max(_NEGLIGIBLE_FACTOR * supply, _ENERGY_ROUNDING * self.stored)
        flows = {name: flow for name, flow in flows.items() if abs(flow) > smallest}
        if not flows:
            return []
        sources = [name for name, flow in flows.items() if flow > 0.0]
        texts = {name: f"{name} {scale.number(abs(flow))}" for name, flow in flows.items()}
        texts[sources[0]] += f" {scale.unit}"
        left = " + ".join(texts[name] for name in sources)
        right = " + ".join(text for name, text in texts.items() if name not in sources)
        items = [f"{left} = {right}"]
        if "efficiency" in self.metrics and "output" in flows:
            items.append(f"efficiency {three_digits(100.0 * self.metrics['efficiency'])} %")
        return items

    def losses(self) -> list[str]:
        """Return the losses by cause, the largest first, with their fractions of all losses."""
        values = {name: self.metrics.get(name, 0.0) for name in LOSSES}
        total = sum(map(abs, values.values()))
        scale = self.scale("J", total)
        names = sorted(values, key=lambda name: -abs(values[name]))
        parts = [name for name in names if abs(values[name]) > _NEGLIGIBLE_FACTOR * total]
        items = []
        for name in parts:
            cause = name.removeprefix(LOST_TO)
            fraction = f" ({100.0 * values[name] / total:.2g} %)" if len(parts) > 1 else ""
            items.append(f"{_CAUSES.get(cause, cause)} {scale.text(values[name])}{fraction}")
        return items

    def forces(self) -> list[str]:
        """Return peak and RMS of the forces on the satellite bearing and on the mounting."""
        return [
            item
            for name, label in _FORCES.items()
            if f"{name}_rms" in self.metrics
            for item in self.pair(f"{label} peak", f"{name}_peak", "RMS", f"{name}_rms")
        ]

    def freewheels(self) -> list[str]:
        """Return the table of the freewheels: engagements, torque, overrunning speed and limits."""
        if DUTY_NOTE in self.result.remarks:
            reason = self.result.remarks[DUTY_NOTE].removeprefix("is ")
            return wrapped("Freewheels", [reason], self.width)
        names = [name for name in FREEWHEELS if f"{name}_torque_peak" in self.metrics]
        limits = self.result.limits
        has_limits = any(f"{name}_{metric}" in limits for name in names for metric in _LIMITED)
        head = ["  Freewheels", "engagements/s", *_PEAK_COLUMNS, *(["limits"] if has_limits else [])]
        rows = [head]
        for name in names:
            frequency = f"{name}_engagement_frequency"
            scale = self.scale("Hz", 1.0)
            mean, highest = (self.metrics[f"{frequency}_{kind}"] for kind in ("mean", "maximum"))
            cells = [f"{scale.number(highest)} (mean {scale.number(mean)})" if highest else "-"]
            for metric in _PEAK_COLUMNS.values():
                has_value = self.metrics[f"{name}_{metric}"] > 0.0
                cells.append(self.text(f"{name}_{metric}") if has_value else "-")
            is_exceeded = any(
                self.metrics[f"{name}_{metric}"] > limits.get(f"{name}_{metric}", math.inf)
                for metric in _LIMITED
            )
            cells += ["exceeded" if is_exceeded else "ok"] if has_limits else []
            rows.append([f"    {name}", *cells])
        return aligned(rows) if names else []

    def impacts(self) -> list[str]:
        """Return the maximum energy and the estimated torque of impacts by freewheel."""
        items = []
        for name in FREEWHEELS:
            if self.metrics.get(f"{name}_impact_energy"):
                torque = f"{name}_impact_torque"
                estimate = f" (about {self.text(torque)})" if torque in self.metrics else ""
                items.append(f"{name} {self.text(f'{name}_impact_energy')}{estimate}")
        return items

    def vehicle(self) -> list[str]:
        """Return acceleration times, maximum speed, distance and tractive force of a vehicle."""
        if "distance" not in self.metrics:
            return []
        metrics, remarks = self.metrics, self.result.remarks
        names = [name for name in {**metrics, **remarks} if name.startswith(TIME_TO)]
        scale, items = self.scale("km/h", 1.0), []
        for name in names:
            speed = float(name.removeprefix(TIME_TO).removesuffix("_kmh")) * scale.factor
            is_reached = name in metrics
            outcome = (
                f"in {three_digits(metrics[name])} s" if is_reached else remarks[name].partition(" (")[0]
            )
            items.append(f"{speed:.6g} {scale.unit} {outcome}")
        if metrics["vehicle_speed_maximum"]:
            items += [f"max {self.text('vehicle_speed_maximum')}", self.text("distance")]
        if TRACTIVE_FORCE in self.metrics:
            grip = self.result.limits[TRACTIVE_FORCE]
            scale = self.scale("N", self.metrics[TRACTIVE_FORCE], grip)
            force = scale.text(self.metrics[TRACTIVE_FORCE])
            items.append(f"tractive force {force} (grip {scale.number(grip)})")
        return items

    def road_load(self) -> list[str]:
        """Return the energies to the resistances and the brake of a vehicle."""
        labels = {"rolling": "rolling", "drag": "air drag", "slope": "slope", "brake": "brake"}
        values = {label: self.metrics.get(f"energy_{part}", 0.0) for part, label in labels.items()}
        scale = self.scale("J", *values.values())
        return [f"{label} {scale.text(value)}" for label, value in values.items() if value]

    def control(self) -> list[str]:
        """Return the speed error of a controlled scene and the time out of the tolerance of a cycle."""
        if "tracking_error_rms" not in self.metrics:
            return []
        items = self.pair("speed error max", "tracking_error_maximum", "RMS", "tracking_error_rms")
        if "share_out_of_tolerance" in self.metrics:
            share, seconds = self.metrics["share_out_of_tolerance"], self.text("time_out_of_tolerance")
            items.append(
                f"out of tolerance for {seconds} ({share:.2g} %)"
                if share > 0.0
                else "always within tolerance"
            )
        return items

    def solution(self) -> list[str]:
        """Return computing time and relative energy error."""
        seconds, factor = self.metrics["wall_time"], self.metrics["real_time_factor"]
        scale = self.scale("s", seconds)
        duration = f"{two_digits(seconds * scale.factor)} {scale.unit}"
        items = [f"in {duration}, {two_digits(factor)} times real time"]
        error = self.metrics["energy_residual_relative"]
        return items + ([f"energy error {error:.0e}"] if error and self.energies() else [])


def summary(result: SceneResult, units: Mapping[str, str] = DISPLAY_UNITS, width: int = WIDTH) -> Summary:
    """Return the summary of a run as text.

    Args:
        result: Result of the run.
        units: Display units, by unit of a metric.
        width: Maximum width of a line, characters.
    """
    writer = SummaryWriter(result, units, width)
    return Summary(writer.title(), writer.warnings(), writer.body())
