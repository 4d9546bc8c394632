"""Test the commands of papers and verification."""

import functools
import json
from pathlib import Path

from papers.__main__ import app as papers_app
from papers.figures import FIGURES
from tests.system import programs
from verification.__main__ import app
from verification.stability.random_motions import Row, read_rows
from verification.stability.verdicts import Verdict

command, succeeded = (functools.partial(run, program=app) for run in (programs.command, programs.succeeded))


def test_papers_writes_figures_as_png_svg_and_csv(tmp_path, monkeypatch):
    # test_papers.py draws all figures
    few = {name: FIGURES[name] for name in ("lysenko_1", "stelmashchuk_2")}
    monkeypatch.setattr("papers.figures.FIGURES", few)
    process = programs.succeeded("-o", tmp_path / "papers", "--json", folder=tmp_path, program=papers_app)
    files = [Path(file) for file in json.loads(process.stdout)["files"]]
    for kind in (".png", ".svg", ".csv"):
        drawn = {file.stem: file for file in files if file.suffix == kind}
        assert set(drawn) == set(few)
        assert all(file.stat().st_size > 1000 for file in drawn.values())


def test_stability_writes_the_table_of_the_extremes(tmp_path):
    arguments = ("stability", "--only", "output locked", "--quick", "-o", tmp_path / "table", "--json")
    process = succeeded(*arguments, folder=tmp_path)
    printed = json.loads(process.stdout)
    assert {verdict["verdict"] for verdict in printed["verdicts"]} <= {"exact", "degraded", "rejected"}
    assert {path.name for path in (tmp_path / "table").iterdir()} == {"stability.csv"}
    assert all(Path(path).is_file() for path in printed["files"].values())


def test_stability_prints_a_row_for_each_axis_and_fails_if_a_case_is_broken(tmp_path, monkeypatch):
    def run_study(cases, report):
        return [Verdict(case, "exact" if number else "broken") for number, case in enumerate(cases)]

    monkeypatch.setattr("verification.stability.verdicts.run_study", run_study)
    process = command("stability", "--only", "output locked", "-o", tmp_path / "table", folder=tmp_path)
    assert process.exit_code == 1
    assert "output locked" in process.stdout
    assert "31 exact, 0 sensitive, 0 degraded, 0 rejected, 1 broken" in process.stdout


def test_stability_runs_random_machines_of_a_seed(tmp_path):
    arguments = ("stability", "--random", "8", "--seed", "5", "--workers", "1", "-o", tmp_path / "random")
    printed = json.loads(succeeded(*arguments, "--json", folder=tmp_path).stdout)
    assert [machine["number"] for machine in printed["machines"]] == list(range(8))
    assert {machine["verdict"] for machine in printed["machines"]} == {"exact"}
    rows = read_rows(Path(printed["files"]["machines"]))
    assert [row._asdict() for row in rows] == printed["machines"]


def test_stability_names_the_random_machines_that_fail(tmp_path, monkeypatch):
    def examine_machines(*_):
        return [Row(0, "rigid", "bevel", "speed", "degraded", "1.0e-05", "momentum")]

    monkeypatch.setattr("verification.stability.random_motions.examine_machines", examine_machines)
    process = command("stability", "--random", "1", "-o", tmp_path / "random", folder=tmp_path)
    assert process.exit_code == 1
    assert "number 0 (rigid): degraded: momentum" in process.stdout
