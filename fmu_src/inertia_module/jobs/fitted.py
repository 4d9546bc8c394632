"""Result of a fit: values with intervals, correlations, noise, what is doubtful, and the fitted scene."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..harness.results import Result, write_text
from ..scene import Scene
from ..scene.reading import scene_text
from .free import Free
from .measurement import Measurement

# correlations from here on are warned of
CORRELATED = 0.95
# so near to an end of its range, of the range, a value is at it
AT_END = 1e-4
# residuals whose autocorrelation at lag 1 is as much as this are not the noise of a sensor
FOLLOWING = 0.2
# standard deviations of chance that a warning keeps from
CHANCE = 4.0
NO_INFLUENCE = "has no influence on what was measured, stays where it was"
NOT_IDENTIFIABLE = "not identifiable from the data: the interval is {}"


@dataclass(frozen=True)
class Fitted:
    """A free key.

    Attributes:
        name: by dots. value, error: the value and its standard error, SI. interval: of 95 %; what is not
            known of error and interval is infinite. unit: "" for none. doubt: what is wrong with it, or "".
    """

    name: str
    value: float
    error: float
    interval: tuple[float, float]
    unit: str
    doubt: str = ""

    @property
    def text(self) -> str:
        """Value, interval and what is wrong with it, in a line."""
        low, high = self.interval
        if not math.isfinite(high - low):
            return f"{self.value:.6g} {self.unit}, {self.doubt}"
        doubt = f", {self.doubt}" if self.doubt else ""
        return f"{self.value:.6g} {self.unit}, from {low:.6g} to {high:.6g}{doubt}"


@dataclass(frozen=True)
class FitResult:
    """Result of a fit.

    Attributes:
        scene: with the values found. parameters: the free keys. correlations: by pairs of them.
        measurement: what was fitted. computed: by the fitted scene, at the same times.
        noise: standard deviation by column, RMS. estimated: columns whose noise was found from the residuals.
        chi_squared: of the residuals over noise, over degrees of freedom. same_end: how many searches ended
            at the best, of how many. runs: of the scene. warnings: sentences. files: written, by kind.
    """

    scene: Scene
    parameters: list[Fitted]
    correlations: dict[tuple[str, str], float]
    measurement: Measurement
    computed: Result
    noise: dict[str, float]
    estimated: list[str]
    chi_squared: float
    same_end: tuple[int, int]
    runs: int
    warnings: list[str] = field(default_factory=list)
    files: dict[str, Path] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Fitted:
        """A free key, by dots or, of the mechanism, by its bare name."""
        return next(one for one in self.parameters if name in (one.name, one.name.rpartition(".")[2]))

    def as_dict(self) -> dict[str, Any]:
        """For machines; what is not known is null."""
        return {
            "parameters": {
                one.name: {
                    "value": one.value,
                    "unit": one.unit,
                    "standard_error": one.error if math.isfinite(one.error) else None,
                    "interval": [end if math.isfinite(end) else None for end in one.interval],
                    "doubt": one.doubt,
                }
                for one in self.parameters
            },
            "correlations": [[*pair, number] for pair, number in self.correlations.items()],
            "noise": {
                name: {
                    "value": value,
                    "unit": self.measurement.table.units[name],
                    "estimated": name in self.estimated,
                }
                for name, value in self.noise.items()
            },
            "chi_squared": self.chi_squared,
            "values": int(self.measurement.counted.sum()),
            "searches_that_agree": list(self.same_end),
            "runs": self.runs,
            "warnings": self.warnings,
        }

    def lines(self) -> dict[str, str]:
        """Give the lines of the printed table, by heading."""
        correlated = {
            f"correlation of {a} and {b}": f"{number:.3f}" for (a, b), number in self.correlations.items()
        }
        units = self.measurement.table.units
        source = {name: ", from the residuals" if name in self.estimated else "" for name in units}
        noise = {
            f"noise of {name}": f"{value:.4g} {units[name]}{source[name]}"
            for name, value in self.noise.items()
        }
        values = {one.name: one.text for one in self.parameters}
        agree = "{} of {}".format(*self.same_end)
        return {**values, **correlated, **noise, "searches that end there": agree, "runs": str(self.runs)}

    def table(self) -> Result:
        """Measured, computed and residual (computed less measured) of each column over time."""
        columns, units, measured = {"time": self.computed.time}, {"time": "s"}, self.measurement.table
        for name in self.measurement.columns:
            values = measured[name], self.computed[name], self.computed[name] - measured[name]
            for kind, found in zip(("measured", "computed", "residual"), values, strict=True):
                columns[f"{name}_{kind}"], units[f"{name}_{kind}"] = found, measured.units[name]
        return Result(columns, units)

    def write(self, folder: Path) -> dict[str, Path]:
        """Write fitted.toml, residuals.csv and fit.json, each whole or not at all."""
        return {
            "scene": write_text(folder / "fitted.toml", scene_text(self.scene)),
            "residuals": self.table().to_csv(folder / "residuals.csv"),
            "fit": write_text(folder / "fit.json", json.dumps(self.as_dict(), indent=2) + "\n"),
        }


def fitted(keys: Sequence[Free], best: Any, intervals: Mapping[str, tuple[float, float]]) -> list[Fitted]:
    """The free keys as they were found.

    Args:
        best: MinimizerResult of lmfit. intervals: of each variable that has an influence, by identifier.
    """
    found = []
    for key in keys:
        one = best.params[key.identifier]
        value, error, interval = key.value(one.value), math.inf, (-math.inf, math.inf)
        doubt = NO_INFLUENCE
        if key.identifier in intervals:
            low, high = sorted(map(key.value, intervals[key.identifier]))
            interval = low, high
            error = math.inf if one.stderr is None else abs(key.span) * float(one.stderr)
            doubt = _doubt(key, one.value, high - low)
        found.append(Fitted(key.name, value, error, interval, key.unit, doubt))
    return found


def _doubt(key: Free, variable: float, width: float) -> str:
    """Say what is wrong with a value; width: of its interval, SI."""
    if key.range is None:
        wide = width > 2.0 * abs(key.value(variable))
        return NOT_IDENTIFIABLE.format("wider than twice the value") if wide else ""
    if width >= (1.0 - AT_END) * abs(key.span):
        return NOT_IDENTIFIABLE.format("as wide as its range")
    return "is at the end of its range" if min(variable - 1.0, 2.0 - variable) < AT_END else ""


def correlations(keys: Sequence[Free], best: Any) -> dict[tuple[str, str], float]:
    """Of each pair of free keys whose errors are known."""
    found = {}
    for n, first in enumerate(keys):
        known = best.params[first.identifier].correl or {}
        for second in keys[n + 1 :]:
            if second.identifier in known:
                # a key that falls as its variable rises
                sign = math.copysign(1.0, first.span * second.span)
                found[first.name, second.name] = sign * float(known[second.identifier])
    return found


def doubts(result: FitResult, ended: bool) -> list[str]:
    """Warn of what the user has to know, in sentences.

    Args:
        ended: whether the last search came to an end.
    """
    found = [f"{one.name}: {one.doubt}" for one in result.parameters if one.doubt]
    for (first, second), number in result.correlations.items():
        if abs(number) > CORRELATED:
            found.append(
                f"{first} and {second} are correlated by {number:.3f}: the data tell both together, not each"
            )
    if not ended:
        found.append("the search was broken off: too many runs")
    same, all_searches = result.same_end
    if all_searches > 1 and same == 1:
        found.append(
            f"only 1 of {all_searches} searches ended at the best: more starts may find a better one"
        )
    number = result.measurement.counted.sum()
    if not result.estimated and result.chi_squared > 1.0 + CHANCE * math.sqrt(2.0 / number):
        found.append(
            f"chi-squared is {result.chi_squared:.3g}: the residuals are larger than the noise,"
            " the scene lacks something"
        )
    table = result.table()
    for name in result.measurement.columns:
        following = _following(table[f"{name}_residual"])
        if following > max(FOLLOWING, CHANCE / math.sqrt(len(table))):
            found.append(
                f"residuals of {name} are autocorrelated (lag-1 {following:.2f}): the model has a systematic"
                " error, and the intervals are too narrow"
            )
    return found


def _following(residual: Any) -> float:
    """Correlation of each residual with the next; 0 where there is nothing to tell."""
    if residual.size < 3 or not np.ptp(residual):
        return 0.0
    centred = residual - residual.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2))
