"""Order spectra of recorded signals, resampled in equal steps of an angle.

Sources: K. R. Fyfe and E. D. S. Munck, Analysis of computed order tracking, Mechanical Systems and Signal
Processing 11 (1997) 187-205; averages over overlapping windows: P. D. Welch, IEEE Transactions on Audio and
Electroacoustics 15 (1967) 70-73; sampling and leakage: A. Brandt, Noise and Vibration Analysis, Wiley 2011,
chapters 3, 9 and 12.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import signal
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline

from ..common.errors import ParameterError, must_be
from ..fmi.simulate import Result
from ..interface.variables import BY_NAME
from .order_lines import HALF_LOBE, PADDING, ROUNDING, WINDOW, Array
from .order_result import BASES, LINK1, Orders

# recorded points per cycle of the maximum order (Nyquist minimum: 2)
POINTS_PER_CYCLE = 2.56
# Resampling uses the sampling at the minimum speed, because coarser sampling would cause aliases. This is the
# maximum ratio to the sampling at the maximum speed.
MAX_REFINEMENT = 10.0
# default maximum and absolute minimum of the revolutions in a window
TURNS, MIN_TURNS = 32.0, 4.0


def spectra(
    table: Result,
    revolutions: Array,
    names: Sequence[str],
    of: str = LINK1,
    highest: float | None = None,
    turns: float | None = None,
    drive: Array | None = None,
) -> Orders:
    """Compute the order spectra of recorded signals.

    Args:
        table: Record of the signals and input_speed, r rows.
        revolutions: Revolutions up to each row, increasing, shape (r,).
        names: Names of the signals.
        of: Reference angle of revolutions, LINK1 or DRIVE.
        highest: Maximum order; None for the maximum that the rows resolve.
        turns: Revolutions in a window; None for a quarter of all revolutions, between MIN_TURNS and TURNS.
            Windows overlap by half.
        drive: Revolutions of the pinion shaft up to each row, for lines that shift with it.

    Raises:
        ParameterError: revolutions do not increase or are too few for a window, or the rows are too
            far apart.
    """
    steps, all_turns = np.diff(revolutions), float(revolutions[-1] - revolutions[0])
    constant_rows = np.flatnonzero(steps <= 0.0)
    if constant_rows.size:
        at = f"constant or decreasing at {table.time[constant_rows[0]]:g} s"
        raise ParameterError(
            f"{must_be('the angle that orders refer to', 'increasing', at)}; choose another time range"
        )
    resolved = 1.0 / (POINTS_PER_CYCLE * float(steps.max()))
    if highest is not None and not 0.0 < highest <= resolved * (1.0 + ROUNDING):
        demand = must_be("highest (maximum order)", f"above 0 and at most {resolved:.4g}", f"{highest:g}")
        raise ParameterError(f"{demand}; a shorter run.communication_step allows higher orders")
    limit = resolved if highest is None else highest
    per_window = min(TURNS, max(MIN_TURNS, all_turns / 4.0)) if turns is None else turns
    if not MIN_TURNS <= per_window <= all_turns:
        allowed = f"at least {MIN_TURNS:g} and at most {all_turns:.4g} (1 turn = 1 {BASES[of]})"
        raise ParameterError(must_be("turns (window length)", allowed, f"{per_window:.4g}"))
    samples = math.ceil(1.0 / max(float(steps.min()), float(steps.max()) / MAX_REFINEMENT))
    size = round(per_window * samples)
    angle = np.arange(math.floor(all_turns * samples) + 1) / samples
    options: dict[str, Any] = {"fs": samples, "window": WINDOW, "nperseg": size, "noverlap": size // 2}
    options |= {"nfft": PADDING * size, "detrend": "linear", "scaling": "spectrum"}
    spectrum = {}
    for name in names:
        values = CubicSpline(revolutions - revolutions[0], table[name])(angle)
        order, middle, half_amplitudes = signal.spectrogram(values, mode="complex", **options)
        order = order[order <= limit + HALF_LOBE / per_window]
        edges = middle[:, None] + 0.5 * size / samples * np.array([-1.0, 0.0, 1.0])
        # Half of the amplitude of a line is at its negative order.
        # Phases refer to angle 0, not to the start of the window.
        amplitudes = np.where(order > 0.0, 2.0, math.sqrt(2.0)) * half_amplitudes.T[:, : order.size]
        amplitudes *= np.exp(-2j * math.pi * (revolutions[0] + edges[:, :1]) * order)
        amplitudes[np.abs(amplitudes) < rounding(table, name)] = 0.0
        spectrum[name] = amplitudes
    begin, time, end = np.interp(edges, revolutions - revolutions[0], table.time).T
    link1_angle = cumulative_trapezoid(table["input_speed"], table.time, initial=0.0)
    angles = np.interp([begin, end], table.time, link1_angle)
    pinion_revolutions = np.interp([begin, end], table.time, revolutions if drive is None else drive)
    return Orders(
        of=of,
        turns=per_window,
        order=order,
        time=time,
        speed=(angles[1] - angles[0]) / (end - begin),
        rate=size / samples / (end - begin),
        ratio=(pinion_revolutions[1] - pinion_revolutions[0]) * samples / size,
        spectrum=spectrum,
        units={name: table.units.get(name, "") for name in names},
        highest=limit,
        step=float(np.diff(table.time).max()),
    )


def rounding(table: Result, name: str) -> float:
    """Return the amplitude of round-off of a signal, in its unit.

    Args:
        table: Record of the signal.
        name: Name of the signal.
    """
    nominal = BY_NAME[name].nominal if name in BY_NAME else None
    return ROUNDING * max(float(np.abs(table[name]).max()), nominal or 0.0)
