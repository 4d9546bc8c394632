"""Cost of accuracy of a scene: its levels of fidelity, their measurements, the choice of a level, the trade.

Trial runs of a scene are measured against the finest level, the outputs by window and not by instant: a loop
under control keeps speeds and torques where they belong, but nothing keeps the phase of the pulses, which
drifts between any two runs.
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

from ..common.equality import ByContent
from ..common.errors import Refused
from ..common.files import kept, sources
from ..common.terminal import Progress, terminal
from ..contract.variables import COMPUTED, ENUMERATIONS, VARIABLES
from ..harness import results
from ..harness.results import TIME
from ..harness.simulate import Result, whole_steps
from ..kernel.codes import AVERAGED, ELASTIC, RIGID
from ..loops import ClosedLoop
from ..loops.closed_loop import PLANT_INPUTS
from ..memory import Module
from ..scene import Scene
from ..scene.run import start_of
from ..scene.schema import at_fidelity, is_elastic

Array = NDArray[np.float64]

# --- levels ---

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}

# outputs that a fidelity does not model, and why; everything else it has
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    fidelity: {one.name: need.reason for one in VARIABLES for need in one.needs if fidelity in need.lacking}
    for fidelity in FIDELITIES
}


@dataclass(frozen=True, eq=False)
class Level(ByContent):
    """Level of fidelity, by its numbers, at one setting, as it is printed, with what makes it."""

    fidelity: int
    setting: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the fidelity."""
        return FIDELITIES[self.fidelity]

    @property
    def values(self) -> dict[str, float]:
        """Parameters of the module for this level."""
        return {"fidelity": float(self.fidelity), **self.parameters}

    def row(self, step: float) -> Row:
        """Make the row of the level in communication steps, s, before anything is measured."""
        return Row(self.name, "", self.setting, step)


def event(fidelity: int, tolerance: float) -> Level:
    """Make a level from event to event, at a tolerance."""
    return Level(fidelity, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


TOLERANCES = tuple(10.0**-n for n in range(3, 12))


def all_levels(elastic: bool, few: bool = False) -> Iterator[Level]:
    """Yield the levels to measure, from coarse to fine, without prescribed motion; few for long scenes."""
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
# fidelity of a row of another integrator
PEER = "peer"
# what a run may end with: refusals, missing libraries, integrators that give up
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


@dataclass(frozen=True, eq=False)
class Row(ByContent):
    """Measurements of one run.

    Attributes:
        fidelity: its name, or "peer". method: of a peer, else "". setting: such as "tolerance 1e-06".
        communication_step: s. errors: by name, NaN where nothing is known.
        wall_time: s per simulated second, of the integration alone. evaluations: of the right-hand side.
        switches: counted, NaN where they are not. failure: why there is nothing measured, else "".
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
        """Fidelity and, of a peer, method."""
        return f"{self.fidelity}, {self.method}" if self.method else self.fidelity

    @property
    def label(self) -> str:
        """Fidelity, method and setting."""
        return f"{self.level}, {self.setting}" if self.setting else self.level

    def worst_of(self, wanted: Sequence[str]) -> tuple[float, str]:
        """Largest error of the wanted ones and where it is: NaN in one that nothing is known of."""
        errors = [(self.errors.get(name, math.nan), name) for name in wanted]
        return max(errors, key=lambda one: (math.isnan(one[0]), one[0]))

    def worst(self, wanted: Sequence[str]) -> float:
        """Largest error of the wanted ones; infinite where one is not known."""
        error, _ = self.worst_of(wanted)
        return math.inf if self.failure or math.isnan(error) else error

    def as_dict(self) -> dict[str, Any]:
        """Give the row for machines: what is not known is None."""
        heads = ("fidelity", "method", "setting", "communication_step", "errors")
        head = {name: getattr(self, name) for name in heads}
        costs = {name.partition(" ")[0]: getattr(self, cost) for name, cost in _COSTS.items()}
        told = {**head, **costs, "failure": self.failure}
        known: dict[str, Any] = to_jsonable_python(told, inf_nan_mode="null")
        return known


def attempt(head: Row, measure: Callable[[], dict[str, Any]]) -> Row:
    """Measure a run, which gives fields of Row by name; of one that fails the row has the reason."""
    try:
        found = measure()
    except FAILURES as error:
        found = {"failure": " ".join(str(error).split()) or type(error).__name__}
    return dataclasses.replace(head, **found)


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write all rows as CSV, failures too; whole or not at all."""
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
    """Read rows that write_rows has written; of another table a ValueError."""
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
    """Say in a line for each kind of run that failed why it did."""
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(found)}: {reason}" for reason, found in labels.items()]


# --- the cheapest that meets an accuracy ---

_NUMBER = {name: number for number, name in FIDELITIES.items()}


@dataclass(frozen=True, eq=False)
class Choice(ByContent):
    """Chosen level and the reasons.

    Attributes:
        row: the cheapest that meets the error in the wanted outputs. following: the next level that meets it
            too, or None. passed: cheaper levels and why not.
    """

    row: Row
    wanted: tuple[str, ...]
    error: float
    following: Row | None
    passed: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Wall time of the next level over that of the chosen one."""
        return None if self.following is None else self.following.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """Say what was chosen, why, and what the next level would cost."""

        def cost(row: Row) -> str:
            return f"{1e3 * row.wall_time:.3g} ms of kernel time per simulated second"

        error, worst = self.row.worst_of(self.wanted)
        met = f"error {error:.2g} ({worst}), requested {self.error:g}"
        lines = [f"chosen: {self.row.label}: {met}, {cost(self.row)}"]
        lines += [f"rejected: {label}: {reason}" for label, reason in self.passed.items()]
        if self.following is None:
            return [*lines, "next level: none"]
        reached = f"error {self.following.worst(self.wanted):.2g}, {cost(self.following)}"
        return [*lines, f"next level: {self.following.label}: {reached}, {self.ratio:.3g} times the run time"]

    def as_dict(self) -> dict[str, Any]:
        """Give the choice for machines."""

        def brief(row: Row) -> dict[str, Any]:
            errors = {name: row.errors[name] for name in self.wanted}
            return row.as_dict() | {"error": row.worst(self.wanted), "errors": errors}

        following = None if self.following is None else brief(self.following) | {"cost": self.ratio}
        asked = {"error": self.error, "wanted": list(self.wanted)}
        return {"asked": asked, "chosen": brief(self.row), "passed": dict(self.passed), "next": following}


def why_not(row: Row, error: float, wanted: Sequence[str]) -> str:
    """Say why a row does not meet an error, "" where it does."""
    if row.failure:
        return row.failure
    lacking = NOT_MODELLED.get(_NUMBER.get(row.fidelity, -1), {})
    for name in wanted:
        if name in lacking:
            return f"it {lacking[name]} ({name})"
    unknown = [name for name in wanted if math.isnan(row.errors.get(name, math.nan))]
    if unknown:
        return f"no reference for {', '.join(unknown)}"
    largest, worst = row.worst_of(wanted)
    return "" if largest <= error else f"error {largest:.2g} ({worst})"


def cheapest(rows: Sequence[Row]) -> Row | None:
    """Pick the cheapest by wall time; of settings of one level by right-hand sides, which do not jitter."""
    best: dict[tuple[str, float], Row] = {}
    for row in sorted(rows, key=lambda row: row.evaluations):
        best.setdefault((row.level, row.communication_step), row)
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> Choice:
    """Recommend the cheapest level of the module that meets an error in all wanted outputs.

    The next is the cheapest of a higher fidelity that meets it too, else the cheapest with a tenth of the
    error.

    Those of peers are left out. Where none meets it, the sentence tells how far the best gets.
    """
    ours = sorted((row for row in rows if row.fidelity in _NUMBER), key=lambda row: row.worst(wanted))
    meeting = [row for row in ours if not why_not(row, error, wanted)]
    chosen = cheapest(meeting)
    if chosen is None:
        best = (
            f"best: {ours[0].label}: {why_not(ours[0], error, wanted)}" if ours else "no level was measured"
        )
        asked = f"error = {error:g} in {', '.join(wanted)}"
        raise Refused(f"no fidelity level reaches {asked}; {best}")
    higher = [row for row in meeting if _NUMBER[row.fidelity] > _NUMBER[chosen.fidelity]]
    much = 0.1 * min(error, chosen.worst(wanted))
    finer = [row for row in meeting if row.worst(wanted) <= much and row.wall_time > chosen.wall_time]
    # one line a level: its best that is cheaper or, where nothing is known, any
    passed: dict[str, tuple[str, str]] = {}
    for row in ours:
        reason = why_not(row, error, wanted)
        if reason and not row.wall_time > chosen.wall_time:
            passed.setdefault(row.level, (row.label, reason))
    following = cheapest(higher) or cheapest(finer)
    return Choice(chosen, tuple(wanted), error, following, dict(passed.values()))


# --- on a terminal ---


def at_levels(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> list[Row]:
    """Pick a row for each fidelity and method: its cheapest that meets the error, else its most accurate.

    The cheapest is found as in recommend, so the recommended row is one of these.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, wanted)])
        or min(level, key=lambda row: row.worst(wanted))
        for level in levels.values()
    ]


def print_levels(title: str, rows: Sequence[Row], wanted: Sequence[str], error: float | None = None) -> None:
    """Print a line for each level of fidelity: its largest error in the wanted outputs, and its cost.

    The rows are of one communication step; the largest error allowed is 1 % where none is given.
    """
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    allowed = 0.01 if error is None else error
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("fidelity level", "setting", "error", "maximum in", "ms per s"):
        table.add_column(heading, no_wrap=heading != "maximum in")
    for row in at_levels(rows, allowed, wanted):
        largest, worst = row.worst_of(wanted)
        cost = text(1e3 * row.wall_time, ".3g")
        table.add_row(row.level, row.setting, text(largest, ".1e"), worst.replace("_", " "), cost)
    console = terminal()
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with an error of at most {allowed:g}, otherwise at its most"
        f" accurate setting; communication step {rows[0].communication_step:g} s;"
        " kernel time in ms per simulated second"
    )
    console.print(table)


# --- trial runs ---

# relative to the energy in, for they are small or zero by themselves
_ENERGIES = ("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual")


def timed(run: Callable[[], Any]) -> float:
    """Measure the wall time of a call, s."""
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def median_of(measure: Callable[[], float], repeats: int = 11) -> float:
    """Take the median of at most so many measurements; where they are slow of fewer, at least one."""
    found: list[float] = []
    begun = time.perf_counter()
    while len(found) < repeats and (not found or time.perf_counter() - begun < 0.5):
        found.append(measure())
    return statistics.median(found)


def median_time(run: Callable[[], Any], repeats: int = 11) -> float:
    """Measure the median wall time, s, of at most so many calls, as median_of."""
    return median_of(lambda: timed(run), repeats)


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[Sequence[float]],
    communication_step: float,
    repeats: int = 31,
) -> float:
    """Measure the time of the kernel for a run that succeeds, s: of all steps less of none, in turns.

    Args:
        module: that ran it. begin: its state before (Module.save).
        inputs: (omega1, load_torque, drive_torque) of each step.
    """
    given, lengths = np.array(inputs, dtype=float), np.full(len(inputs), communication_step)
    rows = np.empty((len(inputs) + 1, 0))

    def steps(number: int) -> float:
        module.restore(begin)
        given_steps = lengths[:number], PLANT_INPUTS, given[:number], (), rows[: number + 1]
        return timed(partial(module.take_steps, *given_steps))

    spent = median_of(lambda: steps(len(inputs)) - steps(0), repeats)
    # what can be measured takes 10 ns a call
    return max(spent, 1e-8 * len(inputs))


def run_in_process(scene: Scene, progress: Progress | None = None) -> Result:
    """Run a scene whose fidelity is chosen: all variables of the module and all signals of the loop."""
    loop = ClosedLoop(_started(scene), scene.surroundings, COMPUTED, scene.signal_units)
    return loop.run(scene.run.stop_time, progress)


def _started(scene: Scene) -> Module:
    values, inputs = start_of(scene)
    return Module().start(**values, **inputs)


def time_of(scene: Scene, record: Result) -> float:
    """Measure the time of the kernel in a scene, s per simulated second; record: of run_in_process."""
    plant = _started(scene)
    # the signals of a row are held over the step it begins, the other inputs over the run
    held = [record[name] if name in record else np.full(len(record), plant[name]) for name in PLANT_INPUTS]
    steps = np.transpose(held)[:-1].tolist()
    return kernel_time(plant, plant.save(), steps, scene.run.communication_step) / scene.run.stop_time


# --- errors over windows of time ---


def _features(record: Result, name: str, window: float) -> list[Array]:
    """Window means and, of what pulses, window RMS; the start itself is left out: it is no step.

    What is left over belongs to the last window.
    """
    values = record[name][1:]
    rows = max(round(window / float(record.time[1] - record.time[0])), 1)
    edges = np.arange(max(values.size // rows, 1)) * rows

    def means(values: Array) -> Array:
        return np.asarray(np.add.reduceat(values, edges) / np.diff(np.append(edges, values.size)))

    return [means(values), np.sqrt(means(values**2))] if name in NOT_MODELLED[AVERAGED] else [means(values)]


def window_errors(record: Result, exact: Result, window: float, fidelity: int) -> Mapping[str, float]:
    """Compute the error of each recorded output, NaN where the fidelity does not model it.

    Each is the largest difference over the windows, s, from the exact record over the same time, relative to
    the largest magnitude of the output in that; energies relative to the largest energy in.
    """
    largest_energy = float(np.abs(exact["energy_in"]).max())
    # evaluations are a matter of cost
    errors = {"rhs_evaluations": 0.0} | dict.fromkeys(NOT_MODELLED[fidelity], math.nan)
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
    """Set a scene to a level; where that has no elastic shaft, the driven mass is rigid with the hub."""
    values = {**at_fidelity(scene.given, level.fidelity), "method": None, "max_step": None, **level.values}
    tolerance = values.pop("tolerance", None)
    step = communication_step or scene.run.communication_step
    return scene.replaced(
        mechanism=values, accuracy={"tolerance": tolerance}, run={"communication_step": step}
    )


def reference_level(scene: Scene) -> Level:
    """Pick the finest level of a scene: elastic where it has parameters of an elastic output."""
    return event(ELASTIC if is_elastic(scene.given) else RIGID, 1e-12)


def measure_scene(
    scene: Scene,
    levels: Sequence[Level],
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Run a scene at levels in communication steps, s, or its own; rows of errors against the finest level.

    Refused where the reference itself is.
    """
    lengths = (scene.run.communication_step,) if steps is None else steps
    runs = [(level, step) for step in lengths for level in levels]

    def share(number: int) -> Progress:
        """Tell how much is done, of one of the runs and of the reference, which is the first."""
        tell = progress or (lambda done: None)
        return lambda done: tell((number + done) / (1 + len(runs)))

    reference = run_in_process(at_level(scene, reference_level(scene)), share(0))

    def measure(number: int, level: Level, step: float) -> dict[str, Any]:
        ours = at_level(scene, level, step)
        record = run_in_process(ours, share(number))
        last = record.last()
        return {
            "errors": window_errors(record, reference, scene.accuracy.window, level.fidelity),
            "wall_time": time_of(ours, record),
            "evaluations": last["rhs_evaluations"],
            "switches": math.nan if level.fidelity == AVERAGED else last["contact_switches"],
        }

    return [
        attempt(level.row(step), partial(measure, number, level, step))
        for number, (level, step) in enumerate(runs, 1)
    ]


# --- kept between runs ---


def measured_from(scene: Scene) -> dict[str, bytes]:
    """All that the measurements of a scene depend on: the simulated system, and the code."""
    chosen = {"mechanism": {"fidelity", "method", "max_step"}, "accuracy": {"tolerance", "error"}}
    others: dict[str, Any] = {"title": True, "description": True, "run": {"outputs"}}
    content = scene.model_dump_json(exclude_none=True, exclude=chosen | others)
    return sources("kernel/**/*.py", "loops/*.py", "fidelity/*.py") | {"scene": content.encode()}


def candidates(scene: Scene) -> list[Level]:
    """List the levels that are tried for a scene."""
    return list(all_levels(is_elastic(scene.given), few=True))


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Give the rows of the candidates for a scene, from the last time if nothing has changed since."""

    def measure() -> bytes:
        rows = measure_scene(scene, candidates(scene), progress=progress)
        with tempfile.TemporaryDirectory() as folder:
            return write_rows(Path(folder) / "trials.csv", rows).read_bytes()

    return read_rows(kept("trials.csv", measured_from(scene), measure))


def choose(scene: Scene, progress: Progress | None = None) -> tuple[Scene, Choice]:
    """Choose the cheapest level that meets accuracy.error in all of run.outputs; the scene at it, and why."""
    assert scene.accuracy.error is not None
    choice = recommend(trial_rows(scene, progress), scene.accuracy.error, scene.run.outputs)
    step = choice.row.communication_step
    (chosen,) = (one for one in candidates(scene) if one.row(step).label == choice.row.label)
    return at_level(scene, chosen), choice


# --- the trade: error over cost, on log-log axes ---

# label of a cost, and factor to the unit in it
_AXES = {
    "wall_time": ("kernel time [ms per simulated second]", 1e3),
    "evaluations": ("right-hand-side evaluations", 1.0),
}


def work_precision(rows: Sequence[Row], wanted: Sequence[str], title: str) -> Figure:
    """Draw the largest error in the wanted outputs over wall time and over right-hand sides.

    Each run is a mark, a dot of the module or a cross of a peer, in the colour of its level.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        if 0.0 < row.worst(wanted) < math.inf:
            name = row.method.partition(",")[0] if row.fidelity == PEER else row.level
            levels.setdefault(name, []).append(row)
    figure = Figure(figsize=(11.0, 5.5), dpi=110, layout="constrained")
    figure.suptitle(f"{title}: accuracy against run time", fontsize=11)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (cost, (label, factor)) in zip(panels, _AXES.items(), strict=True):
        for name, level in levels.items():
            costs, errors = (
                [factor * getattr(row, cost) for row in level],
                [row.worst(wanted) for row in level],
            )
            axes.loglog(costs, errors, "x" if level[0].fidelity == PEER else "o", markersize=4, label=name)
        axes.set_xlabel(label)
        axes.grid(alpha=0.3, linewidth=0.4)
    panels[0].set_ylabel("maximum relative error [1]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=8)
    return figure


def measured_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measure a scene at all levels, in its own communication step and in longer ones."""
    longer = (factor * scene.run.communication_step for factor in (1, 10, 100))
    steps = [step for step in longer if whole_steps(scene.run.stop_time, step)]
    levels = list(all_levels(is_elastic(scene.given)))
    return measure_scene(scene, levels, steps, progress)
