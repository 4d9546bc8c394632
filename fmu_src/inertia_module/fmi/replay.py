"""Replay of the reference experiments in an FMU, and the deviations from their results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FmuError, sentence_of, unknown
from .cosimulation import Array, Plan, Values, run
from .experiments import RELATIVE_DEVIATION, TEXTS, Column, Experiment, Table, read_table, value_of
from .instance import Log
from .report import Deviation, Journal, listed
from .times import ROUNDING, span_of

# maximum number of steps of an experiment
MAX_STEPS = 1_000_000


def replay(description: Any, folder: Path, journal: Journal, experiment: Experiment) -> None:
    """Replay an experiment and report the deviations from its results.

    Args:
        description: model description of fmpy.
        folder: folder of the unpacked FMU.
        journal: journal that receives the report.
        experiment: the experiment.
    """
    report, log = journal.report, Log()
    journal.begin(f"experiment {experiment.name}")
    try:
        variables = {variable.name: variable for variable in description.modelVariables}
        expected = read_table(folder, experiment.results, variables)
        plan = _plan(description, folder, experiment, expected, variables)
        recorder = _Recorder(journal, plan)
        is_over = run(description, str(folder), plan, log, recorder.take)
        if log.errors:
            raise FmuError("the FMU logs an error")
    except Exception as error:
        reason = "; ".join(listed(log.errors)) or sentence_of(error)
        report.problems.append(f"experiment {experiment.name} failed: {reason}")
        return
    if is_over:
        report.facts[experiment.name] = f"{recorder.times[-1]:g} s; the FMU ends the simulation"
    for deviation in deviations(experiment, expected, recorder.table()):
        report.references.append(deviation)
        if deviation.deviation > deviation.allowed:
            report.problems.append(
                f"{experiment.name}: {deviation.variable} deviates from its reference by {deviation}"
            )


def _plan(
    description: Any, folder: Path, experiment: Experiment, expected: Table, variables: Mapping[str, Any]
) -> Plan:
    """Return the run of an experiment; without a stop time it ends at the last result."""
    for name in experiment.parameters:
        if name not in variables:
            raise FmuError(unknown("variable", name, variables))
    start = [
        (variables[name], value_of(variables[name], text)) for name, text in experiment.parameters.items()
    ]
    inputs = None
    if experiment.inputs is not None:
        table = read_table(folder, experiment.inputs, variables)
        # a measurement may contain results in addition to the inputs
        columns = {name: column for name, column in table.columns.items() if _is_input(column)}
        inputs = Table(table.time, columns)
    span = span_of(description, {"stopTime": float(expected.time[-1]), **experiment.settings})
    outputs = {column.variable.name: column.variable for column in expected.columns.values()}
    tolerance = experiment.settings.get("tolerance")
    return Plan(
        span.times(MAX_STEPS), list(outputs.values()), float(tolerance) if tolerance else None, start, inputs
    )


def _is_input(column: Column) -> bool:
    """Return True if a column can be set during a run."""
    variable = column.variable
    return column.element is None and (
        variable.causality == "input"
        or (variable.causality == "parameter" and variable.variability == "tunable")
    )


class _Recorder:
    """Outputs of a run over time.

    Args:
        journal: journal that receives the progress.
        plan: the run.

    Attributes:
        times: communication points, s.
    """

    def __init__(self, journal: Journal, plan: Plan) -> None:
        self._journal, self._plan = journal, plan
        self.times: list[float] = []
        self._rows: dict[str, list[Values]] = {variable.name: [] for variable in plan.outputs}

    def take(self, time: float, values: dict[str, Values]) -> None:
        """Store the values of a communication point.

        Args:
            time: simulation time, s.
            values: values of the outputs by name.
        """
        self.times.append(time)
        for name, elements in values.items():
            self._rows[name].append(elements)
        self._journal.reach(time, (len(self.times) - 1) / (self._plan.times.size - 1))

    def table(self) -> Table:
        """Return all stored values as a table."""
        columns = {}
        for variable in self._plan.outputs:
            rows = self._rows[variable.name]
            values: Any = [row[0] for row in rows] if variable.type in TEXTS else np.array(rows, dtype=float)
            columns[variable.name] = Column(variable, None, values)
        return Table(np.array(self.times), columns)


# --- deviations ---


def deviations(experiment: Experiment, expected: Table, recorded: Table) -> Iterator[Deviation]:
    """Yield the maximum deviation of each variable from the results of an experiment, up to the end of a run.

    Args:
        experiment: the experiment with the allowed deviations.
        expected: results of the experiment.
        recorded: outputs of the run.
    """
    rounding = ROUNDING * float(recorded.time[1] - recorded.time[0]) if recorded.time.size > 1 else 0.0
    rows = max(int(np.searchsorted(expected.time, recorded.time[-1] + rounding, "right")), 1)
    time = expected.time[:rows]
    left = np.searchsorted(recorded.time, time + rounding, "right") - 1
    right = np.searchsorted(recorded.time, time - rounding, "left")
    left, right = left.clip(0), right.clip(None, recorded.time.size - 1)
    for heading, column in expected.columns.items():
        values = recorded.columns[column.variable.name].values
        if isinstance(column.values, list) or isinstance(values, list):
            texts = zip(column.values, left, right, strict=False)
            distance = np.array([float(text not in (values[i], values[j])) for text, i, j in texts])
            yield _maximum(experiment.name, heading, distance, 0.0, time)
            continue
        values = values if column.element is None else values[:, [column.element]]
        reference = column.values[:rows]
        distance = _distance(time, reference, recorded.time, values, left, right, column.variable)
        maximum = float(np.abs(column.values).max()) or abs(float(column.variable.nominal or 1.0))
        allowed = experiment.allowed.get(heading, RELATIVE_DEVIATION * maximum)
        yield _maximum(experiment.name, heading, distance, allowed, time)


def _maximum(experiment: str, heading: str, distance: Array, allowed: float, time: Array) -> Deviation:
    """Return the maximum of the deviations at the times of the results."""
    worst = int(np.argmax(distance))
    return Deviation(experiment, heading, float(distance[worst]), allowed, float(time[worst]))


def _distance(
    time: Array,
    reference: Array,
    times: Array,
    values: Array,
    left: NDArray[np.intp],
    right: NDArray[np.intp],
    variable: Any,
) -> Array:
    """Return the deviations at the times of the results, shape (rows,).

    The outputs between two communication points are interpolated. For a variable that is not continuous, all
    values between the two neighbours are correct. At an event the results contain several rows with the same
    time, and all values between these rows are correct.

    Args:
        time: times of the results, s, shape (rows,).
        reference: the results, shape (rows, elements).
        times: communication points, s, shape (points,).
        values: outputs at the communication points, shape (points, elements).
        left: index of the last communication point before each row, shape (rows,).
        right: index of the first communication point after each row, shape (rows,).
        variable: variable of fmpy.
    """
    before, after = values[left], values[right]
    low, high = np.minimum(before, after), np.maximum(before, after)
    if variable.variability == "continuous":
        length = np.where(right > left, times[right] - times[left], 1.0)
        share = ((time - times[left]) / length).clip(0.0, 1.0)[:, np.newaxis]
        low = high = before + share * (after - before)
    events = np.flatnonzero(np.diff(time, prepend=-np.inf) > 0.0)
    sizes = np.diff(events, append=time.size)
    minimum = np.repeat(np.minimum.reduceat(reference, events, axis=0), sizes, axis=0)
    maximum = np.repeat(np.maximum.reduceat(reference, events, axis=0), sizes, axis=0)
    distance: Array = np.maximum(np.maximum(minimum - high, low - maximum), 0.0).max(axis=1, initial=0.0)
    return distance
