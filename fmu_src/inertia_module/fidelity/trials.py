"""Accuracy and run time of a scene at its fidelity levels, and the choice of a level.

Trial runs are compared with the finest level by averages over time windows, not by instantaneous values. A
closed loop controls speeds and torques but not the phase of the pulses, which drifts between two runs.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pydantic_core import to_jsonable_python

from ..common.colours import Picture, styled
from ..common.equality import ByContent
from ..common.errors import ParameterError
from ..common.files import kept, sources
from ..common.terminal import Progress, terminal
from ..driveline import ClosedLoop
from ..driveline.closed_loop import PLANT_INPUTS
from ..fmi import results
from ..fmi.results import TIME
from ..fmi.simulate import Result, whole_steps
from ..interface.variables import COMPUTED, ENUMERATIONS, VARIABLES
from ..kernel.codes import AVERAGED, ELASTIC, RIGID
from ..model import Module
from ..scene import Scene
from ..scene.run import start_of
from ..scene.schema import at_fidelity, is_elastic

Array = NDArray[np.float64]

# --- levels ---

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}

# outputs that a fidelity does not model, with the reason
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    fidelity: {row.name: need.reason for row in VARIABLES for need in row.needs if fidelity in need.lacking}
    for fidelity in FIDELITIES
}


@dataclass(frozen=True, eq=False)
class Level(ByContent):
    """Fidelity level with its settings.

    Attributes:
        fidelity: Number of the fidelity.
        setting: Printed text of the setting, such as "tolerance 1e-06".
        parameters: Parameters of the setting, by name.
    """

    fidelity: int
    setting: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the name of the fidelity."""
        return FIDELITIES[self.fidelity]

    @property
    def values(self) -> dict[str, float]:
        """Return the parameters of the module for this level, by name."""
        return {"fidelity": float(self.fidelity), **self.parameters}

    def row(self, step: float) -> Row:
        """Make the row of the level without measurements.

        Args:
            step: Communication step, s.
        """
        return Row(self.name, "", self.setting, step)


def event(fidelity: int, tolerance: float) -> Level:
    """Make an event-driven level.

    Args:
        fidelity: Number of the fidelity.
        tolerance: Relative tolerance.
    """
    return Level(fidelity, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


TOLERANCES = tuple(10.0**-n for n in range(3, 12))


def all_levels(elastic: bool, few: bool = False) -> Iterator[Level]:
    """Yield the levels to measure, except kinematic, from coarse to fine.

    Args:
        elastic: True to include fidelity elastic.
        few: True for every second tolerance, for long scenes.
    """
    yield Level(AVERAGED, "map")
    for fidelity in (RIGID, ELASTIC) if elastic else (RIGID,):
        for tolerance in TOLERANCES[:-1:2] if few else TOLERANCES:
            yield event(fidelity, tolerance)


# --- measurements ---

_HEADS = ("fidelity", "method", "setting", "communication_step [s]")
_COSTS = {
    "wall_time_per_second [s]": "wall_time",
    "rhs_evaluations": "evaluations",
    "contact_switches": "switches",
}
# fidelity in rows of other integrators
PEER = "peer"
# exceptions of a failed run: invalid parameters, missing libraries, failed integrators
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


@dataclass(frozen=True, eq=False)
class Row(ByContent):
    """Measurements of one run.

    Attributes:
        fidelity: Name of the fidelity, or PEER.
        method: Integrator of a peer; "" for the module.
        setting: Text of the setting, such as "tolerance 1e-06".
        communication_step: Communication step, s.
        errors: Relative errors by output; NaN without a reference.
        wall_time: Run time of the integration, s per simulated second.
        evaluations: Number of right-hand-side evaluations.
        switches: Number of contact switches; NaN if not counted.
        failure: Reason of a failed run; "" for a successful run.
    """

    fidelity: str
    method: str
    setting: str
    communication_step: float
    errors: Mapping[str, float] = field(default_factory=dict)
    wall_time: float = math.nan
    evaluations: float = math.nan
    switches: float = math.nan
    failure: str = ""

    @property
    def level(self) -> str:
        """Return the fidelity and, for a peer, the method."""
        return f"{self.fidelity}, {self.method}" if self.method else self.fidelity

    @property
    def label(self) -> str:
        """Return fidelity, method and setting."""
        return f"{self.level}, {self.setting}" if self.setting else self.level

    def worst_of(self, outputs: Sequence[str]) -> tuple[float, str]:
        """Return the maximum error of outputs and the name of the output; NaN if an output has no error.

        Args:
            outputs: Names of the outputs.
        """
        errors = [(self.errors.get(name, math.nan), name) for name in outputs]
        return max(errors, key=lambda pair: (math.isnan(pair[0]), pair[0]))

    def worst(self, outputs: Sequence[str]) -> float:
        """Return the maximum error of outputs; infinite if an output has no error or the run failed.

        Args:
            outputs: Names of the outputs.
        """
        error, _ = self.worst_of(outputs)
        return math.inf if self.failure or math.isnan(error) else error

    def as_dict(self) -> dict[str, Any]:
        """Return the row for JSON; NaN becomes None."""
        heads = ("fidelity", "method", "setting", "communication_step", "errors")
        head = {name: getattr(self, name) for name in heads}
        costs = {name.partition(" ")[0]: getattr(self, cost) for name, cost in _COSTS.items()}
        numbers = {**head, **costs, "failure": self.failure}
        row: dict[str, Any] = to_jsonable_python(numbers, inf_nan_mode="null")
        return row


def attempt(head: Row, measure: Callable[[], dict[str, Any]]) -> Row:
    """Measure a run and return its row; after a failure the row contains the reason.

    Args:
        head: Row without measurements.
        measure: Function that runs the measurement and returns fields of Row by name.
    """
    try:
        fields = measure()
    except FAILURES as error:
        fields = {"failure": " ".join(str(error).split()) or type(error).__name__}
    return dataclasses.replace(head, **fields)


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write rows, including failed runs, to a CSV file and return its path.

    Args:
        path: Path of the file, which is written atomically.
        rows: The rows.
    """
    names = list(dict.fromkeys(name for row in rows for name in row.errors))
    lines = []
    for row in rows:
        numbers = [row.errors.get(name, math.nan) for name in names]
        numbers += [getattr(row, name) for name in _COSTS.values()]
        cells = ["" if math.isnan(value) else float(value) for value in numbers]
        lines.append([row.fidelity, row.method, row.setting, row.communication_step, *cells, row.failure])
    headings = [*_HEADS, *(f"error {name}" for name in names), *_COSTS, "failure"]
    return results.write_rows(path, headings, lines)


def read_rows(path: Path) -> list[Row]:
    """Read rows from a file of write_rows.

    Args:
        path: Path of the file.

    Raises:
        ValueError: The file contains another table.
    """
    table = csv.DictReader(path.read_text().splitlines())
    if tuple(table.fieldnames or ())[: len(_HEADS)] != _HEADS:
        raise ValueError(f"{path}: the first headings must be {', '.join(_HEADS)}")
    rows = []
    for line in table:
        fidelity, method, setting, step, failure = (line.pop(name) for name in (*_HEADS, "failure"))
        numbers = {name: float(text) if text else math.nan for name, text in line.items()}
        costs = {cost: numbers.pop(name) for name, cost in _COSTS.items()}
        errors = {name.removeprefix("error "): value for name, value in numbers.items()}
        rows.append(Row(fidelity, method, setting, float(step), errors, failure=failure, **costs))
    return rows


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """Return a line for each reason of failed runs.

    Args:
        rows: The rows.
    """
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(names)}: {reason}" for reason, names in labels.items()]


# --- cheapest level with the required accuracy ---

_NUMBER = {name: number for number, name in FIDELITIES.items()}


@dataclass(frozen=True, eq=False)
class Choice(ByContent):
    """Chosen level with the reasons.

    Attributes:
        row: Cheapest level that meets the allowed error.
        wanted: Names of the outputs that must meet the error.
        error: Allowed relative error.
        following: Next more accurate level that meets the error, or None.
        passed: Reasons to reject cheaper levels, by label.
    """

    row: Row
    wanted: tuple[str, ...]
    error: float
    following: Row | None
    passed: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Return the run time of the next level over the run time of the chosen level."""
        return None if self.following is None else self.following.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """Return the choice, its reasons and the cost of the next level as lines."""

        def cost(row: Row) -> str:
            return f"{1e3 * row.wall_time:.3g} ms of kernel time per simulated second"

        error, worst = self.row.worst_of(self.wanted)
        accuracy = f"error {error:.2g} ({worst}), requested {self.error:g}"
        lines = [f"chosen: {self.row.label}: {accuracy}, {cost(self.row)}"]
        lines += [f"rejected: {label}: {reason}" for label, reason in self.passed.items()]
        if self.following is None:
            return [*lines, "next level: none"]
        next_accuracy = f"error {self.following.worst(self.wanted):.2g}, {cost(self.following)}"
        return [
            *lines,
            f"next level: {self.following.label}: {next_accuracy}, {self.ratio:.3g} times the run time",
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the choice for JSON."""

        def brief(row: Row) -> dict[str, Any]:
            errors = {name: row.errors[name] for name in self.wanted}
            return row.as_dict() | {"error": row.worst(self.wanted), "errors": errors}

        following = None if self.following is None else brief(self.following) | {"cost": self.ratio}
        request = {"error": self.error, "wanted": list(self.wanted)}
        return {"asked": request, "chosen": brief(self.row), "passed": dict(self.passed), "next": following}


def why_not(row: Row, error: float, outputs: Sequence[str]) -> str:
    """Return the reason why a row does not meet an error; "" if it does.

    Args:
        row: The row.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.
    """
    if row.failure:
        return row.failure
    not_modelled = NOT_MODELLED.get(_NUMBER.get(row.fidelity, -1), {})
    for name in outputs:
        if name in not_modelled:
            return f"it {not_modelled[name]} ({name})"
    unknown = [name for name in outputs if math.isnan(row.errors.get(name, math.nan))]
    if unknown:
        return f"no reference for {', '.join(unknown)}"
    maximum, worst = row.worst_of(outputs)
    return "" if maximum <= error else f"error {maximum:.2g} ({worst})"


def cheapest(rows: Sequence[Row]) -> Row | None:
    """Return the row with the minimum run time, or None without rows.

    Settings of one level are compared by right-hand-side evaluations, which have no measurement noise.

    Args:
        rows: The rows.
    """
    best: dict[tuple[str, float], Row] = {}
    for row in sorted(rows, key=lambda row: row.evaluations):
        best.setdefault((row.level, row.communication_step), row)
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, outputs: Sequence[str]) -> Choice:
    """Recommend the cheapest level of the module that meets an error; peers are excluded.

    The next level is the cheapest level of a higher fidelity that meets the error. If there is none, it is
    the cheapest level with a tenth of the error.

    Args:
        rows: Measured rows.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.

    Raises:
        ParameterError: No level meets the error; the message contains the error of the best level.
    """
    module_rows = sorted((row for row in rows if row.fidelity in _NUMBER), key=lambda row: row.worst(outputs))
    accurate = [row for row in module_rows if not why_not(row, error, outputs)]
    chosen = cheapest(accurate)
    if chosen is None:
        best = (
            f"best: {module_rows[0].label}: {why_not(module_rows[0], error, outputs)}"
            if module_rows
            else "no level was measured"
        )
        request = f"error = {error:g} in {', '.join(outputs)}"
        raise ParameterError(f"no fidelity level reaches {request}; {best}")
    higher = [row for row in accurate if _NUMBER[row.fidelity] > _NUMBER[chosen.fidelity]]
    fine_error = 0.1 * min(error, chosen.worst(outputs))
    finer = [row for row in accurate if row.worst(outputs) <= fine_error and row.wall_time > chosen.wall_time]
    # One line per level: its most accurate row that is not slower than the choice, or that failed.
    passed: dict[str, tuple[str, str]] = {}
    for row in module_rows:
        reason = why_not(row, error, outputs)
        if reason and not row.wall_time > chosen.wall_time:
            passed.setdefault(row.level, (row.label, reason))
    following = cheapest(higher) or cheapest(finer)
    return Choice(chosen, tuple(outputs), error, following, dict(passed.values()))


# --- on a terminal ---


def at_levels(rows: Sequence[Row], error: float, outputs: Sequence[str]) -> list[Row]:
    """Return a row for each level: its cheapest row that meets the error, or else its most accurate row.

    The rule is the rule of recommend, so the recommended row is included.

    Args:
        rows: Measured rows.
        error: Allowed relative error.
        outputs: Names of the outputs that must meet the error.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, outputs)])
        or min(level, key=lambda row: row.worst(outputs))
        for level in levels.values()
    ]


def print_levels(title: str, rows: Sequence[Row], outputs: Sequence[str], error: float | None = None) -> None:
    """Print a table with the maximum error and the run time of each level.

    Args:
        title: Title of the table.
        rows: Measured rows of one communication step.
        outputs: Names of the outputs.
        error: Allowed relative error; None for 1 %.
    """
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    allowed = 0.01 if error is None else error
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("fidelity level", "setting", "error", "maximum in", "ms per s"):
        table.add_column(heading, no_wrap=heading != "maximum in")
    for row in at_levels(rows, allowed, outputs):
        maximum, worst = row.worst_of(outputs)
        cost = text(1e3 * row.wall_time, ".3g")
        table.add_row(row.level, row.setting, text(maximum, ".1e"), worst.replace("_", " "), cost)
    console = terminal()
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with an error of at most {allowed:g}, otherwise at its most"
        f" accurate setting; communication step {rows[0].communication_step:g} s;"
        " kernel time in ms per simulated second"
    )
    console.print(table)


# --- trial runs ---

# energies, whose errors are relative to the input energy because they can be small or zero
_ENERGIES = ("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual")


def timed(run: Callable[[], Any]) -> float:
    """Return the wall time of a call, s.

    Args:
        run: Function to call.
    """
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def median_of(measure: Callable[[], float], repeats: int = 11) -> float:
    """Return the median of repeated measurements.

    Measurements end after 0.5 s; at least one is made.

    Args:
        measure: Function that returns one measurement.
        repeats: Maximum number of measurements.
    """
    measurements: list[float] = []
    start = time.perf_counter()
    while len(measurements) < repeats and (not measurements or time.perf_counter() - start < 0.5):
        measurements.append(measure())
    return statistics.median(measurements)


def median_time(run: Callable[[], Any], repeats: int = 11) -> float:
    """Return the median wall time of a call, s, as median_of.

    Args:
        run: Function to call.
        repeats: Maximum number of calls.
    """
    return median_of(lambda: timed(run), repeats)


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[Sequence[float]],
    communication_step: float,
    repeats: int = 31,
) -> float:
    """Measure the kernel time of a successful run, s: time with all steps minus time without steps.

    Args:
        module: Module of the run.
        begin: State before the run, from Module.save.
        inputs: Values of PLANT_INPUTS in each step, shape (steps, 3).
        communication_step: Communication step, s.
        repeats: Maximum number of measurements.
    """
    values, lengths = np.array(inputs, dtype=float), np.full(len(inputs), communication_step)
    rows = np.empty((len(inputs) + 1, 0))

    def steps(number: int) -> float:
        module.restore(begin)
        arguments = lengths[:number], PLANT_INPUTS, values[:number], (), rows[: number + 1]
        return timed(partial(module.take_steps, *arguments))

    duration = median_of(lambda: steps(len(inputs)) - steps(0), repeats)
    # minimum measurable time: 10 ns per step
    return max(duration, 1e-8 * len(inputs))


def run_in_process(scene: Scene, progress: Progress | None = None) -> Result:
    """Run a scene in memory and record all variables of the module and all signals of the loop.

    Args:
        scene: Scene with a named fidelity.
        progress: Function called with the completed fraction of the run, 0 to 1.

    Raises:
        ParameterError: The module rejects a value or a step.
    """
    loop = ClosedLoop(_start_module(scene), scene.surroundings, COMPUTED, scene.signal_units)
    return loop.run(scene.run.stop_time, progress)


def _start_module(scene: Scene) -> Module:
    values, inputs = start_of(scene)
    return Module().start(**values, **inputs)


def time_of(scene: Scene, record: Result) -> float:
    """Measure the kernel time of a scene, s per simulated second.

    Args:
        scene: Scene with a named fidelity.
        record: Record of the scene, from run_in_process.
    """
    plant = _start_module(scene)
    # Signals of a row are constant over the step after it, other inputs over the run.
    inputs = [record[name] if name in record else np.full(len(record), plant[name]) for name in PLANT_INPUTS]
    steps = np.transpose(inputs)[:-1].tolist()
    return kernel_time(plant, plant.save(), steps, scene.run.communication_step) / scene.run.stop_time


# --- errors over windows of time ---


def _features(record: Result, name: str, window: float) -> list[Array]:
    """Return window means of an output and, if it pulses, window RMS values.

    The first row is excluded because no step precedes it. Rows after the last whole window belong to this
    window.
    """
    values = record[name][1:]
    rows = max(round(window / float(record.time[1] - record.time[0])), 1)
    edges = np.arange(max(values.size // rows, 1)) * rows

    def means(values: Array) -> Array:
        return np.asarray(np.add.reduceat(values, edges) / np.diff(np.append(edges, values.size)))

    return [means(values), np.sqrt(means(values**2))] if name in NOT_MODELLED[AVERAGED] else [means(values)]


def window_errors(record: Result, exact: Result, window: float, fidelity: int) -> Mapping[str, float]:
    """Return the relative error of each recorded output; NaN if the fidelity does not model it.

    The error is the maximum difference of window averages. It is relative to the maximum magnitude of the
    output in the reference, or to the maximum input energy for energies.

    Args:
        record: Record of the run.
        exact: Reference record over the same time.
        window: Length of the windows, s.
        fidelity: Number of the fidelity of the run.
    """
    energy_scale = float(np.abs(exact["energy_in"]).max())
    # Evaluations measure cost, not accuracy.
    errors = {"rhs_evaluations": 0.0} | dict.fromkeys(NOT_MODELLED[fidelity], math.nan)
    for name in exact.names:
        if name == TIME or name in errors:
            continue
        pairs = zip(_features(record, name, window), _features(exact, name, window), strict=True)
        difference = max(float(np.abs(actual - expected).max()) for actual, expected in pairs)
        scale = energy_scale if name in _ENERGIES else float(np.abs(exact[name]).max())
        errors[name] = 0.0 if difference == 0.0 else difference / scale if scale > 0.0 else math.inf
    return {name: errors[name] for name in exact.names if name != TIME}


# --- measurements of levels ---


def at_level(scene: Scene, level: Level, communication_step: float | None = None) -> Scene:
    """Return a copy of a scene at a level; unless it is elastic, the driven mass is rigid with the hub.

    Args:
        scene: The scene.
        level: The level.
        communication_step: Communication step, s; None for the step of the scene.

    Raises:
        SceneError: The new scene is invalid.
    """
    values = {
        **at_fidelity(scene.explicit_parameters, level.fidelity),
        "method": None,
        "max_step": None,
        **level.values,
    }
    tolerance = values.pop("tolerance", None)
    step = communication_step or scene.run.communication_step
    return scene.replaced(
        mechanism=values, accuracy={"tolerance": tolerance}, run={"communication_step": step}
    )


def reference_level(scene: Scene) -> Level:
    """Return the finest level of a scene: elastic if it has parameters of an elastic output, else rigid.

    Args:
        scene: The scene.
    """
    return event(ELASTIC if is_elastic(scene.explicit_parameters) else RIGID, 1e-12)


def measure_scene(
    scene: Scene,
    levels: Sequence[Level],
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Run a scene at levels and communication steps, and compare the runs with the finest level.

    Args:
        scene: The scene.
        levels: Levels to measure.
        steps: Communication steps, s; None for the step of the scene.
        progress: Function called with the completed fraction, 0 to 1.

    Returns:
        A row per step and level, also for failed runs.

    Raises:
        ParameterError: The run at the finest level fails.
    """
    lengths = (scene.run.communication_step,) if steps is None else steps
    runs = [(level, step) for step in lengths for level in levels]

    def share(number: int) -> Progress:
        """Return the progress function of a run; the reference is run 0."""
        report = progress or (lambda fraction: None)
        return lambda fraction: report((number + fraction) / (1 + len(runs)))

    reference = run_in_process(at_level(scene, reference_level(scene)), share(0))

    def measure(number: int, level: Level, step: float) -> dict[str, Any]:
        scene_at_level = at_level(scene, level, step)
        record = run_in_process(scene_at_level, share(number))
        last = record.last()
        return {
            "errors": window_errors(record, reference, scene.accuracy.window, level.fidelity),
            "wall_time": time_of(scene_at_level, record),
            "evaluations": last["rhs_evaluations"],
            "switches": math.nan if level.fidelity == AVERAGED else last["contact_switches"],
        }

    return [
        attempt(level.row(step), partial(measure, number, level, step))
        for number, (level, step) in enumerate(runs, 1)
    ]


# --- measurements in the cache ---


def measured_from(scene: Scene) -> dict[str, bytes]:
    """Return everything that the measurements of a scene depend on: the simulated system and the code.

    Args:
        scene: The scene.
    """
    chosen = {"mechanism": {"fidelity", "method", "max_step"}, "accuracy": {"tolerance", "error"}}
    others: dict[str, Any] = {"title": True, "description": True, "run": {"outputs"}}
    content = scene.model_dump_json(exclude_none=True, exclude=chosen | others)
    return sources("kernel/**/*.py", "driveline/*.py", "fidelity/*.py") | {"scene": content.encode()}


def candidates(scene: Scene) -> list[Level]:
    """Return the levels that are measured to choose one for a scene.

    Args:
        scene: The scene.
    """
    return list(all_levels(is_elastic(scene.explicit_parameters), few=True))


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Return the rows of the candidates for a scene, from the cache if nothing has changed.

    Args:
        scene: The scene.
        progress: Function called with the completed fraction, 0 to 1.
    """

    def measure() -> bytes:
        rows = measure_scene(scene, candidates(scene), progress=progress)
        with tempfile.TemporaryDirectory() as folder:
            return write_rows(Path(folder) / "trials.csv", rows).read_bytes()

    return read_rows(kept("trials.csv", measured_from(scene), measure))


def choose(scene: Scene, progress: Progress | None = None) -> tuple[Scene, Choice]:
    """Choose the cheapest level that meets accuracy.error in all outputs of a scene.

    Args:
        scene: Scene with accuracy.error.
        progress: Function called with the completed fraction, 0 to 1.

    Returns:
        The scene at the level, and the reasons.

    Raises:
        ParameterError: No level meets the error.
    """
    assert scene.accuracy.error is not None
    choice = recommend(trial_rows(scene, progress), scene.accuracy.error, scene.run.outputs)
    step = choice.row.communication_step
    (chosen,) = (level for level in candidates(scene) if level.row(step).label == choice.row.label)
    return at_level(scene, chosen), choice


# --- work-precision diagram ---

# label of a cost, and factor to its displayed unit
_AXES = {
    "wall_time": ("kernel time [ms per simulated second]", 1e3),
    "evaluations": ("right-hand-side evaluations", 1.0),
}


@styled()
def work_precision(rows: Sequence[Row], outputs: Sequence[str], title: str) -> Figure:
    """Draw the maximum error over run time and over right-hand-side evaluations, on logarithmic axes.

    Runs of the module are dots, runs of peers are crosses, in the colour of the level.

    Args:
        rows: Measured rows.
        outputs: Names of the outputs.
        title: Title of the figure.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        if 0.0 < row.worst(outputs) < math.inf:
            name = row.method.partition(",")[0] if row.fidelity == PEER else row.level
            levels.setdefault(name, []).append(row)
    figure = Picture(figsize=(11.0, 5.5), dpi=110, layout="constrained")
    figure.suptitle(f"{title}: accuracy against run time")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (cost, (label, factor)) in zip(panels, _AXES.items(), strict=True):
        for name, level in levels.items():
            costs, errors = (
                [factor * getattr(row, cost) for row in level],
                [row.worst(outputs) for row in level],
            )
            axes.loglog(costs, errors, "x" if level[0].fidelity == PEER else "o", markersize=5, label=name)
        axes.set_xlabel(label)
    panels[0].set_ylabel("maximum relative error")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure


def measured_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measure a scene at all levels, with its communication step and with 10 and 100 times longer steps.

    Args:
        scene: The scene.
        progress: Function called with the completed fraction, 0 to 1.
    """
    longer = (factor * scene.run.communication_step for factor in (1, 10, 100))
    steps = [step for step in longer if whole_steps(scene.run.stop_time, step)]
    levels = list(all_levels(is_elastic(scene.explicit_parameters)))
    return measure_scene(scene, levels, steps, progress)
