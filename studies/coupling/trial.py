"""One trial: a case, a coupling and a step; how far it is from the reference, what it loses and costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np

from inertia_module.cosimulation import (
    SCHEMES,
    CoupledEngine,
    Engine,
    EnginePlant,
    Ledger,
    Scheme,
    TorqueDrivenEngine,
    torque_driven,
)
from inertia_module.harness.fmu import Fmu, FmuError

from .case import STOP_TIME, WINDOW, WINDOWS, CoupledCase
from .reference import Course

TOLERANCE = 1e-8
TORQUE = "torque-driven"
# by name; None: the module is driven by torque
COUPLINGS: dict[str, Scheme | None] = {TORQUE: None, **SCHEMES}
# what is called unstable: the engine off its speed by this share, which no course here comes near to
_OFF = 0.9


@dataclass(frozen=True)
class Trial:
    """What a run gave; errors are NaN where it is unstable.

    Attributes:
        case, ratio, scheme: what was run. step: communication step, s. stable: whether it was.
        speed_error: greatest error of the mean of omega1 over a window, relative to the engine's speed.
        output_error: the same of omega_out, relative to the greatest omega_out.
        energy_error: energy lost on the bond over the work of the engine. work_error: of that work.
        cost: see Ledger.cost, for a simulated second.
    """

    UNITS: ClassVar[dict[str, str]] = {"step": "s", "cost": "1/s"}

    case: str
    ratio: float
    scheme: str
    step: float
    stable: bool
    speed_error: float
    output_error: float
    energy_error: float
    work_error: float
    cost: float

    @property
    def worst(self) -> float:
        """Worst of the errors of speed, output speed and energy; infinite if unstable."""
        if not self.stable:
            return math.inf
        return max(self.speed_error, self.output_error, abs(self.energy_error))


class Run(NamedTuple):
    """A run of a case: its course, what is not reached is NaN; sums over it; whether it was stable."""

    course: Course
    ledger: Ledger
    stable: bool


def couple(fmu: Fmu, engine: Engine, scheme: Scheme | None, inertia: float, substeps: int = 1) -> EnginePlant:
    """Engine and module by a scheme, its interface inertia in kg.m2, or, without one, driven by torque."""
    if scheme is None:
        return TorqueDrivenEngine(fmu, engine, substeps)
    return CoupledEngine(fmu, engine, scheme, inertia, substeps)


@contextmanager
def coupled_engine(
    case: CoupledCase, scheme: Scheme | None, fmu_path: Path, tolerance: float = TOLERANCE
) -> Iterator[EnginePlant]:
    """Engine and module at the start of a case; without a scheme the module is driven by torque."""
    engine = case.engine()
    start = {"omega1": case.speed, "load_torque": case.load_torque}
    parameters = case.parameters if scheme is not None else torque_driven(case.parameters, engine.inertia)
    with Fmu(fmu_path, parameters, start, tolerance) as fmu:
        yield couple(fmu, engine, scheme, case.interface.middle)


def course(
    case: CoupledCase, scheme: Scheme | None, step: float, fmu_path: Path, tolerance: float = TOLERANCE
) -> Run:
    """Run a case in equal steps, s, a whole number of them in a window (arguments of coupled_engine)."""
    omega1, omega_out = np.full(WINDOWS, math.nan), np.full(WINDOWS, math.nan)
    count = max(1, round(WINDOW / step))
    with coupled_engine(case, scheme, fmu_path, tolerance) as coupled:
        engine = coupled.engine
        for n in range(WINDOWS):
            angle = engine.state.angle
            try:
                for _ in range(count):
                    coupled.step(WINDOW / count)
            except (FmuError, OverflowError):
                break
            omega1[n] = (engine.state.angle - angle) / WINDOW
            if not abs(engine.speed - case.speed) < _OFF * case.speed:
                break
            (omega_out[n],) = coupled.read(("omega_out",))
        stable = bool(np.isfinite(omega_out).all())
        return Run(Course(omega1, omega_out, engine.state.work_in), coupled.ledger, stable)


def trial(case: CoupledCase, name: str, step: float, reference: Course, fmu_path: Path) -> Trial:
    """Run a case and compare it.

    Args:
        case: what is run. name: in COUPLINGS. step: s. reference: of the case. fmu_path: of the module.
    """
    found, ledger, stable = course(case, COUPLINGS[name], step, fmu_path)
    errors = (
        float(np.abs(found.omega1 - reference.omega1).max()) / case.speed,
        float(np.abs(found.omega_out - reference.omega_out).max() / np.abs(reference.omega_out).max()),
        ledger.defect / reference.work,
        found.work / reference.work - 1.0,
        ledger.cost / STOP_TIME,
    )
    return Trial(case.name, case.ratio, name, step, stable, *(errors if stable else [math.nan] * len(errors)))
