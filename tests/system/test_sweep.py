"""Sweeps on a cluster of processes started by hand; workers and clients that die."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from inertia_module import jobs
from inertia_module.common.errors import Refused
from inertia_module.jobs.axes import axes_of, grid
from inertia_module.jobs.evaluation import Task, evaluate, summaries
from inertia_module.jobs.workers import evaluations, pool
from inertia_module.scene import load_scene, run_scene
from inertia_module.scene.run import Quantity, SceneRunner

dask, cloudpickle = pytest.importorskip("dask"), pytest.importorskip("cloudpickle")
Client = pytest.importorskip("distributed").Client
psutil = pytest.importorskip("psutil")
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


def told(rows):
    """Rows without what they cost."""
    return [row._replace(cost=0.0) for row in rows]


def evaluated(read, fmu, points):
    """Rows of points, computed in this process."""
    with SceneRunner(fmu) as runner:
        return evaluate(summaries(read.tables, runner), points).rows


@pytest.fixture(scope="module")
def found(scene, fmu, cluster, tmp_path_factory):
    """The sweep on the cluster."""
    folder = tmp_path_factory.mktemp("sweep")
    return jobs.sweep(scene, VARY, output=folder, fmu=fmu, scheduler=cluster.address)


def test_one_instance_after_the_other_gives_what_run_scene_gives(scene, fmu):
    read = load_scene(scene)
    points = [
        {"mechanism.imbalance_mass": 2.0, "mechanism.fidelity": "averaged"},
        {},
        {"mechanism.layout": "planar", "accuracy.tolerance": 1e-8},
        {"mechanism.z17": 0.0},
        {"load.inertia": 1.0},
        {},
    ]
    rows = evaluated(read, fmu, points)
    assert "z17 must be a whole number between" in rows.pop(3).refused
    for row in rows:
        summary = run_scene(read.with_keys(row.point), fmu).summary
        assert row.figures == {name: value for name, value in summary.items() if name in row.figures}
        assert set(summary) - set(row.figures) == {"wall_time", "real_time_factor"}
    assert rows[1].figures == rows[-1].figures


def test_a_cluster_started_by_hand_gives_the_same_table_a_refusal_its_row_and_sentence(scene, found, fmu):
    read = load_scene(scene)
    assert len(found.rows) == 32 == found.new
    assert told(found.rows) == told(evaluated(read, fmu, grid(axes_of(VARY, read))))
    assert len(found.refused) == 8
    for row in found.refused:
        assert "housing_freewheel" in row.refused
        assert row.figures == {}
        assert row.point["mechanism.housing_freewheel"] == "false"
        assert row.point["mechanism.fidelity"] == "averaged"
    assert all(row.figures["energy_in"] > 0.0 for row in found.rows if not row.refused)


def test_what_is_done_is_not_done_again(scene, fmu, found):
    folder = found.files["csv"].parent
    # nothing listens there: no worker is asked for
    again = jobs.sweep(scene, VARY, output=folder, fmu=fmu, scheduler="tcp://127.0.0.1:1")
    assert again.new == 0
    assert again.rows == found.rows
    other = load_scene(scene).replaced(run={"stop_time": 0.2})
    with pytest.raises(Refused, match="another scene"):
        jobs.sweep(other, VARY, output=folder, fmu=fmu)


def deadly(settings, runner):
    """Prepare for a point that ends its worker."""

    def figures(point):
        if point["number"] == 200.0:
            os._exit(1)
        return {"double": Quantity(2.0 * point["number"], "")}

    return figures


def listening(processes):
    """Addresses at which processes listen."""
    sockets = [socket for process in processes for socket in process.net_connections("inet")]
    return {socket.laddr for socket in sockets if socket.status == psutil.CONN_LISTEN}


def test_a_point_that_ends_its_workers_is_refused_alone_and_nobody_elsewhere_can_reach_them(fmu):
    own = psutil.Process()
    before = listening([own, *own.children(recursive=True)])  # other tests of this process may listen too
    # the workers cannot import this file
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    points = [{"number": float(n)} for n in range(400)]
    task = Task(fmu.read_bytes(), {}, deadly)
    few = dask.config.set({"distributed.scheduler.allowed-failures": 1})
    with few, pool(task, workers=1) as client:
        addresses = listening([own, *own.children(recursive=True)]) - before
        rows = [row for batch in evaluations(client, task.identity, points) for row in batch.rows]
    cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    assert sorted(row.point["number"] for row in rows) == [point["number"] for point in points]
    refused = [row for row in rows if row.refused]
    assert [(row.point["number"], row.refused) for row in refused] == [(200.0, "its worker ended 2 times")]
    assert all(row.figures["double"] == 2.0 * row.point["number"] for row in rows if not row.refused)
    assert len(addresses) > 2
    assert {address.ip for address in addresses} == {"127.0.0.1"}


SLOW = ["imbalance_mass=0.5:2:60"]


@pytest.fixture(scope="module")
def slow_scene(scene):
    """A run of some hundredths of a second."""
    slow = scene.with_name("slow.toml")
    slow.write_text(SCENE.replace("0.1 s", "20 s").replace("5 ms", "1 s"))
    return slow


def test_a_client_that_is_killed_loses_nothing(slow_scene, fmu, cluster, tmp_path):
    command = [sys.executable, "-m", "inertia_module", "sweep", str(slow_scene), "--vary", SLOW[0]]
    options = ["-o", str(tmp_path / "out"), "--fmu", str(fmu), "--scheduler", cluster.address]
    client = subprocess.Popen([*command, *options], stderr=subprocess.DEVNULL)
    journal = tmp_path / "out" / "journal.jsonl"
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") > 4):
        time.sleep(0.01)
    client.send_signal(signal.SIGKILL)
    client.wait()
    done = sum(len(json.loads(line)["rows"]) for line in journal.read_text().split("\n")[1:-1])
    assert 0 < done < 60
    found = jobs.sweep(slow_scene, SLOW, output=tmp_path / "out", fmu=fmu, scheduler=cluster.address)
    assert found.new == 60 - done
    assert len(found.rows) == 60
    assert not found.refused


def test_a_worker_that_is_killed_loses_nothing(slow_scene, fmu, cluster, tmp_path):
    victims = [cluster.worker()]
    with Client(cluster.address) as client:
        client.wait_for_workers(3, timeout=60)

    def kill_one(share):
        if victims:
            os.kill(victims.pop().pid, signal.SIGKILL)

    found = jobs.sweep(
        slow_scene, SLOW, output=tmp_path, fmu=fmu, scheduler=cluster.address, progress=kill_one
    )
    assert not victims
    assert len(found.rows) == 60 == found.new
    assert not found.refused
    some = found.rows[::20]
    assert told(some) == told(evaluated(load_scene(slow_scene), fmu, [row.point for row in some]))
