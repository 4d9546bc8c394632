"""What the commands print reaches the terminal: every letter of a message, within its width."""

import json
import math
from pathlib import Path

import pytest
from rich.text import Text
from typer.main import get_command
from typer.testing import CliRunner

from inertia_module.cli import app
from inertia_module.cli.shared import show_table
from inertia_module.common.terminal import progress, terminal
from inertia_module.compiling import CompilationUnavailable
from inertia_module.fidelity.choice import at_levels, print_levels, recommend
from inertia_module.fidelity.levels import Row as Measured
from studies.coupling import Trial
from studies.coupling import print_rows as print_coupling
from studies.stability.map import Cell, Row, read_rows
from studies.stability.map import print_rows as print_stability
from studies.stability.trial import OUTCOMES

# a style, a picture and a closing tag to rich; to a user the name of an extra, of a key and of a folder
AWKWARD = "[fast] :key: [/tmp]"


def measured(fidelity, method, setting, wall_time, evaluations=1.0, **errors):
    return Measured(fidelity, method, setting, 1e-3, errors, wall_time, evaluations, 3.0)


def stability_rows():
    cells = {name: Cell("degraded", -4, AWKWARD) for name in ("kinematic", "elastic, timestepping")}
    return [Row(AWKWARD, "1e-313 rad/s", "bevel", cells)]


PRINTERS = {
    "summary": lambda: show_table(AWKWARD, {AWKWARD: "1"}),
    "value of a summary": lambda: show_table("title", {"heading": AWKWARD}),
    "levels": lambda: print_levels(AWKWARD, [measured("rigid", "event", "x", 1.0, omega2=0.1)], ["omega2"]),
    "setting": lambda: print_levels("R1", [measured("peer", "x", AWKWARD, 1.0, omega2=0.1)], ["omega2"]),
    "stability": lambda: print_stability(stability_rows()),
    "coupling": lambda: print_coupling("map", [Trial(AWKWARD, *[1.0] * 9)]),
    "message": lambda: terminal().print(AWKWARD),
}


@pytest.mark.parametrize("name", PRINTERS)
def test_brackets_and_colons_are_printed_as_they_are(name, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    PRINTERS[name]()
    assert AWKWARD in capsys.readouterr().out


@pytest.mark.parametrize("name", get_command(app).commands)
def test_help_of_a_command_has_every_letter(name):
    command = get_command(app).commands[name]
    shown = " ".join(CliRunner().invoke(app, [name, "-h"], terminal_width=1000).stdout.split())
    for text in (command.help, *(parameter.help for parameter in command.params if parameter.help)):
        assert " ".join(text.split()) in shown


def test_list_of_the_commands_says_in_whole_sentences_what_they_do():
    assert "..." not in CliRunner().invoke(app, ["-h"]).stdout.partition("Commands:")[2]


def test_progress_bar_shows_a_title_as_it_is():
    bar = progress()
    task = bar.add_task(AWKWARD)
    title = bar.columns[0].render(bar.tasks[task])
    assert isinstance(title, Text)
    assert title.plain == AWKWARD


@pytest.fixture
def no_compiler(monkeypatch):
    """A machine without ziglang."""
    from inertia_module.compiling import linking
    from inertia_module.fmu import native_fmu

    def missing():
        raise CompilationUnavailable("ziglang is not installed; it comes with the extra inertia-module[fast]")

    for module in (linking, native_fmu):
        monkeypatch.setattr(module, "compiler", missing)


def test_build_without_a_compiler_fails_and_names_the_extra(no_compiler, tmp_path):
    done = CliRunner().invoke(app, ["build", "-o", str(tmp_path)])
    assert done.exit_code == 1
    missing = "ziglang is not installed; it comes with the extra inertia-module[fast]"
    assert f"InertiaModule.fmu: {missing}" in done.stderr
    assert (tmp_path / "InertiaModulePy.fmu").is_file()
    assert not (tmp_path / "InertiaModule.fmu").exists()
    done = CliRunner().invoke(app, ["build", "-o", str(tmp_path), "--json"])
    assert done.exit_code == 1
    assert {"InertiaModule.fmu", "DrivenShaft.fmu"} <= set(json.loads(done.stdout)["skipped"])


OUTPUTS = (
    *("omega2", "omega_out", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("input_torque_mean", "output_torque_mean", "imbalance_acceleration_x", "contact_mode"),
)
LEVELS = [
    measured("averaged", "", "map", 0.1e-3, **dict.fromkeys(OUTPUTS, math.nan)),
    *(measured("rigid", "timestepping", f"step {n} ms", 1e-3, **dict.fromkeys(OUTPUTS, 0.1)) for n in (1, 2)),
    measured("rigid", "event", "tolerance 1e-03", 1.60e-3, 50.0, **dict.fromkeys(OUTPUTS, 2.4e-5)),
    measured("rigid", "event", "tolerance 1e-07", 1.58e-3, 90.0, **dict.fromkeys(OUTPUTS, 2.4e-9)),
    measured("elastic", "timestepping", "step 0.1 ms", 1e-2, **dict.fromkeys(OUTPUTS, 2.4e-3)),
    measured("elastic", "event", "tolerance 1e-03", 1.42e-1, 50.0, **dict.fromkeys(OUTPUTS, 2.4e-5)),
]


@pytest.mark.parametrize("wanted", [OUTPUTS[:1], OUTPUTS[:2], OUTPUTS[7:9], OUTPUTS])
def test_trade_has_a_line_for_each_level_and_fits_the_terminal(wanted, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    print_levels("A scene", LEVELS, wanted)
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    stepped = [f"{level}, {method}" for level in ("rigid", "elastic") for method in ("timestepping", "event")]
    for level in ("averaged", *stepped):
        assert sum(line.startswith(level) for line in lines) == 1
    assert any("2.4e-05" in line and "1.6" in line for line in lines)
    assert not any("tolerance 1e-07" in line for line in lines)


def test_wanted_outputs_that_fit_have_a_column_each(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    print_levels("A scene", LEVELS, ["omega2", "omega_out"])
    heading = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("level"))
    assert " ".join(heading.split()) == "level of fidelity setting omega2 omega out ms per s"


def test_recommended_level_is_the_fastest_of_those_printed_that_meet_the_error():
    for error in (1e-2, 1e-4, 1e-8):
        printed = at_levels(LEVELS, error, OUTPUTS)
        choice = recommend(LEVELS, error, OUTPUTS)
        meeting = [row for row in printed if row.worst(OUTPUTS) <= error]
        assert choice.row is min(meeting, key=lambda row: row.wall_time)


def test_level_that_does_not_meet_the_error_shows_its_most_accurate_setting():
    printed = at_levels(LEVELS, 1e-12, OUTPUTS)
    assert [row.setting for row in printed if row.fidelity == "rigid"] == ["step 1 ms", "tolerance 1e-07"]


def test_map_of_extremes_has_a_line_for_each_level_and_fits_the_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    rows = read_rows(Path(__file__).parents[2] / "docs" / "stability.csv")
    cells = {name: Cell(outcome, 1) for name, outcome in zip(rows[0].cells, OUTCOMES, strict=False)}
    print_stability([*rows, Row("all verdicts", "x", "bevel", cells)])
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    axes = {row.axis for row in rows if "kinematic" in row.cells}
    assert sum(line.startswith("kinematic ") for line in lines) == len(axes) + 1
    exact = sum(cell.outcome == "exact" for row in rows for cell in row.cells.values())
    assert lines[-1].startswith(f"{exact + 1} exact, ")
