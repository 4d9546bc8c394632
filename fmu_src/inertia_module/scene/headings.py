"""Printed headings of the metrics of a summary."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ..interface.variables import LOSSES, LOST_TO

# heading of a metric by its name; other metrics are printed by their name with spaces instead of underscores
HEADINGS: Mapping[str, str] = {
    "omega1_maximum": "maximum input speed",
    "omega_out_maximum": "maximum output speed",
    "omega_out_final": "final output speed",
    "input_torque_mean": "mean input torque",
    "output_torque_mean": "mean output torque",
    "output_torque_mean_maximum": "maximum step-mean output torque",
    "energy_in": "input energy",
    "energy_out": "output energy",
    "energy_stored_gain": "change in stored energy",
    "energy_lost": "losses",
    **{name: f"{name.removeprefix(LOST_TO)} losses" for name in LOSSES},
    "energy_residual_relative": "relative energy residual",
    "energy_rolling": "energy to rolling resistance",
    "energy_drag": "energy to air drag",
    "energy_slope": "energy to slope",
    "energy_brake": "energy to brake",
    "vehicle_speed_maximum": "maximum vehicle speed",
    "tracking_error_rms": "RMS tracking error",
    "tracking_error_maximum": "maximum tracking error",
    "share_out_of_tolerance": "fraction of time out of tolerance",
    "housing_slip_peak": "housing overrunning speed peak",
    "output_slip_peak": "output overrunning speed peak",
    "rhs_evaluations": "right-hand-side evaluations",
    "wall_time": "wall-clock time",
}


def heading(name: str) -> str:
    """Return the printed heading of a metric.

    Args:
        name: Name of the metric, such as omega_out_final for "final output speed".
    """
    speed = re.fullmatch(r"time_to_(.+)_kmh", name)
    return f"time to {speed[1]} km/h" if speed else HEADINGS.get(name, name.replace("_", " "))
