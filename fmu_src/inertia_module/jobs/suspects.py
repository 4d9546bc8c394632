"""Suspects of a fit: what is not free in it and would, if it were, explain what the fit leaves.

Each is freed by one more column of the Jacobian, which takes some runs: how far the residuals sink, with the
noise of each column found anew, and where the answers go is then linear algebra. What counts is the ratio of
the likelihoods with and without, less as far as the residuals that are left follow one another: rows that do
say less. What explains much is then fitted in full.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused
from ..contract.variables import PARAMETER, REAL, VARIABLES, Group
from ..scene import Scene
from ..scene.keys import MECHANISM, unit_of
from .axes import Free
from .least_squares import STEP, End, Problem
from .measurement import CLOCK, GAIN, OFFSET, SHIFT, Measurement

Array = NDArray[np.float64]

# parameters that are suspects
GROUPS = (Group.LOSSES, Group.MASSES)
# first change of one that the scene has at 0
FIRST = 1e-4
# share of the fits without fault in which one is named all the same
FALSE_ALARM = 0.01
# of the ratio of likelihoods, as chi-squared: what explains as much but for this is not told apart, and
# what explains less by more than that is out of the question
AS_GOOD, EXCLUDED = 6.0, 12.0
# of normal noise in standard errors: 95 %
WITHIN = 1.96
# residuals whose autocorrelation at lag 1 is as much as this are not the noise of a sensor
AUTOCORRELATED = 0.2
# standard deviations of chance that a warning keeps from
CHANCE = 4.0
# change of the residuals, the noise being 1 of each, at which a suspect is freed, and that is none; tries
CHANGE, NO_CHANGE, TRIES = 5.0, 0.5, 5
# longest step of it, in sizes of the suspect
LONGEST = 1e5
# evidence from which on a suspect is fitted in full, and share of that of one that explains all; passes over
# the noise then, what ends them, and the share that it changes by where they are enough
WORTH, SHARE, AGAIN, ENOUGH, SETTLED = 10.0, 0.3, 3, 1e-5, 0.02


def suspected(scene: Scene, data: Measurement, out: Collection[str]) -> list[Free]:
    """The suspects of a fit: sensors, losses, masses and inertias, numbers of drive and load.

    Args:
        scene: as fitted. data: what is fitted. out: names of what is free in the fit, or known.
    """
    found = [dataclasses.replace(one, span=0.01 * one.span) for one in data.sensors.values()]
    if len(data.columns) == 1:  # its shift is that of the clock
        found = [one for one in found if one.name != CLOCK]
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
    return [one for one in found if one.name not in out]


def _suspected(name: str, unit: str, ends: tuple[float, float], value: float) -> Free:
    """A suspect with the value that it has in the fit."""
    return Free(name, unit, *ends, start=value, origin=value, span=0.01 * abs(value) or FIRST)


def lag_one(residuals: Array) -> float:
    """Autocorrelation from row to row about the mean; 0 of what does not change."""
    centred = residuals - residuals.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2)) if np.ptp(residuals) else 0.0


def by_chance(rows: int) -> float:
    """Autocorrelation that the noise of a sensor may have."""
    return max(AUTOCORRELATED, CHANCE / math.sqrt(rows))


@dataclass(frozen=True)
class Leftover:
    """Residuals of a fit over noise, with what they are of.

    Attributes:
        values: shape (residuals,). place: number of the column of each, -1 of what was known before.
        estimated: of each column, whether its noise is found from the residuals.
    """

    values: Array
    place: NDArray[np.int64]
    estimated: Sequence[bool] | NDArray[np.bool_]

    @classmethod
    def of(cls, end: End) -> Leftover:
        """Residuals of a fit at its end."""
        data = end.problem.rig.data
        place = np.full(end.residuals.size, -1)
        place[: data.number] = np.nonzero(data.counted)[1]
        return cls(end.residuals, place, data.estimated)

    def weights(self, left: Array) -> Array:
        """Weight of each residual by the noise that is left in its column, shape (residuals,)."""
        rms = [math.sqrt(np.mean(left[self.place == n] ** 2)) for n in range(len(self.estimated))]
        scatter = np.where(self.estimated, np.maximum(rms, 1e-12), 1.0)
        return 1.0 / np.append(scatter, 1.0)[self.place]

    def following(self, left: Array) -> float:
        """Largest autocorrelation of a column in residuals that are left."""
        return max(lag_one(left[self.place == n]) for n in range(len(self.estimated)))

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

    def ranges(self, left: Array, slopes: Array, limits: tuple[float, float]) -> tuple[Array, float]:
        """Compute by how much residuals left allow all variables to change, at 95 %.

        Where the least chi-squared is beyond a limit of the last one, it is what that allows from there on.

        Args:
            left: residuals at the least chi-squared within the limits. slopes: of them, that of the suspect
                last. limits: of its change from there.

        Returns:
            (least and greatest changes, shape (2, variables); standard error of the last one).
        """
        weights = self.weights(left)
        weighed = slopes * weights[:, None]
        size = np.linalg.norm(weighed, axis=0)
        size[size == 0.0] = math.inf
        inverse = np.linalg.pinv(weighed / size) / size[:, None]
        free, spread = -inverse @ (left * weights), inverse @ inverse.T
        deviations = np.maximum(np.sqrt(np.diag(spread)), 1e-30)
        last, share = deviations[-1], spread[:, -1] / deviations[-1]
        # in standard errors of the last one
        low, high = ((limit - free[-1]) / last for limit in limits)
        reach = math.hypot(WITHIN, np.clip(0.0, low, high))
        alone = np.sqrt(np.maximum(deviations**2 - share**2, 0.0))
        # an end of the ellipse, or where it meets the limit
        held = np.clip(np.outer([-reach, reach], share / deviations), low, high)
        across = np.array([[-1.0], [1.0]]) * alone * np.sqrt(np.maximum(reach**2 - held**2, 0.0))
        return free + share * held + across, float(last)


@dataclass(frozen=True)
class Suspect:
    """Something that is not free in a fit, if it were.

    Attributes:
        name: by dots. value, error: at which the residuals are least, and its standard error, SI; infinite
            where it is told only together with what is free. usual: the value in the fit. unit: "" for none.
        other_unit: of a gain, that it is that of another unit, or "". evidence: see Leftover.evidence.
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
    confirmed: bool = False

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
            return f"{column} {abs(1e3 * self.value):.3g} ms {late}"
        return f"{self.name} of {known} in place of {self.usual:.4g}"

    @property
    def freed(self) -> str:
        """Text that frees it in a fit, as the command takes it."""
        other = self.name.startswith((OFFSET, GAIN, SHIFT))
        return self.name if self.usual or other else f"{self.name}=0:{3.0 * abs(self.value):.1g}"

    def within(self, more: Sequence[Suspect]) -> Suspect:
        """This suspect, its answers as far as any one of others, freed with it, lets them go."""
        answers = {}
        for name, (value, low, high) in self.answers.items():
            ends = [one.answers[name][1:] for one in more if math.isfinite(one.error)]
            answers[name] = (value, min([low, *(e[0] for e in ends)]), max([high, *(e[1] for e in ends)]))
        return dataclasses.replace(self, answers=answers)

    @property
    def told(self) -> str:
        """Line on its value and on what it would do to the answers."""
        if not math.isfinite(self.error):
            return "is told only together with what is free"
        changed = [
            f"{name} {value:.5g}, {low:.5g} to {high:.5g}"
            for name, (value, low, high) in self.answers.items()
        ]
        before, after = self.chi_squared
        value = f"{self.value:.4g} ± {self.error:.2g} {self.unit.removeprefix('1')}".rstrip()
        return f"{value}, chi squared {before:,.0f} -> {after:,.0f}; {'; '.join(changed)}"


def causes(suspects: Sequence[Suspect]) -> list[Suspect]:
    """Suspects of which one explains the residuals, as well as the first; none where it may be chance."""
    from scipy.stats import chi2

    least = float(chi2.isf(FALSE_ALARM / max(len(suspects), 1), 1))
    best = max((one.evidence for one in suspects), default=0.0)
    return [one for one in suspects if one.evidence > max(best - AS_GOOD, least)]


def _slope(end: End, key: Free) -> tuple[Array, bool] | None:
    """Slope of the residuals along a suspect, and if any of it is told alone; None where it changes nothing.

    The others give way to it, and a step that is as long as the data then allow counts what a tangent does
    not: where the others make up for nearly all of it, the little that is left is not of the curvature alone.
    """
    problem, (low, high) = end.problem.with_key(key), key.limits
    along, back, found = np.zeros(end.point.size), -np.linalg.pinv(end.slopes), None
    step, longer = 1.0 if high > 1.0 else -1.0, 1e3
    for _ in range(TRIES):
        step = float(np.clip(step, max(low - 1.0, -LONGEST), min(high - 1.0, LONGEST)))
        change = problem.residuals(np.append(end.point + step * along, 1.0 + step)) - end.residuals
        if not np.isfinite(change).all():
            # what the scene refuses, it may take nearer
            step *= 0.1
            continue
        first, moved = found is None, step * end.slopes @ along
        found = (change - moved) / step, moved / step, np.linalg.norm(change) > NO_CHANGE
        nothing = np.linalg.norm(change - moved) < NO_CHANGE
        more = back @ change / step
        size = float(np.linalg.norm(change + step * end.slopes @ more))
        if not first and 0.5 * CHANGE < size < 2.0 * CHANGE:
            break
        along = along + more
        step *= float(np.clip(CHANGE / max(size, 1e-12), 1e-3, longer))
        longer = 10.0
    if found is None or nothing:
        return None
    slope, made_up, alone = found
    return (slope, True) if alone else (-made_up, False)


def _freed(end: End, key: Free) -> Suspect | None:
    """A suspect freed as far as residuals are linear; None of what changes nothing."""
    from scipy.optimize import lsq_linear

    found = _slope(end, key)
    if found is None:
        return None
    slope, alone = found
    problem, slopes = end.problem.with_key(key), np.column_stack([end.slopes, slope])
    point = np.append(end.point, 1.0)
    low, high = problem.limits
    free = np.arange(point.size) == end.point.size
    bounds = np.where(free, low - point, -math.inf), np.where(free, high - point, math.inf)
    changes = lsq_linear(slopes, -end.residuals, bounds).x
    other = End(problem, point + changes, end.residuals + slopes @ changes, slopes, False)
    return _suspect(Leftover.of(end), other, 0.0 if alone else math.inf)


def _suspect(left: Leftover, other: End, error: float = 0.0) -> Suspect:
    """A suspect where a search with it ended; error: of it at least, infinite if nothing tells it alone."""
    *keys, key = other.problem.keys
    limits = key.limits[0] - other.point[-1], key.limits[1] - other.point[-1]
    ranges, deviation = left.ranges(other.residuals, other.slopes, limits)
    answers = {}
    for one, u, ends in zip(keys, other.point, ranges.T, strict=False):
        low, high = sorted(float(np.clip(one.value(u + end), one.low, one.high)) for end in ends)
        answers[one.name] = (one.value(float(u)), low, high)
    data, value = other.problem.rig.data, key.value(float(other.point[-1]))
    kind, _, column = key.name.partition(".")
    weights = left.weights(other.residuals)
    before, after = ((values * weights) @ (values * weights) for values in (left.values, other.residuals))
    return Suspect(
        name=key.name,
        value=value,
        error=max(error, abs(key.span) * deviation),
        usual=key.start,
        unit=key.unit,
        other_unit=data.unit_by(column, value) if kind == GAIN else "",
        evidence=left.evidence(other.residuals),
        chi_squared=(float(before), float(after)),
        answers=answers,
        autocorrelation=left.following(other.residuals),
        confirmed=other.ended,
    )


def _in_full(end: End, key: Free, point: Array) -> tuple[Suspect, End] | None:
    """A suspect fitted in full from a point, the noise found anew, and the end of that; None if refused."""
    problem, steps, slopes = end.problem.with_key(key), np.asarray(STEP), "2-point"
    try:
        for _ in range(AGAIN):
            other = problem.solve(np.clip(point, *problem.limits), steps, slopes, ENOUGH, exact=True)
            point, noisy = other.point, problem.with_noise_of(other.point)
            if slopes == "3-point" and np.allclose(noisy.sigma, problem.sigma, rtol=SETTLED):
                break
            problem, steps, slopes = noisy, other.steps, "3-point"
    except Refused:
        return None
    # over the noise of the fit, as what the fit leaves is
    weight = (other.problem.sigma / end.problem.sigma)[problem.rig.data.counted]
    weight = np.append(weight, np.ones(end.residuals.size - weight.size))
    rest, over = other.residuals * weight, other.slopes * weight[:, None]
    over_all = dataclasses.replace(other, residuals=rest, slopes=over, ended=True)
    return _suspect(Leftover.of(end), over_all), other


def _nearer(problem: Problem, start: Array) -> Array:
    """A point with the last variable where residuals are least, were they linear, if that is true."""
    last = np.eye(start.size)[-1]
    residuals = problem.residuals(start)
    slope = problem.residuals(start + last) - residuals
    there = start - last * (slope @ residuals) / max(slope @ slope, 1e-300)
    there = np.clip(there, *problem.limits)
    less = np.sum(problem.residuals(there) ** 2) < np.sum(residuals**2)
    return there if less else start


def tried(end: End, keys: Sequence[Free], start: Array, begun: Callable[[Free], Free]) -> list[Suspect]:
    """Free suspects in turn; what explains the most first, what changes nothing left out.

    What explains much is fitted in full, as long as it may explain as much as the best one. Where none
    explains all, the fit may have ended in a wrong place: what sensors may have is fitted from its start.

    Args:
        end: of the fit. keys: the suspects. start: point at which the fit began, of the keys at its end.
        begun: passes on a suspect that is looked at now.
    """
    freed = [one for one in (_freed(end, key) for key in map(begun, keys)) if one is not None]
    by_name, full = {key.name: key for key in keys}, dict[str, tuple[Suspect, End]]()
    left, chance = Leftover.of(end), by_chance(len(end.problem.rig.data.table))
    most, following = 0.0, left.following(left.values)

    def fit(key: Free, point: Array) -> None:
        """Fit a suspect in full and keep the best of it and of all."""
        nonlocal most, following
        found = _in_full(end, key, point)
        if found is None or (key.name in full and full[key.name][0].evidence > found[0].evidence):
            return
        full[key.name] = found
        if found[0].evidence > most:
            most, following = found[0].evidence, found[0].autocorrelation

    for one in sorted(freed, key=lambda one: -one.evidence):
        enough = min(most - EXCLUDED, SHARE * most) if following <= chance else 0.0
        if one.evidence > max(WORTH, enough) and one.value != one.usual:
            # near 1, as variables are to be
            key = dataclasses.replace(by_name[one.name], span=one.value - one.usual)
            point = [k.variable(one.answers[k.name][0]) for k in end.problem.keys]
            fit(key, np.array([*point, 2.0]))
    if following > chance:
        for name, key in end.problem.rig.data.sensors.items():
            if name in by_name:
                fit(key, _nearer(end.problem.with_key(key), np.append(start, 1.0)))
    found = {one.name: one for one in freed} | {name: one for name, (one, _) in full.items()}
    named = causes(list(found.values()))
    if named and following <= chance:
        # with it anything else may be otherwise too
        for one, there in (full[cause.name] for cause in named if cause.name in full):
            more = [_freed(there, key) for key in keys if key.name != one.name]
            found[one.name] = one.within([other for other in more if other is not None])
    return sorted(found.values(), key=lambda one: -one.evidence)
