"""Speed and error of scene R1, plain, compiled, as FMU and by SciPy; writes docs/performance.md.

Run: python benchmarks/speed.py
"""

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import hand_written
import native
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from pythonfmu import FmuBuilder
from rich.progress import track
from trade import kept_part

from inertia_module.fmu.builder import MODULE_FMU, PYTHON_FMU, SHAFT_FMU, build
from inertia_module.instance import Fmu
from inertia_module.module import Module
from inertia_module.studies.peers import scipy_clutches
from inertia_module.studies.trajectory import Case

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "performance.md"
R1 = {"omega1": 100.0, "load_torque": 10.0}
WANTED = 1e-6
TOLERANCES = [10.0**-n for n in range(4, 11)]
REPEATS = 7


def median_time(action, repeats=REPEATS):
    """Median wall time of some calls, s."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def reference():
    module = Module("compiled").start(tolerance=1e-13, **R1)
    for _ in range(1000):
        module.advance(1e-3)
    return module["omega_out"]


class KernelRun:
    """One simulated second of R1 in communication steps of 1 s or less."""

    def __init__(self, kernel, steps):
        self.kernel, self.steps = kernel, steps

    def __call__(self, tolerance):
        module = Module(self.kernel).start(tolerance=tolerance, **R1)

        def second():
            for _ in range(self.steps):
                module.advance(1.0 / self.steps)

        begin = module.save()
        second()
        result = module["omega_out"], module["rhs_evaluations"]

        def again():
            module.restore(begin)
            second()

        return median_time(again), *result


class FmuRun:
    def __init__(self, path, steps):
        self.path, self.steps = path, steps

    def __call__(self, tolerance):
        with Fmu(self.path, inputs=R1, tolerance=tolerance) as fmu:
            begin = fmu.save()

            def second():
                for _ in range(self.steps):
                    fmu.advance(1.0 / self.steps)
                    result[:] = fmu.read(("omega_out", "rhs_evaluations"))

            def again():
                fmu.restore(begin, 0.0)
                second()

            result = [0.0, 0.0]
            second()
            return median_time(again), *result


class PeerRun:
    def __init__(self, stiffness):
        self.stiffness = stiffness

    def __call__(self, tolerance):
        try:
            found = scipy_clutches.simulate(Case(), "odeint", self.stiffness, tolerance)
        except RuntimeError:  # it gave up: a row of the table all the same
            return float("nan"), float("inf"), float("nan")
        return found.wall_time, found.omega_out[-1], found.evaluations


def ladder(run, exact):
    """Rows (tolerance, error, wall time, right-hand sides) of one method."""
    rows = []
    for tolerance in TOLERANCES:
        wall, omega3, evaluations = run(tolerance)
        rows.append((tolerance, abs(omega3 / exact - 1.0), wall, evaluations))
    return rows


def loosest(rows):
    """Row of the loosest tolerance that reaches the wanted error, or None."""
    return next((row for row in rows if row[1] <= WANTED), None)


def loop_cost(folder, description, references, steps=20000):
    """Cost of an empty step and two reads through fmpy, us."""
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="bench",
    )
    fmu.instantiate()
    fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()

    def loop():
        for _ in range(steps):
            fmu.doStep(0.0, 1e-3)
            fmu.getReal(references)

    cost = median_time(loop) / steps * 1e6
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)
    return cost


def overhead(ours, workshop):
    """(our cost, cost of the trivial FMU) of an empty step, us, in turns, medians of five."""
    trivial = FmuBuilder.build_FMU(HERE / "trivial_slave.py", dest=workshop)
    pairs = []
    folders = {path: (extract(str(path)), read_model_description(str(path))) for path in (ours, trivial)}
    for _ in range(5):
        costs = []
        for folder, description in folders.values():
            names = [v for v in description.modelVariables if v.causality == "output"][:2]
            costs.append(loop_cost(folder, description, [v.valueReference for v in names]))
        pairs.append(costs)
    return [statistics.median(pair[i] for pair in pairs) for i in (0, 1)]


START = """
import os, time
begin = time.perf_counter()
from inertia_module.instance import Fmu
imported = time.perf_counter()
with Fmu({path!r}, inputs={{"omega1": 100.0}}) as fmu:
    print(time.perf_counter() - imported, flush=True)
os._exit(0)  # pythonfmu 0.7 writes to freed memory at the exit of the process
"""


def start_time(path):
    """Time to unpack, instantiate and initialise in a new process, s."""
    code = START.format(path=str(path))
    times = []
    for _ in range(REPEATS):
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        times.append(float(done.stdout.split()[-1]))
    return statistics.median(times)


def format_rows(name, rows):
    row = loosest(rows)
    if row is None:
        best = min(rows, key=lambda row: row[1])
        return f"| {name} | never: best {best[1]:.1e} | {best[0]:.0e} | {best[2] * 1e3:.3g} | {best[3]:.0f} |"
    return f"| {name} | {row[1]:.1e} | {row[0]:.0e} | {row[2] * 1e3:.3g} | {row[3]:.0f} |"


def page(tables, empty, starts, parts):
    compiled_row = loosest(tables["kernel, compiled, one step of 1 s"])
    peers = [rows for name, rows in tables.items() if name.startswith("SciPy")]
    fastest_peer = min(min(row[2] for row in rows) for rows in peers)
    lines = [
        "# Performance",
        "",
        "Printed by `make bench` (`python benchmarks/speed.py`) on"
        f" {os.cpu_count()} cores, Python {platform.python_version()}. Machines differ and are noisy:"
        " the ratios, taken in one run, are what to quote.",
        "",
        "## Scene R1 at an error of 1e-6 in the output speed",
        "",
        "Wall time per simulated second, median of repeats, at the loosest tolerance whose error in `omega_out`"
        " at 1 s is below 1e-6 (relative, against tolerance 1e-13).",
        "",
        "| method | error | tolerance | ms per simulated second | right-hand sides |",
        "|---|---|---|---|---|",
        *(format_rows(name, rows) for name, rows in tables.items()),
        "",
        f"The cheapest run of the SciPy peer, at any error, costs {fastest_peer / compiled_row[2]:.0f} times the"
        " compiled kernel at 1e-6.",
        "",
        "The peer is SciPy's LSODA on the same equations, compiled right-hand side, with each freewheel made a"
        " viscous clutch of the stiffness given (N.m.s/rad): its error is that of the clutch, and a stiffer"
        " clutch needs a tighter tolerance.",
        "",
        "## Error against tolerance",
        "",
        "Compiled kernel, one communication step of 1 s: the error in `omega_out` at 1 s follows the tolerance.",
        "",
        "| tolerance | error | ms per simulated second | right-hand sides |",
        "|---|---|---|---|",
        *(
            f"| {row[0]:.0e} | {row[1]:.1e} | {row[2] * 1e3:.3g} | {row[3]:.0f} |"
            for row in tables["kernel, compiled, one step of 1 s"]
        ),
        "",
        *parts,
        "## The shell of the Python FMU",
        "",
        "An empty step (standstill) and two reads in a loop of fmpy, against the least FMU that pythonfmu makes,"
        " in turns.",
        "",
        "| FMU | us per step and two reads |",
        "|---|---|",
        f"| InertiaModulePy | {empty[0]:.2f} |",
        f"| trivial pythonfmu FMU | {empty[1]:.2f} |",
        f"| ratio | {empty[0] / empty[1]:.2f} |",
        "",
        "## Instantiation",
        "",
        "Unpacking, instantiation and initialisation in a new process, nothing of ours there but the FMU.",
        "",
        "| FMU | s |",
        "|---|---|",
        *(f"| {name} | {seconds:.2f} |" for name, seconds in starts.items()),
        "",
    ]
    return "\n".join(lines)


def main():
    with tempfile.TemporaryDirectory() as folder:
        workshop = Path(folder)
        build(workshop)
        module, python, shaft = (workshop / fmu.file_name for fmu in (MODULE_FMU, PYTHON_FMU, SHAFT_FMU))
        exact = reference()
        runs = {
            "kernel, plain Python, one step of 1 s": KernelRun("plain", 1),
            "kernel, compiled, one step of 1 s": KernelRun("compiled", 1),
            "kernel, compiled, steps of 1 ms": KernelRun("compiled", 1000),
            "native FMU in an fmpy loop, one step of 1 s": FmuRun(module, 1),
            "native FMU in an fmpy loop, steps of 1 ms": FmuRun(module, 1000),
            "Python FMU in an fmpy loop, one step of 1 s": FmuRun(python, 1),
            "Python FMU in an fmpy loop, steps of 1 ms": FmuRun(python, 1000),
            "SciPy LSODA, clutch 1e2": PeerRun(1e2),
            "SciPy LSODA, clutch 1e3": PeerRun(1e3),
            "SciPy LSODA, clutch 1e4": PeerRun(1e4),
            "SciPy LSODA, clutch 1e6": PeerRun(1e6),
        }
        tables = {name: ladder(run, exact) for name, run in track(runs.items(), "measuring")}
        empty = overhead(python, workshop)
        starts = {path.stem: start_time(path) for path in (module, python)}
        parts = [*native.section(workshop, module, shaft), *hand_written.section()]
    text = page(tables, empty, starts, parts)
    PAGE.write_text(text + "\n" + kept_part(PAGE))
    print(text)


if __name__ == "__main__":
    main()
