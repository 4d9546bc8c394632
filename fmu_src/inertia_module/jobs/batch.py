"""Batch: arrays in, arrays out; the module run in memory over all of them, on all cores."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import Named, Refused
from ..harness.fmu import as_names, run
from ..harness.simulate import communication_points
from ..memory import Module


def batch(
    values: Mapping[str, ArrayLike],
    stop_time: float = 1.0,
    outputs: str | Sequence[str] = "omega_out",
    step: float | None = None,
    workers: int | None = None,
) -> Mapping[str, NDArray[Any]]:
    """Run the module over arrays of parameters and inputs: a run for each element, all broadcast together.

    Args:
        values: parameters and inputs by name: numbers, strings (units, names of items), or arrays of them.
        stop_time: s. outputs: names of variables.
        step: communication step, s, by default the whole run: it is fastest, and means are those of the run.
        workers: threads, by default one for each core.

    Returns:
        Outputs at the end by name, NaN where a run was refused, and `refused`, sentences why, else "". All
        have the shape that the values are broadcast to.

    Raises:
        Refused: an unknown name, no positive time. ValueError: arrays that cannot be broadcast together.
    """
    known = Module.model.by_name  # which tells a name that it has not
    names = [known[name].name for name in as_names(outputs)]
    given = zip(values, np.broadcast_arrays(*values.values()), strict=True)
    arrays = {known[name].name: array for name, array in given}
    shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    lengths = np.diff(communication_points(stop_time, stop_time if step is None else step))
    found = np.full((len(names), *shape), np.nan)
    refused = np.full(shape, "", dtype=object)

    def one(place: Any) -> None:
        rows = np.empty((lengths.size + 1, len(names)))
        try:
            module = Module().start(**{name: array[place].item() for name, array in arrays.items()})
            run(module, lengths, {}, names, rows)
        except Refused as error:
            refused[place] = str(error)
        else:
            found[:, *place] = rows[-1]

    Module().load_kernel()  # which lets go of the interpreter while it runs: threads are enough
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for _ in pool.map(one, np.ndindex(shape)):
            pass
    return Named({**dict(zip(names, found, strict=True)), "refused": refused}, "an output of the batch")
