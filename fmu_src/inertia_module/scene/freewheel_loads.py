"""Operating loads of the freewheels in a run: engagements, torque, slip and impacts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..fmi.simulate import Result
from ..interface.variables import BY_NAME, ENUMERATIONS
from ..kernel.codes import ELASTIC, RIGID
from .quantity import Quantity
from .schema import Scene

FREEWHEELS = ("housing", "output")
# parameter of the stiffness by freewheel
STIFFNESS = {"housing": "housing_stiffness", "output": "freewheel_stiffness"}
# consecutive engagements for the maximum frequency: several, because pulses of a bevel module are irregular
N_CONSECUTIVE = 10
# Minimum overrun between engagements, rad. During shorter overruns the sprags stay engaged, because they wind
# up by 1 to 3 degrees. Jumps of a piecewise constant speed of link 1 cause such overruns.
MIN_OVERRUN = math.radians(0.1)
# name of the note on a run without operating loads of the freewheels
DUTY_NOTE = "freewheel_duty"


def engagements(table: Result, freewheel: str) -> NDArray[np.float64]:
    """Count engagements up to each row, except after overruns shorter than MIN_OVERRUN.

    The angle of an overrun is an upper bound: the sum of maximum slip times step.

    Args:
        table: Record of the run, n rows.
        freewheel: Name in FREEWHEELS.

    Returns:
        Number of engagements, shape (n,).
    """
    increments = np.diff(table[f"{freewheel}_engagements"])
    rows = np.flatnonzero(increments)
    angles = np.cumsum(table[f"{freewheel}_slip_peak"][1:] * np.diff(table.time))[rows]
    increments[rows[np.diff(angles, prepend=0.0) < MIN_OVERRUN * increments[rows]]] = 0.0
    return np.append(0.0, np.cumsum(increments))


def maximum_frequency(time: NDArray[np.float64], count: NDArray[np.float64]) -> float:
    """Return the maximum frequency of N_CONSECUTIVE consecutive events, Hz.

    Args:
        time: Times, s, shape (n,).
        count: Number of events up to each time, shape (n,).
    """
    rows, number = np.flatnonzero(np.diff(count)), int(count[-1])
    group = min(N_CONSECUTIVE, number - 1)
    if group < 1:
        return number / float(np.ptp(time))
    points = np.append(rows[0], rows + 1)
    times = np.interp(np.arange(1, number + 1), count[points], time[points])
    return group / float((times[group:] - times[:-group]).min())


def has_impacts(parameters: Mapping[str, float], freewheel: str) -> bool:
    """Return True if a freewheel locks by impacts, because it is rigid and has an engagement angle.

    Args:
        parameters: Parameters of the module, SI, by name.
        freewheel: Name in FREEWHEELS.
    """
    is_rigid = parameters.get("fidelity", RIGID) != ELASTIC or not parameters.get(STIFFNESS[freewheel], 0.0)
    return is_rigid and parameters.get(f"{freewheel}_engagement_angle", 0.0) > 0.0


def impact_metrics(table: Result, freewheel: str, stiffness: float | None) -> dict[str, Quantity]:
    """Return the maximum impact energy of a freewheel and an estimate of the impact torque.

    A rigid impact has an impulse and no finite torque. It dissipates the energy E = J slip^2 / 2 of the
    relative motion, where J is the reduced inertia. A freewheel of stiffness c absorbs the same energy in a
    half sine of the torque, whose maximum is slip sqrt(c J) = sqrt(2 c E).
    E includes all freewheel losses in the communication step, so it is an upper bound.

    Args:
        table: Record of the run.
        freewheel: Name in FREEWHEELS.
        stiffness: Stiffness of the locked freewheel, N.m/rad; None if it is unknown.
    """
    has_engagement = np.diff(table[f"{freewheel}_engagements"]) > 0.0
    lost = np.diff(table["energy_lost_freewheel"])
    energy = float(np.max(lost[has_engagement], initial=0.0))
    numbers = {f"{freewheel}_impact_energy": Quantity(energy, "J")}
    if stiffness is not None:
        torque = math.sqrt(2.0 * stiffness * max(energy, 0.0))
        numbers[f"{freewheel}_impact_torque"] = Quantity(torque, "N.m")
    return numbers


def impact_warnings(scene: Scene, duty: Mapping[str, Quantity]) -> list[str]:
    """Return warnings about impacts that exceed the torque limit of a freewheel or cannot be checked.

    Args:
        scene: The scene.
        duty: Metrics of freewheel_duty.
    """
    texts, stiffness = [], scene.freewheels.of("stiffness")
    for name, limit in scene.freewheels.of("torque").items():
        if f"{name}_impact_energy" not in duty:
            continue
        if name not in stiffness:
            texts.append(
                f"{name} torque peak excludes impacts, because the impact torque of a rigid freewheel is not"
                f" finite. Set freewheels.{name}.stiffness to compare impacts with the limit of"
                f" {limit:.6g} N.m, or set mechanism.{STIFFNESS[name]} at fidelity elastic"
            )
        elif (torque := duty[f"{name}_impact_torque"].value) > limit:
            texts.append(
                f"{name} impact torque is above the limit of the freewheel, {limit:.6g} N.m: {torque:.6g} N.m"
                f" (estimate with {stiffness[name]:.6g} N.m/rad)"
            )
    return texts


def freewheel_duty(
    table: Result, parameters: Mapping[str, float], stiffness: Mapping[str, float] = MappingProxyType({})
) -> tuple[dict[str, Quantity], dict[str, str]]:
    """Return engagement frequencies, maximum torque, maximum slip and impacts of each freewheel.

    Args:
        table: Record of the run.
        parameters: Parameters of the module, SI, by name.
        stiffness: Stiffness of freewheels that are rigid in the run, N.m/rad, by name.

    Returns:
        Metrics, and notes on missing metrics, by name.
    """
    fidelity, metrics = int(parameters.get("fidelity", RIGID)), dict[str, Quantity]()
    for need in BY_NAME["output_engagements"].needs:
        if fidelity in need.lacking:
            level = ENUMERATIONS["Fidelity"][fidelity][0]
            return {}, {DUTY_NOTE: f"is not available: fidelity {level} {need.reason}"}
    for name, torque in zip(FREEWHEELS, ("housing_torque_peak", "torque_peak"), strict=True):
        if parameters.get(f"{name}_freewheel", 1.0):
            count = engagements(table, name)
            mean = float(count[-1]) / float(np.ptp(table.time))
            metrics[f"{name}_engagement_frequency_mean"] = Quantity(mean, "Hz")
            metrics[f"{name}_engagement_frequency_maximum"] = Quantity(
                maximum_frequency(table.time, count), "Hz"
            )
            metrics[f"{name}_torque_peak"] = Quantity(float(table[torque].max()), "N.m")
            metrics[f"{name}_slip_peak"] = Quantity(float(table[f"{name}_slip_peak"].max()), "rad/s")
            if has_impacts(parameters, name):
                metrics |= impact_metrics(table, name, stiffness.get(name))
    return metrics, {}
