"""Module and driven shaft as two FMUs against the elastic module in one piece: step and stiffness."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...cosimulation.shaft import SHAFT_SCHEMES, CoupledShaft, ShaftScheme, growth
from ...drive import Progress
from ...instance import DriveError, Fmu
from .case import Array

HUB, DRIVEN, DAMPING, STIFFNESS = 0.02, 0.5, 0.05, 400.0
OMEGA1, LOAD = 100.0, 10.0
STIFFNESSES = (400.0, 4e3, 4e4, 4e5)
STEPS = (2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3)
STOP_TIME, WINDOW = 0.5, 0.01
_TOLERANCE = 1e-9
# the hub turns faster than the input only where the coupling makes energy
_OFF = 10.0 * OMEGA1


@dataclass(frozen=True)
class ShaftTrial:
    """What a run gave: errors relative to the greatest speed of the driven mass.

    Attributes:
        stiffness: N.m/rad. scheme: name. step: s. stable: whether the speeds stay finite and below ten times
            omega1. swing: h sqrt(c/J3). growth: in a step, from theory.
        hub_error, driven_error: rms over the course. bond_error: work that leaves the module and does not
            arrive at the shaft, over that which leaves.
    """

    stiffness: float
    scheme: str
    step: float
    stable: bool
    swing: float
    growth: float
    hub_error: float
    driven_error: float
    bond_error: float


def shaft_parameters(stiffness: float) -> dict[str, float]:
    """The shaft of the reference scene, stiffer; its damping keeps its share of the critical one."""
    return {
        "driven_inertia": DRIVEN,
        "shaft_stiffness": stiffness,
        "shaft_damping": DAMPING * math.sqrt(stiffness / STIFFNESS),
    }


def one_piece(stiffness: float, fmu_path: Path, stop_time: float = STOP_TIME) -> Array:
    """Speeds of hub and driven mass at the end of each window, shape (windows, 2), of the elastic module."""
    parameters = {"fidelity": 3.0, "output_inertia": HUB, **shaft_parameters(stiffness)}
    rows = []
    with Fmu(fmu_path, parameters, {"omega1": OMEGA1, "load_torque": LOAD}, 1e-10) as fmu:
        for _ in range(round(stop_time / WINDOW)):
            fmu.advance(WINDOW)
            rows.append(fmu.read(("omega_hub", "omega_out")))
    return np.array(rows)


def shaft_trial(
    stiffness: float, name: str, scheme: ShaftScheme, step: float, reference: Array, paths: tuple[Path, Path]
) -> ShaftTrial:
    """Run two FMUs and compare them.

    Args:
        stiffness: N.m/rad. name, scheme: of coupling. step: s. reference: of one_piece.
        paths: of the module and of the driven shaft.
    """
    rows = np.full(reference.shape, math.nan)
    start = {"omega1": OMEGA1, "load_torque": 0.0}
    with (
        Fmu(paths[0], {"output_inertia": HUB}, start, _TOLERANCE) as module,
        Fmu(paths[1], shaft_parameters(stiffness), {"load_torque": LOAD}) as shaft,
    ):
        coupled = CoupledShaft(module, shaft, scheme)
        stable = True
        for n in range(len(reference)):
            try:
                for _ in range(round(WINDOW / step)):
                    coupled.step(step)
            except (DriveError, OverflowError):
                stable = False
                break
            rows[n] = module["omega_out"], shaft["omega_out"]
            if not np.abs(rows[n]).max() < _OFF:
                stable = False
                break
        left, arrived = module["energy_out"], shaft["energy_in"]
    scale = np.abs(reference[:, 1]).max()
    errors = np.sqrt(np.mean((rows - reference) ** 2, axis=0)) / scale if stable else (math.nan, math.nan)
    z = step * step * stiffness / HUB
    damping = step * shaft_parameters(stiffness)["shaft_damping"] / HUB
    return ShaftTrial(
        stiffness,
        name,
        step,
        stable,
        math.sqrt(z),
        growth(scheme, z, damping),
        float(errors[0]),
        float(errors[1]),
        (left - arrived) / abs(left) if stable else math.nan,
    )


def shaft_trials(paths: tuple[Path, Path], progress: Progress | None = None) -> list[ShaftTrial]:
    """All schemes, stiffnesses and steps (arguments of shaft_trial)."""
    rows: list[ShaftTrial] = []
    for number, stiffness in enumerate(STIFFNESSES, 1):
        reference = one_piece(stiffness, paths[0])
        rows += [
            shaft_trial(stiffness, name, scheme, step, reference, paths)
            for name, scheme in SHAFT_SCHEMES.items()
            for step in STEPS
        ]
        if progress is not None:
            progress(number / len(STIFFNESSES))
    return rows
