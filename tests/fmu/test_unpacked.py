"""What an FMU is unpacked to: one folder for all its instances in a process, and none when that has ended."""

import os
import shutil
import signal
import subprocess
import sys

import pytest

from inertia_module.harness.fmu import Fmu, FmuError

FORGOTTEN = "from inertia_module.harness.fmu import Fmu; fmus = [Fmu({path!r}) for _ in range(3)]; "
FORK = (
    "import multiprocessing; child = multiprocessing.get_context('fork').Process(target={}); child.start(); "
)
# how a process with instances that nobody closes may end, and what it then returns
ENDS = {
    "at its end": ("", 0),
    "by an error": ("1 / 0", 1),
    "by sys.exit": ("import sys; sys.exit(3)", 3),
    "as the command does": (
        "import inertia_module.cli as cli; cli.app = lambda: None; cli.main()",
        0,
    ),
    "with a process forked from it": (FORK.format("fmus[0].advance, args=(0.01,)") + "child.join()", 0),
    "a forked one": (FORK.format("Fmu, args=(other,)") + "child.join()", 0),
}
# it waits where it would otherwise end, until it is told to
WAITS = (
    "import sys, time, inertia_module.cli as cli;"
    "cli.app = lambda: (print('ready', flush=True), time.sleep(60)); cli.main()"
)


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The temporary folder, here and of processes started."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


@pytest.fixture(scope="module")
def module(built):
    return built / "InertiaModule.fmu"


def test_instances_of_a_process_share_one_folder_that_the_last_one_removes(module, temporary):
    with Fmu(module) as first:
        with Fmu(module) as second:
            second.advance(0.01)
            assert len(list(temporary.iterdir())) == 1
        first.advance(0.01)
        assert len(list(temporary.iterdir())) == 1
    assert not list(temporary.iterdir())


def test_what_cannot_be_instantiated_leaves_nothing(module, temporary, tmp_path):
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(module.read_bytes()[:-100])
    with pytest.raises(FmuError):
        Fmu(broken)
    with pytest.raises(FmuError):
        Fmu(module, parameters={"imbalance_mass": -1.0})
    assert not list(temporary.iterdir())


def test_an_fmu_built_anew_is_seen(built, tmp_path):
    path = tmp_path / "one.fmu"
    shutil.copy(built / "InertiaModule.fmu", path)
    with Fmu(path) as before:
        shutil.copy(built / "DrivenShaft.fmu", path)
        with Fmu(path) as after:
            after.advance(0.01)
            assert "hub_speed" in after.variables
            assert "hub_speed" not in before.variables
        before.advance(0.01)


@pytest.mark.parametrize("end", ENDS)
def test_instances_that_nobody_closes_leave_nothing_when_their_process_ends(end, module, temporary, built):
    code, status = ENDS[end]
    other = f"other = {str(built / 'DrivenShaft.fmu')!r}; "
    command = [sys.executable, "-c", FORGOTTEN.format(path=str(module)) + other + code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    assert not list(temporary.iterdir())


@pytest.mark.skipif(os.name == "nt", reason="Windows ends processes without telling them")
def test_the_command_leaves_nothing_when_it_is_told_to_end(module, temporary):
    command = [sys.executable, "-c", FORGOTTEN.format(path=str(module)) + WAITS]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "ready\n"
        assert len(list(temporary.iterdir())) == 1
        running.terminate()
    assert running.returncode == 128 + signal.SIGTERM
    assert not list(temporary.iterdir())
