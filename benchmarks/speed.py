"""Speed of the module in all its forms and of C written by hand (by_hand.c), written into docs/verification/performance.csv.

The C computes the motion of scene R1 and nothing else, with another method of lower order: a yardstick, not a twin. It is
compiled with -O3 for the processors that the native FMU is made for, and compared with the kernel before it is timed.
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

from pythonfmu import FmuBuilder
from rich.progress import track

from benchmarks import averaged, native
from benchmarks.figures import R1, TABLE, in_turns, keep_parts
from inertia_module.compiling.tools import ZIG
from inertia_module.fidelity.trials import kernel_time, median_time
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
WANTED = 1e-6
COARSE = [10.0**-n for n in range(4, 11)]
FINE = [10.0 ** (-n / 4) for n in range(12, 49)]
# the C misses events at looser ones
BEARABLE = [tolerance for tolerance in FINE if tolerance < 1.1e-6]
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

# --- a simulated second of R1 at a tolerance: output speed at its end, right-hand sides, time in s ---


def structure(names):
    return type("Numbers", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_double) for name in names]})


def by_hand(folder):
    """By the C library, as a function of the tolerance and the number of steps; it also tells the switches."""
    path = Path(folder) / "by_hand.so"
    command = [*ZIG, "cc", *FLAGS, "-shared", "-fPIC", str(HERE / "by_hand.c"), "-o", str(path), "-lm"]
    subprocess.run(command, check=True)
    library, derived = ctypes.CDLL(str(path)), Module("plain").start(**R1).derived
    constants = (getattr(derived, name) for name in CONSTANTS)
    mechanism = structure([*CONSTANTS, "omega1", "load"])(*constants, R1["omega1"], R1["load_torque"])

    def run(tolerance, steps):
        state = structure(STATE)(step=1e-3, mode=1.0)  # at rest, the load carried by the housing freewheel
        numbers = ctypes.c_double(tolerance), ctypes.c_double(1.0 / steps), ctypes.c_long(steps)
        begin = time.perf_counter()
        status = library.run(ctypes.byref(mechanism), ctypes.byref(state), *numbers)
        taken = time.perf_counter() - begin
        if status:
            raise RuntimeError(f"by_hand.c gives up at tolerance {tolerance:g}")
        return state.omega3, state.evaluations, taken, state.switches

    return run


def by_kernel(tolerance, steps):
    """By the compiled kernel, with the switches."""
    module = Module("compiled").start(tolerance=tolerance, **R1)
    begin = module.save()
    for _ in range(steps):
        module.advance(1.0 / steps)
    omega_out, switches, evaluations = module.read(("omega_out", "contact_switches", "rhs_evaluations"))
    given = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
    return omega_out, evaluations, kernel_time(module, begin, given, 1.0 / steps, repeats=1), switches


def timed(plant, steps, *time):
    """By a module or FMU at its start."""
    begin, result = plant.save(), [0.0, 0.0]

    def again():
        plant.restore(begin, *time)
        for _ in range(steps):
            plant.advance(1.0 / steps)
            result[:] = plant.read(("omega_out", "rhs_evaluations"))

    again()
    return *result, median_time(again)


def plain_run(tolerance):
    """By the kernel in plain Python."""
    return timed(Module("plain").start(tolerance=tolerance, **R1), 1)


def fmu_run(path, steps, tolerance):
    """By an FMU."""
    with Fmu(path, inputs=R1, tolerance=tolerance) as fmu:
        return timed(fmu, steps, 0.0)


def seconds_of_r1(module, python, folder):
    """Figures of all forms at the loosest tolerance whose error in omega_out is small enough.

    The kernel and the C take turns; the others are slow, and take their own median.
    """
    hand, wanted = by_hand(folder), by_kernel(1e-13, 1000)
    found = hand(1e-12, 1)
    if found[3] != wanted[3] or not abs(found[0] / wanted[0] - 1.0) < 1e-9:
        raise RuntimeError(f"by_hand.c: {found}; the kernel: {wanted}")
    fast = {
        f"{way}, {name}": (partial(run, steps=steps), tolerances)
        for name, steps in STEPS.items()
        for way, run, tolerances in (
            ("kernel, compiled", by_kernel, FINE),
            ("hand-written C", hand, BEARABLE),
        )
    }
    slow = {"kernel, plain Python, one step of 1 s": (plain_run, COARSE)}
    for way, path in (("native FMU in an fmpy loop", module), ("Python FMU in an fmpy loop", python)):
        slow |= {f"{way}, {name}": (partial(fmu_run, path, steps), COARSE) for name, steps in STEPS.items()}
    rows = []
    for runs, rounds in ((fast, ROUNDS), (slow, 1)):
        settings = {}
        for case, (run, tolerances) in track(runs.items(), "measuring"):
            errors = ((tolerance, abs(run(tolerance)[0] / wanted[0] - 1.0)) for tolerance in tolerances)
            settings[case] = next(pair for pair in errors if pair[1] <= WANTED)
        ways = {case: partial(run, settings[case][0]) for case, (run, _) in runs.items()}
        for case, results in in_turns(ways, rounds).items():
            seconds, (tolerance, error) = statistics.median(one[2] for one in results), settings[case]
            rows += [(case, "tolerance", tolerance, ""), (case, "error", error, "")]
            rows += [(case, "time", 1e3 * seconds, "ms"), (case, "right-hand sides", results[0][1], "")]
    return rows


# --- FMUs ---


def shell(ours, workshop):
    """Cost of an empty step and two reads of the Python FMU and of the least that pythonfmu makes, in turns."""
    trivial = FmuBuilder.build_FMU(HERE / "trivial_slave.py", dest=workshop)
    cases = {
        "InertiaModulePy": (native.unpacked(ours), {}, native.OUTPUTS),
        "trivial pythonfmu FMU": (native.unpacked(trivial), {}, ("y", "z")),
    }
    return native.through_fmpy(cases, "time of a step and two reads")


def instantiation(path):
    """Time to unpack, instantiate and initialise in a new process with nothing of ours there but the FMU."""
    times = []
    for _ in range(REPEATS):
        code = START.format(path=str(path))
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        times.append(float(done.stdout.split()[-1]))
    return path.stem, "time", statistics.median(times), "s"


def main():
    with tempfile.TemporaryDirectory() as folder:
        workshop = Path(folder)
        build(workshop)
        module, python, shaft = (workshop / fmu.file_name for fmu in (MODULE_FMU, PYTHON_FMU, SHAFT_FMU))
        parts = {
            "scene R1 at an error of 1e-6": seconds_of_r1(module, python, workshop),
            "native FMU": native.figures(workshop, module, shaft),
            "shell of the Python FMU": shell(python, workshop),
            "instantiation": [instantiation(path) for path in (module, python)],
        }
    parts["urban scene, kernel"] = averaged.figures_of_scene()
    parts["averaged, driven by torque"] = averaged.figures_by_torque()
    python_version = float(f"{sys.version_info.major}.{sys.version_info.minor}")
    parts["machine"] = [("all", "cores", os.cpu_count(), ""), ("all", "Python", python_version, "")]
    keep_parts(parts)
    print(TABLE)


if __name__ == "__main__":
    main()
