"""Torque converter chart of a scene or of parameters."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..analysis.converter_chart import NOMINAL_SPEED, TorqueConverterChart, compute_chart
from ..common.deprecated import renamed_arguments
from .reading import as_scene
from .schema import Scene


@renamed_arguments(parameters="scene")
def torque_converter_chart(
    scene: Scene | Path | str | Mapping[str, float | str],
    omega1: float = NOMINAL_SPEED,
    engagements: bool = False,
) -> TorqueConverterChart:
    """Compute the torque converter chart of a mechanism.

    Args:
        scene: Scene, path of its file, or parameters of the mechanism by name that differ from the defaults.
        omega1: Input speed, rad/s, not 0. Without losses the chart is valid for all speeds with this sign;
            backward rotation gives another torque.
        engagements: True to count the engagements of the freewheels; without losses this is the most
            expensive part.

    Raises:
        SceneError: The scene is invalid.
        ParameterError: The parameters are invalid, or there is no mean torque because a freewheel is missing.
    """
    parameters = scene if isinstance(scene, Mapping) else as_scene(scene).parameters()
    return compute_chart(parameters, omega1, engagements)
