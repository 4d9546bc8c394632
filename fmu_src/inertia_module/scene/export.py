"""What of a scene can be exported to other tools: its mechanism and the values at its start."""

from __future__ import annotations

from ..contract.variables import BY_NAME
from ..export.plan import Plan, make_plan
from .errors import SceneError
from .run import start_of
from .schema import Scene

# of a scene that gives none
DEFAULT_TOLERANCE = BY_NAME["tolerance"].start or 1e-6


def scene_plan(scene: Scene) -> Plan:
    """The system of FMUs for the mechanism of a scene.

    Raises:
        SceneError: its fidelity is still to be chosen.
    """
    if scene.chooses_fidelity:
        raise SceneError("mechanism.fidelity must be a fidelity by name for an export, is 'auto'")
    surroundings, values, inputs = start_of(scene)
    step = float(surroundings.dt)
    tolerance = scene.accuracy.tolerance or DEFAULT_TOLERANCE
    return make_plan(scene.title, values, inputs, step, scene.run.stop_time, tolerance)
