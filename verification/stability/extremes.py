"""The extremes: axes with their values, each a change of one of two ordinary mechanisms.

They are the rows of extremes.toml, and the ends of all ranges in the table of variables.
"""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inertia_module.fidelity.levels import Level
from inertia_module.interface.variables import INTEGER, PARAMETER, REAL, Group, Variable, with_causality
from inertia_module.kernel.codes import AVERAGED
from inertia_module.model import Module

from .motion import ELASTIC_LEVELS, LEVELS, Motion, Segment, imbalance_inertia, solve_at

# relative accuracy of fidelity averaged
AVERAGED_ACCURACY = 0.005
# default angle of link 1 in a trial, rad
TRAVEL = 100.0
RANGE_ENDS, OUT_OF_RANGE = "end of a range", "out of range"


@dataclass(frozen=True)
class Case:
    """An extreme on one layout at one fidelity level.

    Attributes:
        axis: name of the axis.
        value: name of the value on the axis.
        layout: layout.
        motion: parameters and inputs.
        split: number of short communication steps for each long one.
        slow: True if a quick study omits the case.
    """

    axis: str
    value: str
    layout: str
    motion: Motion
    split: int
    slow: bool = False

    @property
    def level(self) -> Level:
        """Fidelity level."""
        return self.motion.level

    @property
    def accuracy(self) -> float:
        """Requested relative accuracy: the tolerance, or the accuracy of averaged if it is larger."""
        minimum = AVERAGED_ACCURACY if self.level.fidelity == AVERAGED else 0.0
        return max(self.motion["tolerance"], minimum)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """An ordinary mechanism.

    Attributes:
        layout: bevel or planar.
        parameters: parameters that differ from the defaults.
        omega1: input speed, rad/s.
        load: load torque, N.m.
    """

    layout: str
    parameters: dict[str, float]
    omega1: float
    load: float

    @functools.cached_property
    def module(self) -> Module:
        """A started module of the plain kernel."""
        return Module("plain").start(**self.parameters, omega1=self.omega1)

    @functools.cached_property
    def imbalance(self) -> float:
        """Maximum inertia of the unbalanced masses at link 2, kg m^2."""
        return imbalance_inertia(self.module.derived)

    @functools.cached_property
    def stall_torque(self) -> float:
        """Maximum torque on link 2 at rest, N.m; the module moves no larger load.

        It is the maximum on a grid over one period, and on ever finer grids around it.
        """
        d = self.module.derived

        def torque(q: float) -> float:
            return float(solve_at(self.module, True, False, q=q, omega1=self.omega1, omega2=0.0).mesh)

        count = 200 * int(d.period_turns)
        best, half = 0.5 * d.period, 0.5 * d.period
        while half > 1e-9:
            best = max((best + half * (2 * n / count - 1) for n in range(count + 1)), key=torque)
            half *= 2.0 / count
        return torque(best)

    @functools.cached_property
    def grazing_speed(self) -> float:
        """Maximum speed of an unloaded output shaft that link 2 reaches within TRAVEL, rad/s."""
        coasting = Segment(TRAVEL / self.omega1, self.omega1, 0.0)

        def engages(speed: float) -> bool:
            values = self.parameters | {"omega_out_start": speed, "tolerance": 1e-12}
            module = Motion(values, (coasting,)).started(Module())
            module.advance(coasting.duration)
            return module["output_torque_mean"] != 0.0

        low, high = 0.0, 100.0 * self.omega1
        while True:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                return middle
            low, high = (middle, high) if engages(middle) else (low, middle)


TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
MECHANISMS = [Mechanism(**row) for row in TABLE["mechanisms"]]
# defaults of the changes that are no parameters
USUAL = {"segments": (), "turns": 0.0, "levels": LEVELS, "split": 50, "slow": False}


def signed(*magnitudes: float) -> list[float]:
    """Return each magnitude with both signs.

    Args:
        magnitudes: positive numbers.
    """
    return [value for magnitude in magnitudes for value in (magnitude, -magnitude)]


def _numbers(mechanism: Mechanism) -> Iterator[Variable]:
    """Yield the numerical parameters of the layout.

    Args:
        mechanism: an ordinary mechanism.
    """
    other = Group.PLANAR if mechanism.layout == "bevel" else Group.BEVEL
    for variable in with_causality(PARAMETER):
        if variable.kind in (REAL, INTEGER) and variable.group != other:
            yield variable


def range_ends(mechanism: Mechanism) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield an extreme for each end of the range of each parameter, and one for the next number beyond it.

    Args:
        mechanism: an ordinary mechanism.

    Yields:
        axis, name of the value, changes of the mechanism.
    """
    for variable in _numbers(mechanism):
        name = variable.name
        levels = ELASTIC_LEVELS if variable.group == Group.ELASTIC else LEVELS
        together = TABLE["together"].get(name, "")
        for end, side, direction in zip(variable.ends, ("below", "above"), (-1.0, 1.0), strict=True):
            if end != mechanism.parameters.get(name, variable.start):
                changes = eval(f"dict({together})", vars(math) | {"x": end, "TRAVEL": TRAVEL})
                yield RANGE_ENDS, f"{name} {end:g}", {"levels": levels, name: end, **changes}
            next_one = (
                end + direction if variable.kind == INTEGER else math.nextafter(end, direction * math.inf)
            )
            if mechanism.layout == "bevel" or variable.group == Group.PLANAR:
                yield OUT_OF_RANGE, f"{name} {side} {end:g}", {"levels": LEVELS[2:3], name: next_one}


def extremes(mechanism: Mechanism) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield the extremes of the table and of the ranges.

    Args:
        mechanism: an ordinary mechanism.

    Yields:
        axis, name of the value, changes of the mechanism.
    """
    scope = {**vars(math), "m": mechanism, "signed": signed, "Segment": Segment, "TRAVEL": TRAVEL}
    scope |= {"ELASTIC_LEVELS": ELASTIC_LEVELS}
    for name, formula in TABLE["constants"].items():
        scope[name] = eval(formula, scope)
    for axis, label, changes, values, layout in (row + ["[()]", ""][len(row) - 3 :] for row in TABLE["rows"]):
        for value in eval(values, scope) if layout in ("", mechanism.layout) else ():
            parts = value if isinstance(value, tuple) else (value,)
            named = dict(zip("xyzw", parts, strict=False))
            yield axis, label.format(*parts), eval(f"dict({changes})", scope | named)
    yield from range_ends(mechanism)


@functools.cache
def axes() -> dict[str, list[Case]]:
    """Return the cases by axis, ordered by layout, value and fidelity level."""
    cases: dict[str, list[Case]] = {}
    for mechanism in MECHANISMS:
        for axis, value, changes in extremes(mechanism):
            omega1, load = mechanism.omega1, mechanism.load
            usual = {**USUAL, "omega1": omega1, "load": load, "duration": TRAVEL / omega1}
            settings = {name: changes.get(name, default) for name, default in usual.items()}
            changed = {name: number for name, number in changes.items() if name not in usual}
            whole = Segment(settings["duration"], settings["omega1"], settings["load"])
            for level in settings["levels"]:
                values = {**mechanism.parameters, **changed, **level.values}
                motion = Motion(values, settings["segments"] or (whole,), settings["turns"])
                case = Case(axis, value, mechanism.layout, motion, settings["split"], settings["slow"])
                cases.setdefault(axis, []).append(case)
    return cases
