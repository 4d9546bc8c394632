"""The reference: engine and module in one piece, from sample to sample of the governor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inertia_module.cosimulation import torque_driven

from ..reference.cases import OMEGA1, THETA1
from ..reference.geometry import Array
from ..reference.motion import Reference
from .case import WINDOW, WINDOWS, CoupledCase


class Course(NamedTuple):
    """Speeds of a run.

    Attributes:
        omega1: mean over each window, rad/s. omega_out: at the end of each, rad/s. work: of the engine, J.
    """

    omega1: Array
    omega_out: Array
    work: float


def one_piece(case: CoupledCase) -> Course:
    """The case from its start by the independent reference, its torque being that of the governor."""
    engine = case.engine()
    governor = engine.governor
    motion = Reference(torque_driven(case.parameters, engine.inertia), case.speed, case.load_torque)
    samples = round(WINDOW / governor.sample_time)
    integral = work = 0.0
    omega1, omega_out = [], []
    for window in range(WINDOWS):
        began = motion.state[THETA1]
        for n in range(samples):
            angle, speed = motion.state[THETA1], motion.state[OMEGA1]
            torque, integral = governor.sample(integral, case.speed, speed, engine.limits.limits(speed))
            motion.give(torque, case.load_torque)
            motion.advance((window * samples + n + 1) * governor.sample_time)
            work += torque * (motion.state[THETA1] - angle)
        omega1.append((motion.state[THETA1] - began) / WINDOW)
        omega_out.append(motion.omega_out)
    return Course(np.array(omega1), np.array(omega_out), work)
