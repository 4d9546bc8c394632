"""Test that other systems agree with Linux on x86-64: Windows under Wine, 64-bit ARM under qemu."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from scenes import PLANAR

from inertia_module.compiling.c_compiler import import_library, windows_headers, windows_runtime
from inertia_module.compiling.targets import LINUX_ARM, WIN64
from inertia_module.compiling.tools import ZIG, run_tool
from inertia_module.fmu.linking import SHELL_FOLDER, header_folder
from inertia_module.fmu.native_fmu import SOURCE, library, source_files
from inertia_module.fmu.tables import generated
from inertia_module.interface.variables import REAL

from ..fmu.conftest import ELASTIC, R1, Instance
from .conftest import FMUS, SOURCES, WITH_KERNEL, run

# The C program that runs the scenes calls FMI 2.0.
OF_FMI_2 = [name for name, fmu in FMUS.items() if fmu.fmi == 2]
# Relative tolerance, and absolute tolerance of values near zero.
RELATIVE, OF_ZERO = 1e-9, 1e-9


# Steps of each scene, s.
STEP, STEPS = 0.01, 100
OF_ELASTIC = {"fidelity": 3, **ELASTIC}
# Step sizes depend on the last digits of pow, which differ. A small tolerance reduces the effect.
OF_TORQUE = {"drive": 1, "input_inertia": 0.2, "drive_torque": 15.0, "tolerance": 1e-10}
SCENES = {
    "InertiaModule": {
        "R1": R1,
        "elastic": R1 | OF_ELASTIC,
        # The map of this layout takes a tenth of the time. The other one would take minutes under emulation.
        "averaged": PLANAR | {"fidelity": 1},
        "by_torque": R1 | OF_TORQUE,
        "elastic_by_torque": R1 | OF_ELASTIC | OF_TORQUE,
        "averaged_by_torque": PLANAR | OF_TORQUE | {"fidelity": 1},
        "planar": {"layout": 1, "satellites": 3, "omega1": 120.0, "load_torque": 8.0},
    },
    "DrivenShaft": {
        "shaft": {"hub_speed": 50.0, "load_torque": 3.0},
        "overdamped": {"hub_speed": 50.0, "shaft_damping": 100.0},
    },
}


def header(identifier, library):
    """Return C source with the scenes of an FMU, and with the path of its library."""
    lines = [
        "struct setting {\n    const char *name;\n    double value;\n};",
        "struct scene {\n    const char *name;\n    const struct setting *settings;\n"
        "    double step;\n    int steps;\n};",
        f'#define LIBRARY "{library}"',
    ]
    for name, settings in SCENES[identifier].items():
        values = ", ".join(f'{{"{key}", {float(value)!r}}}' for key, value in settings.items())
        lines.append(f"static const struct setting of_{name}[] = {{{values}, {{0, 0.0}}}};")
    lines.append("static const struct scene scenes[] = {")
    lines += [f'    {{"{name}", of_{name}, {STEP!r}, {STEPS}}},' for name in SCENES[identifier]]
    return "\n".join([*lines, "};", ""])


def outputs(identifier):
    """Return the variables that the C program prints, in its order: all computed ones except enumerations."""
    table = FMUS[identifier].model.variables
    return [v.name for v in table if v.kind == REAL and v.causality in ("output", "local")]


def by_fmpy(opened, identifier, settings):
    """Return the outputs after each step of a scene on this system."""
    fmu = Instance(*opened(identifier)).start(**settings)
    rows = [[fmu.get(name) for name in outputs(identifier)]]
    for _ in range(STEPS):
        fmu.step(STEP)
        rows.append([fmu.get(name) for name in outputs(identifier)])
    fmu.close()
    return rows


def printed_rows(text):
    """Return the values by scene and step."""
    lines = text.split("\n")
    assert lines[-2].strip() == "done", text[-2000:]
    rows = {}
    for line in lines[:-2]:
        name, _, *values = line.split()
        rows.setdefault(name, []).append([float(value) for value in values])
    return rows


def deviations(identifier, opened, text):
    """Return the largest deviation of each scene from fmpy on this system, relative to the largest value."""
    rows_by_scene = printed_rows(text)
    assert set(rows_by_scene) == set(SCENES[identifier])
    result = {}
    # The integration error is at rounding level. It determines the sampling times of the peaks and the
    # number of steps.
    excluded = ("_peak", "energy_residual", "rhs_evaluations")
    compared = [not label.endswith(excluded) for label in outputs(identifier)]
    for name, settings in SCENES[identifier].items():
        reference = np.array(by_fmpy(opened, identifier, settings))
        assert len(rows_by_scene[name]) == len(reference) == STEPS + 1
        largest, difference = (
            np.abs(reference).max(axis=0),
            np.abs(reference - rows_by_scene[name]).max(axis=0),
        )
        result[name] = (difference / np.where(largest > OF_ZERO, largest, 1.0))[compared].max()
    return result


@pytest.fixture(scope="session")
def arm():
    """Return a function that runs a program for Linux on 64-bit ARM, with the C library of that system."""
    emulator = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
    if emulator is None:
        pytest.skip("qemu-aarch64 is not installed (Debian: qemu-user)")
    system = Path(os.environ.get("QEMU_LD_PREFIX", "/usr/aarch64-linux-gnu"))
    if not (system / "lib" / "libc.so.6").exists():
        pytest.skip("the C library for aarch64 is not installed (Debian: libc6-arm64-cross)")
    return lambda program: run([emulator, "-L", system, program])


def for_arm(workshop, library):
    """Build the program of the scenes for ARM, which loads the library from its own folder."""
    return workshop.cross(LINUX_ARM, "scenes-arm", "scenes.c", library, "-Wl,-rpath,$ORIGIN")


def for_windows(workshop, _):
    """Build the program of the scenes for Windows, which starts at `begin` and requires only Windows."""
    functions = ("LoadLibraryA", "GetProcAddress", "GetStdHandle", "WriteFile", "ExitProcess")
    system_library = import_library(WIN64, workshop.folder, "kernel32.dll", functions)
    files = ("scenes.c", str(WITH_KERNEL / "windows.c"))
    windows_files = [*windows_headers(), windows_runtime(WIN64, workshop.folder)]
    return workshop.cross(WIN64, "scenes.exe", "-Wl,-e,begin", *files, *windows_files, system_library)


@pytest.mark.parametrize(
    "system, target, build", [("arm", LINUX_ARM, for_arm), ("windows", WIN64, for_windows)]
)
@pytest.mark.parametrize("identifier", OF_FMI_2)
def test_another_system_computes_the_same(
    identifier, system, target, build, workshops, opened, request, record_testsuite_property
):
    runs, workshop = request.getfixturevalue(system), workshops(identifier)
    fmu, name = FMUS[identifier], f"{identifier}{target.suffix}"
    (workshop.folder / name).write_bytes(library(fmu, fmu.guid(), target, lambda stage: None))
    (workshop.folder / "scenes.h").write_text(header(identifier, name))
    largest = deviations(identifier, opened, runs(build(workshop, name)))
    record_testsuite_property(f"deviations of {identifier} on {system}", largest)
    assert max(largest.values()) < RELATIVE, largest


# 64-bit ARM, and targets without a library: a 32-bit and a big-endian processor.
OTHERS = {"aarch64": "aarch64-linux-musl", "arm": "arm-linux-musleabihf", "s390x": "s390x-linux-musl"}


@pytest.mark.parametrize("processor", OTHERS)
@pytest.mark.parametrize("identifier", OF_FMI_2)
def test_the_sources_compute_the_same_on_any_processor(
    identifier, processor, tmp_path, opened, record_testsuite_property
):
    emulator = shutil.which(f"qemu-{processor}") or shutil.which(f"qemu-{processor}-static")
    if emulator is None:
        pytest.skip(f"qemu-{processor} is not installed (Debian: qemu-user)")
    fmu = FMUS[identifier]
    source = source_files(fmu, fmu.guid(), lambda stage: None)[f"sources/{SOURCE}"]
    # The program has its own tables of names. The tables of the FMU are not visible.
    for name, text in generated(fmu.model, fmu.guid(), fmu.fmi).items():
        (tmp_path / name).write_text(text)
    (tmp_path / SOURCE).write_bytes(source)
    (tmp_path / "scenes.h").write_text(header(identifier, ""))
    files = [SOURCE, "tables.c", str(SOURCES / "scenes.c")]
    headers = [f"-I{folder}" for folder in (".", SHELL_FOLDER, WITH_KERNEL)]
    options = ["-target", OTHERS[processor], "-static", "-std=c99", "-O1", "-fno-sanitize=all"]
    run_tool(
        [*ZIG, "cc", *options, *headers, "-isystem", str(header_folder()), *files, "-o", "scenes"], tmp_path
    )
    largest = deviations(identifier, opened, run([emulator, tmp_path / "scenes"]))
    record_testsuite_property(f"deviations of the sources of {identifier} on {processor}", largest)
    assert max(largest.values()) < RELATIVE, largest
