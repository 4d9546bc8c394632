"""A place that cannot be written to is found out before the work, not after it."""

import os
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from inertia_module.cli import app
from inertia_module.harness.results import Result

SCENE = str(Path("examples/reference.toml").absolute())


def worked(*_, **__):
    raise AssertionError("the work was begun, and what it gives would be lost")


# arguments, and what does the work of each command
COMMANDS = {
    "build": (["build"], "fmu.builder.content_of", worked),
    "run": (["run", SCENE], "scene.run_scene", worked),
    "run, choosing": (
        ["run", SCENE, "--fidelity", "auto", "--error", "1 %"],
        "fidelity.trials.choose",
        worked,
    ),
    "tradeoff": (["tradeoff", SCENE], "fidelity.tradeoff.measured_rows", worked),
    "chart": (["chart", SCENE], "harness.chart.torque_converter_chart", worked),
    "export": (["export", SCENE], "export.writing.export", worked),
}


def places(folder):
    """Places that cannot be written to, and words on why."""
    (folder / "table.csv").write_text("a file")
    (folder / "nowhere").symlink_to(folder / "gone")
    found = {
        folder / "table.csv": "table.csv is not a folder",
        folder / "table.csv" / "below": "table.csv is not a folder",
        folder / "nowhere": "nowhere is not a folder",
        folder / ("long" * 100): "name too long",
    }
    if sys.platform == "linux":
        found[Path("/proc/results")] = ""
    if os.name == "posix" and os.geteuid() != 0:
        (folder / "locked").mkdir(mode=0o500)
        found[folder / "locked"] = "Permission denied"
    return found


@pytest.mark.parametrize("name", COMMANDS)
def test_a_place_that_cannot_be_written_is_refused_before_the_work(name, tmp_path, monkeypatch):
    arguments, work, stand_in = COMMANDS[name]
    monkeypatch.setattr(f"inertia_module.{work}", stand_in)
    for place, words in places(tmp_path).items():
        done = CliRunner().invoke(app, [*arguments, "-o", str(place)])
        assert done.exit_code == 1, (place, done.exception)
        assert done.stderr.startswith(f"error: {place} must be a folder that can be written to: ")
        assert words.lower() in done.stderr.lower()
        assert done.stderr.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} <= {"table.csv", "nowhere", "locked"}


@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "build"])
def test_so_is_the_folder_that_is_written_to_without_being_named(name, tmp_path, monkeypatch):
    arguments, work, stand_in = COMMANDS[name]
    monkeypatch.setattr(f"inertia_module.{work}", stand_in)
    monkeypatch.chdir(tmp_path)
    Path("out").write_text("a file")
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1, done.exception
    assert "must be a folder that can be written to" in done.stderr


def test_a_good_place_is_not_made_before_there_is_something_to_write(tmp_path):
    done = CliRunner().invoke(app, ["run", "no.toml", "-o", str(tmp_path / "a" / "b")])
    assert done.exit_code == 1
    assert list(tmp_path.iterdir()) == []


def test_a_table_that_cannot_be_written_says_so_in_a_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file must be a folder that can be written to"):
        Result.from_columns({"time": [0.0]}).to_csv(tmp_path / "file" / "table.csv")


@pytest.mark.parametrize("arguments", [["check", "."], ["run", SCENE, "--fmu", "."]])
def test_a_folder_in_the_place_of_an_fmu_is_called_one(arguments, tmp_path):
    if arguments[0] == "run":
        arguments = [*arguments, "-o", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1
    assert done.stderr == "error: . must be an FMU file, is a folder\n"
