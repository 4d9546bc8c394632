"""Batch: arrays in, arrays out; the module run in memory over all of them, on all cores."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import Named, Refused, must_be
from ..common.units import number_of
from ..contract.variables import Variable
from ..harness.fmu import as_names, run
from ..harness.simulate import communication_points
from ..memory import Module

AnyArray = NDArray[Any]


def batch(
    values: Mapping[str, ArrayLike],
    stop_time: float = 1.0,
    outputs: str | Sequence[str] = "omega_out",
    step: float | None = None,
    workers: int | None = None,
) -> Mapping[str, AnyArray]:
    """Run the module over arrays of parameters and inputs: a run for each element, all broadcast together.

    Args:
        values: parameters and inputs by name: numbers, strings (units, names of items), or arrays of them.
        stop_time: stop time, s.
        outputs: names of variables.
        step: communication step, s, by default the whole run: it is fastest, and means are those of the run.
        workers: threads, by default one for each core.

    Returns:
        Outputs at the end by name, NaN where a run was refused, and `refused`, sentences why, else "". All
        have the shape that the values are broadcast to.

    Raises:
        Refused: an argument is wrong for all runs: a name, the times, the workers, arrays that cannot be
            broadcast together, or values of a name of which none has a suitable unit or is a known item.
    """
    known = Module.model.by_name
    names = [known[name].name for name in as_names(outputs)]
    lengths = np.diff(communication_points(stop_time, stop_time if step is None else step))
    if workers is not None and not (isinstance(workers, int) and workers > 0):
        raise Refused(must_be("workers", "a whole number of at least 1", repr(workers)))
    if not isinstance(values, Mapping):
        raise Refused(must_be("values", "numbers, strings or arrays by name", repr(values)))
    arrays = _broadcast({name: _readable(Module.settable(name), value) for name, value in values.items()})
    shape = next(iter(arrays.values())).shape if arrays else ()
    ends = np.full((len(names), *shape), np.nan)
    refused = np.full(shape, "", dtype=object)

    def run_one(place: Any) -> None:
        rows = np.empty((lengths.size + 1, len(names)))
        try:
            module = Module().start(**{name: array.item(place) for name, array in arrays.items()})
            run(module, lengths, {}, names, rows)
        except Refused as error:
            refused[place] = str(error)
        else:
            ends[:, *place] = rows[-1]

    Module().load_kernel()  # which lets go of the interpreter while it runs: threads are enough
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for _ in pool.map(run_one, np.ndindex(shape)):
            pass
    return Named({**dict(zip(names, ends, strict=True)), "refused": refused}, "batch output")


def _readable(variable: Variable, values: ArrayLike) -> AnyArray:
    """Return values of a variable as an array; raise Refused if the variable can read none of them."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise Refused(f"{variable.name} must be an array with rows of equal length: {error}") from None
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
        raise Refused(reason)
    return array


def _broadcast(arrays: Mapping[str, AnyArray]) -> dict[str, AnyArray]:
    """Broadcast arrays by name together; raise Refused with the names and shapes if that is impossible."""
    try:
        together = np.broadcast_arrays(*arrays.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.size != 1)
        raise Refused(f"values must have shapes that broadcast together: {shapes}") from None
    return dict(zip(arrays, together, strict=True))
