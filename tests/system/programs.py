"""Programs that the documentation shows, run as they stand."""

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
from hosts import HOSTS

DOCS = Path(__file__).parents[2] / "docs"


def programs(page):
    """The programs in Python of a page."""
    return re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)


def printed(source, folder):
    """The number that a program prints last, run in a process of its own: readers may crash."""
    environment = dict(os.environ)
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # what Ecos needs of it on Linux
        libraries = [
            file.locate().resolve() for file in importlib.metadata.files("tbb") if "libtbb.so" in file.name
        ]
        environment["LD_LIBRARY_PATH"] = os.pathsep.join({str(path.parent) for path in libraries})
    done = subprocess.run(
        [sys.executable, "-c", source],
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment,
        check=False,
    )
    # Ecos now and then crashes as it closes, after its number is out
    assert done.returncode in (0, -signal.SIGSEGV), done.stdout + done.stderr
    return float(done.stdout.splitlines()[-1])


def needs(package):
    missing = HOSTS["ecos"].missing if package == "ecospy" else []
    if importlib.util.find_spec(package) is None or missing:
        pytest.skip(f"{package} is not installed; the extra inertia-module[hosts] has what pip can install")
