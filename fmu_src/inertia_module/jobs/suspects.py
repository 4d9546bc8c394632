"""Suspects of a fit: what is not free in it and would, if it were, explain what the fit leaves.

Each is freed by one more column of the Jacobian, which takes some runs: how far the residuals sink, with the
noise of each column found anew, and where the answers go is then linear algebra. What counts is the ratio of
the likelihoods with and without, less as far as the residuals that are left follow one another: rows that do
say less.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.units import factor_between
from ..contract.variables import PARAMETER, REAL, VARIABLES, Group
from ..harness.simulate import Result
from ..scene import Scene
from ..scene.keys import MECHANISM, unit_of
from .axes import Beside, Free

Array = NDArray[np.float64]

# what a sensor may have: measured is gain times computed, which is shift earlier, and offset
OFFSET, GAIN, SHIFT = "offset", "gain", "shift"
# of the clock, which all columns share
CLOCK = f"{SHIFT}.time"
# of the time measured
MOST_LATE = 0.1
# parameters that are suspects
GROUPS = (Group.LOSSES, Group.MASSES)
# first change of one that the scene has at 0
FIRST = 1e-4
# share of the fits without fault in which one is named all the same
FALSE_ALARM = 0.01
# of the ratio of likelihoods, as chi-squared: what explains as much but for this is not told apart
AS_GOOD = 6.0
# passes that find the noise that is left
PASSES = 20
# so near, of the factor, a gain is that of another unit
NEAR_UNIT = 0.02
# that columns come in
UNITS = ("rpm", "deg/s", "rev/s", "km/h", "deg", "rev", "mm", "kN", "kNm", "kJ", "kW")


def sensor_keys(table: Result) -> dict[str, Beside]:
    """Keys of what the sensors of a measurement may have, by name; see OFFSET and CLOCK."""
    row = float(np.median(np.diff(table.time))) if len(table) > 1 else 1e-3
    late = Beside("s", 0.0, row, max(MOST_LATE * float(np.ptp(table.time)), row))
    found = {CLOCK: late}
    for name in table.names[1:]:
        size = float(np.std(table[name])) or 1.0
        found[f"{OFFSET}.{name}"] = Beside(table.units[name], 0.0, size)
        found[f"{GAIN}.{name}"] = Beside("", 1.0, 1.0)
        found[f"{SHIFT}.{name}"] = late
    return found


def suspected(scene: Scene, beside: dict[str, Beside], free: Sequence[str]) -> list[Free]:
    """The suspects of a fit: sensors, losses, masses and inertias, numbers of drive and load.

    Args:
        scene: as fitted. beside: of sensor_keys. free: names of what is free in the fit.
    """
    alone = len(beside) == 4  # a single column, whose shift is that of the clock
    found = [
        _suspected(name, one.unit, (one.value - one.most, one.value + one.most), one.value, 0.01 * one.size)
        for name, one in beside.items()
        if not (alone and name == CLOCK)
    ]
    for one in VARIABLES:
        if one.causality == PARAMETER and one.kind == REAL and one.group in GROUPS:
            value = float(scene.given.get(one.name, one.start or 0.0))
            found.append(_suspected(f"{MECHANISM}{one.name}", one.unit, one.ends, value))
    for part in ("drive", "load"):
        table = getattr(scene, part)
        for name, field in type(table).model_fields.items():
            value = getattr(table, name)
            if isinstance(value, float) and value:
                found.append(_suspected(f"{part}.{name}", unit_of(field), (-math.inf, math.inf), value))
    return [one for one in found if one.name not in free]


def _suspected(name: str, unit: str, ends: tuple[float, float], value: float, size: float = 0.0) -> Free:
    """A suspect with the value that it has in the fit; size: of a first change, by default of the value."""
    return Free(name, unit, *ends, start=value, origin=value, span=size or 0.01 * abs(value) or FIRST)


def lag_one(residuals: Array) -> float:
    """Autocorrelation from row to row about the mean; 0 of what does not change."""
    centred = residuals - residuals.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2)) if np.ptp(residuals) else 0.0


@dataclass(frozen=True)
class Leftover:
    """Residuals of a fit over noise, with what they are of.

    Attributes:
        values: shape (residuals,). place: number of the column of each, -1 of what was known before.
        estimated: of each column, whether its noise is found from the residuals.
    """

    values: Array
    place: NDArray[np.int64]
    estimated: Sequence[bool]

    def scatter(self, left: Array) -> Array:
        """Noise that is left in each column, over that before; 1 where the noise is known."""
        rms = [math.sqrt(np.mean(left[self.place == n] ** 2)) for n in range(len(self.estimated))]
        return np.where(self.estimated, np.maximum(rms, 1e-12), 1.0)

    def chi_squared(self, values: Array, scatter: Array) -> float:
        """Chi-squared of residuals, shape (residuals,), by the noise that scatter gives."""
        return float(np.sum((values / np.append(scatter, 1.0)[self.place]) ** 2))

    def evidence(self, left: Array) -> float:
        """Twice the logarithm of the ratio of likelihoods, of those left over all: chi-squared by chance."""
        total = float(np.sum(self.values[self.place < 0] ** 2) - np.sum(left[self.place < 0] ** 2))
        for n, estimated in enumerate(self.estimated):
            rows = self.place == n
            number, after = int(rows.sum()), left[rows]
            before, rest = float(np.sum(self.values[rows] ** 2)), max(float(np.sum(after**2)), 1e-24)
            if estimated:
                gained = number * math.log(max(before, 1e-24) / rest)
            else:
                # noise that is larger than was said is noise
                gained = (before - rest) / max(rest / number, 1.0)
            following = max(lag_one(after), 0.0)
            total += gained * (1.0 - following) / (1.0 + following)
        return total

    def solved(self, slopes: Array, limits: tuple[float, float]) -> tuple[Array, Array, Array]:
        """Free one more variable, as far as residuals are linear.

        Args:
            slopes: of the residuals, shape (residuals, variables), that of the suspect last. limits: of its
                change.

        Returns:
            (changes, shape (variables,); their covariance; the residuals left).
        """
        scatter = np.ones(len(self.estimated))
        for _ in range(PASSES):
            weights = 1.0 / np.append(scatter, 1.0)[self.place]
            weighed = slopes * weights[:, None]
            changes: Array = np.asarray(np.linalg.lstsq(weighed, -self.values * weights, rcond=None)[0])
            last = float(np.clip(changes[-1], *limits))
            if last != changes[-1]:
                held = -(self.values + last * slopes[:, -1]) * weights
                rest = np.linalg.lstsq(weighed[:, :-1], held, rcond=None)[0]
                changes = np.append(rest, last)
            left: Array = self.values + slopes @ changes
            scatter = self.scatter(left)
        weighed = slopes / np.append(scatter, 1.0)[self.place, None]
        size = np.linalg.norm(weighed, axis=0)
        size[size == 0.0] = math.inf
        inverse = np.linalg.pinv(weighed / size)
        spread: Array = inverse @ inverse.T / np.outer(size, size)
        return changes, spread, left


@dataclass(frozen=True)
class Suspect:
    """Something that is not free in a fit, if it were.

    Attributes:
        name: by dots. value, error: at which the residuals are least, and its standard error, SI; infinite
            where it is told only together with what is free. usual: the value in the fit. unit: "" for none.
        of_unit: of the column of a gain. evidence: see Leftover.evidence.
        chi_squared: of the residuals before and after, by the noise that is left.
        answers: value and standard error of each free key then, SI, by name.
        autocorrelation: largest of the residuals left, of a column.
        confirmed: whether it was fitted in full; else as far as the residuals are linear.
    """

    name: str
    value: float
    error: float
    usual: float
    unit: str
    of_unit: str
    evidence: float
    chi_squared: tuple[float, float]
    answers: dict[str, tuple[float, float]]
    autocorrelation: float
    confirmed: bool = False

    @property
    def cause(self) -> str:
        """The cause in words, with its value."""
        kind, _, of = self.name.partition(".")
        known = f"{self.value:.4g} {self.unit.removeprefix('1')}".strip()
        if kind == OFFSET:
            return f"an offset of {known} in {of}"
        if kind == GAIN:
            unit = wrong_unit(self.value, self.of_unit)
            return f"a gain of {known} in {of}{unit and f' ({unit})'}"
        if kind == SHIFT:
            late = "late" if self.value > 0.0 else "early"
            column = "the clock of the file" if self.name == CLOCK else of
            return f"{column} {abs(1e3 * self.value):.3g} ms {late}"
        return f"{self.name} of {known} in place of {self.usual:.4g}"

    @property
    def freed(self) -> str:
        """Text that frees it in a fit, as the command takes it."""
        other = self.name.startswith((OFFSET, GAIN, SHIFT))
        return self.name if self.usual or other else f"{self.name}=0:{3.0 * abs(self.value):.1g}"

    def as_dict(self) -> dict[str, Any]:
        """Give it for machines: what is not known is None."""
        answers = {name: list(map(_known, pair)) for name, pair in self.answers.items()}
        return {**asdict(self), "error": _known(self.error), "answers": answers}

    @property
    def told(self) -> str:
        """Line on its value and on what it would do to the answers."""
        if not math.isfinite(self.error):
            return "is told only together with what is free"
        changed = [f"{name} {value:.6g} ± {error:.2g}" for name, (value, error) in self.answers.items()]
        before, after = self.chi_squared
        value = f"{self.value:.4g} ± {self.error:.2g} {self.unit.removeprefix('1')}".rstrip()
        return f"{value}, chi squared {before:,.0f} -> {after:,.0f}, {', '.join(changed)}"


def wrong_unit(gain: float, unit: str, near: float = NEAR_UNIT) -> str:
    """Say of a gain that it is that of another unit, where it is, but for so much of it."""
    factors = {unit: 1.0}
    for other in UNITS:
        with contextlib.suppress(ValueError):  # it is of another kind
            factors[other] = factor_between(other, unit)
    ratios = {(a, b): factors[b] / factors[a] for a, b in itertools.permutations(factors, 2)}
    off, pair = min(((abs(gain / one - 1.0), names) for names, one in ratios.items()), default=(near, None))
    return f"its numbers are in {pair[0]}, not in {pair[1]}" if pair and off < near else ""


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
