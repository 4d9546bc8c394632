"""How far a trajectory is from the reference, by the measures of the study."""

from __future__ import annotations

import math

import numpy as np

from ..kernel.codes import DRIVING, FREE, RIGID
from ..kernel.layout import imbalance_in_fixed_frame
from ..kernel.links import accelerations
from ..module import Module
from ..scene.mechanism import at_fidelity
from .reference import Reference
from .trajectory import Array, Case, Trajectory

# measure: what it is, unit ("" where it is relative)
MEASURES: dict[str, tuple[str, str]] = {
    "omega_out_final": ("output speed at the end, relative", ""),
    "omega_out_worst": ("output speed, worst, relative to the largest", ""),
    "torque_mean": ("mean output torque over the run, relative", ""),
    "impulse": ("impulse of the output torque in a pulse, worst, relative to the largest", ""),
    "acceleration": ("acceleration of the imbalance, worst, relative to the largest", ""),
    "event_time": ("time of a switch of the freewheels, worst", "s"),
    "energy": ("residual of the energy audit, relative to the energy in", ""),
}
# an interval belongs to a pulse where its impulse is more than this of the largest
_PULSE = 1e-9


def impulse(case: Case, trajectory: Trajectory) -> Array:
    """Impulse of the output torque from the start up to each sample, N.m.s, shape (points + 1,)."""
    if trajectory.impulse is not None:
        return trajectory.impulse
    gained = trajectory.omega_out - trajectory.omega_out[0]
    total: Array = case.parameter("output_inertia") * gained + case.load_torque * trajectory.time
    return total


def pulses(impulses: Array) -> list[tuple[int, int]]:
    """First and last sample of each pulse in impulses up to each sample, shape (points + 1,)."""
    driving = np.diff(impulses) > _PULSE * np.abs(np.diff(impulses)).max(initial=0.0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], driving, [False]]).astype(int)))
    return [(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def acceleration(case: Case, trajectory: Trajectory, modes: Array) -> Array:
    """Acceleration of the imbalance at the sampled states, m/s^2, shape (points + 1,).

    Args:
        modes: contact modes of the reference, so that a switch a little early or late is told by
            event_time alone, and not by which sample it falls on.
    """
    if trajectory.acceleration is not None:
        return trajectory.acceleration
    d = Module("plain").start(**at_fidelity(case.parameters, RIGID)).derived
    k, omega1, found = d.k, case.omega1, []
    for q, omega2, mode in zip(trajectory.drive_angle, trajectory.omega2, modes, strict=True):
        carried = (d.J3, case.load_torque) if mode == DRIVING else (0.0, 0.0)
        held = mode not in (DRIVING, FREE)
        _, alpha2, _ = accelerations(d, q, omega1, omega2, 0.0, held, *carried)  # type: ignore[no-untyped-call]
        place = (d, q, 0.0, omega1, 0.0, k * (omega1 - omega2), -k * alpha2)
        found.append(np.linalg.norm(imbalance_in_fixed_frame(*place)[6:]))  # type: ignore[no-untyped-call]
    return np.array(found)


def _worst(values: Array, exact: Array) -> float:
    """Largest difference relative to the largest exact value, NaN where there is nothing to compare."""
    scale = float(np.abs(exact).max())
    return float(np.abs(values - exact).max()) / scale if scale > 0.0 else math.nan


def _mean_error(case: Case, trajectory: Trajectory, reference: Reference) -> float:
    exact = impulse(case, reference.trajectory)[-1]
    return abs(float(impulse(case, trajectory)[-1] / exact - 1.0)) if exact else math.nan


def _impulse_error(case: Case, trajectory: Trajectory, reference: Reference) -> float:
    exact = impulse(case, reference.trajectory)
    found = pulses(exact)
    if not found or np.isnan(trajectory.drive_angle).any():
        return math.nan
    edges = np.array(found)
    values = impulse(case, trajectory)
    return _worst(values[edges[:, 1]] - values[edges[:, 0]], exact[edges[:, 1]] - exact[edges[:, 0]])


def _acceleration_error(trajectory: Trajectory, reference: Reference) -> float:
    if np.isnan(trajectory.drive_angle).any():
        return math.nan
    ours, exact = (
        acceleration(reference.case, found, reference.modes) for found in (trajectory, reference.trajectory)
    )
    return _worst(ours, exact)


def _event_error(trajectory: Trajectory, reference: Reference) -> float:
    ours, exact = trajectory.switches, reference.trajectory.switches
    if ours is None or exact is None or ours.size != exact.size or not exact.size:
        return math.nan
    return float(np.abs(ours - exact).max())


def _energy_error(trajectory: Trajectory, reference: Reference) -> float:
    if trajectory.energy_residual is None or not reference.trajectory.energy_in:
        return math.nan
    return abs(trajectory.energy_residual / reference.trajectory.energy_in)


def errors(trajectory: Trajectory, reference: Reference) -> dict[str, float]:
    """Errors of a trajectory by the names of MEASURES; NaN where it has nothing to tell.

    Raises:
        ValueError: it has other sampling times than the reference.
    """
    case, exact = reference.case, reference.trajectory
    if trajectory.omega_out.shape != exact.omega_out.shape:
        raise ValueError(
            f"{trajectory.omega_out.size} samples are refused: allowed are those of the reference,"
            f" {exact.omega_out.size}"
        )
    final = exact.omega_out[-1]
    return {
        "omega_out_final": abs(float(trajectory.omega_out[-1] / final - 1.0)) if final else math.nan,
        "omega_out_worst": _worst(trajectory.omega_out, exact.omega_out),
        "torque_mean": _mean_error(case, trajectory, reference),
        "impulse": _impulse_error(case, trajectory, reference),
        "acceleration": _acceleration_error(trajectory, reference),
        "event_time": _event_error(trajectory, reference),
        "energy": _energy_error(trajectory, reference),
    }
