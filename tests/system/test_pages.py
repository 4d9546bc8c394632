"""Pages, the README, programs of docs/tools.md in each host, the tutorial, the study scripts."""

import re
import runpy
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu

from tests.system.programs import needs, printed, programs

ROOT = Path(__file__).parents[2]


def test_a_page_of_figures_is_stale_once_a_figure_or_a_word_has_changed(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    same_figures = runpy.run_path(str(ROOT / "docs" / "make_pages.py"))["same_figures"]
    for page, now, same in (
        ("off by 0.55 (12 %)", "off by 0.55 (12 %)", True),
        ("off by 0.55 (12 %)", "off by 0.56 (12 %)", True),
        ("off by 0.55 (12 %)", "off by 0.57 (12 %)", False),
        ("| 1.2e+02 |", "| 1.5e+02 |", False),
        ("| yes | rounding |", "| no | 0.2 |", False),
        ("**holds**", "**holds partly**", False),
    ):
        assert same_figures(page, now) == same, (page, now)


def test_links_of_the_readme_lead_somewhere():
    links = re.findall(r"\]\((?!http)([^)#]+)\)", (ROOT / "README.md").read_text())
    assert len(links) > 5
    assert all((ROOT / link).exists() for link in links)


def prints_its_residual(names, printed):
    assert "energy residual" in printed


def holds_the_speed(names, printed):
    assert names["run"].outputs[0][-50:] == pytest.approx([20.0] * 50, abs=1.0)


def drives_the_shaft(names, printed):
    speed, twist = map(float, printed.split())
    assert speed == pytest.approx(17.0, abs=1.0)  # in one piece 16.77
    assert abs(twist) < 0.1


def holds_the_engine(names, printed):
    speed, driven = map(float, printed.split())
    assert speed == pytest.approx(200.0, rel=0.2)
    assert 10.0 < driven < speed


@pytest.mark.parametrize(
    "page, checks",
    [
        ("../README.md", [prints_its_residual]),
        ("control.md", [holds_the_speed]),
        ("coupling.md", [holds_the_engine]),
        ("systems.md", [drives_the_shaft]),  # test_export.py tests its other programs
    ],
)
def test_python_of_a_page_runs(page, checks, built, tmp_path, monkeypatch, capsys):
    (tmp_path / "build").symlink_to(built)
    monkeypatch.chdir(tmp_path)
    for code, check in zip(programs(page), checks, strict=page != "systems.md"):
        names = {}
        exec(compile(code, page, "exec"), names)
        check(names, capsys.readouterr().out)


# --- programs of the pages ---


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
    (value,) = printed(PROGRAMS[number], tmp_path)
    # stopped at its switches a step integrates otherwise
    within = 1e-7 if "use_event_mode" in PROGRAMS[number] else 1e-9
    assert value == pytest.approx(expected["omega_out"][-1], rel=within)


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
    displayed = [output["data"] for output in outputs if "data" in output]
    assert sum("image/png" in data for data in displayed) >= 5
    assert "<table>" in displayed[0]["text/html"]
    assert "omega_out [rad/s]" in displayed[1]["text/html"]
    # it launches the car and finds the values of the rig
    text = "".join(output.get("text", "") for output in outputs)
    light, heavy = (float(speed) for speed in re.findall(r"kg: ([\d.]+) rad/s", text))
    assert heavy > light
    assert float(re.search(r"25 km/h after ([\d.]+) s", text)[1]) < 20.0
    low, high = (float(n) for n in re.search(r"imbalance_mass = \S+ from (\S+) to (\S+)", text).groups())
    assert low < 1.07 < high


# --- study scripts: statements about the mechanism ---


STUDIES = Path(__file__).parents[2] / "examples" / "studies"


@pytest.fixture(scope="module", autouse=True)
def scripts():
    """The scripts import each other as a reader runs them: from their own folder."""
    sys.path.insert(0, str(STUDIES))
    yield
    sys.path.remove(str(STUDIES))


def test_launch_stall_torque_is_quadratic_and_averaged_times_agree_with_rigid(fmu):
    import launch

    rows, _ = launch.study(fmu)
    over_square = [torque / omega1**2 for omega1, torque, *_ in rows]
    assert np.ptp(over_square) < 0.03 * over_square[0]
    _, _, rigid_half, rigid_most, half, most = rows[-1]
    assert half == pytest.approx(rigid_half, rel=0.01)
    assert most == pytest.approx(rigid_most, rel=0.02)


def test_load_step_lock_up_transmits_more_than_stall_torque_and_the_shaft_restarts(fmu):
    import load_step

    rows, _ = load_step.study(fmu)
    speeds = np.array([row[1] for row in rows]) / load_step.OMEGA1
    stall = rows[0][0] / load_step.STALL_SHARES[0]
    assert rows[2][0] > 1.2 * stall
    assert speeds[:3] == pytest.approx(1.0, abs=2e-3)
    assert speeds[3] == pytest.approx(0.0, abs=1e-3)
    assert 0.1 < speeds[4] < 0.9
    assert speeds[5] == pytest.approx(1.0, abs=2e-3)


def test_overrunning_shaft_coasts_on_its_load_alone_and_is_caught_again(fmu):
    import overrun

    tables = overrun.study(fmu)
    slowed, free, again = overrun.phases(tables[True])
    assert slowed == pytest.approx(free, rel=1e-6)
    assert 0.0 < again < 1.0
    during = (tables[True].time > overrun.TIMES[2]) & (tables[True].time < overrun.TIMES[3])
    assert np.abs(tables[True]["output_torque_mean"][during]).max() == 0.0
    # one with link 2 the shaft is dragged down
    assert tables[False]["omega_out"][during].min() < 0.5 * tables[True]["omega_out"][during].min()


def test_hoist_holds_its_load_without_a_brake_and_cannot_without_the_freewheel_of_link_2(fmu):
    import hoist

    rows, _ = hoist.study(fmu)
    for _, _, lifted, sunk, _ in rows:
        assert lifted > 0.0
        assert sunk == pytest.approx(0.0, abs=1e-9)
    speeds = [row[4] for row in rows]
    assert speeds == sorted(speeds, reverse=True)
    assert hoist.run(rows[1][0], False, fmu, stop=1.0)["height"][-1] < -0.1


def test_car_with_noise_stays_within_the_tolerances_of_the_cycle(fmu):
    import noisy_cycle

    table = noisy_cycle.run(*noisy_cycle.CASES["both"], fmu)
    error, outside, _, residual = noisy_cycle.judge(table)
    assert 0.3 < error < 0.6
    assert outside < 0.001
    assert residual < 1e-6
    assert np.std(np.diff(table["measured_speed"])) > 0.01
