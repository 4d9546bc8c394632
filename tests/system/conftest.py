"""Fixtures: Chromium with open pages; a cluster of processes."""

import contextlib
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from inertia_module.viewer.html import TEMPLATE
from tests.system.chromium import COARSE, FLAGS, REFERENCE, SMALL, Opened
from tests.system.programs import stdout_of


@pytest.fixture(scope="module")
def browser():
    """Start Debian's Chromium once per file, because open pages continue to draw."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=chromium, args=[*FLAGS])
        yield started
        started.close()


@pytest.fixture(scope="session")
def written(fmu, tmp_path_factory):
    """Return a function that writes the page of a scene file with `inertia-module view`."""
    if not TEMPLATE.exists():
        pytest.skip("the page is not built: `make page` builds it")
    folder = tmp_path_factory.mktemp("pages")

    def write(scene):
        path = folder / f"{Path(scene).stem}.html"
        if not path.exists():
            stdout_of("view", scene, "-o", path, "--fmu", fmu)
        return path

    return write


@pytest.fixture
def opened(browser, written):
    """Return a function that opens the page of a scene file, with options of Playwright's new_page."""
    with contextlib.ExitStack() as pages:
        yield lambda scene, **options: Opened(
            pages.enter_context(browser.new_page(**{**COARSE, **options})), written(scene)
        )


@pytest.fixture(scope="module")
def still(browser, written):
    """Open the page of scene R1 once, without motion, for its functions."""
    with browser.new_page(**COARSE, reduced_motion="reduce") as page:
        yield Opened(page, written(REFERENCE))


@pytest.fixture
def page(still):
    """Open the page of scene R1 again, at rest and without changes."""
    still.page.set_viewport_size(SMALL)
    still.errors.clear()
    return still.at("")


class Cluster:
    """A scheduler and workers in their own processes, started as in sweep.md."""

    def __init__(self, folder):
        self.file = folder / "scheduler.json"
        self.folder = folder
        self.processes = []
        self.start("scheduler", "--scheduler-file", str(self.file), "--port", "0", "--no-dashboard")
        deadline = time.monotonic() + 60.0
        # The scheduler creates the file before it writes the content.
        while not (self.file.exists() and self.file.read_text()) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]

    def start(self, *arguments, without=""):
        """Start a process of Dask, in which a module cannot be imported."""
        code = f"import sys; sys.modules[{without!r}] = None; from dask.__main__ import main; main()"
        process = subprocess.Popen([sys.executable, "-c", code, *arguments], stderr=subprocess.DEVNULL)
        self.processes.append(process)
        return process

    def worker(self, without=""):
        """Start a worker, in which a module cannot be imported."""
        where = ("--local-directory", str(self.folder))
        return self.start("worker", self.address, "--no-nanny", "--nthreads", "1", *where, without=without)

    def end(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A cluster with two workers."""
    pytest.importorskip("distributed")
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    cluster.worker()
    cluster.worker()
    yield cluster
    cluster.end()
