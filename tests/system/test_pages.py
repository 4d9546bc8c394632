"""Generated pages, the README, programs of docs/tools.md in each host, and the tutorial."""

import re
import runpy
import shutil
import tomllib
from pathlib import Path

import pytest
from fmpy import simulate_fmu

from tests.system.programs import needs, printed, process, programs

ROOT = Path(__file__).parents[2]


def test_generated_pages_are_up_to_date():
    process(ROOT / "docs" / "make_pages.py", "--check")


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


def prints_its_residual(names, printed):
    assert "energy residual" in printed


def holds_the_speed(names, printed):
    assert names["run"].outputs[0][-50:] == pytest.approx([20.0] * 50, abs=1.0)


def loses_at_most(defect):
    def check(names, printed):
        speed, _, lost = map(float, printed.split())
        assert speed == pytest.approx(200.0, rel=0.2)
        assert abs(lost) < defect

    return check


@pytest.mark.parametrize(
    "page, checks",
    [
        ("../README.md", [prints_its_residual]),
        ("control.md", [holds_the_speed]),
        ("coupling.md", [loses_at_most(1e-8), loses_at_most(10.0)]),
    ],
)
def test_python_of_a_page_runs(page, checks, built, tmp_path, monkeypatch, capsys):
    (tmp_path / "build").symlink_to(built)
    monkeypatch.chdir(tmp_path)
    for code, check in zip(programs(page), checks, strict=True):
        names = {}
        exec(compile(code, page, "exec"), names)
        check(names, capsys.readouterr().out)


# --- what a reader runs ---


PROGRAMS = programs("tools.md")
PACKAGES = [re.search(r"^from (\w+)", program)[1] for program in PROGRAMS]
# tolerance that a host gives where the parameter has another
TOLERANCE = {"OMSimulator": 1e-4}


def test_every_host_of_the_page_has_a_program():
    assert sorted(PACKAGES) == ["OMSimulator", "ecospy", "fmpy", "fmpy", "libcosimpy"]


@pytest.mark.parametrize("number", range(len(PROGRAMS)), ids=PACKAGES)
def test_program_of_the_page_runs_the_module(number, built, tmp_path):
    package = PACKAGES[number]
    needs(package)
    for name in ("InertiaModule.fmu", "InertiaModule3.fmu"):
        shutil.copy(built / name, tmp_path)
    expected = simulate_fmu(
        str(built / "InertiaModule.fmu"),
        stop_time=1.0,
        output_interval=1e-3,
        relative_tolerance=TOLERANCE.get(package),
        start_values={"output_inertia": 0.4},
        output=["omega_out"],
    )
    (found,) = printed(PROGRAMS[number], tmp_path)
    # stopped at its switches a step integrates otherwise
    within = 1e-7 if "use_event_mode" in PROGRAMS[number] else 1e-9
    assert found == pytest.approx(expected["omega_out"][-1], rel=within)


def test_tutorial_shows_pictures_and_tables(built, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    client = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("pymoo", reason="pymoo is not installed")
    (tmp_path / "build").symlink_to(built, target_is_directory=True)
    notebook = nbformat.read(Path("examples/tutorial.ipynb"), as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "it is kept without outputs"
    client.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    shown = [output["data"] for output in outputs if "data" in output]
    assert sum("image/png" in data for data in shown) >= 5
    assert "<table>" in shown[0]["text/html"]
    assert "omega_out [rad/s]" in shown[1]["text/html"]
    # it launches the car and finds the values of the rig
    text = "".join(output.get("text", "") for output in outputs)
    light, heavy = (float(speed) for speed in re.findall(r"kg: ([\d.]+) rad/s", text))
    assert heavy > light
    assert float(re.search(r"25 km/h after ([\d.]+) s", text)[1]) < 20.0
    low, high = (float(n) for n in re.search(r"imbalance_mass = \S+ from (\S+) to (\S+)", text).groups())
    assert low < 1.07 < high
