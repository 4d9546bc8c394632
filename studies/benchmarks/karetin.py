"""Time of the complete exact Karetin set at a million times.

Run: python -m studies.benchmarks.karetin [TIMES]
"""

import statistics
import sys
import time

import numpy as np

from studies.papers.karetin import EXACT, GENERAL, dynamic_mode, exact

REPEATS = 5
# so many times at once that what is needed of them stays in the cache of the processor
BLOCK = 4096
LONGEST = 1e6  # s


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    t, motion = np.linspace(0.0, LONGEST, count), dynamic_mode(100.0, 2.0)
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        for first in range(0, count, BLOCK):
            part = exact(GENERAL, motion, t[first : first + BLOCK])
            found = [np.atleast_1d(getattr(part, name)) for name in EXACT]
        times.append(time.perf_counter() - begin)
    columns = sum(values.size // values.shape[-1] for values in found)
    print(
        f"{count} times, {columns} columns: {statistics.median(times):.3f} s median, {min(times):.3f} s best,"
        f" {1e9 * statistics.median(times) / count:.0f} ns each"
    )


if __name__ == "__main__":
    main()
