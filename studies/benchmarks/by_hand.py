"""The motion of scene R1 by the kernel and by C written by hand (by_hand.c), at the same error.

The C computes the motion and nothing else, with another method of lower order: a yardstick, not a twin. It is compiled
with -O3 for the processors that the native FMU is made for. Its result is compared with the kernel's before it is timed.
Run: python -m studies.benchmarks.by_hand
"""

import ctypes
import statistics
import subprocess
import tempfile
import time
from functools import partial
from pathlib import Path

from inertia_module.compiling.linking import COMPILER
from inertia_module.fidelity.trials import kernel_time
from inertia_module.memory import Module
from studies.benchmarks.figures import R1, in_turns

SOURCE = Path(__file__).with_suffix(".c")
FLAGS = [
    *("-O3", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"),
    *("-fno-sanitize=all", "-fno-math-errno", "-mcpu=x86_64_v2"),
]
CONSTANTS = (
    *("k", "s", "mass", "phase_a", "phase_b", "radial", "radial_cos", "arm", "axial", "axial_cos"),
    *("pole_offset", "pole_arm", "spin", "J2", "J3", "J16", "harmonic"),
)
STATE = ("q", "omega2", "omega3", "step", "mode", "switches", "evaluations")
WANTED = 1e-6
TOLERANCES = [10.0 ** (-n / 4) for n in range(12, 49)]
# the C misses events at looser ones
BEARABLE = [tolerance for tolerance in TOLERANCES if tolerance < 1.1e-6]
ROUNDS = 21
STEPS = {"one step of 1 s": 1, "steps of 1 ms": 1000}


def structure(names):
    return type("Numbers", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_double) for name in names]})


class ByHand:
    """One simulated second of R1 by the C library."""

    def __init__(self, folder):
        path = Path(folder) / "by_hand.so"
        command = [*COMPILER, "cc", *FLAGS, "-shared", "-fPIC", str(SOURCE), "-o", str(path), "-lm"]
        subprocess.run(command, check=True)
        self.library = ctypes.CDLL(str(path))
        derived = Module("plain").start(**R1).derived
        self.mechanism = structure([*CONSTANTS, "omega1", "load"])(
            *(getattr(derived, name) for name in CONSTANTS), R1["omega1"], R1["load_torque"]
        )
        self.state = structure(STATE)

    def run(self, tolerance, steps):
        """(omega_out at the end, switches, right-hand sides, wall time in s)."""
        state = self.state(step=1e-3, mode=1.0)  # at rest, the load carried by the housing freewheel
        numbers = ctypes.c_double(tolerance), ctypes.c_double(1.0 / steps), ctypes.c_long(steps)
        begin = time.perf_counter()
        status = self.library.run(ctypes.byref(self.mechanism), ctypes.byref(state), *numbers)
        taken = time.perf_counter() - begin
        if status:
            raise RuntimeError(f"by_hand.c gives up at tolerance {tolerance:g}")
        return state.omega3, state.switches, state.evaluations, taken


def by_kernel(tolerance, steps):
    """ByHand.run by the compiled kernel."""
    module = Module("compiled").start(tolerance=tolerance, **R1)
    begin = module.save()
    for _ in range(steps):
        module.advance(1.0 / steps)
    result = module.read(("omega_out", "contact_switches", "rhs_evaluations"))
    given = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
    return *result, kernel_time(module, begin, given, 1.0 / steps, repeats=1)


def agree(by_hand):
    """Compare the C with the kernel where both are tight: its output speed. Raises if they disagree."""
    found, wanted = by_hand(1e-12, 1), by_kernel(1e-13, 1000)
    if found[1] != wanted[1] or not abs(found[0] / wanted[0] - 1.0) < 1e-9:
        raise RuntimeError(
            f"by_hand.c: {found[0]} rad/s after {found[1]:.0f} switches; the kernel: {wanted[:2]}"
        )
    return wanted[0]


def loosest(run, tolerances, exact):
    """The loosest tolerance whose error is below WANTED, and that error."""
    errors = ((tolerance, abs(run(tolerance)[0] / exact - 1.0)) for tolerance in tolerances)
    return next(pair for pair in errors if pair[1] <= WANTED)


def figures():
    """Figures of both at the loosest tolerance whose error is below WANTED, timed in turns."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        ways = {"kernel, compiled": (by_kernel, TOLERANCES), "C by hand": (ByHand(folder).run, BEARABLE)}
        exact = agree(ways["C by hand"][0])
        for name, steps in STEPS.items():
            runs, settings = {}, {}
            for way, (run, tolerances) in ways.items():
                settings[way] = loosest(partial(run, steps=steps), tolerances, exact)
                runs[way] = partial(run, settings[way][0], steps)
            for way, results in in_turns(runs, ROUNDS).items():
                seconds = statistics.median(result[3] for result in results)
                found += run_figures(f"{way}, {name}", *settings[way], seconds, results[0][2])
    return found


def run_figures(case, tolerance, error, seconds, evaluations):
    """Rows of the table for a run of one simulated second."""
    return [
        (case, "tolerance", tolerance, ""),
        (case, "error", error, ""),
        (case, "time", 1e3 * seconds, "ms"),
        (case, "right-hand sides", evaluations, ""),
    ]


if __name__ == "__main__":
    for row in figures():
        print(*row)
