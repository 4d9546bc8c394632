"""Test the commands of papers and verification."""

import functools
import json
from pathlib import Path

from papers.__main__ import app as papers_app
from papers.figures import FIGURES
from tests.system import programs
from verification.__main__ import app
from verification.stability.verdicts import Verdict

command, succeeded = (functools.partial(run, of=app) for run in (programs.command, programs.succeeded))


def test_papers_writes_figures_as_png_svg_and_csv(tmp_path, monkeypatch):
    # test_papers.py draws all figures
    few = {name: FIGURES[name] for name in ("lysenko_1", "stelmashchuk_2")}
    monkeypatch.setattr("papers.figures.FIGURES", few)
    process = programs.succeeded("-o", tmp_path / "papers", "--json", folder=tmp_path, of=papers_app)
    files = [Path(file) for file in json.loads(process.stdout)["files"]]
    for kind in (".png", ".svg", ".csv"):
        drawn = {file.stem: file for file in files if file.suffix == kind}
        assert set(drawn) == set(few)
        assert all(file.stat().st_size > 1000 for file in drawn.values())


def test_stability_writes_the_map_as_tables_and_picture(tmp_path):
    arguments = ("stability", "--only", "output locked", "--quick", "-o", tmp_path / "map", "--json")
    process = succeeded(*arguments, folder=tmp_path)
    printed = json.loads(process.stdout)
    assert {case["verdict"] for case in printed["verdicts"]} <= {"exact", "degraded", "rejected"}
    assert {path.name for path in (tmp_path / "map").iterdir()} == {"stability.csv", "stability_summary.png"}
    assert all(Path(path).is_file() for path in printed["files"].values())


def test_stability_prints_the_map_and_fails_if_one_case_is_broken(tmp_path, monkeypatch):
    def judge(cases, report):
        return [Verdict(case, "exact" if number else "broken") for number, case in enumerate(cases)]

    monkeypatch.setattr("verification.stability.verdicts.run_study", judge)
    process = command("stability", "--only", "output locked", "-o", tmp_path / "map", folder=tmp_path)
    assert process.exit_code == 1
    assert "output locked" in process.stdout
    assert "31 exact, 0 sensitive, 0 degraded, 0 rejected, 1 broken" in process.stdout


def test_stability_runs_random_motions_with_a_seed(tmp_path):
    arguments = ("stability", "--random", "12", "--seed", "5", "-o", tmp_path / "random")
    process = succeeded(*arguments, folder=tmp_path)
    assert "restored state" in process.stdout
    table = (tmp_path / "random" / "random.csv").read_text()
    assert table.startswith("level,invariant,runs,explained,sensitive,failed,worst,bound,number\n")
    printed = json.loads(command(*arguments, "--json", folder=tmp_path).stdout)
    assert printed["findings"] == []
    assert Path(printed["files"]["invariants"]).read_text() == table
