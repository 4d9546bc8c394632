"""A cluster of processes started by hand, as docs/sweep.md says."""

import json
import subprocess
import sys
import time

import pytest


def dask(*arguments):
    return subprocess.Popen([sys.executable, "-m", "dask", *arguments], stderr=subprocess.DEVNULL)


class Cluster:
    """A scheduler and workers as processes of their own."""

    def __init__(self, folder):
        self.file = folder / "scheduler.json"
        self.folder = folder
        self.processes = [
            dask("scheduler", "--scheduler-file", str(self.file), "--port", "0", "--no-dashboard")
        ]
        deadline = time.monotonic() + 60.0
        while not self.file.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]

    def worker(self):
        """Start a worker."""
        process = dask(
            "worker", self.address, "--no-nanny", "--nthreads", "1", "--local-directory", str(self.folder)
        )
        self.processes.append(process)
        return process

    def end(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait()


@pytest.fixture(scope="session")
def cluster(tmp_path_factory):
    """A cluster with two workers."""
    pytest.importorskip("distributed")
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    cluster.worker()
    cluster.worker()
    yield cluster
    cluster.end()
