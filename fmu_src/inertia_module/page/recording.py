"""A recorded run, packed for a page: single precision, compressed, every so many rows if it is long."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np

from ..harness.simulate import Result

# numbers in a page at most: not compressed at all they take 1.5 MB of it
MOST = 280_000


def packed(content: bytes) -> str:
    """Bytes as text: compressed (raw deflate), base64."""
    compressor = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    return base64.b64encode(compressor.compress(content) + compressor.flush()).decode()


def page_run(record: Result, warnings: tuple[str, ...] = ()) -> dict[str, Any]:
    """A run for the page (the interface Recorded of page/src/run/recorded.ts), ready for JSON.

    Args:
        record: with all of variables.COMPUTED, at equal steps of time. warnings: of the FMU.
    """
    names = [name for name in record.names if name != "time"]
    stride = -(-len(record) * len(names) // MOST)
    rows = slice(None, None, stride)
    columns = np.stack([record[name][rows] for name in names]).astype("<f4")
    return {
        "names": names,
        "units": record.units,
        "step": float(record.time[1] - record.time[0]) * stride,
        "rows": columns.shape[1],
        "every": stride,
        "numbers": packed(columns.tobytes()),
        "warnings": list(warnings),
    }
