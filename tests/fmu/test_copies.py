"""Test unpacked copies of FMUs: one copy per content, complete or absent, and no temporary files."""

import errno
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import Mock

import pytest

from inertia_module.common.errors import FmuError
from inertia_module.fmi import copies
from inertia_module.fmi.instance import Fmu
from tests.packed import files_of, with_content
from tests.system.programs import process

OPENED = "from inertia_module.fmi.instance import Fmu; fmus = [Fmu({path!r}) for _ in range(3)]; "
FORK = (
    "import multiprocessing; child = multiprocessing.get_context('fork').Process(target={}); child.start(); "
)
POOL = "import multiprocessing\nwith multiprocessing.get_context({!r}).Pool(2) as pool: pool.map(Fmu, []); "
POOL += (
    "print(pool.map_async(eval, ['__import__(\"inertia_module\").Fmu(' + repr(other) + ').time'] * 4).get())"
)
# Ends of a process with open instances, and its exit codes.
ENDS = {
    "at its end": ("", 0),
    "by an error": ("1 / 0", 1),
    "by sys.exit": ("import sys; sys.exit(3)", 3),
    "by os._exit": ("import os; os._exit(4)", 4),
    "as the command does": ("import inertia_module.cli.program as p; p.app = lambda: None; p.main()", 0),
    "with a process forked from it": (FORK.format("fmus[0].advance, args=(0.01,)") + "child.join()", 0),
    "a forked one": (FORK.format("Fmu, args=(other,)") + "child.join()", 0),
    "with a pool of forked ones": (POOL.format("fork"), 0),
    "with a pool of spawned ones": (POOL.format("spawn"), 0),
}
# The process waits for a signal.
WAITS = (
    "import sys, time, inertia_module.cli.program as cli;"
    "cli.app = lambda: (print('ready', flush=True), time.sleep(60)); cli.main()"
)


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """Return the empty folder of temporary files, for this process and its children."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


@pytest.fixture
def place(tmp_path, monkeypatch, temporary):
    """Return the folder of the copies, which does not exist yet."""
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(copies, "_checked", set())
    return tmp_path / "cache" / "unpacked"


def names(place):
    """Return the names of the copies and check that all are complete."""
    folders = [folder.name for folder in place.iterdir()]
    assert all(re.fullmatch("[0-9a-f]{32}", name) for name in folders), folders
    return folders


def test_instances_of_all_processes_share_a_copy(fmu, place, temporary):
    process("-c", OPENED.format(path=str(fmu)))
    before = names(place)
    with Fmu(fmu) as first, Fmu(fmu) as second:
        second.advance(0.01)
        first.advance(0.01)
    assert names(place) == before
    assert len(before) == 1
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize("end", ENDS)
def test_process_removes_its_temporary_files(end, fmu, place, temporary, built):
    code, status = ENDS[end]
    other = f"other = {str(built / 'DrivenShaft.fmu')!r}; "
    process("-c", OPENED.format(path=str(fmu)) + other + code, statuses=(status,))
    assert list(temporary.iterdir()) == []
    assert len(names(place)) == 1 + (end.startswith("a forked") or "pool" in end)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT", "SIGKILL"])
def test_process_ended_by_a_signal_removes_its_temporary_files(fmu, place, temporary, name):
    command = [sys.executable, "-c", OPENED.format(path=str(fmu)) + WAITS]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as running:
        assert running.stdout.readline() == "ready\n"
        running.send_signal(getattr(signal, name))
    if name in ("SIGTERM", "SIGHUP"):
        assert running.returncode == 128 + getattr(signal, name)
    assert list(temporary.iterdir()) == []
    assert len(names(place)) == 1


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
def test_command_under_nohup_continues():
    program = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); " + WAITS
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "ready\n"
        running.send_signal(signal.SIGHUP)
        running.send_signal(signal.SIGTERM)
    assert running.returncode == 128 + signal.SIGTERM


def test_processes_that_unpack_simultaneously_make_a_single_copy(fmu, place, temporary):
    command = [sys.executable, "-c", OPENED.format(path=str(fmu)) + "fmus[0].advance(0.01)"]
    running = [subprocess.Popen(command) for _ in range(4)]
    assert [child.wait() for child in running] == [0] * 4
    assert len(names(place)) == 1
    assert list(temporary.iterdir()) == []


def damaged(path):
    path.write_bytes(path.read_bytes()[:-1] + b"?")


@pytest.mark.parametrize(
    "damage", [Path.unlink, damaged, lambda path: os.truncate(path, 100)], ids=["missing", "changed", "short"]
)
def test_a_damaged_copy_is_replaced(fmu, place, damage):
    Fmu(fmu).close()
    (folder,) = place.iterdir()
    library = next(folder.glob("binaries/*/*"))
    damage(library)
    copies._checked.clear()
    Fmu(fmu).close()
    assert library.read_bytes() == files_of(fmu)[library.relative_to(folder).as_posix()]
    assert names(place) == [folder.name]


def test_removed_copy_is_made_again(fmu, place):
    Fmu(fmu).close()
    (folder,) = place.iterdir()
    copies._remove_copy(folder)
    Fmu(fmu).close()
    assert names(place) == [folder.name]


def test_an_fmu_may_add_files_to_its_copy(fmu, place):
    Fmu(fmu).close()
    (folder,) = place.iterdir()
    (folder / "resources").mkdir(exist_ok=True)
    (folder / "resources" / "log.txt").write_text("a log of the FMU")
    copies._checked.clear()
    Fmu(fmu).close()
    assert (folder / "resources" / "log.txt").exists()


def test_another_content_has_a_copy_of_its_own(fmu, place, tmp_path):
    other = with_content(tmp_path / "other.fmu", files_of(fmu) | {"resources/a": b"a"})
    Fmu(fmu).close()
    Fmu(other).close()
    assert len(names(place)) == 2


def test_an_interrupted_copy_is_not_there(fmu, place, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(copies.os, "rename", Mock(side_effect=KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            Fmu(fmu)
    assert names(place) == []
    Fmu(fmu).close()


def test_invalid_fmu_leaves_no_files(fmu, place, temporary, tmp_path):
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(fmu.read_bytes()[:-100])
    with pytest.raises(FmuError, match=r"cannot read .*broken.fmu: not a zip archive: "):
        Fmu(broken)
    assert not place.exists()
    assert list(temporary.iterdir()) == []


def test_copies_unused_for_days_are_removed(fmu, built, place):
    Fmu(fmu).close()
    (recent,) = place.iterdir()
    old, unfinished, young = (
        place / name for name in ("0" * 32, f"{copies.UNFINISHED}a", f"{copies.UNFINISHED}b")
    )
    before = time.time() - copies.MAX_AGE - 1.0
    for folder in (old, unfinished, young):
        (folder / "resources").mkdir(parents=True)
    for folder in (old, unfinished, recent):
        os.utime(folder, (before, before))
    Fmu(fmu).close()  # This call renews the copy.
    Fmu(built / "DrivenShaft.fmu").close()
    assert {folder.name for folder in place.iterdir()} >= {recent.name, young.name}
    assert not old.exists()
    assert not unfinished.exists()


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


def test_without_a_cache_folder_the_error_names_the_remedy(fmu, place):
    place.parent.write_text("a file, no folder")
    words = rf"cannot be unpacked: {place}: .*; INERTIA_MODULE_CACHE names another cache folder$"
    with pytest.raises(FmuError, match=words):
        Fmu(fmu)


def test_full_disk_is_an_error_with_the_folder(fmu, place, monkeypatch):
    monkeypatch.setattr(copies, "unpack", full)
    with pytest.raises(FmuError, match=rf"{place}: No space left on device; "):
        Fmu(fmu)
    assert names(place) == []
