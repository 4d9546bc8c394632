"""Bytes as a vector of doubles that survives whatever a library does with a state vector.

Six bytes to a double: a whole number below 2^48, which every copy, print and CSV file keeps.
(Reinterpreted as doubles, states would hold NaN and denormals, which not every copy keeps.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BYTES = 6
_LIMIT = 2.0 ** (8 * BYTES)


def numbers_of(data: bytes) -> NDArray[np.float64]:
    """Bytes as whole numbers, shape (n,); the first is the count of bytes."""
    padded = np.frombuffer(data + bytes(-len(data) % BYTES), dtype=np.uint8).reshape(-1, BYTES)
    wide = np.zeros((len(padded), 8), dtype=np.uint8)
    wide[:, :BYTES] = padded
    return np.concatenate([[float(len(data))], wide.view("<u8")[:, 0].astype(np.float64)])


def bytes_of(numbers: NDArray[np.float64]) -> bytes:
    """Bytes that numbers_of was given.

    Raises:
        ValueError: the numbers are none of numbers_of: a state that has been changed.
    """
    whole = np.isfinite(numbers) & (numbers >= 0.0) & (numbers < _LIMIT) & (numbers == np.floor(numbers))
    count = (len(numbers) - 1) * BYTES
    if not whole.all() or not count - BYTES < numbers[0] <= count:
        place = int(np.argmin(whole))
        raise ValueError(
            f"a whole state must be one that the system has given, is changed: number {place} is"
            f" {numbers[place]:.17g} (state = 'motion' has one that can be changed)"
        )
    narrow = numbers[1:].astype("<u8").view(np.uint8).reshape(-1, 8)[:, :BYTES]
    return narrow.tobytes()[: int(numbers[0])]
