"""A recorded run, packed for a page: single precision, compressed, every so many rows if it is long."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..harness.simulate import Result

# numbers in a page at most: not compressed at all they take 1.5 MB of it
MOST = 280_000
# what a row stands for that has those before it in it, by the ending of the name
OVER_ROWS: dict[str, Callable[..., Any]] = {"_mean": np.mean, "_peak": np.max}


def packed(content: bytes) -> str:
    """Bytes as text: compressed (raw deflate), base64."""
    compressor = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    return base64.b64encode(compressor.compress(content) + compressor.flush()).decode()


def _every(values: NDArray[np.float64], stride: int, name: str) -> NDArray[np.float64]:
    """One row of so many: of means over a step the mean, of peaks the greatest since the row before."""
    over = next((over for ending, over in OVER_ROWS.items() if name.endswith(ending)), None)
    rows = values[::stride].copy()
    if over is not None:
        rows[1:] = over(values[1 : 1 + stride * (rows.size - 1)].reshape(-1, stride), axis=1)
    return rows


def page_run(record: Result, warnings: tuple[str, ...] = ()) -> dict[str, Any]:
    """A run for the page (the interface Recorded of page/src/run/recorded.ts), ready for JSON.

    Args:
        record: with all of variables.COMPUTED, at equal steps of time. warnings: of the FMU.
    """
    names = [name for name in record.names if name != "time"]
    stride = -(-len(record) * len(names) // MOST)
    columns = np.stack([_every(record[name], stride, name) for name in names]).astype("<f4")
    return {
        "names": names,
        "units": record.units,
        "step": float(record.time[1] - record.time[0]) * stride,
        "rows": columns.shape[1],
        "every": stride,
        "numbers": packed(columns.tobytes()),
        "warnings": list(warnings),
    }
