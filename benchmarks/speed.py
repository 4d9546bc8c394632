"""Measure the speed of the module in all its forms and of hand-written C; update the table of results.

The C program (by_hand.c) computes only the motion of scene R1, with a method of lower order. It is compiled
with -O3 for the same processors as the native FMU, and its results are compared with the kernel before it is
timed.
Run: python -m benchmarks.speed
"""

import ctypes
import os
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from pythonfmu import FmuBuilder
from rich.progress import track

from benchmarks import averaged, native
from benchmarks.results_table import R1, TABLE, alternating_results, update_table
from inertia_module.compiling.tools import ZIG
from inertia_module.fidelity.timing import kernel_time, median_time
from inertia_module.fmi.instance import Fmu
from inertia_module.fmu.builder import MODULE_FMU, PYTHON_FMU, SHAFT_FMU, build
from inertia_module.model import Module

HERE = Path(__file__).parent
FLAGS = [
    *("-O3", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"),
    *("-fno-sanitize=all", "-fno-math-errno", "-mcpu=x86_64_v2"),
]
CONSTANTS = (
    *("k", "s", "mass", "phase_a", "phase_b", "radial", "radial_cos", "arm", "axial", "axial_cos"),
    *("pole_offset", "pole_arm", "spin", "J2", "J3", "J16", "harmonic"),
)
STATE = ("q", "omega2", "omega3", "step", "mode", "switches", "evaluations")
# allowed relative error of omega_out after 1 s
MAX_ERROR = 1e-6
# tolerances to try, from loose to tight; the C program misses events at looser ones than 1e-6
COARSE = [10.0**-n for n in range(4, 11)]
FINE = [10.0 ** (-n / 4) for n in range(12, 49)]
C_TOLERANCES = [tolerance for tolerance in FINE if tolerance < 1.1e-6]
STEPS = {"one step of 1 s": 1, "steps of 1 ms": 1000}
ROUNDS, REPEATS = 21, 7
START = """
import os, time
begin = time.perf_counter()
from inertia_module.fmi.instance import Fmu
imported = time.perf_counter()
with Fmu({path!r}, inputs={{"omega1": 100.0}}) as fmu:
    print(time.perf_counter() - imported, flush=True)
os._exit(0)  # pythonfmu 0.7 writes to freed memory at the exit of the process
"""

# --- runs of R1 over 1 s: (final output speed in rad/s, right-hand-side evaluations, time in s, switches) ---


def structure(names):
    """Return a ctypes structure of doubles.

    Args:
        names: Names of the fields.
    """
    return type("Numbers", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_double) for name in names]})


def by_hand(folder):
    """Compile by_hand.c and return its run as a function of the tolerance and the number of steps.

    Args:
        folder: Folder to write into.
    """
    path = Path(folder) / "by_hand.so"
    command = [*ZIG, "cc", *FLAGS, "-shared", "-fPIC", str(HERE / "by_hand.c"), "-o", str(path), "-lm"]
    subprocess.run(command, check=True)
    library, derived = ctypes.CDLL(str(path)), Module("plain").start(**R1).derived
    constants = (getattr(derived, name) for name in CONSTANTS)
    mechanism = structure([*CONSTANTS, "omega1", "load"])(*constants, R1["omega1"], R1["load_torque"])

    def run(tolerance, steps):
        state = structure(STATE)(step=1e-3, mode=1.0)  # at rest, housing freewheel locked
        numbers = ctypes.c_double(tolerance), ctypes.c_double(1.0 / steps), ctypes.c_long(steps)
        begin = time.perf_counter()
        status = library.run(ctypes.byref(mechanism), ctypes.byref(state), *numbers)
        duration = time.perf_counter() - begin
        if status:
            raise RuntimeError(f"by_hand.c failed at tolerance {tolerance:g}")
        return state.omega3, state.evaluations, duration, state.switches

    return run


def by_kernel(tolerance, steps):
    """Run the compiled kernel.

    Args:
        tolerance: Relative tolerance.
        steps: Number of communication steps.
    """
    module = Module("compiled").start(tolerance=tolerance, **R1)
    begin = module.save()
    for _ in range(steps):
        module.advance(1.0 / steps)
    omega_out, switches, evaluations = module.read(("omega_out", "contact_switches", "rhs_evaluations"))
    inputs = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
    return omega_out, evaluations, kernel_time(module, begin, inputs, 1.0 / steps, repeats=1), switches


def timed(plant, steps, *time):
    """Run a module or FMU repeatedly; return omega_out, evaluations and the median time.

    Args:
        plant: Module or FMU at time 0.
        steps: Number of communication steps.
        time: Arguments of plant.restore after the state.
    """
    begin, result = plant.save(), [0.0, 0.0]

    def repeat():
        plant.restore(begin, *time)
        for _ in range(steps):
            plant.advance(1.0 / steps)
            result[:] = plant.read(("omega_out", "rhs_evaluations"))

    repeat()
    return *result, median_time(repeat)


def plain_run(tolerance):
    """Run the kernel in plain Python.

    Args:
        tolerance: Relative tolerance.
    """
    return timed(Module("plain").start(tolerance=tolerance, **R1), 1)


def fmu_run(path, steps, tolerance):
    """Run an FMU.

    Args:
        path: Path of the FMU.
        steps: Number of communication steps.
        tolerance: Relative tolerance.
    """
    with Fmu(path, inputs=R1, tolerance=tolerance) as fmu:
        return timed(fmu, steps, 0.0)


def seconds_of_r1(module, python, folder):
    """Measure all forms of the module, each at its loosest tolerance with an error of at most MAX_ERROR.

    Runs of the kernel and of the C program alternate. The others are slow and are measured one by one.

    Args:
        module: Native FMU of the module.
        python: Python FMU of the module.
        folder: Folder to write into.

    Returns:
        List of (case, quantity, value, unit).
    """
    hand_written, expected = by_hand(folder), by_kernel(1e-13, 1000)
    actual = hand_written(1e-12, 1)
    if actual[3] != expected[3] or not abs(actual[0] / expected[0] - 1.0) < 1e-9:
        raise RuntimeError(f"by_hand.c: {actual}; the kernel: {expected}")
    fast: dict[str, Any] = {
        f"{form}, {name}": (partial(run, steps=steps), tolerances)
        for name, steps in STEPS.items()
        for form, run, tolerances in (
            ("kernel, compiled", by_kernel, FINE),
            ("hand-written C", hand_written, C_TOLERANCES),
        )
    }
    slow: dict[str, Any] = {"kernel, plain Python, one step of 1 s": (plain_run, COARSE)}
    for form, path in (("native FMU in an fmpy loop", module), ("Python FMU in an fmpy loop", python)):
        slow |= {f"{form}, {name}": (partial(fmu_run, path, steps), COARSE) for name, steps in STEPS.items()}
    rows = []
    for runs, rounds in ((fast, ROUNDS), (slow, 1)):
        settings = {}
        for case, (run, tolerances) in track(runs.items(), "measuring"):
            errors = ((tolerance, abs(run(tolerance)[0] / expected[0] - 1.0)) for tolerance in tolerances)
            settings[case] = next(pair for pair in errors if pair[1] <= MAX_ERROR)
        calls = {case: partial(run, settings[case][0]) for case, (run, _) in runs.items()}
        for case, results in alternating_results(calls, rounds).items():
            seconds, (tolerance, error) = statistics.median(result[2] for result in results), settings[case]
            rows += [(case, "tolerance", tolerance, ""), (case, "error", error, "")]
            rows += [(case, "time", 1e3 * seconds, "ms"), (case, "right-hand sides", results[0][1], "")]
    return rows


# --- FMUs ---


def python_fmu_overhead(python_fmu, workshop):
    """Measure a step and two reads of the Python FMU and of a trivial pythonfmu FMU, alternately.

    Args:
        python_fmu: Python FMU of the module.
        workshop: Folder to write into.
    """
    trivial = FmuBuilder.build_FMU(HERE / "trivial_slave.py", dest=workshop)
    cases: dict[str, Any] = {
        "InertiaModulePy": (native.unpacked(python_fmu), {}, native.OUTPUTS),
        "trivial pythonfmu FMU": (native.unpacked(trivial), {}, ("y", "z")),
    }
    return native.through_fmpy(cases, "time of a step and two reads")


def instantiation(path):
    """Measure the time to unpack, instantiate and initialise an FMU in a new process.

    Args:
        path: Path of the FMU.
    """
    times = []
    for _ in range(REPEATS):
        code = START.format(path=str(path))
        process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        times.append(float(process.stdout.split()[-1]))
    return path.stem, "time", statistics.median(times), "s"


def main():
    """Build the FMUs, measure all parts, and update the table."""
    with tempfile.TemporaryDirectory() as folder:
        workshop = Path(folder)
        build(workshop)
        module, python, shaft = (workshop / fmu.file_name for fmu in (MODULE_FMU, PYTHON_FMU, SHAFT_FMU))
        parts = {
            "scene R1 at an error of 1e-6": seconds_of_r1(module, python, workshop),
            "native FMU": native.measure_steps(workshop, module, shaft),
            "shell of the Python FMU": python_fmu_overhead(python, workshop),
            "instantiation": [instantiation(path) for path in (module, python)],
        }
    parts["urban scene, kernel"] = averaged.measure_scene()
    parts["averaged, driven by torque"] = averaged.measure_torque_drive()
    python_version = float(f"{sys.version_info.major}.{sys.version_info.minor}")
    parts["machine"] = [("all", "cores", os.cpu_count(), ""), ("all", "Python", python_version, "")]
    update_table(parts)
    print(TABLE)


if __name__ == "__main__":
    main()
