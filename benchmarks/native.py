"""Cost of the native FMUs, measured by benchmarks/speed.py.

A C host steps them in a loop (benchmarks/native/loop.c), next to the least a native FMU can be
(benchmarks/native/empty.c), in turns; fmpy does the same.
"""

import statistics
import subprocess
import time
from functools import partial
from pathlib import Path
from typing import NamedTuple

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from benchmarks.figures import R1, in_turns
from inertia_module.compiling.tools import ZIG
from inertia_module.fmu.linking import header_folder

HERE = Path(__file__).parent / "native"
ROUNDS = 5
STEP = 1e-3
# what the C host is told: step, s; steps, and how many are timed together; repeats; tolerance
HOST = (STEP, 20000, 500, 3, 1e-6)
# an input inertia with which omega1 hardly changes: the same motion as with omega1 given
TORQUE = {"drive_torque": 15.0, "load_torque": 10.0, "omega1": 100.0, "input_inertia": 100.0}
STANDSTILL = {"omega1": 0.0, "load_torque": 10.0}
SHAFT = {"hub_speed": 20.0, "load_torque": 3.0}


class Library(NamedTuple):
    """A native FMU unpacked: its library, GUID, references by name and folder."""

    path: str
    guid: str
    references: dict[str, int]
    folder: str
    identifier: str


def compile_c(source, target, *options):
    command = [*ZIG, "cc", "-std=gnu99", "-O2", "-fno-sanitize=all", "-Wall", "-Wextra", "-Werror"]
    files = ["-isystem", str(header_folder()), "-o", str(target), str(source)]
    subprocess.run([*command, *files, *options], check=True)


def unpacked(path):
    """An FMU as a Library."""
    description = read_model_description(str(path))
    folder, identifier = extract(str(path)), description.coSimulation.modelIdentifier
    references = {v.name: v.valueReference for v in description.modelVariables}
    library = f"{folder}/binaries/linux64/{identifier}.so"
    return Library(library, description.guid, references, folder, identifier)


def empty_fmu(workshop):
    """The empty FMU as a Library."""
    folder = workshop / "empty"
    (folder / "binaries" / "linux64").mkdir(parents=True)
    library = folder / "binaries" / "linux64" / "empty.so"
    compile_c(HERE / "empty.c", library, str(HERE / "empty_rest.c"), "-shared", "-fPIC")
    return Library(str(library), "", {"u": 0, "v": 1, "y": 2, "z": 3}, str(folder), "empty")


def timed(loop, library, values, outputs, **whole):
    """Wall time of a step with two values set and two read, and of the worst step, ns, in a run of the C host."""
    numbers = library.references
    given = [f"{numbers[name]}={value!r}" for name, value in values.items()]
    given += [f"i{numbers[name]}={value}" for name, value in whole.items()]
    read = [str(numbers[name]) for name in outputs]
    command = [str(loop), library.path, library.guid, *map(str, HOST), *read, *given]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    *batches, _, worst = done.stdout.splitlines()
    return statistics.median(map(float, batches)), float(worst.split()[1])


OUTPUTS = ("omega_out", "output_torque_mean")
CASES = {
    "module at a standstill": (STANDSTILL, {}),
    "kinematic": (R1, {"fidelity": 0}),
    "averaged": (R1, {"fidelity": 1}),
    "rigid": (R1, {}),
    "elastic": (R1, {"fidelity": 3}),
    "averaged, driven by torque": (TORQUE, {"drive": 1, "fidelity": 1}),
    "rigid, driven by torque": (TORQUE, {"drive": 1}),
    "elastic, driven by torque": (TORQUE, {"drive": 1, "fidelity": 3}),
}


def c_loop(loop, module, shaft, empty):
    """Measure the time of a step, ns, and the worst step, us, of each case."""
    cost = partial(timed, loop)
    ways = {"empty native FMU": partial(cost, empty, {"u": 1.0, "v": 2.0}, ("y", "z"))}
    for name, (values, whole) in CASES.items():
        ways[name] = partial(cost, module, values, OUTPUTS, **whole)
    ways["DrivenShaft"] = partial(cost, shaft, SHAFT, ("omega_out", "shaft_torque_mean"))
    return {
        name: (statistics.median(step for step, _ in runs), min(worst for _, worst in runs) / 1e3)
        for name, runs in in_turns(ways, ROUNDS).items()
    }


def through_fmpy(cases, quantity):
    """Rows of a step and two reads through fmpy, in turns: library, values and outputs by name."""
    runs = in_turns({name: partial(fmpy_loop, *case) for name, case in cases.items()}, ROUNDS)
    return [(name, quantity, statistics.median(times), "us") for name, times in runs.items()]


def fmpy_loop(library, values, outputs, steps=20000):
    """Cost of a step and two reads through fmpy, us."""
    fmu = FMU2Slave(
        guid=library.guid,
        unzipDirectory=library.folder,
        modelIdentifier=library.identifier,
        instanceName="bench",
    )
    fmu.instantiate()
    fmu.setupExperiment()
    fmu.setReal([library.references[name] for name in values], list(values.values()))
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    read = [library.references[name] for name in outputs]
    begin = time.perf_counter()
    for n in range(steps):
        fmu.doStep(n * STEP, STEP)
        fmu.getReal(read)
    cost = (time.perf_counter() - begin) / steps * 1e6
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)
    return cost


def figures(workshop, module_path, shaft_path):
    """Figures of steps of 1 ms, two values set and two read, in a C host and through fmpy."""
    loop = workshop / "loop"
    compile_c(HERE / "loop.c", loop, "-ldl", "-lm")
    module, shaft, empty = unpacked(module_path), unpacked(shaft_path), empty_fmu(workshop)
    found = []
    for name, (step, worst) in c_loop(loop, module, shaft, empty).items():
        found += [(name, "time of a step", step, "ns"), (name, "worst step", worst, "us")]
    cases = {
        "empty native FMU": (empty, {"u": 1.0}, ("y", "z")),
        "module at a standstill": (module, STANDSTILL, OUTPUTS),
    }
    return found + through_fmpy(cases, "time of a step and two reads through fmpy")
