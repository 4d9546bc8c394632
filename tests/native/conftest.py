"""Fixtures: C programs with the shell of the native FMUs, and the FMUs."""

import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

from inertia_module.common.files import PACKAGE_FOLDER
from inertia_module.compiling import CompilationError
from inertia_module.compiling.c_compiler import WARNINGS, object_file
from inertia_module.compiling.targets import LINUX64
from inertia_module.compiling.tools import ZIG, run_tool
from inertia_module.fmu import builder
from inertia_module.fmu.linking import SHELL_FOLDER, header_folder, shell_sources
from inertia_module.fmu.tables import generated

from ..compilers import system_compiler
from ..fmu.conftest import opened

__all__ = ["opened"]
SOURCES = Path(__file__).parent
# C files of each library that contains a kernel.
WITH_KERNEL = PACKAGE_FOLDER / "compiling"
FMUS = {fmu.identifier: fmu for fmu in builder.FMUS if fmu is not builder.PYTHON_FMU}
OF_FMI_3 = [name for name, fmu in FMUS.items() if fmu.fmi == 3]
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
TIME_LIMIT = 900  # s, for programs that hang


def run(command, **environment):
    """Run a program and return its output.

    Raises:
        AssertionError: The program fails; the message contains its output.
    """
    # Write into files: programs that continue, such as the server of Wine, would keep a pipe open.
    with (
        tempfile.TemporaryFile("w+", errors="replace") as out,
        tempfile.TemporaryFile("w+", errors="replace") as errors,
    ):
        done = subprocess.run(
            [str(word) for word in command],
            stdout=out,
            stderr=errors,
            timeout=TIME_LIMIT,
            env=os.environ | environment,
            check=False,
        )
        out.seek(0)
        printed = out.read()
        errors.seek(0)
        assert done.returncode == 0, f"status {done.returncode}: {(printed + errors.read())[-3000:]}"
    return printed


class Workshop:
    """Builds C programs with the shell, the tables and the kernel of an FMU.

    Attributes:
        fmu: The FMU. folder: Folder of the programs. objects: Names by C file and flags.
    """

    def __init__(self, fmu, folder):
        self.fmu, self.folder, self.objects = fmu, folder, {}
        (folder / "kernel.o").write_bytes(object_file(self.fmu.model, LINUX64))
        for name, text in generated(self.fmu.model, self.fmu.guid(), self.fmu.fmi).items():
            (folder / name).write_text(text)

    def flags(self):
        """Return options of all compilations: language, warnings as errors, headers, name of the kernel."""
        headers = [f"-I{folder}" for folder in (SHELL_FOLDER, WITH_KERNEL, SOURCES, self.folder)]
        symbol = f"-DKERNEL={self.fmu.model.symbol}"
        return ["-std=c99", "-O1", *WARNINGS, "-Werror", *headers, "-isystem", str(header_folder()), symbol]

    def all_sources(self, *names):
        """Return paths of C files: first the tests, then the shell and the tables.

        The tests call FMI 2.0. For a shell of FMI 3.0 an adapter translates these calls.
        """
        shell = [*shell_sources(self.fmu.fmi), *sorted(WITH_KERNEL.glob("*.c"))]
        if names and self.fmu.fmi == 3:
            names = (*names, "fmi2_by_3.c")
            if "threads.c" not in names:  # This program counts no calls.
                names = (*names, "fmi3_counted.c")
                shell = [path for path in shell if path.name != "fmi3.c"]
        return [*(str(SOURCES / name) for name in names), *map(str, shell), "tables.c"]

    def build(self, program, *names, flags=(), libraries=()):
        """Build a program for this machine with a C compiler of the system, from C files by name."""
        compiler = system_compiler(flags)
        objects = [self.compiled(compiler, file, *flags) for file in self.all_sources(*names)]
        self.call(compiler, *flags, *objects, "kernel.o", "-o", program, "-lm", *libraries)
        return self.folder / program

    def compiled(self, compiler, file, *flags):
        """Compile a C file to an object file; programs with the same flags share it."""
        if (file, flags) not in self.objects:
            name = f"{len(self.objects)}.o"
            self.call(compiler, *self.flags(), *flags, "-c", file, "-o", name)
            self.objects[file, flags] = name
        return self.objects[file, flags]

    def call(self, *command):
        """Run a compiler in the folder and return its messages."""
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stderr

    def cross(self, target, program, *arguments):
        """Build a program for a target with the C compiler of ziglang, from C files of the tests."""
        words = [str(SOURCES / word) if word.endswith(".c") else word for word in arguments]
        options = ["-target", target.compiler, *self.flags(), "-fno-sanitize=all", "tables.c", *words]
        run_tool([*ZIG, "cc", *options, *target.libraries, "-o", program], self.folder)
        return self.folder / program


@pytest.fixture(scope="session")
def workshops(tmp_path_factory):
    """Return a function that makes the workshop of an FMU, or skips the test."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("the test programs are made for Linux on x86-64")
    workshop_by_fmu = {}

    def workshop_of(identifier):
        if identifier not in workshop_by_fmu:
            try:
                workshop_by_fmu[identifier] = Workshop(FMUS[identifier], tmp_path_factory.mktemp(identifier))
            except CompilationError as reason:
                pytest.skip(str(reason))
        return workshop_by_fmu[identifier]

    return workshop_of


@pytest.fixture(scope="session", params=FMUS)
def workshop(request, workshops):
    """Return the workshop of each native FMU in turn."""
    return workshops(request.param)


@pytest.fixture(scope="session", params=("InertiaModule", "DrivenShaft3"))
def representative_workshop(request, workshops):
    """Return the workshops of two FMUs, which include each model and each version of FMI."""
    return workshops(request.param)


@pytest.fixture(scope="session")
def windows(tmp_path_factory):
    """Return a function that runs a program for Windows with its files in a separate folder."""
    commands = (shutil.which(name) for name in ("wine64", "wine", "/usr/lib/wine/wine64"))
    command = next(filter(None, commands), None)
    if command is None:
        pytest.skip("wine is not installed")
    settings = {
        "WINEPREFIX": str(tmp_path_factory.mktemp("wine")),
        "WINEDEBUG": "-all",
        "DISPLAY": "",
        "LC_ALL": "C.UTF-8",
        "WINEDLLOVERRIDES": "mscoree,mshtml=",  # This setting suppresses offers to install these.
    }
    yield lambda program, **environment: run([command, program], **settings, **environment)
    server = shutil.which("wineserver") or "/usr/lib/wine/wineserver"
    if os.path.exists(server):
        subprocess.run([server, "-k"], env=os.environ | settings, timeout=TIME_LIMIT, check=False)
