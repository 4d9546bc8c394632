"""Plan of the export of a scene as FMUs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..common.errors import SceneError
from ..kernel.codes import ELASTIC
from .run import initial_values
from .schema import Scene

if TYPE_CHECKING:
    from ..export.systems import Plan


def scene_plan(scene: Scene) -> Plan:
    """Plan the export of a scene: the FMUs of its mechanism with their initial values.

    Args:
        scene: The scene.

    Raises:
        SceneError: The scene has elastic freewheels, or its fidelity is 'auto'.
    """
    from ..export.systems import make_plan  # imports the builder of FMUs

    values, inputs = initial_values(scene)
    for name in ("housing_stiffness", "freewheel_stiffness"):
        if values.get("fidelity") == ELASTIC and values.get(name, 0.0) > 0.0:
            raise SceneError(
                f"mechanism.{name} must be 0 for an export (got {values[name]:g}). An elastic mechanism is"
                " exported as a rigid module and a shaft. Neither has freewheel compliance."
            )
    return make_plan(scene.title, values, inputs, scene.run.communication_step, scene.run.stop_time)
