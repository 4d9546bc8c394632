"""A scene as a page starts with it: parameters and inputs of the module."""

from __future__ import annotations

from typing import Any

from ..harness.simulate import Result
from ..loops.closed_loop import PLANT_INPUTS
from ..loops.sources import Signal, Table
from ..scene import Scene
from ..scene.run import start_of


def page_scene(scene: Scene, record: Result | None = None) -> dict[str, Any]:
    """A scene for the page (the interface Scene of page/src/run/start.ts), ready for JSON.

    Args:
        scene: whose fidelity is chosen. record: a run of it. An input that follows from what the module does
            becomes constant: its mean over the run to four digits, without a run its value at the start.
    """
    _, parameters, inputs = start_of(scene)
    if record is not None:
        inputs |= {name: float(f"{record[name].mean():.4g}") for name in PLANT_INPUTS if name in record}
    prescribed = inputs | scene.drive.prescribed() | scene.load.prescribed()
    if scene.accuracy.tolerance is not None:
        parameters = {**parameters, "tolerance": scene.accuracy.tolerance}
    return {
        "name": "scene",
        "title": scene.title,
        "description": scene.description.strip(),
        "parameters": parameters,
        "inputs": {name: _as_input(signal) for name, signal in prescribed.items()},
        "step": scene.run.communication_step,
        "duration": scene.run.stop_time,
        "outputs": scene.run.outputs,
        "exact": is_exact(scene),
    }


def is_exact(scene: Scene) -> bool:
    """Tell whether the inputs follow from nothing that the module does: the page can run the scene itself."""
    return not scene.surroundings.input_labels


def _as_input(signal: Signal) -> float | dict[str, list[float]]:
    """A number, or points of straight lines (the type Input of page/src/run/signals.ts)."""
    if isinstance(signal, Table):
        return {"times": signal.points.tolist(), "values": signal.values.tolist()}
    return float(signal)
