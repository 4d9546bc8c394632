"""Batch: run the module in memory over arrays of parameters and inputs, on all cores."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import InertiaModuleError, Named, ParameterError, must_be
from ..common.units import number_of
from ..fmi.instance import as_names, run
from ..fmi.simulate import communication_points
from ..interface.variables import Variable
from ..model import Module

AnyArray = NDArray[Any]


def batch(
    values: Mapping[str, ArrayLike],
    stop_time: float = 1.0,
    outputs: str | Sequence[str] = "omega_out",
    step: float | None = None,
    workers: int | None = None,
) -> Mapping[str, NDArray[np.float64] | NDArray[np.object_]]:
    """Run the module over arrays of parameters and inputs, broadcast together: one run per element.

    Args:
        values: Parameters and inputs by name: numbers, strings (with units, or names of items), or arrays.
        stop_time: Stop time, s.
        outputs: Names of variables.
        step: Communication step, s; None for the whole run. One step is fastest, and step means then cover
            the run.
        workers: Number of threads; None for one per core.

    Returns:
        Outputs at the stop time by name, NaN for failed runs, and `refused`, the message of a failed run or
        "". All have the shape of the broadcast values.

    Raises:
        ParameterError: An argument is invalid for all runs: a name, the times, the workers, arrays that do
            not broadcast together, or a name without any valid value.
    """
    variables = Module.model.by_name
    names = [variables[name].name for name in as_names(outputs)]
    lengths = np.diff(communication_points(stop_time, stop_time if step is None else step))
    if workers is not None and not (isinstance(workers, int) and workers > 0):
        raise ParameterError(must_be("workers", "a whole number of at least 1", repr(workers)))
    if not isinstance(values, Mapping):
        raise ParameterError(must_be("values", "numbers, strings or arrays by name", repr(values)))
    arrays = _broadcast({name: _readable(Module.settable(name), value) for name, value in values.items()})
    shape = next(iter(arrays.values())).shape if arrays else ()
    ends = np.full((len(names), *shape), np.nan)
    refused = np.full(shape, "", dtype=object)

    def run_at(place: Any) -> None:
        rows = np.empty((lengths.size + 1, len(names)))
        try:
            module = Module().start(**{name: array.item(place) for name, array in arrays.items()})
            run(module, lengths, {}, names, rows)
        except InertiaModuleError as error:
            refused[place] = str(error)
        else:
            ends[:, *place] = rows[-1]

    Module().load_kernel()  # the kernel releases the interpreter lock, so threads run in parallel
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for _ in pool.map(run_at, np.ndindex(shape)):
            pass
    return Named({**dict(zip(names, ends, strict=True)), "refused": refused}, "batch output")


def _readable(variable: Variable, values: ArrayLike) -> AnyArray:
    """Return values of a variable as an array; reject them if none is valid for the variable."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ParameterError(f"{variable.name} must be an array with rows of equal length: {error}") from None
    reason = ""
    for value in array.ravel().tolist():
        try:
            if not isinstance(value, float):  # NaN and infinite numbers are values out of range
                number_of(value, variable.unit or "1", variable.items)
        except ValueError as error:
            reason = reason or f"{must_be(variable.name, variable.allowed, repr(value))}: {error}"
        else:
            return array
    if reason:
        raise ParameterError(reason)
    return array


def _broadcast(arrays: Mapping[str, AnyArray]) -> dict[str, AnyArray]:
    """Broadcast arrays together; reject incompatible shapes with names and shapes in the message."""
    try:
        broadcast = np.broadcast_arrays(*arrays.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.size != 1)
        raise ParameterError(f"values must have shapes that broadcast together: {shapes}") from None
    return dict(zip(arrays, broadcast, strict=True))
