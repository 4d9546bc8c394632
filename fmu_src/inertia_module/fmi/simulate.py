"""Simulation of an FMU: a run from a table of inputs to a table of results."""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.deprecated import renamed_arguments, renamed_names
from ..common.errors import ParameterError, SimulationTerminated, listed, must_be, unknown
from ..common.terminal import Progress, progress_bar
from ..common.time_range import time_warnings
from ..common.units import split_quantity
from .instance import Fmu, FmuError, Plant, as_names, fmu_file, is_number, read_description, run
from .results import TIME, Result, TableError

__all__ = ["Fmu", "FmuError", "Plant", "Progress", "Result", "TableError", "progress_bar", "simulate_fmu"]

# maximum number of steps of a run, with which each recorded column needs 800 MB
MAX_STEPS = 100_000_000


def input_table(inputs: Result | Mapping[str, ArrayLike] | Path | str) -> Result:
    """Convert inputs to a table.

    Args:
        inputs: a Result, columns by name (scalars are constant), or the path of a CSV file.

    Raises:
        TableError: a value is no number, or the columns are no table over time.
    """
    if isinstance(inputs, Result):
        return inputs
    if isinstance(inputs, str | Path):
        return Result.from_csv(inputs)
    columns, units = {}, {}
    for name, values in inputs.items():
        try:
            number, unit = split_quantity(values) if isinstance(values, str) else (values, "")
            columns[name] = np.atleast_1d(np.asarray(number, dtype=float))
        except (TypeError, ValueError) as error:
            demand = must_be(name, "numbers, or a string with a unit", repr(values))
            raise TableError(f"{demand}: {error}") from None
        if unit:
            units[name] = unit
    columns.setdefault(TIME, np.zeros(1))
    n = columns[TIME].size
    constant = {name: np.full(n, values[0]) for name, values in columns.items() if values.size == 1}
    return Result.from_columns(columns | constant, units)


def _checked_unit(name: str, variables: Mapping[str, Any], file: str, table: Result) -> str:
    """Return the unit of a column in an FMU, or ""; raise TableError if the FMU cannot use the column."""
    variable = variables.get(name)
    if variable is None:
        names = (other for other, v in variables.items() if v.causality in ("input", "output"))
        raise TableError(f"{file}: {unknown('input or output', name, names)}")
    if variable.causality == "parameter" and variable.variability != "tunable":
        raise TableError(f"{name} is a fixed parameter of {file}. Set it with parameters, not as a column.")
    unit = variable.unit or ("1" if name in table.units else "")
    # both raise an error if the column is unreadable, the first one also if its unit is incompatible
    if unit:
        table.converted({name: unit})
    else:
        table[name]
    return str(unit)


def _convert_for_fmu(description: Any, file: str, table: Result) -> tuple[Result, list[str]]:
    """Return a table in the units of an FMU, and the names of its columns that are inputs.

    Columns of computed variables are renamed to NAME_measured. In a file, a column that is no input may have
    any name, unit and content: an unusable one is omitted with a warning.
    """
    variables = {variable.name: variable for variable in description.modelVariables}
    settable = [name for name, v in variables.items() if v.causality in ("input", "parameter")]
    units: dict[str, str] = {}
    unused: dict[str, TableError] = {}
    origin = table.origin
    for name in (*table.names[1:], *(origin.unread if origin else ())):
        try:
            units[name] = _checked_unit(name, variables, file, table)
        except TableError as error:
            if origin is None or name in settable:
                raise
            unused[name] = error
    inputs = [name for name in units if name in settable]
    if unused and not inputs:
        raise next(iter(unused.values()))
    if unused and origin:
        text = f"{origin.path}: columns that are not inputs or readable outputs of {file} are ignored: "
        warnings.warn(text + listed(unused), stacklevel=3)
    table = table.without(unused.keys()).converted({name: unit for name, unit in units.items() if unit})
    names = {name: name if name in (TIME, *inputs) else f"{name}_measured" for name in table.names}
    columns = {names[name]: values for name, values in table.columns.items()}
    return Result(columns, {names[name]: unit for name, unit in table.units.items()}, origin), inputs


@renamed_arguments(path="fmu")
def simulate_fmu(
    fmu: Path | str | None,
    inputs: Result | Mapping[str, ArrayLike] | Path | str,
    stop_time: float,
    step: float,
    outputs: str | Sequence[str] | None = None,
    parameters: Mapping[str, float | bool | str] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> Result:
    """Simulate an FMU with a table of inputs and record outputs at every communication point.

    Args:
        fmu: path of the .fmu file; None for current_fmu().
        inputs: arrays by name (with time), a Result, or the path of a CSV file. The inputs are interpolated
            linearly between rows and constant before the first and after the last row. Two rows with the same
            time are a step. Columns in other units (`omega1 [rpm]`) are converted. Columns of computed
            variables are measured values. Other columns of a file are omitted with a warning.
        stop_time: stop time, s; the run starts at 0.
        step: communication step, s; the last step is shortened to end at stop_time.
        outputs: names of variables to record, or a single name; None for all outputs.
        parameters: start values by name: numbers, strings with a unit ("90 deg"), enumerations by number
            or item name.
        tolerance: relative tolerance of the experiment, or None.
        progress: function that receives the completed share, 0 to 1; by default runs over two seconds show a
            progress bar.

    Returns:
        Table of time, inputs, measured values (`omega_out_measured`) and outputs, shape (steps + 1,) each; it
        is shorter if the FMU ends the simulation.

    Raises:
        FmuError: the FMU rejects a value or a step.
        TableError: the inputs are not a table, not inputs of this FMU, or not within the run.
        ParameterError: stop_time or step is not positive, or there are too many steps.
    """
    times = communication_points(stop_time, step)
    path = fmu_file(fmu)
    description = read_description(path)
    outputs = _outputs_of(description) if outputs is None else as_names(outputs)
    table, names = _convert_for_fmu(description, path.name, input_table(inputs))
    label = table.origin.path if table.origin else "inputs"
    for text in time_warnings(label, table.time, [table[name] for name in names], stop_time):
        warnings.warn(text, stacklevel=2)
    columns = {name: np.interp(times, table.time, table[name]) for name in table.names[1:]}
    input_columns = {name: columns[name][:-1] for name in names}
    start = {name: float(values[0]) for name, values in input_columns.items()}
    with contextlib.ExitStack() as stack:
        instance = stack.enter_context(Fmu(path, parameters, start, tolerance, stop_time=stop_time))
        report = progress or stack.enter_context(progress_bar(f"simulating {path.name}"))
        rows = np.empty((times.size, len(table.names) + len(outputs)))
        rows[:, : len(table.names)] = np.transpose([times, *columns.values()])
        try:
            run(instance, np.diff(times), input_columns, outputs, rows[:, len(table.names) :], report)
        except SimulationTerminated:
            rows = rows[: int(np.searchsorted(times, instance.time, "right"))]
        units = table.units | {name: instance.units[name] for name in outputs if name in instance.units}
    return Result.from_rows((TIME, *columns, *outputs), rows, units)


def _outputs_of(description: Any) -> tuple[str, ...]:
    """Return the names of all outputs of an FMU that are numbers."""
    variables = description.modelVariables
    return tuple(v.name for v in variables if v.causality == "output" and is_number(v))


def check_number_of_steps(stop_time: float, step: float, name: str = "step") -> None:
    """Check that a run has no more than MAX_STEPS steps.

    Args:
        stop_time: stop time, s.
        step: communication step, s.
        name: name of the step in the message.

    Raises:
        ParameterError: there are more steps.
    """
    if stop_time > step * MAX_STEPS:
        allowed = f"at least {stop_time / MAX_STEPS:g} s, for at most {MAX_STEPS:,} steps"
        raise ParameterError(must_be(name, allowed, step))


def whole_steps(duration: float, step: float) -> int:
    """Return the number of steps in a duration; 0 if it is not an integer within 1e-6.

    Args:
        duration: duration, s.
        step: communication step, s.
    """
    number = duration / step
    return max(round(number), 0) if math.isfinite(number) and abs(number - round(number)) <= 1e-6 else 0


def communication_points(stop_time: float, step: float) -> NDArray[np.float64]:
    """Return the communication points 0, step, 2 step ... and stop_time, s, shape (steps + 1,).

    A remainder below 1e-9 of a step is omitted.

    Args:
        stop_time: stop time, s.
        step: communication step, s.

    Raises:
        ParameterError: stop_time or step is not positive, or there are more than MAX_STEPS steps.
    """
    for name, value in (("stop_time", stop_time), ("step", step)):
        if not (isinstance(value, Real) and math.isfinite(value) and value > 0.0):
            raise ParameterError(must_be(name, "a positive number of seconds", repr(value)))
    check_number_of_steps(stop_time, step)
    count = max(math.ceil(stop_time / step - 1e-9), 1)
    times = np.arange(count + 1, dtype=np.float64) * step
    times[-1] = stop_time
    return times


__getattr__ = renamed_names(__name__, drive="simulate_fmu")
