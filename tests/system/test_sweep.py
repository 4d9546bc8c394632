"""Test sweeps and designs on a cluster of processes; some workers and clients die."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path
from unittest.mock import Mock

import pytest
from rejected import assert_rejected

from inertia_module import studies
from inertia_module.common.errors import InertiaModuleError, SceneError
from inertia_module.plots.studies import design_figure
from inertia_module.scene import load_scene, run_scene
from inertia_module.scene.keys import keys_from_options
from inertia_module.scene.quantity import Quantity
from inertia_module.scene.run import SceneRunner
from inertia_module.studies.axes import axes_of, grid
from inertia_module.studies.design_specification import read_spec
from inertia_module.studies.evaluation import Task, evaluate, summaries
from inertia_module.studies.workers import ClusterError, evaluations, pool
from tests.system.conftest import Cluster
from tests.system.programs import process

dask, cloudpickle = pytest.importorskip("dask"), pytest.importorskip("cloudpickle")
Client = pytest.importorskip("distributed").Client
psutil = pytest.importorskip("psutil")
pytest.importorskip("pyarrow")
workers = pytest.importorskip("inertia_module.studies.workers")

REFERENCE = Path(__file__).parents[2] / "examples" / "reference.toml"
SHORT = {"load": {"kind": "shaft", "torque": None, "inertia": 0.5}, "run": {"stop_time": 0.1}}
# Each run takes some hundredths of a second.
SLOW = {"imbalance_mass": "0.5:2:60"}
LONG = {"accuracy.tolerance": "1e-6", "run.stop_time": "20 s", "run.communication_step": "1 s"}
VARY = {
    "imbalance_mass": "0.5:2:4",
    "layout": "bevel,planar",
    "fidelity": "averaged,rigid",
    "housing_freewheel": "false,true",
}


@pytest.fixture(scope="module")
def scene():
    return load_scene(REFERENCE, {"run.communication_step": "5 ms"}).replaced(**SHORT)


def without_cost(rows):
    """Return the rows without their cost."""
    return [row._replace(cost=0.0) for row in rows]


def evaluated(read, fmu, points):
    """Return the rows of points that this process computes."""
    with SceneRunner(fmu) as runner:
        return evaluate(summaries(read.tables, runner), points).rows


@pytest.fixture(scope="module")
def cluster_sweep(scene, fmu, cluster, tmp_path_factory):
    """Return the result of the sweep on the cluster."""
    folder = tmp_path_factory.mktemp("sweep")
    return studies.sweep(scene, VARY, output=folder, fmu=fmu, scheduler=cluster.address)


def test_sequential_instances_agree_with_run_scene(scene, fmu):
    points = [
        {"mechanism.imbalance_mass": 2.0, "mechanism.fidelity": "averaged"},
        {},
        {"mechanism.layout": "planar", "accuracy.tolerance": 1e-8},
        {"mechanism.z17": 0.0},
        {"load.inertia": 1.0},
        {},
    ]
    rows = evaluated(scene, fmu, points)
    assert "z17 must be a whole number between" in rows.pop(3).refused
    for row in rows:
        summary = run_scene(scene.with_keys(row.point), fmu).summary
        assert row.metrics == {name: value for name, value in summary.items() if name in row.metrics}
        assert set(summary) - set(row.metrics) == {"wall_time", "real_time_factor"}
    assert rows[1].metrics == rows[-1].metrics


def test_manually_started_cluster_gives_the_same_table_with_rejections(scene, cluster_sweep, fmu):
    assert len(cluster_sweep.rows) == 32 == cluster_sweep.new
    assert without_cost(cluster_sweep.rows) == without_cost(evaluated(scene, fmu, grid(axes_of(VARY, scene))))
    assert len(cluster_sweep.refused) == 8
    for row in cluster_sweep.refused:
        assert "housing_freewheel" in row.refused
        assert row.metrics == {}
        assert row.point["mechanism.housing_freewheel"] == "false"
        assert row.point["mechanism.fidelity"] == "averaged"
    assert all(row.metrics["energy_in"] > 0.0 for row in cluster_sweep.rows if not row.refused)


def test_completed_points_are_not_repeated(scene, fmu, cluster_sweep):
    folder = cluster_sweep.files["csv"].parent
    # The address has no scheduler: the sweep needs no worker.
    again = studies.sweep(scene, VARY, output=folder, fmu=fmu, scheduler="tcp://127.0.0.1:1")
    assert again.new == 0
    assert again.rows == cluster_sweep.rows
    other = scene.replaced(run={"stop_time": 0.2})
    with pytest.raises(InertiaModuleError, match="another scene"):
        studies.sweep(other, VARY, output=folder, fmu=fmu)


def deadly(settings, runner):
    """Prepare a point that kills its worker."""

    def figures(point):
        if point["number"] == 200.0:
            os._exit(1)
        return {"double": Quantity(2.0 * point["number"], "")}

    return figures


def listening(processes):
    """Return the addresses on which processes listen."""
    sockets = [socket for process in processes for socket in process.net_connections("inet")]
    return {socket.laddr for socket in sockets if socket.status == psutil.CONN_LISTEN}


def test_point_that_crashes_its_workers_is_rejected_and_workers_are_local(fmu):
    own = psutil.Process()
    before = listening([own, *own.children(recursive=True)])  # Other tests of this process may listen too.
    # The workers cannot import this file.
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
    assert all(row.metrics["double"] == 2.0 * row.point["number"] for row in rows if not row.refused)
    assert len(addresses) > 2
    assert {address.ip for address in addresses} == {"127.0.0.1"}


def test_workers_release_a_finished_task(scene, fmu, cluster):
    task = Task(fmu.read_bytes(), scene.tables, summaries)
    name = task.identity
    with pool(task, cluster.address) as client:
        (batch,) = evaluations(client, name, [{}])
        assert not batch.rows[0].refused
        files = client.run(lambda dask_worker: str(dask_worker.plugins[name].path)).values()
        assert files
        assert all(Path(file).is_file() for file in files)
    assert not any(Path(file).exists() for file in files)


@pytest.fixture
def slow_scene():
    return load_scene(REFERENCE, LONG)


def test_killed_client_loses_no_results(slow_scene, fmu, cluster, tmp_path):
    command = [
        sys.executable,
        "-m",
        "inertia_module",
        "sweep",
        str(REFERENCE),
        "--vary",
        "imbalance_mass=0.5:2:60",
    ]
    options = [*(f"--set={key}={value}" for key, value in LONG.items())]
    options += ["-o", str(tmp_path / "out"), "--fmu", str(fmu), "--scheduler", cluster.address]
    client = subprocess.Popen([*command, *options], stderr=subprocess.DEVNULL)
    journal = tmp_path / "out" / "journal.jsonl"
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") > 4):
        time.sleep(0.01)
    client.send_signal(signal.SIGKILL)
    client.wait()
    done = sum(len(json.loads(line)["rows"]) for line in journal.read_text().split("\n")[1:-1])
    assert 0 < done < 60
    result = studies.sweep(slow_scene, SLOW, output=tmp_path / "out", fmu=fmu, scheduler=cluster.address)
    assert result.new == 60 - done
    assert len(result.rows) == 60
    assert not result.refused


def test_killed_worker_loses_no_results(slow_scene, fmu, cluster, tmp_path):
    victims = [cluster.worker()]
    with Client(cluster.address) as client:
        client.wait_for_workers(3, timeout=60)

    def kill_worker(fraction):
        if victims:
            os.kill(victims.pop().pid, signal.SIGKILL)

    result = studies.sweep(
        slow_scene, SLOW, output=tmp_path, fmu=fmu, scheduler=cluster.address, progress=kill_worker
    )
    assert not victims
    assert len(result.rows) == 60 == result.new
    assert not result.refused
    some = result.rows[::20]
    assert without_cost(some) == without_cost(evaluated(slow_scene, fmu, [row.point for row in some]))


# --- clusters with errors, scripts, Ctrl-C ---


@pytest.fixture
def empty_cluster(tmp_path):
    """Return a scheduler without workers."""
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


def sweep_command(fmu, folder, *options):
    """Return a command that sweeps 60 points of some hundredths of a second."""
    keys = [f"--set={key}={value}" for key, value in LONG.items()]
    command = [
        sys.executable,
        "-m",
        "inertia_module",
        "sweep",
        str(REFERENCE),
        "--vary",
        "imbalance_mass=0.5:2:60",
    ]
    return [*command, *keys, "-o", str(folder), "--fmu", str(fmu), *options]


def test_scheduler_of_another_version_is_an_error_in_a_line(scene, fmu, cluster, tmp_path, monkeypatch):
    failing = Mock(side_effect=TypeError("Scheduler.identity() got an unexpected keyword argument"))
    monkeypatch.setattr(workers, "Client", failing)
    monkeypatch.setattr(workers.distributed, "__version__", "2024.8.0")
    words = (
        f"scheduler at {cluster.address} .it must have version 2024.8.0 of distributed, .* Scheduler.identity"
    )
    with pytest.raises(workers.ClusterError, match=words):
        studies.sweep(scene, VARY, output=tmp_path, fmu=fmu, scheduler=cluster.address)


def test_worker_without_the_package_is_an_error_in_a_line(scene, fmu, empty_cluster, tmp_path):
    empty_cluster.worker(without="inertia_module")
    with Client(empty_cluster.address) as client:
        client.wait_for_workers(1, timeout=60)
    words = f"^the workers of {empty_cluster.address} cannot run the task: .*inertia_module"
    with pytest.raises(workers.ClusterError, match=words):
        studies.sweep(scene, VARY, output=tmp_path / "out", fmu=fmu, scheduler=empty_cluster.address)


def test_worker_of_another_version_is_an_error_in_a_line(scene, fmu, cluster, tmp_path, monkeypatch):
    with Client(cluster.address) as client:
        client.wait_for_workers(1, timeout=60)
    monkeypatch.setattr(workers, "__version__", "0.1.0")
    words = "cannot run the task: .*version of inertia-module on the worker must be 0.1.0 .got 0"
    with pytest.raises(workers.ClusterError, match=words):
        studies.sweep(scene, VARY, output=tmp_path, fmu=fmu, scheduler=cluster.address)


def test_failed_task_on_a_worker_is_an_error_in_a_line(fmu, cluster):
    task = Task(fmu.read_bytes(), {}, print)
    words = "a worker cannot run the task: TypeError: "
    with pool(task, cluster.address) as client, pytest.raises(workers.ClusterError, match=words):
        list(evaluations(client, task.identity, [{}]))


def test_invalid_fmu_is_named_by_the_worker(scene, cluster, tmp_path):
    (tmp_path / "x.fmu").write_text("no FMU")
    sweep = partial(studies.sweep, scene, VARY, output=tmp_path / "out", fmu=tmp_path / "x.fmu")
    assert_rejected("cannot read .*Module.fmu: not a zip archive", sweep, scheduler=cluster.address)


@pytest.mark.parametrize("number", [0, -1])
def test_number_of_workers_must_be_positive(scene, fmu, tmp_path, number):
    assert_rejected(
        f"workers must be at least 1 .got {number}.$",
        partial(studies.sweep, scene, VARY, output=tmp_path, fmu=fmu, workers=number),
    )


def test_scheduler_without_workers_is_a_notice_until_workers_connect(fmu, empty_cluster, tmp_path):
    command = sweep_command(fmu, tmp_path / "out", "--scheduler", empty_cluster.address)
    client = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    notice = f"the scheduler at {empty_cluster.address} has no workers: waiting for some\n"
    assert client.stderr.readline() == notice
    empty_cluster.worker()
    assert client.communicate(timeout=100)[1] == ""
    assert client.returncode == 0


SCRIPT = """
from inertia_module import sweep
print(len(sweep({scene!r}, {{"imbalance_mass": "1:2:4"}}, output="out", fmu={fmu!r}, workers=1).rows))
"""


def test_script_needs_no_guard(fmu, tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT.format(scene=str(REFERENCE), fmu=str(fmu)))
    assert process("script.py", folder=tmp_path).stdout == "4\n"


@pytest.mark.skipif(os.name != "posix", reason="process groups are those of POSIX")
def test_ctrl_c_is_an_error_in_a_line_and_the_command_resumes(fmu, tmp_path):
    command = sweep_command(fmu, tmp_path / "out", "--workers", "1")
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    client = subprocess.Popen(command, start_new_session=True, **pipes)
    journal = tmp_path / "out" / "journal.jsonl"
    deadline = time.monotonic() + 100.0
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") > 4):
        time.sleep(0.01)
    os.killpg(client.pid, signal.SIGINT)
    assert client.communicate(timeout=60)[1] == "stopped; the same command continues\n"
    assert client.returncode == 128 + signal.SIGINT
    done = sum(len(json.loads(line)["rows"]) for line in journal.read_text().split("\n")[1:-1])
    again = json.loads(subprocess.run([*command, "--json"], capture_output=True, check=True).stdout)
    assert (again["rows"], again["new"]) == (60, 60 - done)
    assert 0 < done < 60


# --- search, check and files of designs ---


SPEC = Path(__file__).with_name("light_module.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def spec(tmp_path_factory):
    pytest.importorskip("pymoo")
    path = tmp_path_factory.mktemp("spec") / "spec.toml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="module")
def designs(spec, fmu, tmp_path_factory):
    return studies.design(spec, output=tmp_path_factory.mktemp("one"), fmu=fmu, workers=1)


def test_front_contains_all_best_designs_within_the_limits(designs):
    assert designs.chosen == designs.finalists
    assert len(designs.chosen) == 3
    for row in designs.front:
        assert designs.judge.meets(row)
        mass, ripple = row.metrics["total_imbalance_mass"], row.metrics["torque_ripple"]
        for other in designs.rows:
            if designs.judge.meets(other, 0.05):
                lighter = other.metrics["total_imbalance_mass"] <= mass
                assert not (lighter and other.metrics["torque_ripple"] < ripple)
    verdict = designs.verdict()
    assert verdict.startswith("3 of 3 verified designs satisfy all limits; converged; best of 3 starts: ")
    assert "; tightest in design 1: " in verdict


@pytest.mark.slow
def test_designs_of_a_seed_do_not_depend_on_the_number_of_workers(designs, spec, fmu, cluster, tmp_path):
    two = studies.design(spec, output=tmp_path, fmu=fmu, scheduler=cluster.address)
    assert without_cost(two.rows) == without_cost(designs.rows)
    checked, expected = ([finalist.checked for finalist in result.finalists] for result in (two, designs))
    assert without_cost(checked) == without_cost(expected)


def test_design_is_written_as_a_scene_that_reproduces_its_values(designs, fmu):
    for number, finalist in enumerate(designs.finalists, 1):
        read, text = load_scene(finalist.file), finalist.file.read_text()
        assert read.tables == finalist.scene.tables
        assert read.mechanism.fidelity == 2.0
        assert run_scene(read, fmu).summary["omega_out_final"] == finalist.checked.metrics["omega_out_final"]
        assert 'layout = "planar"' in text
        assert f'title = "A light module: design {number}"' in text
        point = finalist.searched.point
        assert f'eccentricity = "{point["mechanism.eccentricity"]!r} m"' in text
        assert f"satellites = {int(point['mechanism.satellites'])}\n" in text
        assert 'stop_time = "0.5 s"' in text
        assert "outputs" not in text


def test_table_and_figure_of_a_design_have_integers_and_units(designs):
    for row in csv.DictReader(designs.files["checked csv"].open()):
        assert (row["mechanism.satellites"] + row["contact_switches"]).isdecimal()
    picture = design_figure(designs)
    assert picture.get_suptitle() == "A light module"
    panel, overview, table = picture.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("torque ripple [N·m]", "total imbalance mass [kg]")
    assert (panel.get_xscale(), panel.get_yscale()) == ("linear", "linear")
    picture.draw_without_rendering()
    assert not any("$" in label.get_text() for label in overview.get_xticklabels(which="both"))
    numbers = [finalist.file.stem.rpartition("_")[2] for finalist in designs.finalists]
    cells = table.tables[0].get_celld()
    assert [cells[row, 0].get_text().get_text() for row in range(1, len(numbers) + 1)] == numbers
    assert {text.get_text() for text in panel.texts} == set(numbers)


def test_second_search_of_a_scene_reuses_its_runs(designs, spec, fmu, cluster):
    harder = read_spec(spec, {"metrics.stall_torque.minimum": "2 kN.m"})
    folder = designs.files["checked csv"].parent
    stopped = studies.design(harder, output=folder, fmu=fmu, scheduler=cluster.address)
    assert 0 < stopped.new < len(stopped.rows)
    assert stopped.chosen == []
    assert stopped.verdict().startswith("0 of ")
    assert "no improvement in the last 8 generations of 3 starts" in stopped.verdict()
    assert "closest design: stall_torque " in stopped.verdict()
    assert "(limit: at least 2000 N·m)" in stopped.verdict()


@pytest.mark.slow
def test_search_without_a_valid_design_continues_while_it_improves(spec, fmu, cluster, tmp_path):
    """With each seed, the first generation meets no limits, although valid designs exist."""
    # The limit is far from the first generation, but within the ranges.
    distant_limit = ["metrics.stall_torque.minimum=300 N.m", "search.generations=1"]
    for seed in (1, 2, 3):
        keys = [*distant_limit, f"search.seed={seed}"]
        result = studies.design(
            read_spec(spec, keys_from_options(keys)), output=tmp_path, fmu=fmu, scheduler=cluster.address
        )
        assert result.chosen, seed
        assert len(result.rows) > 12
        assert not result.cut
    short = read_spec(spec, keys_from_options([*distant_limit, "search.seed=1", "search.longest=0.001 ms"]))
    cut = studies.design(short, output=tmp_path, fmu=fmu, scheduler=cluster.address)
    assert cut.cut
    assert len(cut.rows) == 12
    assert "search.longest = 1e-06 s ended the search" in cut.verdict()


@pytest.mark.slow
def test_search_reports_a_better_design_of_another_seed(spec, fmu, cluster, tmp_path):
    """The second search in a folder reads the results of the first."""
    short = ["search.population=4", "search.generations=1", "search.starts=1"]
    searches = [[], [*short, "search.seed=7"]]
    long, brief = (
        studies.design(
            read_spec(spec, keys_from_options(keys)), output=tmp_path, fmu=fmu, scheduler=cluster.address
        )
        for keys in searches
    )
    doubt = "dominated by another search"
    assert not any(doubt in finalist.doubts for finalist in long.finalists)
    worse = [finalist for finalist in brief.finalists if doubt in finalist.doubts]
    assert worse
    assert worse[0].doubts[doubt].startswith("a better design has ")
    assert f"caveat: {doubt}" in brief.lines(worse[0])


@pytest.mark.slow
def test_stalled_search_restarts(spec, fmu, cluster, tmp_path):
    """A start with few light designs may stall; another start then reaches a valid design."""
    lone = ["metrics.stall_torque.minimum=250 N.m", "search.population=4", "search.generations=1"]
    for starts in (1, 50):
        keys = [*lone, "search.stall=1", f"search.starts={starts}"]
        result = studies.design(
            read_spec(spec, keys_from_options(keys)), output=tmp_path, fmu=fmu, scheduler=cluster.address
        )
        assert bool(result.chosen) == (starts == 50)


def test_unknown_metric_is_rejected(spec, fmu, cluster, tmp_path):
    wrong = spec.with_name("wrong.toml")
    wrong.write_text(SPEC.replace("omega_out_final", "omega_out_last"))
    with pytest.raises(
        SceneError, match=r"metrics: unknown metric 'omega_out_last'; did you mean 'omega_out_final'"
    ):
        studies.design(wrong, output=tmp_path, fmu=fmu, scheduler=cluster.address)


def test_scheduler_that_does_not_respond_is_an_error_with_its_address(monkeypatch):
    def silent_client(*args, **options):
        raise TimeoutError

    monkeypatch.setattr(workers, "Client", silent_client)
    with pytest.raises(
        ClusterError, match=r"^no response from the scheduler at tcp://127\.0\.0\.1:9 within 10 s$"
    ):
        workers._connect("tcp://127.0.0.1:9")
