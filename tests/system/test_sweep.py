"""Sweeps on a cluster of processes started by hand, on one of this machine; workers and clients that die."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from inertia_module import jobs
from inertia_module.common.errors import Refused
from inertia_module.jobs.task import SceneTask, evaluate
from inertia_module.scene import load_scene, run_scene

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

SCENE = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "shaft"
inertia = "0.5 kg.m2"
[run]
stop_time = "0.1 s"
communication_step = "5 ms"
"""
VARY = [
    "imbalance_mass=0.5:2:4",
    "layout=bevel,planar",
    "fidelity=averaged,rigid",
    "housing_freewheel=false,true",
]


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "scene.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def module(built):
    return built / "InertiaModule.fmu"


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


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    cluster.worker()
    cluster.worker()
    yield cluster
    cluster.end()


def told(rows):
    """Rows without what they cost."""
    return [row._replace(cost=0.0) for row in rows]


@pytest.fixture(scope="module")
def expected(scene, module, tmp_path_factory):
    """The sweep, on a cluster of this machine."""
    folder = tmp_path_factory.mktemp("local")
    return jobs.sweep(scene, VARY, output=folder, fmu=module, workers=1)


def test_one_instance_after_the_other_gives_what_run_scene_gives(scene, module):
    read = load_scene(scene)
    points = [
        {"mechanism.imbalance_mass": 2.0, "mechanism.fidelity": "averaged"},
        {},
        {"mechanism.layout": "planar", "accuracy.tolerance": 1e-8},
        {"mechanism.z17": 0.0},
        {"load.inertia": 1.0},
        {},
    ]
    figures_of = SceneTask(read.tables, module.read_bytes()).opened(module)
    rows = evaluate(figures_of, points).rows
    assert "z17 must be a whole number between" in rows.pop(3).refused
    for row in rows:
        summary = run_scene(read.with_keys(row.point), module).summary
        assert row.figures == {name: value for name, value in summary.items() if name in row.figures}
        assert set(summary) - set(row.figures) == {"wall_time", "real_time_factor"}
    assert rows[1].figures == rows[-1].figures


def test_a_cluster_started_by_hand_gives_the_same_table(scene, module, cluster, expected, tmp_path):
    found = jobs.sweep(scene, VARY, output=tmp_path, fmu=module, scheduler=cluster.address)
    assert len(found.rows) == 32 == found.new
    assert told(found.rows) == told(expected.rows)


def test_a_refusal_is_a_row_with_its_sentence(expected):
    assert len(expected.refused) == 8
    for row in expected.refused:
        assert "housing_freewheel" in row.refused
        assert row.figures == {}
        assert (row.point["mechanism.housing_freewheel"], row.point["mechanism.fidelity"]) == (
            "false",
            "averaged",
        )
    assert all(row.figures["energy_in"] > 0.0 for row in expected.rows if not row.refused)


def test_what_is_done_is_not_done_again(scene, module, expected, tmp_path):
    folder = expected.files["csv"].parent
    # nothing listens there: no worker is asked for
    again = jobs.sweep(scene, VARY, output=folder, fmu=module, scheduler="tcp://127.0.0.1:1")
    assert again.new == 0
    assert again.rows == expected.rows
    other = load_scene(scene).replaced(run={"stop_time": 0.2})
    with pytest.raises(Refused, match="another scene"):
        jobs.sweep(other, VARY, output=folder, fmu=module)


SLOW = ["imbalance_mass=0.5:2:60"]


@pytest.fixture(scope="module")
def slow_scene(scene):
    """A run of some hundredths of a second."""
    slow = scene.with_name("slow.toml")
    slow.write_text(SCENE.replace("0.1 s", "20 s").replace("5 ms", "1 s"))
    return slow


def test_a_client_that_is_killed_loses_nothing(slow_scene, module, cluster, tmp_path):
    command = [sys.executable, "-m", "inertia_module", "sweep", str(slow_scene), "--vary", SLOW[0]]
    options = ["-o", str(tmp_path / "out"), "--fmu", str(module), "--scheduler", cluster.address]
    client = subprocess.Popen([*command, *options], stderr=subprocess.DEVNULL)
    journal = tmp_path / "out" / "journal.jsonl"
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") > 4):
        time.sleep(0.01)
    client.send_signal(signal.SIGKILL)
    client.wait()
    done = sum(len(json.loads(line)["rows"]) for line in journal.read_text().split("\n")[1:-1])
    assert 0 < done < 60
    found = jobs.sweep(slow_scene, SLOW, output=tmp_path / "out", fmu=module, scheduler=cluster.address)
    assert found.new == 60 - done
    assert len(found.rows) == 60
    assert not found.refused


def test_a_worker_that_is_killed_loses_nothing(slow_scene, module, cluster, tmp_path):
    victims = [cluster.processes[1]]

    def kill_one(share):
        if victims:
            os.kill(victims.pop().pid, signal.SIGKILL)

    found = jobs.sweep(
        slow_scene, SLOW, output=tmp_path, fmu=module, scheduler=cluster.address, progress=kill_one
    )
    assert not victims
    assert len(found.rows) == 60 == found.new
    assert not found.refused
    runner = SceneTask(load_scene(slow_scene).tables, module.read_bytes()).opened(module)
    some = found.rows[::20]
    assert told(some) == told(evaluate(runner, [row.point for row in some]).rows)
