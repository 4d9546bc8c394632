"""The added-mass limit: theory against measurement, on a module that is an inertia and little else.

An engine without a governor gets a step of torque. Where the speeds settle to the common acceleration the
scheme is stable; the limit is found by bisection of Phi/J_E, at communication steps that differ by a factor
of fifty.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from ...cosimulation import SCHEMES, CoupledEngine, Engine, EngineMap, Governor, Scheme, inertia_limit
from ...cosimulation.schemes import INERTIA
from ...drive import Progress
from ...instance import Fmu

# interface inertia, kg.m2: nearly all of it on link 1, so that it does not change with the angle
INTERFACE = 0.1
_PARAMETERS = {"input_inertia": INTERFACE, "imbalance_mass": 1e-9}
_SPEED, _TORQUE = 100.0, 1.0
STEPS = (1e-4, 5e-3)
# beyond it a scheme counts as free of a limit
GREATEST_RATIO = 50.0
_COUNT = 300
_BISECTIONS = 10


# where the inertia that the engine feels is measured
_GENTLE_RATIO = 0.2


@dataclass(frozen=True)
class Limit:
    """Greatest Phi/J_E that is stable; infinite where none is found.

    Attributes:
        scheme: name. theory: from the characteristic polynomial. short, long: as measured at either of STEPS.
        felt: share of the interface inertia that the engine feels in the end, at Phi/J_E = 0.2.
    """

    scheme: str
    theory: float
    short: float
    long: float
    felt: float


def speed_changes(scheme: Scheme, ratio: float, step: float, fmu_path: Path) -> list[float]:
    """Changes of the engine's speed, step by step, after a step of torque; cut off where they are absurd."""
    inertia = INTERFACE / ratio
    still = Governor(0.0, 0.0, 1e9)
    engine = Engine(inertia, EngineMap((0.0,), (1e6,), (1e6,)), still, _SPEED, _SPEED, _TORQUE)
    changes: list[float] = []
    with Fmu(fmu_path, _PARAMETERS, {"omega1": _SPEED, "load_torque": 0.0}, 1e-8) as fmu:
        assumed = INTERFACE if scheme.correction == INERTIA else None
        coupled = CoupledEngine(fmu, engine, scheme, assumed)
        while len(changes) < _COUNT and (not changes or abs(changes[-1]) < 1e3 * _TORQUE / inertia * step):
            before = engine.speed
            coupled.step(step)
            changes.append(engine.speed - before)
    return changes


def is_stable(scheme: Scheme, ratio: float, step: float, fmu_path: Path) -> bool:
    """Whether a disturbance dies out.

    Args:
        scheme: of coupling. ratio: Phi/J_E. step: s. fmu_path: of the module.
    """
    changes = speed_changes(scheme, ratio, step, fmu_path)
    if len(changes) < _COUNT:
        return False
    unrest = [abs(b - a) for a, b in pairwise(changes)]
    return max(unrest[-20:]) < max(*unrest[20:40], 1e-3 * abs(changes[-1]))


def felt_inertia(scheme: Scheme, fmu_path: Path) -> float:
    """Share of the interface inertia that slows the engine down in the end."""
    step = STEPS[0]
    acceleration = speed_changes(scheme, _GENTLE_RATIO, step, fmu_path)[-1] / step
    return (_TORQUE / acceleration - INTERFACE / _GENTLE_RATIO) / INTERFACE


def measured_limit(scheme: Scheme, step: float, fmu_path: Path) -> float:
    """Greatest stable Phi/J_E by bisection (arguments of is_stable)."""
    low, high = 0.05, GREATEST_RATIO
    if is_stable(scheme, high, step, fmu_path):
        return math.inf
    for _ in range(_BISECTIONS):
        middle = math.sqrt(low * high)
        if is_stable(scheme, middle, step, fmu_path):
            low = middle
        else:
            high = middle
    return math.sqrt(low * high)


def limits(fmu_path: Path, progress: Progress | None = None) -> list[Limit]:
    """Limits of all schemes."""
    found = []
    for number, (name, scheme) in enumerate(SCHEMES.items(), 1):
        share = 1.0 if scheme.correction == INERTIA else 0.0
        short, long = (measured_limit(scheme, step, fmu_path) for step in STEPS)
        found.append(Limit(name, inertia_limit(scheme, share), short, long, felt_inertia(scheme, fmu_path)))
        if progress is not None:
            progress(number / len(SCHEMES))
    return found
