"""Cost of a step of the native FMUs in a C host and in fmpy; speed.py measures it.

The C host (benchmarks/native/loop.c) steps the FMUs and an empty FMU (benchmarks/native/empty.c) alternately.
"""

import statistics
import subprocess
import time
from functools import partial
from pathlib import Path
from typing import NamedTuple

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from benchmarks.results_table import R1, alternating_results
from inertia_module.compiling.tools import ZIG
from inertia_module.fmu.linking import header_folder

HERE = Path(__file__).parent / "native"
ROUNDS = 5
STEP = 1e-3
# arguments of the C host: step, s; number of steps; steps per measured batch; repeats; tolerance
HOST = (STEP, 20000, 500, 3, 1e-6)
# with this input inertia omega1 is nearly constant, so the motion resembles the speed-driven one
TORQUE = {"drive_torque": 15.0, "load_torque": 10.0, "omega1": 100.0, "input_inertia": 100.0}
STANDSTILL = {"omega1": 0.0, "load_torque": 10.0}
SHAFT = {"hub_speed": 20.0, "load_torque": 3.0}


class Library(NamedTuple):
    """Unpacked native FMU.

    Attributes:
        path: Path of the shared library.
        guid: GUID of the FMU.
        references: Value references by variable name.
        folder: Folder of the unpacked FMU.
        identifier: Model identifier.
    """

    path: str
    guid: str
    references: dict[str, int]
    folder: str
    identifier: str


def compile_c(source, target, *options):
    """Compile a C file with optimisation.

    Args:
        source: C file.
        target: File to write.
        options: More arguments of the compiler.
    """
    command = [*ZIG, "cc", "-std=gnu99", "-O2", "-fno-sanitize=all", "-Wall", "-Wextra", "-Werror"]
    files = ["-isystem", str(header_folder()), "-o", str(target), str(source)]
    subprocess.run([*command, *files, *options], check=True)


def unpacked(path):
    """Unpack an FMU into a temporary folder and return it as a Library.

    Args:
        path: Path of the FMU.
    """
    description = read_model_description(str(path))
    folder, identifier = extract(str(path)), description.coSimulation.modelIdentifier
    references = {v.name: v.valueReference for v in description.modelVariables}
    library = f"{folder}/binaries/linux64/{identifier}.so"
    return Library(library, description.guid, references, folder, identifier)


def empty_fmu(folder):
    """Compile the empty FMU and return it as a Library.

    Args:
        folder: Folder to write into.
    """
    folder = folder / "empty"
    (folder / "binaries" / "linux64").mkdir(parents=True)
    library = folder / "binaries" / "linux64" / "empty.so"
    compile_c(HERE / "empty.c", library, str(HERE / "empty_rest.c"), "-shared", "-fPIC")
    return Library(str(library), "", {"u": 0, "v": 1, "y": 2, "z": 3}, str(folder), "empty")


def timed(loop, library, values, outputs, **integers):
    """Run the C host and return the wall time of a step and of the slowest step, ns.

    A step includes setting two inputs and reading two outputs.

    Args:
        loop: Path of the C host.
        library: The FMU.
        values: Values of real variables, by name.
        outputs: Names of the two outputs.
        integers: Values of integer variables, by name.
    """
    numbers = library.references
    settings = [f"{numbers[name]}={value!r}" for name, value in values.items()]
    settings += [f"i{numbers[name]}={value}" for name, value in integers.items()]
    read = [str(numbers[name]) for name in outputs]
    command = [str(loop), library.path, library.guid, *map(str, HOST), *read, *settings]
    process = subprocess.run(command, capture_output=True, text=True, check=True)
    *batches, _, slowest = process.stdout.splitlines()
    return statistics.median(map(float, batches)), float(slowest.split()[1])


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
    """Measure the time of a step, ns, and of the slowest step, us, by case.

    Args:
        loop: Path of the C host.
        module: FMU of the module.
        shaft: FMU of the driven shaft.
        empty: Empty FMU.
    """
    measure = partial(timed, loop)
    calls = {"empty native FMU": partial(measure, empty, {"u": 1.0, "v": 2.0}, ("y", "z"))}
    for name, (values, integers) in CASES.items():
        calls[name] = partial(measure, module, values, OUTPUTS, **integers)
    calls["DrivenShaft"] = partial(measure, shaft, SHAFT, ("omega_out", "shaft_torque_mean"))
    return {
        name: (statistics.median(step for step, _ in runs), min(slowest for _, slowest in runs) / 1e3)
        for name, runs in alternating_results(calls, ROUNDS).items()
    }


def through_fmpy(cases, quantity):
    """Measure a step and two reads through fmpy, with alternating cases.

    Args:
        cases: Arguments of fmpy_loop (library, values, outputs) by name.
        quantity: Name of the measured quantity.

    Returns:
        List of (case, quantity, time in us, "us").
    """
    runs = alternating_results({name: partial(fmpy_loop, *case) for name, case in cases.items()}, ROUNDS)
    return [(name, quantity, statistics.median(times), "us") for name, times in runs.items()]


def fmpy_loop(library, values, outputs, steps=20000):
    """Return the time of a step and two reads through fmpy, us.

    Args:
        library: The FMU.
        values: Values of real variables, by name.
        outputs: Names of the outputs.
        steps: Number of steps.
    """
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


def measure_steps(folder, module_path, shaft_path):
    """Measure steps of 1 ms with two inputs and two outputs, in a C host and through fmpy.

    Args:
        folder: Folder to write into.
        module_path: FMU of the module.
        shaft_path: FMU of the driven shaft.

    Returns:
        List of (case, quantity, value, unit).
    """
    loop = folder / "loop"
    compile_c(HERE / "loop.c", loop, "-ldl", "-lm")
    module, shaft, empty = unpacked(module_path), unpacked(shaft_path), empty_fmu(folder)
    rows = []
    for name, (step, slowest) in c_loop(loop, module, shaft, empty).items():
        rows += [(name, "time of a step", step, "ns"), (name, "worst step", slowest, "us")]
    cases = {
        "empty native FMU": (empty, {"u": 1.0}, ("y", "z")),
        "module at a standstill": (module, STANDSTILL, OUTPUTS),
    }
    return rows + through_fmpy(cases, "time of a step and two reads through fmpy")
