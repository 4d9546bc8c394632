"""Export of a scene to other tools: its mechanism and the values at its start."""

from __future__ import annotations

from ..contract.variables import BY_NAME
from ..export.plan import Plan, make_plan
from ..kernel.codes import ELASTIC
from .errors import SceneError
from .run import start_of
from .schema import Scene

# of a scene that gives none
DEFAULT_TOLERANCE = BY_NAME["tolerance"].start or 1e-6


def scene_plan(scene: Scene) -> Plan:
    """The system of FMUs for the mechanism of a scene.

    Raises:
        SceneError: its fidelity is still to be chosen, or its freewheels wind up.
    """
    if scene.chooses_fidelity:
        raise SceneError("mechanism.fidelity must be a fidelity by name for an export, is 'auto'")
    surroundings, values, inputs = start_of(scene)
    for name in ("housing_stiffness", "freewheel_stiffness"):
        if values.get("fidelity") == ELASTIC and values.get(name, 0.0) > 0.0:
            raise SceneError(
                f"mechanism.{name} must be 0 for an export, is {values[name]:g}: an elastic mechanism becomes"
                " a rigid module and a shaft, and neither has freewheels that wind up"
            )
    step = float(surroundings.dt)
    tolerance = scene.accuracy.tolerance or DEFAULT_TOLERANCE
    return make_plan(scene.title, values, inputs, step, scene.run.stop_time, tolerance)
