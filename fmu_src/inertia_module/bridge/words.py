"""Bytes as a vector of doubles that survives whatever a library does with a state vector.

Six bytes to a double: a whole number below 2^48, which every copy, print and CSV file keeps.
(Reinterpreted as doubles, states would hold NaN and denormals, which not every copy keeps.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BYTES = 6
_LIMIT = 2.0 ** (8 * BYTES)


def words_of(data: bytes) -> NDArray[np.float64]:
    """Bytes as whole numbers, shape (n,); the first is the count of bytes."""
    padded = np.frombuffer(data + bytes(-len(data) % BYTES), dtype=np.uint8).reshape(-1, BYTES)
    wide = np.zeros((len(padded), 8), dtype=np.uint8)
    wide[:, :BYTES] = padded
    return np.concatenate([[float(len(data))], wide.view("<u8")[:, 0].astype(np.float64)])


def bytes_of(words: NDArray[np.float64]) -> bytes:
    """What words_of was given.

    Raises:
        ValueError: the numbers are none of words_of: a state that has been changed.
    """
    whole = np.isfinite(words) & (words >= 0.0) & (words < _LIMIT) & (words == np.floor(words))
    count = (len(words) - 1) * BYTES
    if not whole.all() or not count - BYTES < words[0] <= count:
        place = int(np.argmin(whole))
        raise ValueError(
            f"number {place} of a whole state, {words[place]:.17g}, is refused: allowed is a state the system"
            " has given, unchanged (state = 'motion' has one that can be changed)"
        )
    narrow = words[1:].astype("<u8").view(np.uint8).reshape(-1, 8)[:, :BYTES]
    return narrow.tobytes()[: int(words[0])]
