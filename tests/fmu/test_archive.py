"""The files in the FMUs, as a host unpacks them."""

import struct
import zipfile
from pathlib import PurePosixPath

import pytest

from inertia_module.compiling.load import SHIPPED
from inertia_module.compiling.targets import TARGETS
from inertia_module.fmu.builder import FMUS, PYTHON_FMU
from inertia_module.fmu.native_fmu import library_path
from inertia_module.fmu.python_fmu import bundled_files

FLAVOURS = [fmu.identifier for fmu in FMUS]
NATIVE = [fmu for fmu in FMUS if fmu is not PYTHON_FMU]
DOCUMENTATION = {f"documentation/{name}" for name in ("index.html", "mechanism.png", "licenses/license.txt")}
ICONS = {f"terminalsAndIcons/{name}" for name in ("icon.png", "icon.svg", "flange.png", "flange.svg")}
PAPERS = {
    2: DOCUMENTATION | {"modelDescription.xml", "model.png"},
    3: DOCUMENTATION | {"modelDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml"} | ICONS,
}
LARGEST = 1_200_000
# how a library for a processor begins: ELF and PE tell the number of it
ELF, PE = {"x86_64": 0x3E, "aarch64": 0xB7}, {"x86_64": 0x8664, "aarch64": 0xAA64}
FUNCTIONS = {
    2: (b"fmi2Instantiate", b"fmi2DoStep", b"fmi2GetReal", b"fmi2SetFMUstate"),
    3: (b"fmi3InstantiateCoSimulation", b"fmi3DoStep", b"fmi3GetFloat64", b"fmi3SetFMUState"),
}


def content_of(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_archive_is_small_and_whole_and_unpacks_within_its_folder(fmu_path):
    assert fmu_path.stat().st_size < LARGEST
    with zipfile.ZipFile(fmu_path) as archive:
        assert archive.testzip() is None
        names, infos = archive.namelist(), archive.infolist()
    assert names[0] == "modelDescription.xml"
    assert len(names) == len({name.lower() for name in names})
    for info in infos:
        path = PurePosixPath(info.filename)
        assert not path.is_absolute()
        assert ".." not in path.parts
        assert "\\" not in info.filename
        assert info.filename.isascii()
        assert info.external_attr >> 16 == 0o644  # readable and nothing more
        assert info.compress_type == zipfile.ZIP_DEFLATED
    assert content_of(fmu_path)["documentation/licenses/license.txt"].startswith(b"MIT License")


@pytest.mark.parametrize("fmu", NATIVE, ids=lambda fmu: fmu.identifier)
def test_native_fmu_holds_its_libraries_and_its_papers_and_nothing_else(fmu, built):
    libraries = {library_path(fmu, target) for target in TARGETS}
    assert content_of(built / fmu.file_name).keys() == PAPERS[fmu.fmi] | libraries


def test_python_fmu_holds_its_source_and_the_compiled_kernel(built):
    content = content_of(built / PYTHON_FMU.file_name)
    assert content.keys() > PAPERS[2]
    needed = content["documentation/externalDependencies.txt"].decode()
    assert "Python 3.11" in needed
    assert "glibc 2.32" in needed
    assert b"Permission is hereby granted" in content["documentation/licenses/pythonfmu.txt"]
    inside = {name.split("/", 2)[2] for name in content if name.startswith("resources/inertia_module_")}
    libraries = {f"{SHIPPED.name}/{name}" for name in ("linux64.so", "win64.dll")}
    assert inside == bundled_files().keys() | libraries


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.label)
@pytest.mark.parametrize("fmu", NATIVE, ids=lambda fmu: fmu.identifier)
def test_native_library_is_of_its_platform(fmu, opened, target):
    library = (opened(fmu.identifier)[1] / library_path(fmu, target)).read_bytes()
    processor = target.compiler.split("-", 1)[0]
    if target.suffix == ".so":
        assert library[:4] == b"\x7fELF"
        assert struct.unpack_from("<H", library, 18)[0] == ELF[processor]
    elif target.suffix == ".dll":
        assert library[:2] == b"MZ"
        (head,) = struct.unpack_from("<I", library, 60)
        assert library[head : head + 4] == b"PE\0\0"
        assert struct.unpack_from("<H", library, head + 4)[0] == PE[processor]
    elif fmu.fmi == 3:
        assert library[:4] == b"\xcf\xfa\xed\xfe"  # a file for each processor
    else:
        assert struct.unpack_from(">II", library) == (0xCAFEBABE, 2)  # one file for two processors
    for function in FUNCTIONS[fmu.fmi]:
        assert function in library
