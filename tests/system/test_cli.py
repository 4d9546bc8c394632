"""Test the command: its files, its errors before the work, its output and its help."""

import importlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from rejected import REJECTED
from rich.console import Console
from typer.main import get_command
from typer.testing import CliRunner

from inertia_module import PUBLIC, __version__
from inertia_module.cli import app, options, print_part, scene_runs, studies
from inertia_module.common.errors import InertiaModuleError
from inertia_module.common.examples import examples
from inertia_module.common.files import MAX_TEXT_SIZE
from inertia_module.common.terminal import progress, terminal
from inertia_module.fidelity.level_table import print_levels
from inertia_module.fidelity.rows import Row as Measured
from inertia_module.fmi.results import Result
from inertia_module.fmu import builder
from inertia_module.fmu.archive import DESCRIPTION
from inertia_module.fmu.builder import FMUS, PYTHON_FMU
from inertia_module.interface.variables import ENUMERATIONS
from inertia_module.scene import load_any_scene, summary_text
from inertia_module.scene.keys import AUTO
from inertia_module.scene.summary_text import Summary
from inertia_module.studies.order_result import BASES
from tests.packed import with_words
from tests.system.programs import assert_one_line_error, command, process, succeeded

EXAMPLES = Path(__file__).parents[2] / "examples"
REFERENCE = str(EXAMPLES / "reference.toml")
RIG = [EXAMPLES / "fit_rig.csv", EXAMPLES / "fit_rig.toml"]


def own_process(*arguments, folder):
    """Run a command in its own process."""
    done = process("-m", "inertia_module", *arguments, statuses=(0, 1), folder=folder)
    done.exit_code = done.returncode
    return done


@pytest.fixture
def workshop(built, tmp_path):
    """Return a folder with built FMUs."""
    (tmp_path / "build").symlink_to(built, target_is_directory=True)
    return tmp_path


SHORT = (REFERENCE, "--set", "run.stop_time=0.1 s", "--set", "run.communication_step=1 ms")


# --- files of commands ---


def test_run_writes_only_table_summary_and_plot(tmp_path):
    done = own_process("run", *SHORT, "-o", tmp_path / "out", folder=tmp_path)
    assert done.exit_code == 0, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    table = (tmp_path / "out" / "table.csv").read_text().splitlines()
    assert table[0].startswith("time [s]")
    assert len(table) == 102
    written = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (written["inertia_module"], written["parameters"]) == (__version__, {})
    assert written["units"]["omega_out_final"] == "rad/s"
    assert written["summary"]["omega_out_final"] == pytest.approx(3.447176379, rel=1e-5)
    assert written["summary"]["rhs_evaluations"] > 0
    assert (tmp_path / "out" / "plot.png").read_bytes().startswith(b"\x89PNG")
    title, speed = done.stdout.splitlines()[:2]
    assert re.fullmatch(r"R1: a bevel inertia module starts a flywheel +0\.1 s, rigid", title)
    assert speed.startswith("  Speed       input 100 rad/s   output at the end 3.45 rad/s")


SCENES = [path for path in examples().values() if path.suffix == ".toml" and path.stem != "design_car"]


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_summary_of_each_example_fits_a_terminal_of_80_columns(workshop, scene):
    for name in ("InertiaModule", "DrivenShaft"):
        builder.current_fmu(name)  # in the cache; otherwise the run reports that it builds the FMU
    done = succeeded("run", scene, folder=workshop)
    lines = done.stdout.splitlines()
    assert (done.stderr, max(map(len, lines)) <= 80, len(lines) <= 17) == ("", True, True), done.stdout
    assert lines[0].startswith(load_any_scene(scene).title[:40])
    assert lines[-1] == f"  out/{scene.stem}: table.csv  summary.json  plot.png"
    assert not re.search(r"(?<![\d.])0 (J|N|N·m|rpm|rad/s)", done.stdout)


@pytest.mark.parametrize("no_color, code", [("", "\x1b[31m"), ("1", "")])
def test_warnings_are_red_on_a_terminal_unless_the_user_wants_no_colour(monkeypatch, no_color, code):
    out = io.StringIO()
    monkeypatch.setenv("NO_COLOR", no_color)
    monkeypatch.setattr(scene_runs, "terminal", lambda: Console(file=out, force_terminal=True, width=80))
    summary = Summary(["title"], ["  ! a warning"], ["  Speed"])
    monkeypatch.setattr(summary_text, "summary", lambda *_: summary)
    scene_runs._print_summary(None, {})
    assert out.getvalue().splitlines()[1].startswith(f"{code}  ! a warning")
    assert out.getvalue().splitlines()[2] == "  Speed"


def test_run_prints_every_metric_with_all(workshop, tmp_path):
    done = succeeded("run", *SHORT, "--all", "-o", tmp_path / "out", folder=workshop)
    metrics = json.loads((tmp_path / "out" / "summary.json").read_text())["summary"]
    assert len(re.findall("^│", done.stdout, re.MULTILINE)) == len(metrics)
    assert "final output speed" in done.stdout


def test_run_chooses_the_fidelity_and_prints_the_reason(workshop, tmp_path):
    auto = ("--fidelity", "auto", "--error", "5 %")
    done = succeeded("run", *SHORT, *auto, "-o", tmp_path / "out", folder=workshop)
    for words in ("chosen: ", "requested 0.05", "next level: "):
        assert words in " ".join(done.stdout.split())
    assert max(map(len, done.stdout.splitlines()[:-2])) <= 80
    choice = json.loads((tmp_path / "out" / "summary.json").read_text())["fidelity_choice"]
    assert choice["chosen"]["error"] <= 0.05
    # All outputs of the module are requested: only a level with pulses has them.
    assert choice["chosen"]["fidelity"] == "rigid"


def test_mechanism_that_cannot_be_built_runs_with_a_warning(workshop, tmp_path):
    scene = (*SHORT, "--set", "satellites=6", "--set", "a=1.5", "--set", "method=timestepping")
    done = succeeded("run", *scene, "-o", tmp_path / "out", folder=workshop)
    marks = [line.startswith("  ! ") for line in done.stdout.splitlines()]
    assert (marks[1], sum(marks), done.stderr) == (True, 3, "")
    text = " ".join(done.stdout.split())
    assert "the 6 satellites of a module overlap" in text
    assert "a must be at most 1 and at most b = 1 (got 1.5)" in text
    assert "method = timestepping is no longer available" in text
    printed = json.loads(command("run", *scene, "-o", tmp_path / "out", "--json", folder=workshop).stdout)
    assert printed["summary"]["simulated_time"] == 0.1
    assert Path(printed["files"]["table"]).is_file()
    assert len(printed["warnings"]) == 3
    every = succeeded("run", *scene, "--all", "-o", tmp_path / "out", folder=workshop)
    assert [f"warning: {warning}" for warning in printed["warnings"]] == every.stderr.splitlines()


def test_tradeoff_of_a_scene_for_machines(tmp_path):
    arguments = ("--recommend", "1 %", "--set", 'run.outputs=["omega_out"]', "--json")
    done = succeeded("tradeoff", *SHORT, *arguments, "-o", tmp_path / "out", folder=tmp_path)
    answer = json.loads(done.stdout)
    assert answer["recommendation"]["chosen"]["error"] <= 0.01
    assert answer["recommendation"]["request"] == {"error": 0.01, "outputs": ["omega_out"]}
    settings = {(row["fidelity"], row["method"], row["setting"]) for row in answer["rows"]}
    assert {("averaged", "", "map"), ("rigid", "", "tolerance 1e-05")} <= settings
    rows = (tmp_path / "out" / "tradeoff.csv").read_text().splitlines()
    assert len(rows) == len(answer["rows"]) + 1
    assert all(Path(file).stat().st_size > 500 for file in answer["files"].values())


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_check_reports_no_problems_of_the_fmus(built, tmp_path, fmu):
    # A Python FMU ends its process in an unusual way, so use a separate process.
    done = (own_process if fmu is PYTHON_FMU else command)("check", built / fmu.file_name, folder=tmp_path)
    assert done.exit_code == 0
    assert "no problems found" in done.stdout
    assert "deviation from reference results" in done.stdout
    assert "generation tool" in done.stdout
    assert ("with event mode" in done.stdout) == (fmu.identifier == "InertiaModule3")


def test_check_names_the_problems_of_a_foreign_fmu(built, tmp_path):
    units = b'unit="rad/s"', b'unit="furlong"'
    broken = with_words(tmp_path / "broken.fmu", built / "InertiaModule.fmu", DESCRIPTION, *units)
    done = command("check", broken, "--json")
    assert done.exit_code == 1
    assert any("furlong" in problem for problem in json.loads(done.stdout)["problems"])


# Files and options of a study, and its expected arguments.
OPTIONS = {
    "sweep": (
        [REFERENCE, "--vary=a=1:2", "--sample=latin:3", "--seed=7", "--sensitivity=8"],
        {"sample": "latin:3", "sensitivity": 8, "seed": 7},
    ),
    "design": ([EXAMPLES / "design_car.toml"], {}),
    "fit": (
        [*RIG, "--free=a", "--column=omega2", "--starts=3", "--seed=7"],
        {"columns": ["omega2"], "starts": 3, "seed": 7},
    ),
    "orders": (
        [REFERENCE, "--of=drive_angle", "--signal=omega2", "--highest=5", "--turns=6", "--from=1 s"],
        {"of": "drive_angle", "signals": ["omega2"], "highest": 5.0, "turns": 6.0, "begin": 1.0, "end": None},
    ),
}


@pytest.mark.parametrize(
    "arguments, code, message",
    [
        (("run", "nothing.toml"), 1, "cannot read nothing.toml: no such file or directory"),
        (("run", REFERENCE, "--fidelity", "rigd"), 1, "unknown fidelity 'rigd'; did you mean 'rigid'?"),
        (("run", REFERENCE, "--fidelty", "rigid"), 2, "No such option: --fidelty"),
        (("rn", REFERENCE), 2, "No such command 'rn'."),
        (("run",), 2, "Missing argument"),
    ],
)
def test_json_of_an_error_is_one_object_with_the_message(tmp_path, arguments, code, message):
    done = command(*arguments, "--json", folder=tmp_path)
    printed = json.loads(done.stdout)
    assert (done.exit_code, list(printed)) == (code, ["error"])
    assert printed["error"].startswith(message)
    assert command(*arguments, folder=tmp_path).stdout == ""


def test_choices_of_an_option_are_the_names_of_the_package():
    levels = [name for name, *_ in ENUMERATIONS["Fidelity"]]
    assert (*levels, AUTO) == options.FIDELITIES
    assert tuple(BASES) == studies.REFERENCE_ANGLES


CLUSTER = ["--scheduler", "tcp://host:1", "--workers", "2"]


@pytest.mark.parametrize("name", OPTIONS)
def test_options_reach_the_study_and_errors_are_a_line(name, tmp_path, monkeypatch):
    received = {}

    def stand_in(*arguments, **options):
        received.update(options)
        raise RuntimeError("the work\nis not done")

    module = importlib.import_module(f"inertia_module.{PUBLIC[name]}")
    monkeypatch.setattr(module, name, stand_in)
    arguments, expected = OPTIONS[name]
    if name in ("sweep", "design"):
        arguments = [*arguments, *CLUSTER]
        expected = {**expected, "scheduler": "tcp://host:1", "workers": 2}
    done = command(name, *arguments, "--fmu", "x.fmu", "-o", tmp_path / "out")
    assert (done.exit_code, done.stderr) == (1, "error: the work is not done\n")
    assert {key: received[key] for key in expected} == expected


# --- errors (test_scene.py tests the sentences about scenes) ---


@pytest.mark.parametrize("arguments, words", REJECTED["options"])
def test_invalid_request_is_an_error_in_a_line_before_the_build(tmp_path, monkeypatch, arguments, words):
    monkeypatch.setattr(builder, "current_fmu", lambda *_: pytest.fail("an FMU was built"))
    name, *options = arguments
    files = {"fit": RIG, "design": [EXAMPLES / "design_car.toml"]}.get(name, SHORT)
    assert_one_line_error(command(name, *files, *options, "-o", tmp_path / "out", folder=tmp_path), *words)
    assert not list(tmp_path.iterdir())


IS_FOLDER = "error: cannot read .: is a directory\n"


@pytest.mark.parametrize(
    "run, arguments, words",
    [
        (own_process, ("check", "nothing.fmu"), "nothing.fmu"),
        (command, ("run", "nothing.toml", "-o", "a/b"), "nothing.toml"),
        (command, ("check", "."), IS_FOLDER),
        (command, ("run", REFERENCE, "--fmu", ".", "-o", "out"), IS_FOLDER),
    ],
)
def test_missing_files_are_named_before_a_folder_is_created(tmp_path, run, arguments, words):
    assert_one_line_error(run(*arguments, folder=tmp_path), words)
    assert list(tmp_path.iterdir()) == []


# --- a folder without write permission is an error before the work ---

# Arguments of each command, and the function that does its work.
COMMANDS = {
    "build": (["build"], "fmu.builder.content_of"),
    "run": (["run", REFERENCE], "scene.run_scene"),
    "run, choosing": (["run", REFERENCE, "--fidelity", "auto", "--error", "1 %"], "fidelity.choice.choose"),
    "tradeoff": (["tradeoff", REFERENCE], "fidelity.measure.trial_rows"),
    "chart": (["chart", REFERENCE], "scene.chart.compute_chart"),
    "export": (["export", REFERENCE], "export.systems.export"),
}


def unwritable_paths(folder):
    """Return paths without write permission, and words of the reason."""
    (folder / "table.csv").write_text("a file")
    (folder / "nowhere").symlink_to(folder / "gone")
    reasons = {
        folder / "table.csv": "table.csv is not a folder",
        folder / "table.csv" / "below": "table.csv is not a folder",
        folder / "nowhere": "nowhere is not a folder",
        folder / ("long" * 100): "name too long",
    }
    if sys.platform == "linux":
        reasons[Path("/proc/results")] = ""
    if os.name == "posix" and os.geteuid() != 0:
        (folder / "locked").mkdir(mode=0o500)
        reasons[folder / "locked"] = "Permission denied"
    return reasons


@pytest.mark.parametrize("name", COMMANDS)
def test_path_without_write_permission_is_rejected_before_the_work(name, tmp_path, monkeypatch):
    arguments, work = COMMANDS[name]
    monkeypatch.setattr(f"inertia_module.{work}", lambda *_, **__: pytest.fail("the work was begun"))
    for path, words in unwritable_paths(tmp_path).items():
        start = f"error: cannot write to {path}: "
        assert_one_line_error(command(*arguments, "-o", path), start, words)
    assert {path.name for path in tmp_path.iterdir()} <= {"table.csv", "nowhere", "locked"}
    if name != "build":  # The folder may also be implicit.
        (tmp_path / "out").write_text("a file")
        assert_one_line_error(command(*arguments, folder=tmp_path), "error: cannot write to out")


def test_unwritable_table_is_an_error_in_a_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=r"^cannot write to .*file: .*file is not a folder$"):
        Result.from_columns({"time": [0.0]}).to_csv(tmp_path / "file" / "table.csv")


# --- closed outputs, full disks, devices instead of files ---

# A command with closed or full outputs of the shell, the line on the error output, the exit code.
OUTPUTS = [
    ("new planar | head -0", "error: standard output: Broken pipe", 1),
    (f"chart {REFERENCE} | head -0", "error: standard output: Broken pipe", 1),
    ("new planar --json >&-", "error: standard output: Bad file descriptor", 1),
    ("new planar > /dev/full", "error: standard output: No space left on device", 1),
    ("new -h > /dev/full", "error: standard output: No space left on device", 1),
    ("new planar 2>&-", "", 0),
    ("new nothing 2> /dev/full", "", 1),
    ("new planar <&- >&- 2>&-", "", 1),
]
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="there is no /dev/full")


@LINUX
@pytest.mark.parametrize("arguments, line, code", OUTPUTS)
def test_closed_or_full_output_is_an_error_in_a_line(tmp_path, arguments, line, code):
    shell = ["bash", "-o", "pipefail", "-c", f"{shlex.quote(sys.executable)} -m inertia_module {arguments}"]
    done = subprocess.run(shell, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (done.stderr, done.returncode) == (f"{line}\n" if line else "", code)


# This process can write files of at most 1,000 bytes, like a nearly full disk.
NEARLY_FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
from inertia_module.cli import main
main()
"""


@LINUX
@pytest.mark.parametrize(
    "arguments, file", [(["new", "urban"], "urban.toml"), (["chart", REFERENCE], "out/chart/reference.csv")]
)
def test_full_disk_is_an_error_with_the_file_name_and_leaves_no_partial_file(tmp_path, arguments, file):
    done = process("-c", NEARLY_FULL, *arguments, statuses=(1,), folder=tmp_path)
    assert done.stderr == f"error: {file}: File too large\n"
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


@LINUX
@pytest.mark.parametrize("device", ["/dev/zero", "pipe"])
@pytest.mark.parametrize("name", ["run", "view", "report", "chart", "tradeoff", "export", "design", "orders"])
def test_device_or_pipe_as_a_scene_is_an_error_in_a_line(tmp_path, name, device):
    os.mkfifo(tmp_path / "pipe")
    message = f"error: cannot read {device}: not a regular file (a device or a pipe)"
    assert_one_line_error(command(name, device, folder=tmp_path), message)


@LINUX
@pytest.mark.parametrize("device", ["/dev/zero", "pipe"])
def test_device_or_pipe_as_another_file_is_an_error_in_a_line(tmp_path, device):
    os.mkfifo(tmp_path / "pipe")
    folder = "/dev" if device == "/dev/zero" else tmp_path
    words = "not a regular file (a device or a pipe)"
    commands = [
        ["fit", device, RIG[1], "--free", "a"],
        ["sweep", REFERENCE, "--vary", "a=1:2:3", "--fmu", device],
        ["design", EXAMPLES / "design_car.toml", "--fmu", device],
    ]
    for arguments in commands:
        assert_one_line_error(command(*arguments, folder=tmp_path), device, words)
    with pytest.raises(InertiaModuleError, match=re.escape(words)):
        Result.from_csv(Path(folder, device))


def test_too_large_file_is_rejected(tmp_path):
    path = tmp_path / "table.csv"
    path.touch()
    os.truncate(path, MAX_TEXT_SIZE + 1)
    with pytest.raises(InertiaModuleError, match=r"^cannot read .*table.csv: larger than 100 MB$"):
        Result.from_csv(path)


# --- messages appear on the terminal unchanged and within its width ---

# rich reads a style, a picture and a closing tag; users read an extra, a key and a folder.
AWKWARD = "[fast] :key: [/tmp]"


def levels(title, fidelity, setting):
    row = Measured(fidelity, "event", setting, 1e-3, {"omega2": 0.1}, 1.0, 1.0, 3.0)
    print_levels(title, [row], ["omega2"])


def bar():
    progress_bar = progress()
    progress_bar.add_task(AWKWARD)
    terminal().print(progress_bar.columns[0].render(progress_bar.tasks[0]))


PRINTERS = {
    "summary": lambda: print_part((AWKWARD, {AWKWARD: "1"})),
    "value of a summary": lambda: print_part(("title", {"heading": AWKWARD})),
    "levels": lambda: levels(AWKWARD, "rigid", "x"),
    "setting": lambda: levels("R1", "peer", AWKWARD),
    "message": lambda: terminal().print(AWKWARD),
    "title of a bar": bar,
}


@pytest.mark.parametrize("name", PRINTERS)
def test_brackets_and_colons_are_printed_unchanged(name, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    PRINTERS[name]()
    assert AWKWARD in capsys.readouterr().out


@pytest.mark.parametrize("name", get_command(app).commands)
def test_help_of_a_command_is_not_cut(name):
    command = get_command(app).commands[name]
    help_text = " ".join(CliRunner().invoke(app, [name, "-h"], terminal_width=1000).stdout.split())
    shown_options = [parameter for parameter in command.params if not getattr(parameter, "hidden", False)]
    for text in (command.help, *(parameter.help for parameter in shown_options if parameter.help)):
        assert " ".join(text.split()) in help_text


def test_help_lists_the_commands_in_the_order_of_work_without_cutting_their_descriptions():
    assert command("-h").stdout == command("--help").stdout
    listed = command("-h").stdout.partition("Commands:")[2]
    assert "..." not in listed
    order = "new run view report chart orders sweep design fit tradeoff export check build"
    assert [line.split()[0] for line in listed.splitlines() if line.strip()] == order.split()


def example_of(name):
    """Return the arguments of the example in the help of a command."""
    help_text = CliRunner().invoke(app, [name, "-h"], terminal_width=80).stdout
    assert all(len(line) <= 80 for line in help_text.splitlines())
    (example,) = re.findall(r"^  Example:\n    inertia-module (.+)$", help_text, re.MULTILINE)
    first, *arguments = shlex.split(example)
    assert first == name
    return arguments


# These arguments shorten the work of an example.
SHORTER = {"design": [f"--set=search.{key}" for key in ("population=8", "generations=1", "starts=1")]}
SLOW = ("build", "design", "export", "fit", "orders", "sweep")
NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in get_command(app).commands
]


@pytest.mark.parametrize("name", NAMES)
def test_example_in_the_help_of_a_command_runs(name, built, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    for path in [*EXAMPLES.glob("*.toml"), *EXAMPLES.glob("*.csv")] if name != "new" else []:
        shutil.copy(path, tmp_path)
    shutil.copytree(built, tmp_path / "build")
    before = set(tmp_path.rglob("*"))
    arguments = example_of(name)
    done = succeeded(name, *arguments, *SHORTER.get(name, ()), folder=tmp_path)
    assert done.stdout
    assert (set(tmp_path.rglob("*")) > before) == (name not in ("check", "build"))
    assert len(opened) == ("--open" in arguments)
