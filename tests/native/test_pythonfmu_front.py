"""Test the library in front of pythonfmu's library in hosts without Python, on Linux and under Wine."""

import re
import subprocess

import pytest

from inertia_module.compiling import c_compiler
from inertia_module.compiling.targets import LINUX64, WIN64
from inertia_module.compiling.tools import ZIG, run_tool
from inertia_module.fmu.linking import header_folder

from ..fmu.test_binaries import glibc_versions, read, required_by
from .conftest import SOURCES, run, system_compiler


@pytest.fixture(scope="session")
def binary_folder(opened):
    """Return the folder of the binaries of the Python FMU."""
    return opened("InertiaModulePy")[1] / "binaries"


def host(folder, *flags):
    """Build a C host for the Python FMU."""
    options = [
        "-isystem",
        str(header_folder()),
        "-include",
        "stdarg.h",
        *flags,
        str(SOURCES / "python_host.c"),
    ]
    command = [system_compiler(), "-rdynamic", *options, "-o", "host", "-ldl"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "host"


NEEDED = "3 logStatusError: Python must be 3.11 or later"


@pytest.mark.parametrize(
    "flags, version, message",
    [
        *(
            (["-DWITH_PYTHON"], version, f"{NEEDED} \\(got {re.escape(version)}\\)\n")
            for version in ("2.7.18 (default)", "3.9.2 (default)", "3.10.12 (main, Jun 11 2023)")
        ),
        ([], "", f"{NEEDED} \\(got none in the process of this FMU\\)\n"),
        (["-DWITH_PYTHON"], "3.12.1", ".*pythonfmu cannot be loaded: .*"),
    ],
)
def test_host_without_a_suitable_python_gets_a_message(binary_folder, tmp_path, flags, version, message):
    printed = run([host(tmp_path, *flags), binary_folder / "linux64" / "InertiaModulePy.so", version])
    assert re.fullmatch(message, printed, re.S)


def test_front_library_exports_fmi_and_requires_few_libraries(binary_folder):
    linux = read(binary_folder / "linux64" / "InertiaModulePy.so")
    windows = read(binary_folder / "win64" / "InertiaModulePy.dll")
    assert required_by(2) <= linux.offers
    assert required_by(2) <= windows.offers
    assert linux.needs <= {"libc.so.6", "libdl.so.2"}
    assert windows.needs == {"ucrtbase.dll", "kernel32.dll"}


def test_docs_name_the_c_library_that_pythonfmu_requires(binary_folder):
    """The Python FMU requires the versions of the C library in docs/reference/fmu.md."""
    needed = glibc_versions(read(binary_folder / LINUX64.folder / "pythonfmu-export.so"))
    text = (SOURCES.parents[1] / "docs" / "reference" / "fmu.md").read_text()
    for family in ("GLIBC_", "GLIBCXX_"):
        numbers = [name.removeprefix(family) for name in needed if name.startswith(family)]
        newest = max(numbers, key=lambda number: tuple(map(int, number.split("."))))
        assert f"{family}{newest}" in text


@pytest.fixture(scope="session")
def run_at(binary_folder, tmp_path_factory, windows):
    """Return a function that runs a host with stand-ins for Python and pythonfmu on Windows."""
    folder = tmp_path_factory.mktemp("windows")
    front = (binary_folder / "win64" / "InertiaModulePy.dll").read_bytes()
    (folder / "InertiaModulePy.dll").write_bytes(front)
    names = (
        *("ExitProcess", "GetEnvironmentVariableA", "GetFileAttributesA", "GetProcAddress", "GetStdHandle"),
        *("LoadLibraryA", "SetCurrentDirectoryA", "WriteFile"),
    )

    def build(file, *flags):
        windows_files = [*c_compiler.windows_headers(), c_compiler.windows_runtime(WIN64, folder)]
        system_library = c_compiler.import_library(WIN64, folder, "kernel32.dll", names)
        options = [
            "-target",
            WIN64.compiler,
            *c_compiler.FLAGS,
            "-fno-sanitize=all",
            "-isystem",
            str(header_folder()),
        ]
        source = str(SOURCES / "windows_pythonfmu.c")
        run_tool(
            [
                *ZIG,
                "cc",
                *options,
                *flags,
                "-Wl,-e,begin",
                source,
                "-o",
                file,
                *windows_files,
                system_library,
            ],
            folder,
        )
        return folder / file

    stubs = " ".join(f"STUB({name})" for name in sorted(required_by(2) - {"fmi2Instantiate"}))
    build("python3.dll", "-DPYTHON", "-shared")
    build("pythonfmu-export.dll", "-DBEHIND", f"-DSTUBS={stubs}", "-shared")
    program = build("host.exe")
    return lambda location: windows(program, LOCATION=location)


@pytest.mark.parametrize("name", ["plain", "with space", "100% #3", "Jürgen Müller", "日本"])
def test_windows_path_is_readable_for_pythonfmu_and_python(run_at, tmp_path, name):
    resources = tmp_path / name / "resources"
    resources.mkdir(parents=True)
    (resources / "slavemodule.txt").write_text("slave")
    (resources / "guid.txt").write_text("")  # The host passes the same GUID.
    for scheme in ("file:///Z:", "FILE:///Z:", "File://localhost/Z:", "file:/Z:", "file://Z:"):
        path, result = run_at(resources.as_uri().replace("file://", scheme)).splitlines()
        assert path.isascii()
        assert result == "found"
    (resources / "guid.txt").write_text("{of-another-build}")
    assert run_at(resources.as_uri().replace("file://", "file:///Z:")) == (
        "the GUID must match modelDescription.xml: import the FMU again\n"
    )


def test_invalid_location_is_reported_on_windows(run_at):
    printed = run_at("file:///Z:/no/such/folder")
    assert printed.startswith("the resource location must be the URI of this FMU's resources")
