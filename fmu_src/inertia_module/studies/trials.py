"""Trial runs of a scene on the rungs of the ladder, measured against the finest, kept for the next time."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..drive import Progress
from ..files import cache_folder, content_hash, sources
from ..kernel.codes import ELASTIC, RIGID
from ..results import write_text
from ..scene import Scene
from ..scene.mechanism import at_fidelity, is_elastic, parameters
from .choice import Choice, recommend
from .report import as_dict
from .rungs import FIDELITIES, Rung, event, ladder
from .scene_run import SceneRun, run_in_process
from .trajectory import Row
from .window_errors import window_errors

REFERENCE_TOLERANCE = 1e-12
_FAILURES = (ValueError, RuntimeError, ArithmeticError)


def _given(scene: Scene) -> dict[str, float]:
    """Parameters that the scene gives its mechanism, without the load's."""
    return parameters(scene.mechanism)


def at_rung(scene: Scene, rung: Rung, communication_step: float | None = None) -> Scene:
    """The scene at a rung; where that has no elastic shaft, the driven mass is rigid with the hub.

    Raises:
        SceneError: the scene is refused there.
    """
    rigid = at_fidelity(_given(scene), rung.fidelity)
    inertia = {name: rigid[name] for name in ("output_inertia",) if name in rigid}
    values: dict[str, float | None] = {**inertia, **rung.values}
    tolerance = values.pop("tolerance", None)
    values.setdefault("max_step", None)
    step = scene.run.communication_step if communication_step is None else communication_step
    return scene.replaced(
        mechanism=values, accuracy={"tolerance": tolerance}, run={"communication_step": step}
    )


def reference_rung(scene: Scene) -> Rung:
    """The finest rung of a scene: elastic where it has parameters of an elastic output."""
    elastic = is_elastic(_given(scene))
    return event(ELASTIC if elastic else RIGID, REFERENCE_TOLERANCE)


def _row(rung: Rung, step: float, scene: Scene, run: Callable[[], SceneRun], reference: SceneRun) -> Row:
    """Row of a run, or of the reason why there is none."""
    head = (rung.fidelity_name, rung.method_name, rung.setting, step)
    try:
        found = run()
    except _FAILURES as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        return Row(*head, {}, math.nan, math.nan, None, reason, rung.values)
    last = found.record.last()
    errors = window_errors(found.record, reference.record, scene.accuracy.window, rung.fidelity)
    switches = None if rung.lacks("contact_switches") else last["contact_switches"]
    cost = (found.module_time, last["rhs_evaluations"], switches)
    return Row(*head, errors, *cost, "", rung.values, found.loop_time)


def measure_scene(
    scene: Scene,
    rungs: Sequence[Rung],
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Run a scene on rungs in communication steps; rows of errors by output against the finest rung.

    Args:
        scene: what is run, at any fidelity. rungs: to be measured.
        steps: communication steps, s, by default that of the scene. progress: told how much is done.

    Raises:
        Refused: the reference itself is refused.
    """
    lengths = (scene.run.communication_step,) if steps is None else steps
    total = 1 + len(rungs) * len(lengths)

    def part(number: int) -> Progress:
        def report(done: float) -> None:
            if progress is not None:
                progress((number + done) / total)

        return report

    reference = run_in_process(at_rung(scene, reference_rung(scene)), part(0))
    rows: list[Row] = []
    for step in lengths:
        for rung in rungs:
            report = part(len(rows) + 1)

            def run(rung: Rung = rung, step: float = step, report: Progress = report) -> SceneRun:
                return run_in_process(at_rung(scene, rung, step), report)

            rows.append(_row(rung, step, scene, run, reference))
            report(1.0)
    return rows


# --- kept between runs ---


def measurement_file(scene: Scene) -> Path:
    """Where the measurements of a scene are kept: by what it simulates, whatever error is asked of it."""
    content = scene.model_dump(mode="json", exclude_none=True)
    for name in ("title", "description"):
        content.pop(name, None)
    content["mechanism"] = {
        name: value
        for name, value in content["mechanism"].items()
        if name not in ("fidelity", "method", "max_step")
    }
    content["accuracy"] = {"window": scene.accuracy.window}
    content["run"].pop("outputs")
    # and by the code that a measurement depends on: kernel, loops and this study
    code = sources("kernel/*.py", "loops/*.py", "studies/*.py")
    name = content_hash(code | {"scene": json.dumps(content, sort_keys=True).encode()})[:24]
    return cache_folder() / f"trials-{name}.json"


def _from_dict(data: dict[str, Any]) -> Row:
    def number(value: float | None) -> float:
        return math.nan if value is None else value

    return Row(
        data["rung"],
        data["method"],
        data["setting"],
        data["communication_step"],
        {name: number(value) for name, value in data["errors"].items()},
        number(data["wall_time_per_second"]),
        number(data["rhs_evaluations"]),
        data["contact_switches"],
        data["failure"],
        data["parameters"],
        number(data["loop_time_per_second"]),
    )


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measured rows of the candidates for a scene, from the last time if nothing has changed since.

    Raises:
        Refused: the reference itself is refused.
    """
    path = measurement_file(scene)
    try:
        return [_from_dict(data) for data in json.loads(path.read_text())]
    except (OSError, ValueError, KeyError):
        pass
    elastic = is_elastic(_given(scene))
    rows = measure_scene(scene, list(ladder(elastic, kinematic=False, few=True)), progress=progress)
    kept = [as_dict(row) | {"parameters": dict(row.parameters)} for row in rows]
    write_text(path, json.dumps(kept, indent=1) + "\n")
    return rows


def choose(scene: Scene, progress: Progress | None = None) -> tuple[Scene, Choice]:
    """Choose the fidelity of a scene that leaves it to be chosen.

    Returns:
        The scene at the cheapest rung that meets accuracy.error in all of run.outputs, and the choice.

    Raises:
        NoneMeets: no rung does. Refused: the scene cannot be run at all.
    """
    assert scene.accuracy.error is not None
    choice = recommend(trial_rows(scene, progress), scene.accuracy.error, scene.run.outputs)
    number = next(number for number, name in FIDELITIES.items() if name == choice.row.rung)
    settings = {k: v for k, v in choice.row.parameters.items() if k not in ("fidelity", "method")}
    rung = Rung(number, int(choice.row.parameters["method"]), choice.row.setting, settings)
    return at_rung(scene, rung), choice
