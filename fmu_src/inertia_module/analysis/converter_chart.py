"""Torque converter chart of a mechanism: torque, efficiency and ripple over the speed ratio (as SAE J643).

Without losses all torques scale with the square of the input speed: one chart, made from the map of fidelity
`averaged`, is valid for all speeds. With losses a chart is valid for one input speed, and a map contains
several speeds. Then the charts contain means over whole periods of the pinion shaft, including all losses.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..common.deprecated import renamed_names
from ..common.equality import ByContent
from ..fmi.results import write_columns
from ..interface.variables import BY_NAME
from ..model import Module
from .steady_state import Array, SteadyMachine, SteadyMeans

NOMINAL_SPEED: float = BY_NAME["omega1"].nominal or 1.0
# number of intervals of the speed ratio in the chart of a mechanism without losses
INTERVALS = 200
# speed ratios of the chart of a mechanism with losses
RATIOS = np.linspace(0.0, 0.98, 29)

ENGAGEMENTS = ("housing_engagements", "output_engagements")
TORQUES = ("output_torque", "input_torque", "ripple", "peak", "lock_up_torque")


@dataclass(frozen=True, eq=False, repr=False)
class TorqueConverterChart(ByContent):
    """Means over the speed ratio, shape (n,) each; torques are divided by omega1^2.

    Attributes:
        speed_ratio: output speed relative to input speed, magnitudes, increasing from 0.
        output_torque: mean torque on the load, N m s^2.
        input_torque: mean of M1, N m s^2.
        efficiency: output power relative to input power.
        link2_ratio: mean speed of link 2 relative to link 1, magnitudes.
        ripple: RMS of the output freewheel torque about its mean, N m s^2.
        peak: maximum output freewheel torque, N m s^2.
        lock_up_torque: maximum load torque in lock-up at speed ratio 1, without stiction, N m s^2, the same
            in all rows; 0 without lock-up.
        housing_engagements: engagements of the housing freewheel per revolution of link 1, or None; in
            lock-up the number at a slightly lower speed ratio.
        output_engagements: engagements of the output freewheel, like housing_engagements.
    """

    speed_ratio: Array
    output_torque: Array
    input_torque: Array
    efficiency: Array
    link2_ratio: Array
    ripple: Array
    peak: Array
    lock_up_torque: Array
    housing_engagements: Array | None = None
    output_engagements: Array | None = None

    def __repr__(self) -> str:
        ratios = f"{self.speed_ratio.size} speed ratios 0…{self.speed_ratio[-1]:.3g}"
        return f"TorqueConverterChart({ratios}, stall torque {self.stall_torque:.4g} N m s²)"

    @property
    def stall_torque(self) -> float:
        """Mean output torque at stall divided by omega1^2, N m s^2."""
        return float(self.output_torque[0])

    @property
    def lossless(self) -> bool:
        """True if the efficiency is 1 at all speed ratios."""
        return bool((self.efficiency == 1.0).all())

    @property
    def end_ratio(self) -> float:
        """Maximum speed ratio with torque; 1 with lock-up, which can be beyond the last row."""
        return 1.0 if self.lock_up_torque[0] > 0.0 else float(self.speed_ratio[-1])

    def summary(
        self, omega1: float | None = None, indexing: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Return characteristic numbers of the chart by name, for the comparison of mechanisms.

        Args:
            omega1: input speed, rad/s; if None, torques are divided by omega1^2 and engagements are per
                revolution.
            indexing: maximum indexing frequency, Hz, by freewheel (housing, output). It adds indexing_speed,
                the maximum input speed, rad/s, at which no freewheel exceeds its frequency at any ratio.
        """
        numbers = {
            "stall_torque": self.stall_torque,
            "least_torque": float(self.output_torque.min()),
            "least_torque_ratio": float(self.speed_ratio[np.argmin(self.output_torque)]),
            "end_ratio": self.end_ratio,
            "lock_up_torque": float(self.lock_up_torque[0]),
            "efficiency_maximum": float(self.efficiency.max()),
            "efficiency_maximum_ratio": float(self.speed_ratio[np.argmax(self.efficiency)]),
            "stall_peak_over_mean": float(self.peak[0] / self.stall_torque) if self.stall_torque else 0.0,
        }
        if self.output_engagements is not None:
            maxima = {name: float(getattr(self, name).max()) for name in ENGAGEMENTS}
            numbers |= {f"{name}_maximum": value for name, value in maxima.items()}
            shares = [maxima[f"{name}_engagements"] / limit for name, limit in (indexing or {}).items()]
            numbers |= {"indexing_speed": math.tau / max(shares)} if any(shares) else {}
        return {name: _scale(name, omega1)[0] * value for name, value in numbers.items()}

    def units(self, omega1: float | None = None) -> dict[str, str]:
        """Return the units of the numbers in summary by name, "" for ratios.

        Args:
            omega1: input speed, rad/s, or None, as in summary.
        """
        return {name: _scale(name, omega1)[1] for name in (*self.summary(), "indexing_speed")}

    def beyond_drive(self, omega1: float, torque: float) -> str:
        """Describe the speed ratios at which the mechanism requires more torque than its drive provides.

        Args:
            omega1: speed of link 1, rad/s.
            torque: maximum torque of the drive at this speed, N.m.

        Returns:
            A sentence, or "" if the torque is sufficient at all speed ratios.
        """
        required = self.input_torque * omega1**2
        is_overloaded = required > torque * (1.0 + 1e-9)
        if not is_overloaded.any():
            return ""
        first = float(self.speed_ratio[np.argmax(is_overloaded)])
        return (
            f"the drive provides {torque:.4g} N·m, but the mechanism requires up to {required.max():.4g}"
            f" N·m at {abs(omega1):.4g} rad/s: it cannot hold this speed from a speed ratio of {first:.2g}"
        )

    def save(self, path: Path) -> Path:
        """Write the chart as CSV atomically, with the digits that give the same doubles; return the path.

        Args:
            path: path of the file.
        """
        columns = {name: values for name, values in vars(self).items() if values is not None}
        units = {**dict.fromkeys(TORQUES, "N.m.s2"), **dict.fromkeys(ENGAGEMENTS, "1/rev")}
        return write_columns(path, columns, units)


def _scale(name: str, omega1: float | None) -> tuple[float, str]:
    """Return factor and unit of a number of the summary at an input speed, rad/s, or without speed (None)."""
    if name.endswith("_torque"):
        return (1.0, "N.m.s2") if omega1 is None else (omega1**2, "N.m")
    if name.endswith("_engagements_maximum"):
        return (1.0, "1/rev") if omega1 is None else (abs(omega1) / math.tau, "Hz")
    return 1.0, "rad/s" if name == "indexing_speed" else ""


def means_over_ratios(machine: SteadyMachine, omega1: float) -> dict[str, Array]:
    """Return the fields of SteadyMeans by name, shape (n,) each, at the speed ratios RATIOS.

    Args:
        machine: the mechanism.
        omega1: input speed, rad/s, not 0.
    """
    rows = np.array([machine.at(omega1, ratio) for ratio in RATIOS])
    return dict(zip(SteadyMeans._fields, rows.T, strict=True))


def compute_chart(
    parameters: Mapping[str, float | str],
    omega1: float = NOMINAL_SPEED,
    engagements: bool = False,
) -> TorqueConverterChart:
    """Compute the torque converter chart of a mechanism.

    Args:
        parameters: parameters of the module by name that differ from the defaults, as in Module.set.
        omega1: input speed, rad/s, not 0. Without losses the chart is valid for all speeds with this sign;
            backward rotation gives another torque.
        engagements: True to count the engagements of the freewheels; without losses this is the most
            expensive part.

    Raises:
        ParameterError: the parameters are invalid, or there is no mean torque because a freewheel is missing.
    """
    machine = SteadyMachine(parameters)
    machine.check_freewheels()
    if machine.ideal:
        chart = _chart_from_map(parameters, omega1 < 0.0)
        means = means_over_ratios(machine, omega1) if engagements else {}
        columns = {name: np.interp(chart.speed_ratio, RATIOS, means[name]) for name in ENGAGEMENTS if means}
        return replace(chart, **columns)
    # a chart with losses ends at the last ratio with a positive output torque
    means = means_over_ratios(machine, omega1)
    number = max(np.flatnonzero(means["output_torque"] > 0.0), default=0) + 1
    locks = omega1 > 0.0 and number == RATIOS.size
    means["lock_up_torque"] = np.full(RATIOS.size, machine.lock_up_torque(omega1) if locks else 0.0)
    columns = {name: means[name][:number] / omega1**2 for name in TORQUES}
    columns |= {name: means[name][:number] for name in ("efficiency", "link2_ratio", *ENGAGEMENTS)}
    return TorqueConverterChart(RATIOS[:number], **columns)


def _chart_from_map(parameters: Mapping[str, float | str], backward: bool) -> TorqueConverterChart:
    """Return the chart of a mechanism without losses, made from the map of fidelity averaged."""
    # the map contains torques over speeds; it does not depend on the kind of drive
    modes = {**parameters, "fidelity": "averaged", "drive": "speed", "load_torque": 0.0}
    modes |= {"omega1": -1.0 if backward else 1.0, "omega2_start": 0.0, "omega_out_start": 0.0}
    d = Module().start(**modes).derived
    side = d.backward if backward else d.forward
    ratios = np.linspace(0.0, side.end, INTERVALS + 1)
    # at the last ratio the shaft overruns
    modules = [Module().start(**modes | {"omega_out_start": float(ratio)}) for ratio in ratios[:-1]]
    names = ("output_torque", "omega2", "torque_ripple", "torque_peak")
    columns = np.array([module.read(names) for module in modules])
    torque, link2, ripple, peak = np.vstack([columns, columns[-1]]).T
    lock = d.map_lock if side.locks else 0.0
    ones = np.ones(ratios.size)
    return TorqueConverterChart(ratios, torque, ratios * torque, ones, link2, ripple, peak, lock * ones)


__getattr__ = renamed_names(
    __name__,
    torque_converter_chart="compute_chart",
    steady_map="analysis.chart_files:steady_map",
    save_map="analysis.chart_files:save_map",
    converter_table="analysis.chart_files:converter_table",
    save_converter="analysis.chart_files:save_converter",
)
