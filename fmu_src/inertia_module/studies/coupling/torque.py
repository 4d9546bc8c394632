"""The module driven by torque, with the engine's rotor in it: errors and cost beside couplings by speed."""

from __future__ import annotations

import dataclasses
import math
import statistics
from dataclasses import dataclass
from pathlib import Path

from ...cosimulation import SCHEMES
from ...drive import Progress
from .case import CASES, CoupledCase
from .monolithic import Course, Monolith
from .trial import STABLE, Run, Trial, compared, course, fixed

TORQUE = "torque-driven"
RATIOS = (0.1, 0.3, 0.5, 1.0, 2.0, 5.0)
# 2 ms does not divide the sample time of the governor (5 ms); 10 and 20 ms are longer
STEPS = (2e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2)
# recommended couplings by speed, which are timed in turn with it
COMPARED = (TORQUE, "implicit ramp", "inertia module first ramp", "mean module first held")
COMPARED_RATIO, COMPARED_STEPS = 0.5, (2e-4, 1e-3, 5e-3)
REPEATS = 9
QUICK_REPEATS = 3


@dataclass(frozen=True)
class TorqueTrial(Trial):
    """A trial, and what Trial does not tell of it.

    Attributes:
        All are NaN where the run is unstable.
        work_error: of the work of the engine, relative to that of the reference.
        milliseconds: that a simulated second takes, median over the repeats.
        cost_ratio: median over the repeats of that time over the time of the module driven by torque with a
            step of one sample of the governor, in the same repeat.
    """

    work_error: float
    milliseconds: float
    cost_ratio: float


Key = tuple[str, float]


def _run(case: CoupledCase, key: Key, fmu_path: Path) -> Run:
    name, step = key
    return course(case, None if name == TORQUE else SCHEMES[name], fixed(step), fmu_path)


def _row(case: CoupledCase, key: Key, runs: dict[Key, list[Run]], reference: Course) -> TorqueTrial:
    base = (TORQUE, case.engine().governor.sample_time)
    mine, basic = ([run.seconds for run in runs[which]] for which in (key, base))
    ratios = [a / b for a, b in zip(mine, basic, strict=True)]
    run = runs[key][0]
    stable = run.word == STABLE
    return TorqueTrial(
        **dataclasses.asdict(compared(case, *key, run, reference)),
        work_error=run.course.work / reference.work - 1.0 if stable else math.nan,
        milliseconds=1e3 * statistics.median(mine) / case.stop_time if stable else math.nan,
        cost_ratio=statistics.median(ratios) if stable else math.nan,
    )


def torque_trials(fmu_path: Path, quick: bool, progress: Progress | None = None) -> list[TorqueTrial]:
    """All steps and ratios by torque, and at one ratio the best couplings by speed.

    Args:
        fmu_path: of the module. quick: only the ratio and the steps that are compared, on one case.
        progress: told how much is done (0 to 1).
    """
    cases = tuple(CASES)[:1] if quick else tuple(CASES)
    ratios = (COMPARED_RATIO,) if quick else RATIOS
    steps = COMPARED_STEPS if quick else STEPS
    repeats = QUICK_REPEATS if quick else REPEATS
    rows: list[TorqueTrial] = []
    for number, name in enumerate(cases):
        for place, ratio in enumerate(ratios):
            case = CASES[name](ratio)
            keys = [(TORQUE, step) for step in steps]
            if ratio == COMPARED_RATIO:
                keys += [(scheme, step) for scheme in COMPARED[1:] for step in COMPARED_STEPS]
            # in turn, so that a disturbance of the machine meets all of them
            rounds = [{key: _run(case, key, fmu_path) for key in keys} for _ in range(repeats)]
            runs = {key: [found[key] for found in rounds] for key in keys}
            reference = Monolith(case).run()
            rows += [_row(case, key, runs, reference) for key in keys]
            if progress is not None:
                progress((number + (place + 1) / len(ratios)) / len(cases))
    return rows
