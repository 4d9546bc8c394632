"""The extremes: axes, each with its values and what they change of two ordinary mechanisms.

They are rows of a table (extremes.toml).
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
from inertia_module.kernel.codes import AVERAGED
from inertia_module.model import Module

from .motion import ELASTIC_LEVELS, LEVELS, Motion, Segment, imbalance_inertia, solve_at

# accuracy of the torque map of averaged, relative
AVERAGED_ACCURACY = 0.005
# rad that link 1 turns in a trial, where nothing else is said
TRAVEL = 100.0


@dataclass(frozen=True)
class Case:
    """One value on an axis, for one layout, at one level of fidelity.

    Attributes:
        axis, value, layout: how they are called. motion: what is run.
        split: short communication steps that replace each long one.
        slow: whether it is left out of a quick run.
    """

    axis: str
    value: str
    layout: str
    motion: Motion
    split: int
    slow: bool = False

    @property
    def level(self) -> Level:
        """Level of fidelity."""
        return self.motion.level

    @property
    def accuracy(self) -> float:
        """Relative accuracy asked for: the tolerance, or the accuracy of the fidelity if that is larger."""
        least = AVERAGED_ACCURACY if self.level.fidelity == AVERAGED else 0.0
        return max(self.motion["tolerance"], least)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A layout at ordinary values.

    Attributes:
        layout: bevel or planar. parameters: over the defaults. omega1: rad/s. load: N.m.
    """

    layout: str
    parameters: dict[str, float]
    omega1: float
    load: float

    @functools.cached_property
    def module(self) -> Module:
        """A module at the ordinary speed."""
        return Module("plain").start(**self.parameters, omega1=self.omega1)

    @functools.cached_property
    def imbalance(self) -> float:
        """Largest inertia of the imbalances behind link 2, kg m^2."""
        return imbalance_inertia(self.module.derived)

    @functools.cached_property
    def largest_held_torque(self) -> float:
        """Largest torque on link 2 while it is held at the ordinary speed, N.m: no load above it is moved.

        Looked for on a grid over a period, then on ever finer ones around the best.
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
        """Speed of the unloaded output shaft that link 2 only just reaches in TRAVEL rad, rad/s."""
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
# what an extreme changes besides parameters, where it does not
USUAL = {"segments": (), "turns": 0.0, "levels": LEVELS, "split": 50, "slow": False}


def signed(*sizes: float) -> list[float]:
    """Each size with both signs."""
    return [value for size in sizes for value in (size, -size)]


def extremes(m: Mechanism) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Work out the table beside the code: axis, value as it is called, changes of the mechanism."""
    known = {**vars(math), "m": m, "signed": signed, "Segment": Segment, "TRAVEL": TRAVEL}
    known |= {"ELASTIC_LEVELS": ELASTIC_LEVELS}
    for name, formula in TABLE["known"].items():
        known[name] = eval(formula, known)
    for axis, called, changes, values, layout in (
        row + ["[()]", ""][len(row) - 3 :] for row in TABLE["rows"]
    ):
        for value in eval(values, known) if layout in ("", m.layout) else ():
            together = value if isinstance(value, tuple) else (value,)
            named = dict(zip("xyzw", together, strict=False))
            yield axis, called.format(*together), eval(f"dict({changes})", known | named)


@functools.cache
def axes() -> dict[str, list[Case]]:
    """Cases by name of the axis: layout by layout, value by value, level by level."""
    found: dict[str, list[Case]] = {}
    for m in MECHANISMS:
        for axis, value, changes in extremes(m):
            usual = {**USUAL, "omega1": m.omega1, "load": m.load, "duration": TRAVEL / m.omega1}
            run = {name: changes.get(name, ordinary) for name, ordinary in usual.items()}
            changed = {name: number for name, number in changes.items() if name not in usual}
            whole = Segment(run["duration"], run["omega1"], run["load"])
            for level in run["levels"]:
                values = {**m.parameters, **changed, **level.values}
                motion = Motion(values, run["segments"] or (whole,), run["turns"])
                case = Case(axis, value, m.layout, motion, run["split"], run["slow"])
                found.setdefault(axis, []).append(case)
    return found
