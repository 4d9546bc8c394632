"""Order lines: detection of the main lines of order spectra, and their texts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import signal

if TYPE_CHECKING:
    from .order_result import Orders

Array = NDArray[np.float64]

# window, and its noise bandwidth in 1 / revolutions
WINDOW, BANDWIDTH = "hann", 1.5
# Zero padding factor of spectra, so that lines between two points are visible.
PADDING = 4
# half width of the main lobe of the Hann window, in 1 / revolutions of the window
HALF_LOBE = 2
# Side lobes within twice this width reach this fraction of the line, because speed and amplitude change.
SIDE_LOBE = 0.05
# More distant side lobes reach this multiple of the side lobes of a constant sine.
LEAKAGE_FACTOR = 4.0
# Harmonics of a torque with jumps decrease as 1 / n, so aliases from n = 50 stay below 2 % of the first.
ALIASED_HARMONIC = 50.0
MIN_SHARE = 1.0 / ALIASED_HARMONIC
# minimum ratio of the amplitude along a shifting line to the amplitude along a constant order
SHIFT_FACTOR = 1.1
# relative round-off of a signal (of its maximum or nominal value) and of limits
ROUNDING = 1e-8


class Line(NamedTuple):
    """Order line of a spectrum.

    Attributes:
        order: Order in the window of the maximum, cycles per revolution.
        amplitude: RMS average over the windows, in the unit of the signal.
        greatest: Maximum amplitude of all windows.
        speed: Speed of link 1 in the window of the maximum, rad/s.
        low: Minimum order of a line that shifts with the speed ratio, otherwise the order.
        high: Maximum order of such a line, otherwise the order.
        frequency: Frequency in the window of the maximum, Hz.
        phase: Phase in the window of the maximum, rad, as in Orders.
    """

    order: float
    amplitude: float
    greatest: float
    speed: float
    low: float
    high: float
    frequency: float
    phase: float


class _Candidate(NamedTuple):
    """Peak of a mean spectrum.

    Attributes:
        line: Line of the peak.
        window: Window of its maximum.
        family: Family of its track: 0 for constant orders, 1 to 3 for orders that shift with the pinion
            shaft.
        track: Order in each window.
    """

    line: Line
    window: int
    family: int
    track: Array


def leakage(distance: float) -> float:
    """Return the maximum spectrum of the Hann window near a distance from a sine of amplitude 1.

    Args:
        distance: Distance from the sine, in 1 / length of the window. Within the main lobe the result is 1.
    """
    return 1.0 / (math.pi * distance * (distance**2 - 1.0)) if distance > HALF_LOBE else 1.0


def lines_of(orders: Orders, name: str) -> list[Line]:
    """Return the lines of a signal in descending order of amplitude.

    A line is constant, or shifts with the pinion shaft, alone or added to a revolution of link 1. Each
    peak is evaluated along all of these tracks and belongs to the track with the maximum amplitude. Peaks
    that are leakage of a larger line or of the trend are omitted. Lines below MIN_SHARE of the maximum,
    which can be aliases, are also omitted.

    Args:
        orders: Spectra of the signals.
        name: Name of the signal.
    """
    candidates = _candidates(orders, name)
    candidates.sort(
        key=lambda peak: peak.line.amplitude / (SHIFT_FACTOR if peak.family else 1.0), reverse=True
    )
    lines = list[_Candidate]()
    for peak in candidates:
        if not any(_explains(orders, larger, peak) for larger in lines):
            lines.append(peak)
    in_range = [
        peak.line
        for peak in lines
        if peak.line.order > _resolution(orders) * (1.0 + ROUNDING)
        and peak.line.order <= orders.highest + 0.5 * orders.order[1]
    ]
    maximum = max((line.amplitude for line in in_range), default=0.0)
    return sorted(
        (line for line in in_range if line.amplitude >= MIN_SHARE * maximum),
        key=lambda line: -line.amplitude,
    )


def _resolution(orders: Orders) -> float:
    """Return the minimum distance of separate lines, in orders; lower orders are the trend."""
    return 2 * HALF_LOBE / orders.turns


def _candidates(orders: Orders, name: str) -> list[_Candidate]:
    """Return the peaks of the mean spectrum of a signal along each family of tracks."""
    rows, resolution = orders.waterfall[name], _resolution(orders)
    candidates = list[_Candidate]()
    ratio = orders.ratio[:, None] / (orders.ratio.mean() or 1.0)  # the pinion shaft is at rest in lock-up
    for family, (offset, factor) in enumerate([(0.0, ratio**0), (0.0, ratio), (1.0, ratio), (-1.0, ratio)]):
        tracks = offset + (orders.order - offset) * factor
        pairs = zip(tracks, rows, strict=True)
        heights = [np.interp(track, orders.order, row, right=0.0) for track, row in pairs]
        amplitude = np.sqrt(np.mean(np.square(heights), axis=0))
        places, _ = signal.find_peaks(amplitude, distance=HALF_LOBE * PADDING)
        for track in tracks.T[places]:
            if track.min() >= 0.0 and (family == 0 or np.ptp(track) > 0.5 * resolution):
                candidates.append(_Candidate(*_line(orders, name, track), family, track))
    return candidates


def _explains(orders: Orders, larger: _Candidate, other: _Candidate) -> bool:
    """Return True if a peak is leakage of a larger peak, or part of the same line.

    Args:
        orders: Spectra of the signals.
        larger: Peak with the larger amplitude.
        other: Possible side lobe.
    """
    centre, height = float(larger.track[other.window]), larger.line.amplitude
    if larger.line.order <= _resolution(orders) * (1.0 + ROUNDING):  # the trend is a line of order 0
        centre, height = 0.0, height / min(leakage(centre * orders.turns), 1.0)
    distance = abs(centre - other.line.order)
    if distance <= _resolution(orders):
        return other.family != larger.family or other.line.amplitude <= SIDE_LOBE * height
    return other.line.amplitude <= LEAKAGE_FACTOR * leakage(distance * orders.turns) * height


def _line(orders: Orders, name: str, track: Array) -> tuple[Line, int]:
    """Return the line along a track, from the closest points of the spectrum, and its window.

    Args:
        orders: Spectra of the signals.
        name: Name of the signal.
        track: Order in each window, shape (m,).
    """
    places = np.add(np.rint(track[:, None] / orders.order[1]), [-1, 0, 1]).astype(int)
    neighbours = np.take_along_axis(orders.spectrum[name], places.clip(0, orders.order.size - 1), axis=1)
    peaks = neighbours[np.arange(track.size), np.abs(neighbours).argmax(axis=1)]
    amplitudes = np.abs(peaks if np.ptp(track) > 0.0 else neighbours[:, 1])
    at = int(np.abs(peaks).argmax())
    line = Line(
        order=float(track[at]),
        amplitude=float(np.sqrt(np.mean(amplitudes**2))),
        greatest=float(np.abs(peaks[at])),
        speed=float(orders.speed[at]),
        low=float(track.min()),
        high=float(track.max()),
        frequency=float(orders.rate[at] * track[at]),
        phase=float(np.angle(peaks[at])),
    )
    return line, at
