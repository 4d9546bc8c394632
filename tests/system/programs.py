"""Functions that run commands, and programs of the documentation, unchanged."""

import contextlib
import importlib.metadata
import importlib.util
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from inertia_module.cli import app

DOCS = Path(__file__).parents[2] / "docs"
ECOS_DEPENDENCY = "tbb"  # Ecos on Linux loads libtbb.so.12 from the libraries of the system.


def command(*arguments, folder=None, program=app):
    """Run a command in this process, in a folder."""
    with contextlib.chdir(folder or Path.cwd()):
        return CliRunner().invoke(program, [str(argument) for argument in arguments])


def succeeded(*arguments, **settings):
    """Run a command with `command`; it must succeed."""
    done = command(*arguments, **settings)
    assert done.exit_code == 0, done.output
    return done


def stdout_of(*arguments):
    """Return the output of a command that must succeed."""
    return succeeded(*arguments).stdout


def assert_one_line_error(done, *words):
    """Check that a command failed with a single line that contains these words."""
    assert (done.exit_code, done.stderr.count("\n")) == (1, 1), done.stderr
    assert done.stderr.startswith("error: ")
    assert all(word in done.stderr for word in words), done.stderr


def process(*arguments, statuses=(0,), folder=None, **environment):
    """Run Python with these arguments; the exit code must be expected; the output is text."""
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        errors="replace",
        cwd=folder,
        env=os.environ | environment,
        check=False,
    )
    assert done.returncode in statuses, done.stdout + done.stderr
    return done


def programs(page):
    """Return the Python programs of a page."""
    return re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)


def printed(source, folder):
    """Run a program in its own process, because hosts can crash, and return the numbers of its last line.

    Raises:
        AssertionError: The program fails. The message contains its output.
    """
    environment = {}
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):
        libraries = [file for file in importlib.metadata.files(ECOS_DEPENDENCY) if "libtbb.so" in file.name]
        folders = {str(file.locate().resolve().parent) for file in libraries}
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(folders)
    # Ecos sometimes crashes at its end, after it has printed its numbers.
    done = process("-c", source, statuses=(0, -signal.SIGSEGV), folder=folder, **environment)
    return [float(number) for number in done.stdout.splitlines()[-1].split()]


def needs(package):
    """Skip a test if a package is not installed."""
    dependencies = {ECOS_DEPENDENCY} if package == "ecospy" and sys.platform == "linux" else set()
    installed = {name for name in dependencies if [*importlib.metadata.distributions(name=name)]}
    if importlib.util.find_spec(package) is None or installed != dependencies:
        pytest.skip(f"{package} is not installed; the extra inertia-module[hosts] has what pip can install")
