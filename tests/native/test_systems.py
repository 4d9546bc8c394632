"""Other systems compute what Linux on x86-64 does: Windows under Wine, 64-bit ARM under qemu."""

import os
import shutil
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.fmi2 import FMU2Slave

from inertia_module.compiling.targets import LINUX_ARM
from inertia_module.contract.variable import REAL

from . import scenes
from .conftest import FMUS, run

# the C program that runs the scenes knows FMI 2.0
OF_FMI_2 = [name for name, fmu in FMUS.items() if fmu.fmi == 2]
# relative, and what counts as zero where the values themselves are of this size
RELATIVE, OF_ZERO = 1e-9, 1e-9


def outputs(identifier):
    """Variables the C program prints, in its order: all that are calculated, but enumerations."""
    table = FMUS[identifier].model.variables
    return [v.name for v in table if v.kind == REAL and v.causality in ("output", "local")]


def by_fmpy(folder, scene):
    """Values of the outputs after every step of a scene, here."""
    description = read_model_description(str(folder))
    known = {v.name: v for v in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.modelName,
        instanceName="here",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    for name, value in scene.settings.items():
        kind = "Real" if known[name].type == "Real" else "Integer"
        getattr(fmu, f"set{kind}")(
            [known[name].valueReference], [float(value) if kind == "Real" else int(value)]
        )
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    references = [known[name].valueReference for name in outputs(description.modelName)]
    rows = [fmu.getReal(references)]
    for n in range(scene.steps):
        fmu.doStep(currentCommunicationPoint=n * scene.step, communicationStepSize=scene.step)
        rows.append(fmu.getReal(references))
    fmu.freeInstance()
    return rows


def printed_rows(text):
    """Values by scene and step."""
    lines = text.split("\n")
    assert lines[-2].strip() == "done", text[-2000:]
    rows = {}
    for line in lines[:-2]:
        name, _, *values = line.split()
        rows.setdefault(name, []).append([float(value) for value in values])
    return rows


def transposed(rows):
    return list(zip(*rows, strict=True))


def deviations(identifier, folder, text):
    """Largest deviation of each scene from fmpy's values here, over the largest value of the output."""
    there = printed_rows(text)
    assert set(there) == set(scenes.SCENES[identifier])
    found = {}
    for name, scene in scenes.SCENES[identifier].items():
        here = by_fmpy(folder, scene)
        assert len(there[name]) == len(here) == scene.steps + 1
        pairs = zip(transposed(here), transposed(there[name]), strict=True)
        for label, (mine, other) in zip(outputs(identifier), pairs, strict=True):
            # the error of the integration is nothing but rounding, and which moments a peak sees hangs on it
            if label in ("energy_residual", "torque_peak", "satellite_force_peak"):
                continue
            size = max(map(abs, mine))
            worst = max(abs(a - b) for a, b in zip(mine, other, strict=True))
            found[name] = max(found.get(name, 0.0), worst / size if size > OF_ZERO else worst)
    return found


@pytest.mark.parametrize("identifier", OF_FMI_2)
def test_windows_computes_the_same(identifier, workshops, unpacked, windows, record_testsuite_property):
    workshop = workshops(identifier)
    library = unpacked[identifier] / "binaries" / "win64" / f"{identifier}.dll"
    (workshop.folder / library.name).write_bytes(library.read_bytes())
    (workshop.folder / "scenes.h").write_text(scenes.header(identifier, library.name))
    program = workshop.build_windows_program("scenes.exe", "scenes.c")
    found = deviations(identifier, unpacked[identifier], windows(program))
    record_testsuite_property(f"deviations of {identifier} on Windows", found)
    assert max(found.values()) < RELATIVE, found


@pytest.fixture(scope="session")
def arm():
    """Runs a program for Linux on 64-bit ARM, with the C library of that system."""
    emulator = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
    if emulator is None:
        pytest.skip("qemu-aarch64 is not installed (Debian: qemu-user)")
    system = Path(os.environ.get("QEMU_LD_PREFIX", "/usr/aarch64-linux-gnu"))
    if not (system / "lib" / "libc.so.6").exists():
        pytest.skip("the C library for aarch64 is not installed (Debian: libc6-arm64-cross)")
    return lambda program: run([emulator, "-L", system, program])


@pytest.mark.parametrize("identifier", OF_FMI_2)
def test_arm_computes_the_same(identifier, workshops, unpacked, arm, record_testsuite_property):
    workshop = workshops(identifier)
    library = unpacked[identifier] / "binaries" / "aarch64-linux" / f"{identifier}.so"
    (workshop.folder / library.name).write_bytes(library.read_bytes())
    (workshop.folder / "scenes.h").write_text(scenes.header(identifier))
    program = workshop.build_beside_library(LINUX_ARM, "scenes-arm", library.name, "scenes.c")
    found = deviations(identifier, unpacked[identifier], arm(program))
    record_testsuite_property(f"deviations of {identifier} on ARM", found)
    assert max(found.values()) < RELATIVE, found
