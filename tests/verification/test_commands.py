"""The commands of the studies, as they are run at the root of the project."""

import functools
import json
from pathlib import Path

from papers.__main__ import app as papers_app
from papers.figures import FIGURES
from tests.system import programs
from verification.__main__ import app
from verification.stability.verdicts import Verdict

command, succeeded = (functools.partial(run, of=app) for run in (programs.command, programs.succeeded))


def test_papers_leaves_every_figure_as_png_svg_and_csv(tmp_path, monkeypatch):
    # test_papers.py draws them all
    few = {name: FIGURES[name] for name in ("lysenko_1", "stelmashchuk_2")}
    monkeypatch.setattr("papers.figures.FIGURES", few)
    done = programs.succeeded("-o", tmp_path / "papers", "--json", folder=tmp_path, of=papers_app)
    files = [Path(file) for file in json.loads(done.stdout)["files"]]
    for kind in (".png", ".svg", ".csv"):
        drawn = {file.stem: file for file in files if file.suffix == kind}
        assert set(drawn) == set(few)
        assert all(file.stat().st_size > 1000 for file in drawn.values())


def test_stability_leaves_the_map_as_tables_and_picture(tmp_path):
    arguments = ("stability", "--only", "output locked", "--quick", "-o", tmp_path / "map", "--json")
    done = succeeded(*arguments, folder=tmp_path)
    printed = json.loads(done.stdout)
    assert {found["verdict"] for found in printed["verdicts"]} <= {"exact", "degraded", "rejected"}
    assert {path.name for path in (tmp_path / "map").iterdir()} == {"stability.csv", "stability_summary.png"}
    assert all(Path(path).is_file() for path in printed["files"].values())


def test_stability_prints_the_map_and_fails_if_one_case_is_broken(tmp_path, monkeypatch):
    def judged(chosen, report):
        return [Verdict(case, "exact" if number else "broken") for number, case in enumerate(chosen)]

    monkeypatch.setattr("verification.stability.verdicts.run_study", judged)
    done = command("stability", "--only", "output locked", "-o", tmp_path / "map", folder=tmp_path)
    assert done.exit_code == 1
    assert "output locked" in done.stdout
    assert "31 exact, 0 sensitive, 0 degraded, 0 rejected, 1 broken" in done.stdout


def test_stability_tries_random_motions_of_a_seed(tmp_path):
    arguments = ("stability", "--random", "12", "--seed", "5", "-o", tmp_path / "random")
    done = succeeded(*arguments, folder=tmp_path)
    assert "restored state" in done.stdout
    written = (tmp_path / "random" / "random.csv").read_text()
    assert written.startswith("level,invariant,runs,explained,sensitive,failed,worst,bound,number\n")
    printed = json.loads(command(*arguments, "--json", folder=tmp_path).stdout)
    assert printed["findings"] == []
    assert Path(printed["files"]["invariants"]).read_text() == written
