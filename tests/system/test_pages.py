"""What is generated, and what the README promises."""

import re
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE

ROOT = Path(__file__).parents[2]


def test_generated_pages_are_up_to_date():
    done = subprocess.run(
        [sys.executable, ROOT / "docs" / "make_pages.py", "--check"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_a_page_of_figures_is_stale_once_a_figure_or_a_word_has_changed(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    same_figures = runpy.run_path(str(ROOT / "docs" / "make_pages.py"))["same_figures"]
    for shown, now, same in (
        ("off by 0.55 (12 %)", "off by 0.55 (12 %)", True),
        ("off by 0.55 (12 %)", "off by 0.56 (12 %)", True),
        ("off by 0.55 (12 %)", "off by 0.57 (12 %)", False),
        ("| 1.2e+02 |", "| 1.5e+02 |", False),
        ("| yes | rounding |", "| no | 0.2 |", False),
        ("**holds**", "**holds partly**", False),
    ):
        assert same_figures(shown, now) == same, (shown, now)


def test_every_variable_is_in_the_documentation():
    page = (ROOT / "docs" / "variables.md").read_text()
    assert all(
        f"| `{variable.name}` |" in page for variable in (*INERTIA_MODULE.variables, *DRIVEN_SHAFT.variables)
    )


def test_page_on_development_tells_the_floors_that_are_enforced():
    (contract, *_) = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    enforced = [re.findall(r"inertia_module\.(\w+)", layer) for layer in contract["layers"]]
    enforced = [floor for floor in enforced if floor]
    page = (ROOT / "docs" / "development.md").read_text()
    table = page[page.index("| floor | what |") : page.index("Floors only import downwards")]
    told = [re.findall(r"`(\w+)`", line.split("|")[1]) for line in table.strip().splitlines()[2:]]
    assert told == enforced


def test_links_of_the_readme_lead_somewhere():
    links = re.findall(r"\]\((?!http)([^)#]+)\)", (ROOT / "README.md").read_text())
    assert len(links) > 5
    assert all((ROOT / link).exists() for link in links)


def test_python_of_the_readme_runs(built, tmp_path, monkeypatch, capsys):
    (tmp_path / "build").symlink_to(built)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {})
    assert "energy residual" in capsys.readouterr().out
