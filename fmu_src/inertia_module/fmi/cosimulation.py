"""Runs of any FMU: co-simulation of FMI 2.0 and 3.0 with values of all types; fmpy runs all other kinds.

The class `instance.Fmu` is faster, but it supports only numbers.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from ..common.errors import FmuError
from .experiments import TEXTS, Column, Table, size_of
from .instance import DISCARD, REALS, TERMINATED, Log
from .loading import instantiate

Array = NDArray[np.float64]
Values = list[float] | list[str]
# function that receives the time, s, and the values of the outputs by name
Sample = Callable[[float, dict[str, Values]], None]

# type in the names of the functions get… and set…, if it differs from the type of the variable
CALLS_2 = {"Enumeration": "Integer"}
CALLS_3 = {"Real": "Float64", "Integer": "Int32", "Enumeration": "Int64"}


class Plan(NamedTuple):
    """A run of an FMU.

    Attributes:
        times: communication points, s, shape (steps + 1,).
        outputs: variables of fmpy to read at each communication point.
        tolerance: relative tolerance, or None.
        start: pairs of a variable and its start values.
        inputs: table of the inputs, or None.
        events: True to use event mode and early return (FMI 3.0).
    """

    times: Array
    outputs: Sequence[Any]
    tolerance: float | None = None
    start: Sequence[tuple[Any, Values]] = ()
    inputs: Table | None = None
    events: bool = False


class Outputs:
    """Reads variables of an instance, with one call for each type.

    Args:
        variables: variables of fmpy.
        with_sizes: True if arrays are possible (FMI 3.0).
    """

    def __init__(self, variables: Iterable[Any], with_sizes: bool) -> None:
        self._kinds: dict[str, list[Any]] = {}
        self._with_sizes, self._calls = with_sizes, CALLS_3 if with_sizes else CALLS_2
        for variable in variables:
            if variable.type != "Clock":
                self._kinds.setdefault(variable.type, []).append(variable)

    def read(self, instance: Any) -> dict[str, Values]:
        """Return the elements of each variable by name.

        Args:
            instance: instance of fmpy.
        """
        result: dict[str, Values] = {}
        for kind, variables in self._kinds.items():
            sizes = [size_of(variable) for variable in variables]
            more = {"nValues": sum(sizes)} if self._with_sizes else {}
            call = getattr(instance, f"get{self._calls.get(kind, kind)}")
            values = call([variable.valueReference for variable in variables], **more)
            begin = 0
            for variable, size in zip(variables, sizes, strict=True):
                result[variable.name] = [_plain(value, kind) for value in values[begin : begin + size]]
                begin += size
        return result


def _plain(value: Any, kind: str) -> Any:
    """Return a value of fmpy as a number or a text; binary data as hexadecimal digits, as in CSV files."""
    if kind not in TEXTS:
        return float(value)
    if isinstance(value, bytes):
        return value.hex() if kind == "Binary" else value.decode("utf-8", "replace")
    return value or ""


def set_values(instance: Any, variable: Any, values: Values) -> None:
    """Set all elements of a variable.

    Args:
        instance: instance of fmpy.
        variable: variable of fmpy.
        values: numbers or texts, one for each element.
    """
    converted: list[Any] = list(values)
    if variable.type == "Binary":
        converted = [bytes.fromhex(str(text)) for text in values]
    elif variable.type == "Boolean":
        converted = [bool(number) for number in values]
    elif variable.type not in (*REALS, *TEXTS):
        converted = [round(float(number)) for number in values]
    getattr(instance, f"set{variable.type}")([variable.valueReference], converted)


class Inputs:
    """Sets the inputs of a table: continuous inputs are interpolated, others have the value of the last row.

    Args:
        table: table of the inputs, or None.
    """

    def __init__(self, table: Table | None) -> None:
        self._table = table

    def apply(self, instance: Any, time: float) -> None:
        """Set the inputs at a time.

        Args:
            instance: instance of fmpy.
            time: simulation time, s.
        """
        if self._table is None:
            return
        rows = self._table.time
        last = max(int(np.searchsorted(rows, time + 1e-9 * abs(time), "right")) - 1, 0)
        share = 0.0
        if last + 1 < rows.size and time > rows[last]:
            share = float((time - rows[last]) / (rows[last + 1] - rows[last]))
        for column in self._table.columns.values():
            set_values(instance, column.variable, _values_at(column, last, share))


def _values_at(column: Column, row: int, share: float) -> Values:
    """Return the values of a column in a row, or between this row and the next one (share 0 to 1)."""
    if isinstance(column.values, list):
        return [column.values[row]]
    values = column.values[row]
    if share > 0.0 and column.variable.variability == "continuous":
        values = values + share * (column.values[row + 1] - values)
    return [float(number) for number in values]


def run(description: Any, folder: str, plan: Plan, log: Log, sample: Sample) -> bool:
    """Run an unpacked FMU.

    Args:
        description: model description of fmpy.
        folder: folder of the unpacked FMU.
        plan: the run.
        log: log that receives the messages of the FMU.
        sample: function that receives the outputs at each communication point.

    Returns:
        True if the FMU ends the simulation.

    Raises:
        FmuError, FMICallException, other errors of fmpy: the FMU fails.
    """
    if plan.events or description.coSimulation is None or description.fmiVersion.startswith("1."):
        return _run_by_fmpy(description, folder, plan, log, sample)
    instance = instantiate(description, folder, description.modelName, log)
    is_over = _co_simulate(instance, plan, Outputs(plan.outputs, description.fmiVersion[0] == "3"), sample)
    with contextlib.suppress(FMICallException):  # an instance that ends the simulation may reject the call
        instance.terminate()
    instance.freeInstance()
    return is_over


def _co_simulate(instance: Any, plan: Plan, outputs: Outputs, sample: Sample) -> bool:
    """Initialise an instance and step it; return True if it ends the simulation."""
    inputs, first, last = Inputs(plan.inputs), float(plan.times[0]), float(plan.times[-1])
    instance.setupExperiment(plan.tolerance, first, last)
    for variable, values in plan.start:
        set_values(instance, variable, values)
    inputs.apply(instance, first)
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    sample(first, outputs.read(instance))
    for begin, end in pairwise(plan.times.tolist()):
        inputs.apply(instance, begin)
        if _advance(instance, begin, end):
            return True
        sample(end, outputs.read(instance))
    return False


def _advance(instance: Any, begin: float, end: float) -> bool:
    """Advance an instance from one time to another, s; return True if it ends the simulation."""
    try:
        # with FMI 2.0 the call returns None
        result = instance.doStep(begin, end - begin)
    except FMICallException as error:
        if error.status == DISCARD and _ends_simulation(instance):
            return True
        raise FmuError(f"at time {begin:.9g} s: {error}") from error
    if result is not None and result[2]:
        raise FmuError(f"at time {begin:.9g} s: the step returns early, but early return is not allowed")
    return False


def _ends_simulation(instance: Any) -> bool:
    """Return True if the discarded step of an instance ends the simulation."""
    with contextlib.suppress(Exception):
        return bool(instance.getBooleanStatus(TERMINATED))
    return False


def _run_by_fmpy(description: Any, folder: str, plan: Plan, log: Log, sample: Sample) -> bool:
    """Run an FMU for model exchange, of FMI 1.0 or with events with fmpy; return True if it ends the run."""
    outputs = Outputs(plan.outputs, description.fmiVersion[0] == "3")
    last = float(plan.times[-1])
    last_time = -math.inf

    def step_finished(time: float, recorder: Any) -> bool:
        nonlocal last_time
        last_time = time
        recorder.rows.clear()
        sample(time, outputs.read(recorder.fmu))
        return True

    def take_message(environment: int | None, instance: bytes, *message: Any) -> None:
        log.take(environment, *message)

    simulate_fmu(
        folder,
        validate=False,
        model_description=description,
        start_time=float(plan.times[0]),
        stop_time=last,
        output_interval=float(plan.times[1] - plan.times[0]),
        output=[],
        relative_tolerance=plan.tolerance,
        debug_logging=True,
        remote_platform=None,
        use_event_mode=plan.events,
        early_return_allowed=plan.events,
        step_finished=step_finished,
        logger=log.take if description.fmiVersion[0] == "3" else take_message,
    )
    return last_time < last - 1e-6 * float(plan.times[-1] - plan.times[0])
