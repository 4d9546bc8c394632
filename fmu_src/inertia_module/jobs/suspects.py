"""Suspects of a fit: what is not free in it and would, if it were, explain what the fit leaves.

Each is freed by one more column of the Jacobian; how far the residuals sink and where answers go is then
linear algebra. What counts is the ratio of the likelihoods with and without, less as far as the residuals
that are left follow one another. What explains much is then fitted in full.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..common.equality import ByContent
from ..common.errors import Refused
from ..common.terminal import Progress
from ..contract.variables import PARAMETER, REAL, VARIABLES, Group
from ..scene import Scene
from ..scene.keys import MECHANISM
from .axes import Free, as_given
from .least_squares import Array, End, Problem
from .measurement import CLOCK, GAIN, OFFSET, SHIFT, Measurement, lag_one

# parameters that are suspects
GROUPS = (Group.LOSSES, Group.MASSES)
# size of one that the scene has at 0
FIRST = 1e-2
# share of the fits without fault in which one is named all the same
FALSE_ALARM = 0.01
# of the ratio of likelihoods, as chi-squared: what explains as much but for this is not told apart, and
# what explains less by more than that is out of the question
AS_GOOD, EXCLUDED = 6.0, 12.0
# change of the residuals, the noise being 1 of each, at which a suspect is freed, and that is none; tries
CHANGE, NO_CHANGE, TRIES = 5.0, 0.5, 5
# longest step of it, in sizes of the suspect
LONGEST = 1e5
# evidence from which on a suspect is fitted in full, and share of that of one that explains all
WORTH, SHARE = 10.0, 0.3


@dataclass(frozen=True, eq=False)
class Suspect(ByContent):
    """Something that is not free in a fit, if it were.

    Attributes:
        value, error: at which the residuals are least, and its standard error, SI; infinite where it is told
            only together with what is free. usual: the value in the fit.
        other_unit: of a gain, that it is that of another unit, or "".
        evidence: twice the logarithm of the ratio of likelihoods; as chi-squared where it is chance.
        chi_squared: of the residuals before and after, by the noise that is left.
        answers: value and both ends of the interval of 95 % of each free key then, SI, by name; with any one
            more suspect free if this one is a cause.
        autocorrelation: largest of the residuals left, of a column.
        confirmed: whether it was fitted in full; else as far as the residuals are linear.
    """

    name: str
    value: float
    error: float
    usual: float
    unit: str
    other_unit: str
    evidence: float
    chi_squared: tuple[float, float]
    answers: dict[str, tuple[float, float, float]]
    autocorrelation: float
    confirmed: bool

    @property
    def cause(self) -> str:
        """The cause in words, with its value."""
        kind, _, of = self.name.partition(".")
        known = f"{self.value:.4g} {self.unit.removeprefix('1')}".strip()
        if kind == OFFSET:
            return f"an offset of {known} in {of}"
        if kind == GAIN:
            return f"a gain of {known} in {of}{self.other_unit and f' ({self.other_unit})'}"
        if kind == SHIFT:
            late = "late" if self.value > 0.0 else "early"
            column = "the clock of the file" if self.name == CLOCK else of
            return f"a time shift of {abs(1e3 * self.value):.3g} ms ({late}) in {column}"
        return f"{self.name} = {known} instead of {self.usual:.4g}"

    @property
    def freed(self) -> str:
        """Text that frees it in a fit, as the command takes it."""
        other = self.name.startswith((OFFSET, GAIN, SHIFT))
        return self.name if self.usual or other else f"{self.name}=0:{3.0 * abs(self.value):.1g}"

    @property
    def told(self) -> str:
        """Line on its value and on what it would do to the answers."""
        changed = "; ".join(
            f"{name} {value:.5g} ({low:.5g} to {high:.5g})"
            for name, (value, low, high) in self.answers.items()
        )
        before, after = self.chi_squared
        value = f"{self.value:.4g} ± {self.error:.2g} {self.unit.removeprefix('1')}".rstrip()
        return f"{value}, chi-squared {before:,.0f} → {after:,.0f}; {changed}"


def suspected(scene: Scene, data: Measurement, out: Collection[str]) -> list[Free]:
    """The suspects of a fitted scene but those out: sensors, losses, masses, numbers of drive and load."""
    names = [
        f"{MECHANISM}{one.name}"
        for one in VARIABLES
        if one.causality == PARAMETER and one.kind == REAL and one.group in GROUPS
    ]
    for part in ("drive", "load"):
        table = getattr(scene, part)
        names += [f"{part}.{name}" for name, value in table if isinstance(value, float) and value]
    found = [one for one in data.sensors.values() if one.name != CLOCK or len(data.columns) > 1]
    found += [as_given(name, scene) for name in names]
    return [dataclasses.replace(one, size=0.01 * (one.size or FIRST)) for one in found if one.name not in out]


def causes(suspects: Iterable[Suspect]) -> list[Suspect]:
    """Suspects of which one explains the residuals, as well as the first; none where it may be chance."""
    from scipy.stats import chi2

    found = list(suspects)
    least = float(chi2.isf(FALSE_ALARM / max(len(found), 1), 1))
    best = max((one.evidence for one in found), default=0.0)
    return [one for one in found if one.evidence > max(best - AS_GOOD, least)]


def _squares(end: End) -> tuple[Array, float]:
    """Sums of squares: of each column, SI where they tell its noise, and of what was known before."""
    *columns, known = (float(part @ part) for part in end.parts)
    units = np.where(end.problem.rig.data.estimated, end.problem.sigma[0], 1.0)
    return np.maximum(columns * units**2, 1e-30), known


def beside(end: End, other: End) -> Suspect:
    """A suspect where a search with it ended, beside the end of that without it."""
    data, key = end.problem.rig.data, other.problem.keys[-1]
    (before, known_before), (after, known_after) = _squares(end), _squares(other)
    number = data.counted.sum(axis=0)
    noise = np.where(data.estimated, after / number, 1.0)
    gained = np.where(
        data.estimated,
        number * np.log(before / after),
        # noise that is larger than was said is noise
        (before - after) / np.maximum(after / number, 1.0),
    )
    following = np.maximum([lag_one(part) for part in other.parts[:-1]], 0.0)
    value, ranges = other.problem.values(other.point), other.ranges
    kind, _, column = key.name.partition(".")
    return Suspect(
        name=key.name,
        value=value[key.name],
        error=other.errors[key.name],
        usual=key.start,
        unit=key.unit,
        other_unit=data.unit_by(column, value[key.name]) if kind == GAIN else "",
        evidence=float(np.sum(gained * (1.0 - following) / (1.0 + following))) + known_before - known_after,
        chi_squared=(
            float(np.sum(before / noise)) + known_before,
            float(np.sum(after / noise)) + known_after,
        ),
        answers={one.name: (value[one.name], *ranges[one.name]) for one in end.problem.keys},
        autocorrelation=other.following,
        confirmed=other.ended,
    )


def _freed(end: End, key: Free) -> End | None:
    """The end with a suspect freed as far as residuals are linear; None of what changes nothing.

    The others give way to it, and a step that is as long as the data then allow counts what a tangent does
    not: where the others make up for nearly all of it, the little that is left is not of the curvature alone.
    """
    problem, longest = end.problem.with_key(key), LONGEST * key.size
    low, high = max(key.low - key.start, -longest), min(key.high - key.start, longest)
    step = key.size if high > 0.0 else -key.size
    along, back = np.zeros(end.point.size), -np.linalg.pinv(end.slopes)
    slope: Array | None = None
    for _ in range(TRIES):
        step = min(max(step, low), high)
        change = problem.residuals(np.append(end.point + step * along, key.start + step)) - end.residuals
        if not np.isfinite(change).all():
            # what the scene refuses, it may take nearer
            step *= 0.1
            continue
        first, alone = slope is None, change - step * end.slopes @ along
        slope, seen = alone / step, [np.linalg.norm(one) > NO_CHANGE for one in (change, alone)]
        size = float(np.linalg.norm(change + end.slopes @ (back @ change)))
        if not first and 0.5 * CHANGE < size < 2.0 * CHANGE:
            break
        along = along + back @ change / step
        step *= min(max(CHANGE / max(size, 1e-12), 1e-3), 1e3 if first else 10.0)
    if slope is None or not seen[1]:
        return None
    if not seen[0]:
        # the others make up for all of it
        slope = np.zeros_like(slope)
    left = slope + end.slopes @ (back @ slope)
    least = -float(left @ end.residuals) / max(float(left @ left), 1e-300)
    last = min(max(least, low), high)
    point = back @ (end.residuals + slope * last)
    residuals = end.residuals + end.slopes @ point + slope * last
    key = dataclasses.replace(key, size=abs(last) or key.size)
    slopes, point = np.column_stack([end.slopes, slope]), np.append(end.point + point, key.start + last)
    return End(end.problem.with_key(key), point, residuals, slopes, False)


def tried(end: End, keys: Sequence[Free], start: Array, progress: Progress) -> list[Suspect]:
    """Free suspects in turn; what explains the most first, what changes nothing left out.

    What explains much is fitted in full, as long as it may explain as much as the best one. Where none
    explains all, the fit may have ended in a wrong place: what sensors may have is fitted from its start.

    Args:
        end: of the fit. keys: the suspects. start: point at which the fit began, of the keys at its end.
    """
    freed, full = dict[str, End](), dict[str, End]()
    for n, key in enumerate(keys):
        progress(n / len(keys))
        other = _freed(end, key)
        if other is not None:
            freed[key.name] = other
    found = {name: beside(end, other) for name, other in freed.items()}
    most, whole = 0.0, not end.systematic

    def fit(problem: Problem, point: Array) -> None:
        """Fit a suspect in full; the best of it and of all are kept."""
        nonlocal most, whole
        name = problem.keys[-1].name
        try:
            other = problem.solve(point).settled()
        except Refused:
            return
        suspect = beside(end, other)
        if name not in full or suspect.evidence > found[name].evidence:
            found[name], full[name] = suspect, other
        if suspect.evidence > most:
            most, whole = suspect.evidence, not other.systematic

    for name in sorted(found, key=lambda name: -found[name].evidence):
        enough = min(most - EXCLUDED, SHARE * most) if whole else 0.0
        if found[name].evidence > max(WORTH, enough):
            fit(freed[name].problem, freed[name].point)
    if not whole:
        for key in end.problem.rig.data.sensors.values():
            if key.name in {one.name for one in keys}:
                fit(end.problem.with_key(key), np.append(start, key.start))
    for cause in causes(found.values()):
        if whole and cause.name in full:
            # with it anything else may be otherwise too
            found[cause.name] = _with_any(cause, full[cause.name], keys)
    return sorted(found.values(), key=lambda one: -one.evidence)


def _with_any(cause: Suspect, end: End, keys: Sequence[Free]) -> Suspect:
    """A suspect, its answers as far as any one more, freed at the end of the fit with it, lets them go."""
    answers = cause.answers
    for key in keys:
        other = None if key.name == cause.name else _freed(end, key)
        if other is not None and math.isfinite(other.errors[key.name]):
            ranges = other.ranges
            answers = {
                name: (value, min(low, ranges[name][0]), max(high, ranges[name][1]))
                for name, (value, low, high) in answers.items()
            }
    return dataclasses.replace(cause, answers=answers)
