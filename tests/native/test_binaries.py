"""The libraries in the FMUs need only what their systems bring, and offer all of co-simulation."""

import re

import pytest

from inertia_module import __version__
from inertia_module.compiling.linking import with_kernel
from inertia_module.compiling.targets import TARGETS
from inertia_module.contract.models import DRIVEN_SHAFT
from inertia_module.fmu.linking import header_folder

from . import binaries
from .conftest import FMUS

# of model exchange
LEFT_OUT = {
    *("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime"),
    *("SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates"),
    "GetNominalsOfContinuousStates",
}


# folders of FMI 3.0, where they have other names in FMI 2.0
FOLDERS = {"linux64": "x86_64-linux", "win64": "x86_64-windows"}


def required_by(fmi):
    """Functions from the header of FMI: of 2.0 those for co-simulation; of 3.0 hosts look for all."""
    text = (header_folder() / f"fmi{fmi}FunctionTypes.h").read_text()
    names = set(re.findall(rf"\bfmi{fmi}(\w+)TYPE\b", text)) - (LEFT_OUT if fmi == 2 else set())
    return {f"fmi{fmi}{name}" for name in names}


@pytest.fixture(params=FMUS)
def fmu(request):
    return FMUS[request.param]


@pytest.fixture
def required(fmu):
    return required_by(fmu.fmi)


@pytest.fixture
def library(fmu, opened):
    """Path of a library of an FMU, by its folder and suffix."""

    def path(system, suffix):
        folder = system if fmu.fmi == 2 else FOLDERS.get(system, system)
        return opened(fmu.identifier)[1] / "binaries" / folder / f"{fmu.identifier}{suffix}"

    return path


def test_the_headers_name_the_functions_of_co_simulation():
    of_2, of_3 = required_by(2), required_by(3)
    assert {"fmi2Instantiate", "fmi2DoStep", "fmi2GetBooleanStatus", "fmi2DeSerializeFMUstate"} <= of_2
    assert {
        "fmi3InstantiateCoSimulation",
        "fmi3DoStep",
        "fmi3GetAdjointDerivative",
        "fmi3EnterStepMode",
    } <= of_3
    assert (len(of_2), len(of_3)) == (34, 75)


@pytest.mark.parametrize("system", ["linux64", "aarch64-linux"])
def test_linux_library_needs_only_the_c_library_of_2012_and_its_loader_changes_no_code(
    library, required, system
):
    found = binaries.read_elf(library(system, ".so"))
    assert required <= found.offers
    # of which the last is the loader
    assert found.needs <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}
    assert "__stack_chk_fail" in found.asks
    versions = {tuple(map(int, name.removeprefix("GLIBC_").split("."))) for name in found.versions}
    assert max(versions) <= (2, 17)
    assert ".data.rel.ro" in found.fixups
    assert found.fixups <= {".data.rel.ro", ".got", ".got.plt"}


@pytest.mark.parametrize("system", ["win64", "aarch64-windows"])
def test_windows_library_needs_only_windows_and_says_what_it_is(fmu, library, required, system):
    found = binaries.read_pe(library(system, ".dll"))
    assert required <= found.offers
    assert found.needs == {"ucrtbase.dll"}
    assert found.fixups == {".rdata"}  # the loader changes no code
    assert found.says["FileDescription"] == fmu.model.title
    assert found.says["FileVersion"] == found.says["ProductVersion"] == __version__
    assert __version__.startswith(f"{found.says['numbers']}.")
    assert found.says["OriginalFilename"] == f"{fmu.identifier}.dll"


def test_mac_libraries_are_for_both_processors_and_that_for_arm_is_signed(fmu, library, required):
    folders = ("darwin64",) if fmu.fmi == 2 else ("x86_64-darwin", "aarch64-darwin")
    parts = [binaries.read_universal(library(folder, ".dylib")) for folder in folders]
    of_mac = {processor: part for found in parts for processor, part in found.items()}
    assert set(of_mac) == {"X86_64", "ARM64"}
    for found in of_mac.values():
        assert {f"_{name}" for name in required} <= found.offers
        assert found.needs == {"/usr/lib/libSystem.B.dylib"}
        assert found.minimum == "11.0"
        assert "___stack_chk_fail" in found.asks
        assert found.fixups == {"__DATA", "__DATA_CONST"}  # the loader changes no code
    assert of_mac["ARM64"].signed


def test_libraries_offer_little_but_fmi(library, required):
    offered = binaries.read_elf(library("linux64", ".so")).offers - required
    assert offered <= {"inertia_module_kernel", "_init", "_fini", "__bss_start", "_edata", "_end"}


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.label)
def test_kernel_alone_is_linked_for_every_platform(target, compiled):
    library = with_kernel(DRIVEN_SHAFT, target, f"kernel{target.suffix}", {})
    assert b"inertia_module_kernel" in library
