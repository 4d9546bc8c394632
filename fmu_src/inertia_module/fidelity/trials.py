"""Trial runs of a scene at its levels of fidelity, measured against the finest; the trade of a scene.

Outputs of a long run under control are compared by window and not by instant: the loop keeps speeds and
torques where they belong, but nothing keeps the phase of the pulses, which drifts between any two runs. The
trade of speed for accuracy is the measured rows, their files, and a plot of error against cost.
"""

from __future__ import annotations

import dataclasses
import json
import math
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLUE, VERMILION
from ..common.files import cache_folder, content_hash, sources, write_figure
from ..common.terminal import Progress
from ..contract.variables import COMPUTED
from ..harness.results import TIME
from ..harness.simulate import Result, whole_steps
from ..kernel.codes import AVERAGED, ELASTIC, RIGID, STEP
from ..loops import ClosedLoop
from ..loops.closed_loop import PLANT_INPUTS
from ..memory import Module
from ..scene import Scene
from ..scene.run import start_of
from ..scene.schema import at_fidelity, is_elastic
from .levels import (
    NOT_MODELLED,
    PEER,
    Attempt,
    Choice,
    Level,
    Row,
    all_levels,
    attempt_all,
    event,
    read_rows,
    recommend,
    write_rows,
)

Array = NDArray[np.float64]

REFERENCE_TOLERANCE = 1e-12
# a call that the kernel refuses at once costs what every call costs around it
_REFUSED_STEP = -1.0
# no further call once so much time has passed, s
_PATIENCE = 0.5
# shortest time that can be measured, s a call
_RESOLUTION = 1e-8
_PULSING = frozenset(NOT_MODELLED[1])
# relative to the energy in, for they are small or zero by themselves
_ENERGIES = ("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual")
# a matter of cost, not of accuracy
NOT_COMPARED = ("rhs_evaluations",)


# --- wall time ---


def median_time(run: Callable[[], Any], repeats: int = 11) -> float:
    """Measure the median wall time of some calls, s.

    Args:
        run: what is timed. repeats: at most so many calls; fewer (at least one) of what is slow.
    """
    times: list[float] = []
    begun = time.perf_counter()
    while len(times) < repeats and (not times or time.perf_counter() - begun < _PATIENCE):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[Sequence[float]],
    communication_step: float,
    repeats: int = 31,
) -> float:
    """Measure the time of the kernel for a run that succeeds, s: that of all calls less that of empty ones.

    Args:
        module: that ran it. begin: its state before (Module.save). communication_step: s.
        inputs: (omega1, load_torque, drive_torque) of each step. repeats: at most.
    """

    def calls(size: float) -> None:
        module.restore(begin)
        held, call = module.inputs, module.call
        for held.omega1, held.load_torque, held.drive_torque in inputs:
            call(STEP, size)

    spent = median_time(lambda: calls(communication_step), repeats)
    empty = median_time(lambda: calls(_REFUSED_STEP), repeats)
    return max(spent - empty, _RESOLUTION * len(inputs))


# --- a run ---


class SceneRun(NamedTuple):
    """Result of a run of a scene.

    Attributes:
        record: all variables of the module and all signals of the loop at each communication point.
        module_time: of the kernel, s per simulated second.
    """

    record: Result
    module_time: float


def run_in_process(scene: Scene, progress: Progress | None = None) -> SceneRun:
    """Run a scene whose fidelity is chosen.

    Args:
        scene: as it is to be run. progress: told how much is done (0 to 1).

    Raises:
        Refused: the module refuses its parameters, an input or a step.
    """
    values, inputs = start_of(scene)
    plant = Module().start(**values, **inputs)
    begin = plant.save()
    loop = ClosedLoop(plant, scene.surroundings, COMPUTED, scene.signal_units)
    record = loop.run(scene.run.stop_time, progress)
    # the signals of a row are held over the step it begins, the other inputs over the run
    held = [record[name] if name in record else np.full(len(record), plant[name]) for name in PLANT_INPUTS]
    steps = np.transpose(held)[:-1].tolist()
    spent = kernel_time(plant, begin, steps, scene.run.communication_step)
    return SceneRun(record, spent / scene.run.stop_time)


# --- errors over windows of time ---


def window_means(values: Array, rows: int) -> Array:
    """Average over windows of so many rows; what is left over belongs to the last window."""
    count = max(values.size // rows, 1)
    edges = np.arange(count) * rows
    sizes = np.diff(np.append(edges, values.size))
    means: Array = np.add.reduceat(values, edges) / sizes
    return means


def _features(record: Result, name: str, window: float) -> list[Array]:
    """Window means and, of what pulses, window RMS; the start itself is left out: it is no step."""
    values = record[name][1:]
    rows = max(round(window / float(record.time[1] - record.time[0])), 1)
    means = window_means(values, rows)
    return [means, np.sqrt(window_means(values**2, rows))] if name in _PULSING else [means]


def window_errors(record: Result, exact: Result, window: float, fidelity: int) -> Mapping[str, float]:
    """Compute the error of each recorded output, NaN where the fidelity does not model it.

    Each is the largest difference over the windows, relative to the largest magnitude of the output in
    the reference; energies relative to the largest energy in.

    Args:
        record, exact: of the run and of the reference, over the same time. window: s.
        fidelity: of the run.
    """
    largest_energy = float(np.abs(exact["energy_in"]).max())
    errors = dict.fromkeys(NOT_COMPARED, 0.0) | dict.fromkeys(NOT_MODELLED[fidelity], math.nan)
    for name in exact.names:
        if name == TIME or name in errors:
            continue
        pairs = zip(_features(record, name, window), _features(exact, name, window), strict=True)
        difference = max(float(np.abs(ours - theirs).max()) for ours, theirs in pairs)
        scale = largest_energy if name in _ENERGIES else float(np.abs(exact[name]).max())
        errors[name] = 0.0 if difference == 0.0 else difference / scale if scale > 0.0 else math.inf
    return {name: errors[name] for name in exact.names if name != TIME}


# --- levels, measured ---


def at_level(scene: Scene, level: Level, communication_step: float | None = None) -> Scene:
    """Set a scene to a level; where that has no elastic shaft, the driven mass is rigid with the hub.

    Raises:
        SceneError: the scene is refused there.
    """
    rigid = at_fidelity(scene.given, level.fidelity)
    inertia = {name: rigid[name] for name in ("output_inertia",) if name in rigid}
    values: dict[str, float | None] = {"max_step": None, **inertia, **level.values}
    tolerance = values.pop("tolerance", None)
    step = communication_step or scene.run.communication_step
    return scene.replaced(
        mechanism=values, accuracy={"tolerance": tolerance}, run={"communication_step": step}
    )


def reference_level(scene: Scene) -> Level:
    """Pick the finest level of a scene: elastic where it has parameters of an elastic output."""
    return event(ELASTIC if is_elastic(scene.given) else RIGID, REFERENCE_TOLERANCE)


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
    finest = at_level(scene, reference_level(scene))
    reference = run_in_process(finest, lambda done: tell(done * share)).record

    def of_level(level: Level, step: float) -> Callable[[Progress], dict[str, Any]]:
        def run(report: Progress) -> dict[str, Any]:
            found = run_in_process(at_level(scene, level, step), report)
            last = found.record.last()
            return {
                "errors": window_errors(found.record, reference, scene.accuracy.window, level.fidelity),
                "wall_time": found.module_time,
                "evaluations": last["rhs_evaluations"],
                "switches": math.nan if level.fidelity == AVERAGED else last["contact_switches"],
            }

        return run

    attempts: list[Attempt] = [
        (level.row(step), of_level(level, step)) for step in lengths for level in levels
    ]
    return attempt_all(attempts, progress, share)


# --- kept between runs ---


def measurement_file(scene: Scene) -> Path:
    """Name the file of the measurements of a scene: by what it simulates, whatever error is asked of it."""
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
    """List the levels that are tried for a scene."""
    return list(all_levels(is_elastic(scene.given), few=True))


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Give the measured rows of the candidates for a scene, from the last time if nothing has changed since.

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
    (chosen,) = (one for one in candidates(scene) if one.row(step).label == choice.row.label)
    return at_level(scene, chosen), choice


# --- the trade ---

# communication steps of a scene over its own
_LONGER = (1, 10, 100)
WORST = "worst"
_DPI = 110
# a slope is fitted to at least so many points
_FITTED = 3
_COSTS = {"wall_time": "ms per simulated second", "evaluations": "right-hand sides"}


# --- least error for the cost, on log-log axes ---


def front(rows: Sequence[Row], error: str, cost: str) -> list[Row]:
    """Pick rows that succeeded and no other one beats, cheapest first: each is more accurate than the last.

    Args:
        rows: measured. error: name in Row.errors. cost: wall_time or evaluations.
    """
    known = [
        row
        for row in rows
        if not row.failure and getattr(row, cost) > 0.0 and row.errors.get(error, 0.0) > 0.0
    ]
    best: list[Row] = []
    for row in sorted(known, key=lambda row: (getattr(row, cost), row.errors[error])):
        if not best or row.errors[error] < best[-1].errors[error]:
            best.append(row)
    return best


def slope(costs: Array, errors: Array) -> float:
    """Fit the exponent p of error ~ cost^p; NaN of fewer than three different points."""
    if np.unique(costs).size < _FITTED:
        return math.nan
    return float(np.polyfit(np.log(costs), np.log(errors), 1)[0])


def _panel(axes: Axes, rows: Sequence[Row], error: str, cost: str) -> None:
    """Draw the front of the module and that of the peers; where a level begins, its name and slope."""
    scale = 1e3 if cost == "wall_time" else 1.0
    for peers, colour, side in ((False, VERMILION, -1), (True, BLUE, 1)):
        found = front([row for row in rows if (row.fidelity == PEER) is peers], error, cost)
        costs = np.array([scale * getattr(row, cost) for row in found])
        errors = np.array([row.errors[error] for row in found])
        if found:
            axes.loglog(costs, errors, color=colour, marker="o", markersize=3, linewidth=1.2)
        names = [row.method.partition(",")[0] if peers else row.level for row in found]
        for name, part in groupby(range(len(found)), key=names.__getitem__):
            places = list(part)
            fitted = slope(costs[places], errors[places])
            axes.annotate(
                name if math.isnan(fitted) else f"{name} (slope {fitted:.1f})",
                (costs[places[0]], errors[places[0]]),
                xytext=(6 * side, 2 * side),
                textcoords="offset points",
                ha="left" if peers else "right",
                fontsize=7,
                color=colour,
            )
    # room for the names at the line
    axes.margins(x=0.3)
    axes.set_xlabel(_COSTS[cost])
    axes.set_ylabel(f"error of {error.replace('_', ' ')} [1]")
    axes.grid(alpha=0.3, linewidth=0.4)


def work_precision(rows: Sequence[Row], error: str, title: str) -> Figure:
    """Draw one error against wall time and against right-hand sides.

    Args:
        rows: measured. error: name in Row.errors. title: of the figure.
    """
    figure = Figure(figsize=(11.0, 5.0), dpi=_DPI, layout="constrained")
    figure.suptitle(f"{title}: least relative error for the cost", fontsize=11)
    for axes, cost in zip(figure.subplots(1, 2, sharey=True), _COSTS, strict=True):
        _panel(axes, rows, error, cost)
    return figure


# --- a scene ---


def measured_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measure a scene at all levels, in its own communication step and in longer ones.

    Raises:
        Refused: the module refuses the scene.
    """
    longer = (factor * scene.run.communication_step for factor in _LONGER)
    steps = [step for step in longer if whole_steps(scene.run.stop_time, step)]
    levels = list(all_levels(is_elastic(scene.given)))
    return measure_scene(scene, levels, steps, progress)


def with_worst(rows: Sequence[Row], wanted: Sequence[str]) -> list[Row]:
    """Rows with the errors of the wanted outputs alone, and WORST, the largest of them."""
    kept = []
    for row in rows:
        errors = {name: row.errors[name] for name in wanted if name in row.errors}
        kept.append(dataclasses.replace(row, errors={**errors, WORST: row.worst(wanted)} if errors else {}))
    return kept


def leave_rows(folder: Path, title: str, rows: Sequence[Row]) -> dict[str, Path]:
    """Leave rows of with_worst in a folder, as CSV, and a plot as PNG and SVG. Returns the files by name."""
    files = {"rows": write_rows(folder / "tradeoff.csv", rows)}
    figure = work_precision(rows, WORST, title)
    for kind in ("png", "svg"):
        files[f"tradeoff_{kind}"] = write_figure(folder / f"tradeoff.{kind}", figure)
    return files
