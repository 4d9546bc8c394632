"""C programs built with the shell of the native FMUs, and the FMUs themselves."""

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
# C files of every library with a kernel in it
WITH_KERNEL = PACKAGE_FOLDER / "compiling"
FMUS = {fmu.identifier: fmu for fmu in builder.FMUS if fmu is not builder.PYTHON_FMU}
OF_FMI_3 = [name for name, fmu in FMUS.items() if fmu.fmi == 3]
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
TIME_LIMIT = 900  # s, for programs that hang


def run(command, **environment):
    """Run a program; its output.

    Raises:
        AssertionError: it fails; with what it says.
    """
    # into files: a pipe is held open by what a program leaves running, such as the server of Wine
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
    """Builds C programs together with the shell, the tables and the kernel of one FMU.

    Attributes:
        fmu: what is built. folder: where the programs are. objects: names by C file and flags.
    """

    def __init__(self, fmu, folder):
        self.fmu, self.folder, self.objects = fmu, folder, {}
        (folder / "kernel.o").write_bytes(object_file(self.fmu.model, LINUX64))
        for name, text in generated(self.fmu.model, self.fmu.guid(), self.fmu.fmi).items():
            (folder / name).write_text(text)

    def flags(self):
        """Options of every compilation: language, warnings as errors, headers, name of the kernel."""
        headers = [f"-I{folder}" for folder in (SHELL_FOLDER, WITH_KERNEL, SOURCES, self.folder)]
        symbol = f"-DKERNEL={self.fmu.model.symbol}"
        return ["-std=c99", "-O1", *WARNINGS, "-Werror", *headers, "-isystem", str(header_folder()), symbol]

    def all_sources(self, *names):
        """Paths of C files of the tests, then those of the shell and the tables.

        The tests call FMI 2.0: for a shell of FMI 3.0 there is a file that makes the one of the other.
        """
        shell = [*shell_sources(self.fmu.fmi), *sorted(WITH_KERNEL.glob("*.c"))]
        if names and self.fmu.fmi == 3:
            names = (*names, "fmi2_by_3.c")
            if "threads.c" not in names:  # which count nothing
                names = (*names, "fmi3_counted.c")
                shell = [path for path in shell if path.name != "fmi3.c"]
        return [*(str(SOURCES / name) for name in names), *map(str, shell), "tables.c"]

    def build(self, program, *names, flags=(), libraries=()):
        """A program for this machine, by a compiler of the system; names are of its C files."""
        compiler = system_compiler(flags)
        objects = [self.compiled(compiler, file, *flags) for file in self.all_sources(*names)]
        self.call(compiler, *flags, *objects, "kernel.o", "-o", program, "-lm", *libraries)
        return self.folder / program

    def compiled(self, compiler, file, *flags):
        """Object file of a C file; programs that are compiled alike share it."""
        if (file, flags) not in self.objects:
            name = f"{len(self.objects)}.o"
            self.call(compiler, *self.flags(), *flags, "-c", file, "-o", name)
            self.objects[file, flags] = name
        return self.objects[file, flags]

    def call(self, *command):
        """Run a compiler in the folder; its messages."""
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stderr

    def cross(self, target, program, *arguments):
        """A program for a target, by the C compiler that comes with ziglang; C files are of the tests."""
        words = [str(SOURCES / word) if word.endswith(".c") else word for word in arguments]
        given = ["-target", target.compiler, *self.flags(), "-fno-sanitize=all", "tables.c", *words]
        run_tool([*ZIG, "cc", *given, *target.libraries, "-o", program], self.folder)
        return self.folder / program


@pytest.fixture(scope="session")
def workshops(tmp_path_factory):
    """Makes the workshop of an FMU, or skips the test."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("the test programs are made for Linux on x86-64")
    made = {}

    def of(identifier):
        if identifier not in made:
            try:
                made[identifier] = Workshop(FMUS[identifier], tmp_path_factory.mktemp(identifier))
            except CompilationError as reason:
                pytest.skip(str(reason))
        return made[identifier]

    return of


@pytest.fixture(scope="session", params=FMUS)
def workshop(request, workshops):
    """The workshops of the native FMUs in turn."""
    return workshops(request.param)


@pytest.fixture(scope="session", params=("InertiaModule", "DrivenShaft3"))
def one_of_each(request, workshops):
    """The workshops of two: each model and each version of FMI once, for what hangs on one of them alone."""
    return workshops(request.param)


@pytest.fixture(scope="session")
def windows(tmp_path_factory):
    """Runs a program for Windows; its files are in a folder of their own."""
    found = (shutil.which(name) for name in ("wine64", "wine", "/usr/lib/wine/wine64"))
    command = next(filter(None, found), None)
    if command is None:
        pytest.skip("wine is not installed")
    settings = {
        "WINEPREFIX": str(tmp_path_factory.mktemp("wine")),
        "WINEDEBUG": "-all",
        "DISPLAY": "",
        "LC_ALL": "C.UTF-8",
        "WINEDLLOVERRIDES": "mscoree,mshtml=",  # no offers to install these
    }
    yield lambda program, **environment: run([command, program], **settings, **environment)
    server = shutil.which("wineserver") or "/usr/lib/wine/wineserver"
    if os.path.exists(server):
        subprocess.run([server, "-k"], env=os.environ | settings, timeout=TIME_LIMIT, check=False)
