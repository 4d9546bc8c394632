"""How far a trajectory is from the reference, by the measures of the study."""

from __future__ import annotations

import math

import numpy as np

from inertia_module.kernel.codes import DRIVING, FREE, RIGID
from inertia_module.kernel.layout import imbalance_in_fixed_frame
from inertia_module.kernel.links import accelerations
from inertia_module.memory.instances import Module
from inertia_module.scene.mechanism import at_fidelity

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
        modes: contact modes of the reference, so that a switch a little early or late counts in
            event_time alone, and not by which sample it falls on.
    """
    if trajectory.acceleration is not None:
        return trajectory.acceleration
    d = Module("plain").start(**at_fidelity(case.parameters, RIGID)).derived
    k, omega1, found = d.k, case.omega1, []
    for q, omega2, mode in zip(trajectory.drive_angle, trajectory.omega2, modes, strict=True):
        carried = (d.J3, d.b3, case.load_torque) if mode == DRIVING else (0.0, 0.0, 0.0)
        held = mode not in (DRIVING, FREE)
        _, alpha2, _ = accelerations(d, q, omega1, omega2, 0.0, held, *carried)  # type: ignore[no-untyped-call]
        place = (d, q, 0.0, omega1, 0.0, k * (omega1 - omega2), -k * alpha2, 0.0)
        found.append(np.linalg.norm(imbalance_in_fixed_frame(*place)[6:]))  # type: ignore[no-untyped-call]
    return np.array(found)


def _worst(values: Array, exact: Array) -> float:
    """Largest difference relative to the largest exact value, NaN where there is nothing to compare."""
    scale = float(np.abs(exact).max(initial=0.0))
    return float(np.abs(values - exact).max()) / scale if scale > 0.0 else math.nan


def _relative(value: float, exact: float | None) -> float:
    """Difference of a value from the exact one, relative to it; NaN where that is zero or not known."""
    return abs(value / exact - 1.0) if exact else math.nan


def errors(trajectory: Trajectory, reference: Reference) -> dict[str, float]:
    """Errors of a trajectory by the names of MEASURES; NaN where nothing is known.

    Raises:
        ValueError: it has other sampling times than the reference.
    """
    case, exact = reference.case, reference.trajectory
    if trajectory.omega_out.shape != exact.omega_out.shape:
        raise ValueError(
            f"a trajectory must have the samples of the reference, {exact.omega_out.size},"
            f" has {trajectory.omega_out.size}"
        )
    ours, theirs = impulse(case, trajectory), impulse(case, exact)
    found = dict.fromkeys(MEASURES, math.nan)
    found["omega_out_final"] = _relative(trajectory.omega_out[-1], exact.omega_out[-1])
    found["omega_out_worst"] = _worst(trajectory.omega_out, exact.omega_out)
    found["torque_mean"] = _relative(ours[-1], theirs[-1])
    if not np.isnan(trajectory.drive_angle).any():
        edges = np.array(pulses(theirs), dtype=int).reshape(-1, 2)
        found["impulse"] = _worst(*(values[edges[:, 1]] - values[edges[:, 0]] for values in (ours, theirs)))
        found["acceleration"] = _worst(
            *(acceleration(case, one, reference.modes) for one in (trajectory, exact))
        )
    switches, expected = trajectory.switches, exact.switches
    if switches is not None and expected is not None and switches.size == expected.size > 0:
        found["event_time"] = np.abs(switches - expected).max()
    if trajectory.energy_residual is not None and exact.energy_in:
        found["energy"] = abs(trajectory.energy_residual / exact.energy_in)
    return {name: float(value) for name, value in found.items()}
