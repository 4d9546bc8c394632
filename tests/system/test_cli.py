"""The command as a user types it."""

import contextlib
import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from inertia_module import __version__, jobs
from inertia_module.cli import app
from inertia_module.fmu.builder import FMUS

ROOT = Path(__file__).parents[2]


def process(*arguments, folder):
    """A command as a process of its own."""
    words = [sys.executable, "-m", "inertia_module", *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder, check=False)
    done.exit_code = done.returncode
    return done


def command(*arguments, folder):
    """The same in this process."""
    with contextlib.chdir(folder):
        return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture
def workshop(built, tmp_path):
    """A folder with built FMUs."""
    (tmp_path / "build").symlink_to(built, target_is_directory=True)
    return tmp_path


SCENE = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "torque"
torque = "10 N.m"
[run]
stop_time = "0.1 s"
communication_step = "1 ms"
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_build_leaves_the_fmus_in_build_and_tells_machines(tmp_path):
    done = command("build", "--json", folder=tmp_path)
    assert done.exit_code == 0, done.stderr
    assert [Path(path).name for path in json.loads(done.stdout)["fmus"]] == [fmu.file_name for fmu in FMUS]
    for fmu in FMUS:
        assert (tmp_path / "build" / fmu.file_name).is_file()


def test_run_leaves_table_summary_and_plot(workshop, scene, tmp_path):
    done = process("run", scene, "-o", tmp_path / "out", folder=workshop)
    assert done.exit_code == 0, done.stderr
    table = (tmp_path / "out" / "table.csv").read_text().splitlines()
    assert table[0].startswith("time [s]")
    assert len(table) == 102
    told = json.loads((tmp_path / "out" / "summary.json").read_text())
    summary = told["summary"]
    assert told["inertia_module"] == __version__
    assert told["parameters"] == {}
    assert told["units"]["omega_out_final"] == "rad/s"
    assert summary["omega_out_final"] == pytest.approx(3.447176379, rel=1e-5)
    assert summary["rhs_evaluations"] > 0
    assert (tmp_path / "out" / "plot.png").read_bytes().startswith(b"\x89PNG")
    assert "omega out final" in done.stdout


def test_run_builds_the_fmu_it_needs(scene, tmp_path):
    done = command("run", scene, "-o", tmp_path / "out", folder=tmp_path)
    assert done.exit_code == 0, done.stderr
    assert (tmp_path / "build" / "InertiaModule.fmu").is_file()


AUTO = ("run", "--fidelity", "auto")
REFUSED = [
    (("run",), ('kind = "constant"', 'kind = "konstant"'), ("drive.kind must be one of", "is 'konstant'")),
    (("run",), ('"100 rad/s"', '"100 m"'), ("drive.omega1 must be a number", "is '100 m'")),
    (
        ("run",),
        ("[run]", "[run]\nspeed = 3"),
        ("run.speed = 3: there is no such key", "(there are stop_time"),
    ),
    (("run",), ("stop_time", "stoptime"), ("stoptime", "did you mean stop_time?")),
    (("run",), ('"10 N.m"', '"10 N.m'), ("scene.toml",)),
    (AUTO, None, ("accuracy.error must be given",)),
    (("run", "--error", "1 %"), None, ("--error = 1 % must come with fidelity auto",)),
    ((*AUTO, "--error", "much"), None, ("--error must be a number above 0", "is 'much'")),
    (("run", "--fidelity", "exact"), None, ("mechanism.fidelity must be 0 (kin", "or auto, is 'exact'")),
    ((*AUTO, "--error", "1e-15"), None, ("error = 1e-15", "met by no level of fidelity")),
    (("tradeoff", "--recommend", "0"), None, ("--recommend must be a number above 0", "is '0'")),
    (("tradeoff", "--wanted", "speed"), None, ("run.outputs", "'speed'")),
]


@pytest.mark.parametrize("arguments, change, words", REFUSED)
def test_what_cannot_be_is_one_line_and_leaves_nothing(workshop, scene, tmp_path, arguments, change, words):
    scene.write_text(SCENE.replace(*change) if change else SCENE)
    name, *options = arguments
    done = command(name, scene, *options, "-o", tmp_path / "out", folder=workshop)
    assert done.exit_code == 1
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    assert all(word in done.stderr for word in words)
    assert not (tmp_path / "out").exists()


def test_run_chooses_the_fidelity_and_says_why(workshop, scene, tmp_path):
    auto = ("--fidelity", "auto", "--error", "5 %")
    done = command("run", scene, *auto, "-o", tmp_path / "out", folder=workshop)
    assert done.exit_code == 0, done.stderr
    for words in ("chosen: ", "where 0.05 was asked for", "next level: "):
        assert words in done.stdout
    choice = json.loads((tmp_path / "out" / "summary.json").read_text())["fidelity_choice"]
    assert choice["chosen"]["error"] <= 0.05
    # every output of the module is wanted: only a level with pulses has them
    assert choice["chosen"]["fidelity"] == "rigid"


def test_tradeoff_of_a_scene_for_machines(scene, tmp_path):
    arguments = ("--recommend", "1 %", "--wanted", "omega_out", "--json")
    done = command("tradeoff", scene, *arguments, "-o", tmp_path / "out", folder=tmp_path)
    assert done.exit_code == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["recommendation"]["chosen"]["error"] <= 0.01
    assert found["recommendation"]["asked"] == {"error": 0.01, "wanted": ["omega_out"]}
    settings = {(row["fidelity"], row["method"], row["setting"]) for row in found["rows"]}
    assert {("rigid", "event", "tolerance 1e-05"), ("rigid", "timestepping", "step 1 ms")} <= settings
    rows = (tmp_path / "out" / "tradeoff.csv").read_text().splitlines()
    assert len(rows) == len(found["rows"]) + 1
    assert all(Path(file).stat().st_size > 500 for file in found["files"].values())


@pytest.mark.parametrize(
    "name, run",
    [
        ("InertiaModule", command),
        ("InertiaModule3", command),
        ("InertiaModulePy", process),  # that of a Python FMU is left in a way of its own
        ("DrivenShaft3", command),
    ],
)
def test_check_finds_no_problem_in_ours(workshop, name, run):
    done = run("check", f"build/{name}.fmu", folder=workshop)
    assert done.exit_code == 0
    assert "no problems found" in done.stdout
    assert ("with event mode" in done.stdout) == (name == "InertiaModule3")


def test_check_tells_what_is_wrong_with_another(workshop, tmp_path):
    import zipfile

    broken = tmp_path / "broken.fmu"
    with (
        zipfile.ZipFile(workshop / "build" / "InertiaModule.fmu") as old,
        zipfile.ZipFile(broken, "w") as new,
    ):
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                content = content.replace(b'unit="rad/s"', b'unit="furlong"', 1)
            new.writestr(name, content)
    done = command("check", broken, "--json", folder=tmp_path)
    assert done.exit_code == 1
    assert any("furlong" in problem for problem in json.loads(done.stdout)["problems"])


@pytest.mark.parametrize(
    "run, arguments", [(process, ("check", "nothing.fmu")), (command, ("run", "nothing.toml"))]
)
def test_missing_files_are_named(tmp_path, run, arguments):
    done = run(*arguments, folder=tmp_path)
    assert done.exit_code == 1
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    assert arguments[1] in done.stderr


def test_run_warns_of_a_mechanism_that_cannot_be_built_and_runs_it(workshop, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE + "[mechanism]\nsatellites = 6\na = 1.5\n")
    done = command("run", path, "-o", tmp_path / "out", folder=workshop)
    assert done.exit_code == 0, done.stderr
    assert [line[:9] for line in done.stderr.splitlines()] == ["warning: "] * 2
    assert "the 6 satellites of a module overlap" in done.stderr
    assert "a must be at most 1 and at most b = 1, is 1.5" in done.stderr
    printed = json.loads(command("run", path, "-o", tmp_path / "out", "--json", folder=workshop).stdout)
    assert printed["summary"]["simulated_time"] == 0.1
    assert Path(printed["files"]["table"]).is_file()
    assert [f"warning: {warning}" for warning in printed["warnings"]] == done.stderr.splitlines()


OPTIONS = {
    "sweep": (
        [*("--vary", "a=1:2", "--sample", "latin:3", "--seed", "7"), *("--sensitivity", "8")],
        {"sample": "latin:3", "sensitivity": 8, "seed": 7},
    ),
    "design": ([], {}),
    "fit": (
        [*("--free", "a", "--column", "omega2", "--starts", "3", "--seed", "7")],
        {"columns": ["omega2"], "starts": 3, "seed": 7},
    ),
    "orders": (
        [*("--of", "pulses", "--signal", "omega2", "--highest", "5", "--turns", "6"), "--from", "1 s"],
        {"of": "pulses", "signals": ["omega2"], "highest": 5.0, "turns": 6.0, "begin": 1.0, "end": None},
    ),
}
CLUSTER = ["--scheduler", "tcp://host:1", "--workers", "2"]


@pytest.mark.parametrize("name", OPTIONS)
def test_options_of_a_job_reach_it_and_what_it_refuses_is_one_line(name, scene, tmp_path, monkeypatch):
    told = {}

    def stand_in(*arguments, **options):
        told.update(options)
        raise RuntimeError("the work\nis not done")

    monkeypatch.setattr(jobs, name, stand_in)
    options, expected = OPTIONS[name]
    if name in ("sweep", "design"):
        options = [*options, *CLUSTER]
        expected = {**expected, "scheduler": "tcp://host:1", "workers": 2}
    if name == "design":
        scene.write_text(SCENE + '[free]\na = "0.5:0.9"\n[figures]\nenergy_in = { goal = "least" }\n')
    first = [scene.with_suffix(".csv"), scene] if name == "fit" else [scene]
    done = command(name, *first, *options, "--fmu", "x.fmu", "-o", tmp_path / "out", folder=tmp_path)
    assert (done.exit_code, done.stderr) == (1, "error: the work is not done\n")
    assert {key: told[key] for key in expected} == expected
