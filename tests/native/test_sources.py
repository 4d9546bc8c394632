"""Test that importers and strict compilers can compile the sources in the FMUs."""

import shutil
from pathlib import Path

import pytest
from fmpy import build, extract, simulate_fmu

from inertia_module.fmu.linking import header_folder
from inertia_module.fmu.native_fmu import SOURCE, source_files

from .conftest import FMUS, run, system_compiler

STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wshadow", "-Wstrict-prototypes")


def simulated(folder, **modes):
    """Return the bits of the results that FMPy reads in a simulation."""
    return simulate_fmu(str(folder), stop_time=0.3, output_interval=1e-3, **modes).tobytes()


# Each model and each version of FMI.
@pytest.mark.parametrize("identifier", ["InertiaModule3", "DrivenShaft"])
def test_library_compiled_by_fmpy_has_the_bits_of_the_shipped_library(identifier, built_for_all, tmp_path):
    if shutil.which("cmake") is None:
        pytest.skip("cmake is not installed")
    system_compiler()
    folder = Path(extract(str(built_for_all / f"{identifier}.fmu"), str(tmp_path / "fmu")))
    modes = [{}]
    if identifier == "InertiaModule3":
        modes.append({"use_event_mode": True, "early_return_allowed": True})
    ours = [simulated(folder, **mode) for mode in modes]
    shutil.rmtree(folder / "binaries")
    build.build_platform_binary(folder)
    assert [simulated(folder, **mode) for mode in modes] == ours


@pytest.mark.parametrize("identifier", FMUS)
def test_sources_compile_as_c99_without_warnings(identifier, tmp_path):
    fmu = FMUS[identifier]
    source = tmp_path / SOURCE
    source.write_bytes(source_files(fmu, fmu.guid(), lambda stage: None)[f"sources/{SOURCE}"])
    options = ["-std=c99", "-O1", "-fsyntax-only", *STRICT, "-isystem", header_folder()]
    assert run([system_compiler(), *options, source]) == ""
