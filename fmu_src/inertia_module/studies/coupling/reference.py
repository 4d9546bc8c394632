"""The reference: engine and module in one piece, from sample to sample of the governor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...cosimulation import torque_driven
from ..canonical import Canonical
from ..fourier_inertia import REAL
from ..trajectory import Array
from ..trajectory import Case as OpenCase
from .case import STOP_TIME, WINDOW, WINDOWS, CoupledCase

# that the highest harmonic turns in a step, rad: a sample's new torque may close a contact for a moment
_STEP_ANGLE = 0.5


class Course(NamedTuple):
    """Speeds of a run.

    Attributes:
        omega1: mean over each window, rad/s. omega_out: at the end of each, rad/s. work: of the engine, J.
    """

    omega1: Array
    omega_out: Array
    work: float


def one_piece(case: CoupledCase) -> Course:
    """The case from its start by the second reference, its torque being that of the governor."""
    engine = case.engine()
    governor = engine.governor
    parameters = torque_driven(case.parameters, engine.inertia)
    motion = Canonical(OpenCase(parameters, case.speed, case.load_torque, STOP_TIME))
    samples = round(WINDOW / governor.sample_time)
    integral = work = 0.0
    omega1, omega_out = [], []
    for window in range(WINDOWS):
        began = motion.state.theta1
        for n in range(samples):
            angle, speed = motion.state.theta1, float(motion.state.omega1)
            torque, integral = governor.sample(integral, case.speed, speed, engine.limits.limits(speed))
            motion.push(torque)
            motion.advance(REAL(window * samples + n + 1) * governor.sample_time, _STEP_ANGLE)
            work += torque * float(motion.state.theta1 - angle)
        omega1.append(float(motion.state.theta1 - began) / WINDOW)
        omega_out.append(float(motion.state.omega3))
    return Course(np.array(omega1), np.array(omega_out), work)
