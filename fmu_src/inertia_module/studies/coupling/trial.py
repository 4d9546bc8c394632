"""One trial: a case, a scheme and a step; how far it is from the reference, what it loses, what it costs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...cosimulation import (
    CoupledEngine,
    EnginePlant,
    ErrorControl,
    Ledger,
    Scheme,
    TorqueDrivenEngine,
    run_adaptive,
    torque_driven,
)
from ...cosimulation.schemes import INERTIA
from ...instance import DriveError, Fmu
from .case import CoupledCase
from .monolithic import Course

TOLERANCE = 1e-8
# what is called unstable: the engine off its speed by this share, which no course here comes near to
OFF = 0.9
STABLE, UNSTABLE, REFUSED = "stable", "unstable", "refused"

Stepper = Callable[[EnginePlant, float], None]


@dataclass(frozen=True)
class Trial:
    """What a run gave.

    Attributes:
        word: stable or unstable. speed_error: greatest error of the mean of omega1 over a window, relative
            to the engine's speed. output_error: the same of omega_out, relative to the greatest omega_out.
        energy_error: energy lost on the bond over the work of the engine. cost: see Ledger.cost, for
            each simulated second. step: mean communication step, s. residual: sum of |residual| of the
            bond over the work of the engine.
    """

    case: str
    ratio: float
    scheme: str
    step: float
    word: str
    speed_error: float
    output_error: float
    energy_error: float
    cost: float
    residual: float


def fixed(step: float) -> Stepper:
    """Equal steps, s (a window is made of a whole number of them, or the step of whole windows)."""

    def to(coupled: EnginePlant, end: float) -> None:
        count = max(1, round((end - coupled.ledger.time) / step))
        length = (end - coupled.ledger.time) / count
        for _ in range(count):
            coupled.step(length)

    return to


def adaptive(control: ErrorControl) -> Stepper:
    """Steps driven by the residual; a window's end ends a step."""

    def to(coupled: EnginePlant, end: float) -> None:
        for _ in run_adaptive(coupled, end - coupled.ledger.time, control):
            pass

    return to


class Run(NamedTuple):
    """A run of a case.

    Attributes:
        course: what is not reached is NaN. ledger: of the bond. word: stable or unstable.
        seconds: that it took, without loading the FMU.
    """

    course: Course
    ledger: Ledger
    word: str
    seconds: float


@contextmanager
def coupled_engine(
    case: CoupledCase, scheme: Scheme | None, fmu_path: Path, tolerance: float = TOLERANCE
) -> Iterator[EnginePlant]:
    """Engine and module at the start of a case; without a scheme the module is driven by torque."""
    engine = case.engine()
    start = {"omega1": case.speed, "load_torque": case.load_torque}
    if scheme is None:
        with Fmu(fmu_path, torque_driven(case.parameters, engine.inertia), start, tolerance) as fmu:
            yield TorqueDrivenEngine(fmu, engine)
    else:
        inertia = case.interface.middle if scheme.correction == INERTIA else None
        with Fmu(fmu_path, case.parameters, start, tolerance) as fmu:
            yield CoupledEngine(fmu, engine, scheme, inertia)


def course(
    case: CoupledCase, scheme: Scheme | None, stepper: Stepper, fmu_path: Path, tolerance: float = TOLERANCE
) -> Run:
    """Run a case; without a scheme the module is driven by torque."""
    omega1, omega_out = np.full(case.windows, math.nan), np.full(case.windows, math.nan)
    with coupled_engine(case, scheme, fmu_path, tolerance) as coupled:
        engine, word = coupled.engine, STABLE
        began = time.perf_counter()
        for n in range(case.windows):
            angle = engine.state.angle
            try:
                stepper(coupled, (n + 1) * case.window)
            except (DriveError, OverflowError):
                word = UNSTABLE
                break
            omega1[n] = (engine.state.angle - angle) / case.window
            (omega_out[n],) = coupled.read(("omega_out",))
            if not abs(engine.speed - case.speed) < OFF * case.speed:
                word = UNSTABLE
                break
        seconds = time.perf_counter() - began
        return Run(Course(omega1, omega_out, engine.state.work_in), coupled.ledger, word, seconds)


def trial(
    case: CoupledCase,
    name: str,
    scheme: Scheme | None,
    step: float,
    stepper: Stepper,
    reference: Course,
    fmu_path: Path,
) -> Trial:
    """Run a case and compare it.

    Args:
        case: what is run. name, scheme: of coupling, None for a module driven by torque.
        step: s, for the record. stepper: how it steps.
        reference: course of the same case. fmu_path: of the module.
    """
    return compared(case, name, step, course(case, scheme, stepper, fmu_path), reference)


def compared(case: CoupledCase, name: str, step: float, run: Run, reference: Course) -> Trial:
    """A run against the reference (arguments of trial)."""
    found, ledger, word, _ = run
    stable = word == STABLE
    return Trial(
        case.name,
        case.ratio,
        name,
        ledger.time / ledger.steps if ledger.steps else step,
        word,
        float(np.abs(found.omega1 - reference.omega1).max()) / case.speed if stable else math.nan,
        float(np.abs(found.omega_out - reference.omega_out).max() / np.abs(reference.omega_out).max())
        if stable
        else math.nan,
        ledger.defect / reference.work if stable else math.nan,
        ledger.cost / case.stop_time,
        ledger.residual_magnitude / abs(reference.work) if stable else math.nan,
    )
