"""Scene files: mechanism, drive, load, accuracy and outputs of a simulation."""

from ..common.errors import SceneError
from .chart import torque_converter_chart
from .reading import load_any_scene, load_scene
from .result import SceneResult
from .run import run_scene
from .schema import Scene
from .shaft import ShaftScene
from .shaft_run import run_shaft_scene
from .simulation import simulate

__all__ = [
    "Scene",
    "SceneError",
    "SceneResult",
    "ShaftScene",
    "load_any_scene",
    "load_scene",
    "run_scene",
    "run_shaft_scene",
    "simulate",
    "torque_converter_chart",
]
