"""The libraries in the FMUs need only what their systems bring, and offer all of FMI 2.0 co-simulation."""

import re

import pytest

from inertia_module.fmu.linking import header_folder

from . import binaries
from .conftest import FMUS

# of model exchange
LEFT_OUT = {
    *("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime"),
    *("SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates"),
    "GetNominalsOfContinuousStates",
}


def required():
    """Functions of FMI 2.0 for co-simulation, from its header."""
    text = (header_folder() / "fmi2FunctionTypes.h").read_text()
    names = set(re.findall(r"\bfmi2(\w+)TYPE\b", text)) - LEFT_OUT
    return {f"fmi2{name}" for name in names}


@pytest.fixture(params=FMUS)
def library(request, unpacked):
    """Path of a library of an FMU, by its folder and suffix."""
    folder = unpacked[request.param] / "binaries"
    return lambda system, suffix: folder / system / f"{request.param}{suffix}"


def test_the_header_names_the_functions_of_co_simulation():
    assert {"fmi2Instantiate", "fmi2DoStep", "fmi2GetBooleanStatus", "fmi2DeSerializeFMUstate"} <= required()
    assert len(required()) == 34


@pytest.mark.parametrize("system", ["linux64", "aarch64-linux"])
def test_linux_library_needs_only_the_c_library_of_2012(library, system):
    found = binaries.read_elf(library(system, ".so"))
    assert required() <= found.offers
    assert found.needs <= {"libc.so.6", "libm.so.6"}
    versions = {tuple(map(int, name.removeprefix("GLIBC_").split("."))) for name in found.versions}
    assert max(versions) <= (2, 17)


@pytest.mark.parametrize("system", ["linux64", "aarch64-linux"])
def test_loader_of_linux_changes_no_code(library, system):
    fixups = binaries.read_elf(library(system, ".so")).fixups
    assert ".data.rel.ro" in fixups
    assert fixups <= {".data.rel.ro", ".got", ".got.plt"}


@pytest.mark.parametrize("system", ["win64", "aarch64-windows"])
def test_windows_library_needs_only_the_runtime_of_windows(library, system):
    found = binaries.read_pe(library(system, ".dll"))
    assert required() <= found.offers
    assert found.needs == {"ucrtbase.dll"}


@pytest.mark.parametrize("system", ["win64", "aarch64-windows"])
def test_loader_of_windows_changes_no_code(library, system):
    assert binaries.read_pe(library(system, ".dll")).fixups == {".rdata"}


def test_mac_library_is_one_file_for_both_processors(library):
    parts = binaries.read_universal(library("darwin64", ".dylib"))
    assert set(parts) == {"X86_64", "ARM64"}
    for found in parts.values():
        assert {f"_{name}" for name in required()} <= found.offers
        assert found.needs == {"/usr/lib/libSystem.B.dylib"}
        assert found.minimum == "11.0"


@pytest.mark.parametrize("processor", ["X86_64", "ARM64"])
def test_loader_of_macos_changes_no_code(library, processor):
    assert binaries.read_universal(library("darwin64", ".dylib"))[processor].fixups == {
        "__DATA",
        "__DATA_CONST",
    }


def test_mac_library_for_arm_is_signed(library):
    assert binaries.read_universal(library("darwin64", ".dylib"))["ARM64"].signed


def test_libraries_offer_little_but_fmi(library):
    offered = binaries.read_elf(library("linux64", ".so")).offers - required()
    assert offered <= {"inertia_module_kernel", "_init", "_fini", "__bss_start", "_edata", "_end"}
