"""Trial runs of a scene at its levels of fidelity, measured against the finest, kept for the next time."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..common.files import cache_folder, content_hash, sources
from ..harness.simulate import Progress
from ..kernel.codes import AVERAGED, ELASTIC, RIGID
from ..scene import Scene
from ..scene.mechanism import at_fidelity, is_elastic, parameters
from .choice import Choice, recommend
from .levels import Level, all_levels, event
from .rows import Attempt, Row, attempt_all, head_of, read_rows, write_rows
from .scene_run import run_in_process
from .window_errors import window_errors

REFERENCE_TOLERANCE = 1e-12


def at_level(scene: Scene, level: Level, communication_step: float | None = None) -> Scene:
    """The scene at a level; where that has no elastic shaft, the driven mass is rigid with the hub.

    Raises:
        SceneError: the scene is refused there.
    """
    rigid = at_fidelity(parameters(scene.mechanism), level.fidelity)
    inertia = {name: rigid[name] for name in ("output_inertia",) if name in rigid}
    values: dict[str, float | None] = {"max_step": None, **inertia, **level.values}
    tolerance = values.pop("tolerance", None)
    step = communication_step or scene.run.communication_step
    return scene.replaced(
        mechanism=values, accuracy={"tolerance": tolerance}, run={"communication_step": step}
    )


def has_elastic_output(scene: Scene) -> bool:
    """Tell whether a scene gives parameters of an elastic output."""
    return is_elastic(parameters(scene.mechanism))


def reference_level(scene: Scene) -> Level:
    """The finest level of a scene: elastic where it has parameters of an elastic output."""
    return event(ELASTIC if has_elastic_output(scene) else RIGID, REFERENCE_TOLERANCE)


def measure_scene(
    scene: Scene,
    levels: Sequence[Level],
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Run a scene at levels in communication steps; rows of errors by output against the finest level.

    Args:
        scene: what is run, at any fidelity. levels: to be measured.
        steps: communication steps, s, by default that of the scene. progress: told how much is done.

    Raises:
        Refused: the reference itself is refused.
    """
    lengths = (scene.run.communication_step,) if steps is None else steps
    share = 1.0 / (1 + len(levels) * len(lengths))
    tell = progress or (lambda done: None)
    reference = run_in_process(
        at_level(scene, reference_level(scene)), lambda done: tell(done * share)
    ).record

    def of_level(level: Level, step: float) -> Callable[[Progress], dict[str, Any]]:
        def run(report: Progress) -> dict[str, Any]:
            found = run_in_process(at_level(scene, level, step), report)
            last = found.record.last()
            return {
                "errors": window_errors(found.record, reference, scene.accuracy.window, level.fidelity),
                "wall_time": found.module_time,
                "loop_time": found.loop_time,
                "evaluations": last["rhs_evaluations"],
                "switches": math.nan if level.fidelity == AVERAGED else last["contact_switches"],
            }

        return run

    attempts: list[Attempt] = [
        (head_of(level, step), of_level(level, step)) for step in lengths for level in levels
    ]
    return attempt_all(attempts, progress, share)


# --- kept between runs ---


def measurement_file(scene: Scene) -> Path:
    """Where the measurements of a scene are kept: by what it simulates, whatever error is asked of it."""
    content = scene.model_dump(mode="json", exclude_none=True)
    for name in ("title", "description"):
        content.pop(name, None)
    for name in ("fidelity", "method", "max_step"):
        content["mechanism"].pop(name, None)
    content["accuracy"] = {"window": scene.accuracy.window}
    content["run"].pop("outputs")
    # and by the code that a measurement depends on: kernel, loops and this study
    code = sources("kernel/**/*.py", "loops/*.py", "fidelity/*.py")
    name = content_hash(code | {"scene": json.dumps(content, sort_keys=True).encode()})[:24]
    return cache_folder() / f"trials-{name}.csv"


def candidates(scene: Scene) -> list[Level]:
    """The levels that are tried for a scene."""
    return list(all_levels(has_elastic_output(scene), kinematic=False, few=True))


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measured rows of the candidates for a scene, from the last time if nothing has changed since.

    Raises:
        Refused: the reference itself is refused.
    """
    path = measurement_file(scene)
    try:
        return read_rows(path)
    except (OSError, ValueError, KeyError):
        rows = measure_scene(scene, candidates(scene), progress=progress)
        write_rows(path, rows)
        return rows


def choose(scene: Scene, progress: Progress | None = None) -> tuple[Scene, Choice]:
    """Choose the fidelity of a scene that leaves it to be chosen.

    Returns:
        The scene at the cheapest level that meets accuracy.error in all of run.outputs, and the choice.

    Raises:
        NoneMeets: no level does. Refused: the scene cannot be run at all.
    """
    assert scene.accuracy.error is not None
    choice = recommend(trial_rows(scene, progress), scene.accuracy.error, scene.run.outputs)
    step = choice.row.communication_step
    (chosen,) = (one for one in candidates(scene) if head_of(one, step).label == choice.row.label)
    return at_level(scene, chosen), choice
