"""Errors of the recorded outputs of a scene: means, and RMS of what pulses, over windows of time.

Outputs of a long run under control are compared by window and not by instant: the loop keeps speeds and
torques where they belong, but nothing keeps the phase of the pulses, which drifts between any two runs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..harness.results import TIME
from ..harness.simulate import Result
from .levels import NOT_MODELLED

Array = NDArray[np.float64]

_PULSING = frozenset(NOT_MODELLED[1])
# relative to the energy in, for they are small or zero by themselves
_ENERGIES = ("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual")
# a matter of cost, not of accuracy
NOT_COMPARED = ("rhs_evaluations",)


def window_means(values: Array, rows: int) -> Array:
    """Means over windows of so many rows; what is left over belongs to the last window."""
    count = max(values.size // rows, 1)
    edges = np.arange(count) * rows
    sizes = np.diff(np.append(edges, values.size))
    means: Array = np.add.reduceat(values, edges) / sizes
    return means


def _features(record: Result, name: str, window: float) -> list[Array]:
    """Window means and, of what pulses, window RMS; the start itself is left out: it is no step."""
    values = record[name][1:]
    rows = max(round(window / float(record.time[1] - record.time[0])), 1)
    means = window_means(values, rows)
    return [means, np.sqrt(window_means(values**2, rows))] if name in _PULSING else [means]


def window_errors(record: Result, exact: Result, window: float, fidelity: int) -> Mapping[str, float]:
    """Error of each recorded output, NaN where the fidelity does not model it.

    Each is the largest difference over the windows, relative to the largest magnitude of the output in
    the reference; energies relative to the largest energy in.

    Args:
        record, exact: of the run and of the reference, over the same time. window: s.
        fidelity: of the run.
    """
    largest_energy = float(np.abs(exact["energy_in"]).max())
    errors: dict[str, float] = {}
    for name in exact.names:
        if name == TIME:
            continue
        if name in NOT_COMPARED:
            errors[name] = 0.0
            continue
        if name in NOT_MODELLED[fidelity]:
            errors[name] = math.nan
            continue
        pairs = list(zip(_features(record, name, window), _features(exact, name, window), strict=True))
        difference = max(float(np.abs(ours - theirs).max()) for ours, theirs in pairs)
        scale = float(np.abs(exact[name]).max())
        if name in _ENERGIES:
            scale = largest_energy
        errors[name] = 0.0 if difference == 0.0 else difference / scale if scale > 0.0 else math.inf
    return errors
