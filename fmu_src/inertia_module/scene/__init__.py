"""Scene files: what is to be simulated, how accurately, and what is wanted of it."""

from .errors import SceneError
from .run import SceneResult, run_scene
from .schema import Scene, load_scene, read_scene

__all__ = ["Scene", "SceneError", "SceneResult", "load_scene", "read_scene", "run_scene"]
