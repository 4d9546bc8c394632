"""Result of a fit: numbers, the texts of all warnings and notes, and files."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic_core import to_jsonable_python

from ..common.equality import ByContent
from ..common.errors import listed
from ..common.files import write_text
from ..common.units import printed_unit
from ..fmi.simulate import Result
from ..scene import Scene
from ..scene.reading import scene_text
from .axes import Free
from .candidates import SIGNIFICANCE, Candidate, causes
from .measurement import N_DEVIATIONS, Measurement, autocorrelation
from .profile_likelihood import END_RTOL

# correlation from which there is a warning
MAX_CORRELATION = 0.95
# number of candidates that are printed
N_CANDIDATES = 8

NO_INFLUENCE = "has no influence on the measured columns and keeps its start value"
SYSTEMATIC = "the residuals are systematic: no interval is reliable until their cause is known"

Interval = tuple[float, float]


@dataclass(frozen=True)
class Fitted:
    """A fitted key.

    Attributes:
        name: dotted name.
        value: estimate, SI.
        unit: of the value, "" for none.
        error: standard error in the linear model, SI; infinite without influence.
        interval: 95 % interval by profile likelihood, with the plausible candidates released one at a time,
            SI.
        interval_if_exact: 95 % interval by profile likelihood if everything else is exact, SI.
        released: names of the candidates whose release sets the ends of the interval.
        is_excluded: True if a candidate explains the residuals, so that the value does not apply.
        doubt: caveat of the estimate, or "".
    """

    name: str
    value: float
    unit: str
    error: float = math.inf
    interval: Interval = (-math.inf, math.inf)
    interval_if_exact: Interval = (-math.inf, math.inf)
    released: tuple[str, ...] = ()
    is_excluded: bool = False
    doubt: str = ""

    @property
    def text(self) -> str:
        """Line with the value, the interval, the released candidates and the caveat."""
        unit, (low, high) = printed_unit(self.unit), self.interval
        text = f"{self.value:.6g} {unit}".rstrip()
        released = f" with {' or '.join(self.released)} released" if self.released else ""
        if self.is_excluded:
            text = f"{f'from {low:.6g} to {high:.6g} {unit}'.rstrip()}{released}"
        elif math.isfinite(high - low):
            text = f"{text}, from {low:.6g} to {high:.6g}{released}"
        return f"{text}; {self.doubt}" if self.doubt else text


def is_at_end(key: Free, value: float) -> bool:
    """Return True if a value is at an end of the range of its key.

    Args:
        key: the key.
        value: the value, SI.
    """
    return key.has_range and min(value - key.low, key.high - value) < END_RTOL * key.size


def doubt(key: Free, value: float, is_open: Sequence[bool]) -> str:
    """Return the caveat of a key that is not identifiable or at the end of its range, or "".

    Args:
        key: key with its range.
        value: estimate, SI.
        is_open: True for the lower, and for the upper end, if the profile reaches no limit there.
    """
    if not any(is_open):
        return ""
    if all(is_open):
        return "not identifiable from the data: the profile likelihood has no limit within the ranges"
    if is_at_end(key, value):
        return "is at the end of its range"
    side = "lower" if is_open[0] else "upper"
    return f"not identifiable from the data: they set no {side} limit within the ranges"


def unit_remark(name: str, gain: float, unit: str) -> str:
    """Return a warning about a column that is probably in another unit.

    Args:
        name: name of the column.
        gain: measured values over the values that the unfitted scene computes.
        unit: probable cause, a clause.
    """
    return f"{name} is {gain:.3g} times the value that the unfitted scene computes; possible cause: {unit}"


def combination_remark(names: Sequence[str], singular: float) -> str:
    """Return a warning about keys of which only a combination is identifiable.

    Args:
        names: names of the keys with a component in the weakest direction.
        singular: singular value of this direction.
    """
    return (
        f"only a combination of {', '.join(names)} is identifiable: along the weakest direction of the scaled"
        f" Jacobian (singular value {singular:.2g}) the profiles reach no limit"
    )


def scale_remark(free: Sequence[str], scale: Sequence[str]) -> str:
    """Return a warning if only one fixed parameter, or none, sets the scale of the free ones, else "".

    Args:
        free: names of the free keys that scale with mass.
        scale: names of the fixed parameters that scale with mass.
    """
    ratios = f"only ratios of {', '.join(free)} are identifiable:"
    if not scale:
        return f"{ratios} a common factor changes nothing, because no mass, inertia or torque is fixed"
    alone = f"{ratios} the result scales with {scale[0]}, which is taken as exact"
    return alone if len(scale) == 1 else ""


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(ByContent):
    """Result of a fit.

    Attributes:
        scene: scene with the fitted values.
        parameters: the fitted keys.
        correlations: correlations by pairs of names.
        measurement: the measurement.
        computed: columns of the fitted scene at the measured times, SI.
        noise: standard deviation of each column, SI, RMS.
        estimated: columns whose noise is estimated from the residuals.
        chi_squared: reduced chi-squared.
        candidates: fixed parameters and sensor errors, released one at a time; the most significant first.
        inseparable: names of candidates that the data cannot separate from the fitted keys, so they are taken
            as exact.
        scale: names of the fixed parameters that set the scale of all masses and torques.
        remarks: warnings about units, ranges, scale and combinations.
        searches: number of searches that converged to the optimum, and number of all searches.
        runs: number of runs of the scene.
        converged: True if the last search converged.
        files: written files, by kind.
    """

    scene: Scene
    parameters: list[Fitted]
    correlations: dict[tuple[str, str], float]
    measurement: Measurement
    computed: Result
    noise: dict[str, float]
    estimated: list[str]
    chi_squared: float
    candidates: list[Candidate]
    inseparable: list[str]
    scale: list[str]
    remarks: list[str]
    searches: tuple[int, int]
    runs: int
    converged: bool
    files: dict[str, Path] = field(default_factory=dict)

    def __repr__(self) -> str:
        values = (f"{fitted.name} = {fitted.value:.5g} {fitted.unit}".rstrip() for fitted in self.parameters)
        return f"FitResult({listed(values)})"

    def __getitem__(self, name: str) -> Fitted:
        """Return a fitted key by its dotted name, or by the part of the name after the last dot."""
        return next(
            fitted for fitted in self.parameters if name in (fitted.name, fitted.name.rpartition(".")[2])
        )

    @property
    def causes(self) -> list[Candidate]:
        """Best candidate and those that the data do not exclude; none if the best is not significant."""
        return causes(self.candidates)

    @property
    def warnings(self) -> list[str]:
        """Warnings, a sentence each."""
        data = self.measurement
        doubtful = {fitted.name: fitted.doubt for fitted in self.parameters if fitted.doubt}
        lines = [*self.remarks, *(f"{name}: {text}" for name, text in doubtful.items())]
        if data.unused:
            lines.append(f"columns that the scene does not compute are not compared: {listed(data.unused)}")
        lines += [
            f"{first} and {second} have a correlation of {number:.3f}: the data determine only a combination"
            " of them"
            for (first, second), number in self.correlations.items()
            if abs(number) > MAX_CORRELATION and not {first, second} <= set(doubtful)
        ]
        if not self.converged:
            lines.append("the search did not converge within the maximum number of iterations")
        if self.searches[0] == 1 < self.searches[1]:
            lines.append(
                f"only 1 of {self.searches[1]} searches converged to this optimum: more starts may find a"
                " better optimum"
            )
        if not self.estimated and self.chi_squared > 1.0 + N_DEVIATIONS * math.sqrt(2.0 / data.number):
            lines.append(
                f"reduced chi-squared is {self.chi_squared:.3g}: the residuals are larger than the specified"
                " noise, so the scene does not explain the data"
            )
        for name in data.columns:
            number = autocorrelation(self.table()[f"{name}_residual"])
            if number > data.max_autocorrelation:
                lines.append(
                    f"residuals of {name} are autocorrelated (lag-1 {number:.2f}): the model has a"
                    " systematic error"
                )
        return [*lines, *self._cause()]

    def _cause(self) -> list[str]:
        """Return the warning about the plausible causes, or nothing."""
        if not self.causes:
            return []
        first = self.causes[0]
        before, after = first.chi_squared
        values = ", ".join(
            f"{name} would be {value:.5g} instead of {self[name].value:.5g}"
            for name, value in first.values.items()
        )
        p_value = f"p = {first.p_value:.1g}" if first.p_value > 1e-15 else "p < 1e-15"
        names = " or ".join(cause.cause for cause in self.causes)
        rest = " in part; autocorrelated residuals remain" if first.is_systematic else ""
        return [
            f"{names} would explain the residuals{rest} (chi-squared {before:,.0f} → {after:,.0f},"
            f" {p_value}): {values}; correct the cause or fit again with --free {first.option}"
        ]

    def candidate_lines(self) -> dict[str, str]:
        """Return a line for each candidate that is significant or sets an end of an interval, by name."""
        ends = {name for fitted in self.parameters for name in fitted.released}
        printed = [
            candidate
            for candidate in self.candidates
            if candidate.name in ends or candidate.p_value < SIGNIFICANCE
        ]
        lines = {candidate.name: candidate.text for candidate in printed[:N_CANDIDATES]}
        if self.inseparable:
            lines["not separately identifiable"] = f"{', '.join(self.inseparable)}, taken as exact"
        if len(self.scale) > 1:
            lines["scale of masses and torques"] = f"{', '.join(self.scale)}, taken as exact"
        return lines

    def as_dict(self) -> dict[str, object]:
        """Return the result for JSON; None stands for unknown numbers."""
        units = self.measurement.table.units
        content: dict[str, Any] = to_jsonable_python(
            {
                "parameters": {fitted.name: fitted for fitted in self.parameters},
                "correlations": [[*pair, number] for pair, number in self.correlations.items()],
                "noise": {
                    name: {"value": value, "unit": units[name], "estimated": name in self.estimated}
                    for name, value in self.noise.items()
                },
                "chi_squared": self.chi_squared,
                "candidates": [
                    {
                        field.name: getattr(candidate, field.name)
                        for field in dataclasses.fields(candidate)[:-1]
                    }
                    for candidate in self.candidates
                ],
                "causes": [cause.name for cause in self.causes],
                "inseparable": self.inseparable,
                "scale": self.scale,
                "values": self.measurement.number,
                "searches_that_agree": self.searches,
                "runs": self.runs,
                "warnings": self.warnings,
            },
            inf_nan_mode="null",
        )
        return content

    def lines(self) -> dict[str, str]:
        """Return the texts of the printed table, by heading."""
        lines = {}
        for fitted in self.parameters:
            lines[fitted.name], (low, high) = fitted.text, fitted.interval_if_exact
            if math.isfinite(high - low):
                excluded = f" around {fitted.value:.6g}; excluded by the data" if fitted.is_excluded else ""
                lines[f"{fitted.name}, if everything else is exact"] = (
                    f"from {low:.6g} to {high:.6g}{excluded}"
                )
        for (first, second), number in self.correlations.items():
            lines[f"correlation of {first} and {second}"] = f"{number:.3f}"
        for name, value in self.noise.items():
            source = ", estimated from the residuals" if name in self.estimated else ""
            lines[f"noise of {name}"] = (
                f"{value:.4g} {printed_unit(self.measurement.table.units[name])}{source}"
            )
        freedom = self.measurement.number - len(self.parameters)
        untested = "; no test of the model, because the noise is estimated" if self.estimated else ""
        lines["chi-squared"] = f"{self.chi_squared * freedom:.4g} for {freedom} degrees of freedom{untested}"
        lines["searches converged to this optimum"] = "{} of {}".format(*self.searches)
        return {**lines, "runs": str(self.runs)}

    def table(self) -> Result:
        """Return measured, computed and residual (computed - measured) of each column over time, SI."""
        columns, units, measured = {"time": self.computed.time}, {"time": "s"}, self.measurement.table
        for name in self.measurement.columns:
            values = measured[name], self.computed[name], self.computed[name] - measured[name]
            for kind, column in zip(("measured", "computed", "residual"), values, strict=True):
                columns[f"{name}_{kind}"], units[f"{name}_{kind}"] = column, measured.units[name]
        return Result(columns, units)

    def write(self, folder: Path) -> dict[str, Path]:
        """Write fitted.toml, residuals.csv and fit.json, each atomically; return their paths by kind.

        Args:
            folder: output folder (created if missing).
        """
        return {
            "scene": write_text(folder / "fitted.toml", scene_text(self.scene)),
            "residuals": self.table().to_csv(folder / "residuals.csv"),
            "fit": write_text(folder / "fit.json", json.dumps(self.as_dict(), indent=2) + "\n"),
        }
