"""Test the libraries in the FMUs with lief: they require only their platform and export co-simulation."""

import re
import struct
import zipfile
from pathlib import Path
from types import SimpleNamespace

import lief
import pytest

from inertia_module import __version__
from inertia_module.compiling.c_compiler import with_kernel
from inertia_module.compiling.targets import TARGETS
from inertia_module.fmu.builder import FMUS, PYTHON_FMU
from inertia_module.fmu.linking import header_folder
from inertia_module.interface.models import DRIVEN_SHAFT
from tests.ready import HERE

lief.logging.disable()  # Otherwise lief prints a warning for each empty table.

NATIVE = [fmu for fmu in FMUS if fmu is not PYTHON_FMU]
# This platform is fast to build; the others are slow.
PLATFORMS = [
    pytest.param(target, marks=[] if target in HERE else pytest.mark.slow, id=target.label)
    for target in TARGETS
]
# Functions of model exchange.
LEFT_OUT = {
    *("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime"),
    *("SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates"),
    "GetNominalsOfContinuousStates",
}
PROCESSORS = {"x86_64": "X86_64", "aarch64": "ARM64"}
# See Apple's kern/cs_blobs.h.
SIGNATURE, CODE_DIRECTORY, AD_HOC = 0xFADE0CC0, 0xFADE0C02, 2


def required_by(fmi):
    """Return the required functions of the FMI header: co-simulation of 2.0, all of 3.0."""
    text = (header_folder() / f"fmi{fmi}FunctionTypes.h").read_text()
    names = set(re.findall(rf"\bfmi{fmi}(\w+)TYPE\b", text)) - (LEFT_OUT if fmi == 2 else set())
    return {f"fmi{fmi}{name}" for name in names}


def read(path, processor="X86_64"):
    """Read a library with lief: its imported and exported names, and its relocated sections."""
    whole = lief.MachO.parse(str(path))  # This object must live as long as its parts.
    if path.suffix == ".dylib":
        (binary,) = (part for part in whole if part.header.cpu_type.name == processor)
        assert binary.header.file_type == lief.MachO.Header.FILE_TYPE.DYLIB
        laid_out, why = lief.MachO.check_layout(binary)
        assert laid_out, why
        own = lief.MachO.LoadCommand.TYPE.ID_DYLIB
        needs = {library.name for library in binary.libraries if library.command != own}
        offers = {symbol.name.removeprefix("_") for symbol in binary.exported_symbols}
        parts = {
            binary.segment_from_virtual_address(relocation.address).name for relocation in binary.relocations
        }
        parts |= {relocation.segment.name for relocation in binary.bindings}
    elif path.suffix == ".dll":
        binary = lief.PE.parse(str(path))
        needs = {name.lower() for name in binary.libraries}
        offers = {entry.name for entry in binary.get_export().entries}
        padding = lief.PE.RelocationEntry.BASE_TYPES.ABS
        entries = [entry for block in binary.relocations for entry in block.entries if entry.type != padding]
        parts = {binary.section_from_rva(entry.address).name for entry in entries}
    else:
        binary = lief.ELF.parse(str(path))
        needs = {str(name) for name in binary.libraries}
        offers = {symbol.name for symbol in binary.exported_symbols}
        parts = {
            binary.section_from_virtual_address(relocation.address).name for relocation in binary.relocations
        }
    return SimpleNamespace(whole=whole, binary=binary, needs=needs, offers=offers, loader_writes_to=parts)


def glibc_versions(library):
    """Return the versions of the Linux symbols that a library requires."""
    needed = library.binary.symbols_version_requirement
    return {symbol.name for part in needed for symbol in part.get_auxiliary_symbols()}


def is_ad_hoc(signature):
    """Return True if a macOS signature contains a code directory marked as ad hoc."""
    magic, _, count = struct.unpack_from(">III", signature)
    assert magic == SIGNATURE
    blobs = dict(struct.unpack_from(">II", signature, 12 + 8 * n) for n in range(count))
    directory, _, _, flags = struct.unpack_from(">IIII", signature, blobs[0])
    return directory == CODE_DIRECTORY and bool(flags & AD_HOC)


def test_the_headers_name_the_functions_of_co_simulation():
    of_2, of_3 = required_by(2), required_by(3)
    assert {"fmi2Instantiate", "fmi2DoStep", "fmi2GetBooleanStatus", "fmi2DeSerializeFMUstate"} <= of_2
    assert {"fmi3InstantiateCoSimulation", "fmi3DoStep", "fmi3GetAdjointDerivative"} <= of_3
    assert (len(of_2), len(of_3)) == (34, 75)


@pytest.mark.parametrize("target", PLATFORMS)
@pytest.mark.parametrize("fmu", NATIVE, ids=lambda fmu: fmu.identifier)
def test_library_requires_only_its_platform_and_exports_fmi(fmu, target, request, tmp_path):
    processor = PROCESSORS[target.compiler.split("-", 1)[0]]
    folder = request.getfixturevalue("built" if target in HERE else "built_for_all")
    with zipfile.ZipFile(folder / fmu.file_name) as packed:
        library = read(Path(packed.extract(fmu.library_path(target), tmp_path)), processor)
    required = required_by(fmu.fmi)
    assert required | {"inertiaModuleRun"} <= library.offers
    if target.suffix == ".so":
        # The libraries of glibc 2012, and the loader.
        assert library.needs <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}
        versions = {tuple(map(int, name[len("GLIBC_") :].split("."))) for name in glibc_versions(library)}
        assert max(versions) <= (2, 17)
        assert {".data.rel.ro"} <= library.loader_writes_to <= {".data.rel.ro", ".got", ".got.plt"}
        assert "__stack_chk_fail" in {symbol.name for symbol in library.binary.imported_symbols}
        others = {"inertia_module_kernel", "inertia_module_kernel_run", "inertiaModuleRun"}
        others |= {"_init", "_fini", "__bss_start", "_edata", "_end"}
        assert library.offers - required <= others
    elif target.suffix == ".dll":
        assert library.needs == {"ucrtbase.dll"}
        assert library.loader_writes_to == {".rdata"}
        (version,) = library.binary.resources_manager.version
        (texts,) = version.string_file_info.children
        says = {entry.key: entry.value for entry in texts.entries}
        assert says["FileDescription"] == fmu.model.title
        assert says["FileVersion"] == says["ProductVersion"] == __version__
        assert __version__.startswith("{}.{}.".format(*divmod(version.file_info.file_version_ms, 1 << 16)))
        assert says["OriginalFilename"] == f"{fmu.identifier}.dll"
    else:
        assert library.needs == {"/usr/lib/libSystem.B.dylib"}
        assert library.binary.build_version.minos[:2] == [11, 0]
        assert library.loader_writes_to == {"__DATA", "__DATA_CONST"}
        assert "___stack_chk_fail" in {symbol.name for symbol in library.binary.imported_symbols}
        signed = library.binary.has_code_signature
        assert processor == "X86_64" or signed
        assert not signed or is_ad_hoc(bytes(library.binary.code_signature.content))
    assert library.binary.abstract.header.architecture.name == processor


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.label)
def test_kernel_alone_is_linked_for_every_platform(target, compiled):
    library = with_kernel(DRIVEN_SHAFT, target, f"kernel{target.suffix}", {})
    assert b"inertia_module_kernel" in library
