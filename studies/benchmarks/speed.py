"""Speed of the module in all its forms, written into docs/performance.csv.

Run: python -m studies.benchmarks.speed
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from pythonfmu import FmuBuilder
from rich.progress import track

from inertia_module.fidelity.trials import median_time
from inertia_module.fmu.builder import MODULE_FMU, PYTHON_FMU, SHAFT_FMU, build
from inertia_module.harness.fmu import Fmu
from inertia_module.memory import Module
from studies.benchmarks import averaged, by_hand, native
from studies.benchmarks.figures import R1, TABLE, keep_parts

HERE = Path(__file__).parent

TOLERANCES = [10.0**-n for n in range(4, 11)]
REPEATS = 7
START = """
import os, time
begin = time.perf_counter()
from inertia_module.harness.fmu import Fmu
imported = time.perf_counter()
with Fmu({path!r}, inputs={{"omega1": 100.0}}) as fmu:
    print(time.perf_counter() - imported, flush=True)
os._exit(0)  # pythonfmu 0.7 writes to freed memory at the exit of the process
"""


def timed(plant, steps, *time):
    """One simulated second by a module or FMU at its start: (output speed, evaluations, wall time)."""
    begin, result = plant.save(), [0.0, 0.0]

    def again():
        plant.restore(begin, *time)
        for _ in range(steps):
            plant.advance(1.0 / steps)
            result[:] = plant.read(("omega_out", "rhs_evaluations"))

    again()
    return *result, median_time(again)


def plain_run(tolerance):
    """Run of R1 by the kernel in plain Python."""
    return timed(Module("plain").start(tolerance=tolerance, **R1), 1)


def fmu_run(path, steps):
    """Run of R1 in an FMU, as a function of the tolerance."""

    def run(tolerance):
        with Fmu(path, inputs=R1, tolerance=tolerance) as fmu:
            return timed(fmu, steps, 0.0)

    return run


def ways(module, python):
    """Figures of R1 at the loosest tolerance whose error in omega_out at 1 s is small enough."""
    exact = by_hand.by_kernel(1e-13, 1000)[0]
    runs = {
        "kernel, plain Python, one step of 1 s": plain_run,
        "native FMU in an fmpy loop, one step of 1 s": fmu_run(module, 1),
        "native FMU in an fmpy loop, steps of 1 ms": fmu_run(module, 1000),
        "Python FMU in an fmpy loop, one step of 1 s": fmu_run(python, 1),
        "Python FMU in an fmpy loop, steps of 1 ms": fmu_run(python, 1000),
    }
    found = by_hand.figures()
    for name, run in track(runs.items(), "measuring"):
        tolerance, error = by_hand.loosest(run, TOLERANCES, exact)
        _, evaluations, seconds = run(tolerance)
        found += by_hand.run_figures(name, tolerance, error, seconds, evaluations)
    return found


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
            "scene R1 at an error of 1e-6": ways(module, python),
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
