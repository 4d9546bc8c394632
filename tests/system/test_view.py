"""The command view, and run --view: a page whole or not at all, bad places refused before the run."""

import base64
import json
import re
import zlib
from pathlib import Path

import numpy as np
import pytest

from inertia_module.harness.results import Result
from inertia_module.page import html
from tests.system.programs import command, left

EXAMPLES = Path("examples").absolute()
REFERENCE, ENGINE = (EXAMPLES / f"{name}.toml" for name in ("reference", "engine"))
# the load follows the motion, and the drive turns about once from point to point
COARSE = """
[drive]
kind = "constant"
omega1 = 100.0
[load]
kind = "shaft"
inertia = 1e4
[run]
stop_time = "6 s"
communication_step = "60 ms"
outputs = ["mesh_torque", "mesh_torque_mean"]
"""
MOST_BYTES = 2_500_000
PLAYED = """async () => {
  const { start, playable } = window.inertiaModule;
  const { time, columns } = await playable(start.run, start.scene.parameters);
  return { time: [...time], omega_out: [...columns.omega_out], q: [...columns.q] };
}"""


def check_page(page):
    """It opens from disk, asks for nothing and is no larger than a page may be."""
    page.page.wait_for_timeout(500)
    assert (page.errors, page.requests) == ([], [])
    assert page.path.stat().st_size < MOST_BYTES


def table_of(scene, fmu, folder):
    """What a scene is run to."""
    left("run", scene, "-o", folder, "--fmu", fmu)
    return Result.from_csv(folder / "table.csv")


def test_run_is_played_as_it_was_recorded(opened, fmu, tmp_path):
    """The load of this scene follows the motion: the page cannot run it, so it holds the run."""
    page, table = opened(ENGINE), table_of(ENGINE, fmu, tmp_path)
    check_page(page)
    start, played = page.page.evaluate("window.inertiaModule.start"), page.page.evaluate(PLAYED)
    every = start["run"]["every"]
    assert not start["scene"]["exact"]
    assert start["scene"]["inputs"]["load_torque"] == pytest.approx(table["load_torque"].mean(), rel=1e-3)
    assert start["scene"]["inputs"]["drive_torque"]["values"] == [0.0, 40.0, 25.0, 15.0]
    assert played["time"] == pytest.approx(table.time[::every], abs=1e-9)
    assert played["omega_out"] == pytest.approx(table["omega_out"][::every], rel=1e-7)
    assert np.diff(played["q"]).max() < 0.4 * every  # no whole turn is lost between rows


def test_a_run_too_coarse_for_its_pulses_shows_means_and_dots_in_place_of_curves(opened, fmu, tmp_path):
    scene = tmp_path / "coarse.toml"
    scene.write_text(COARSE)
    page = opened(scene, reduced_motion="reduce")
    mean = table_of(scene, fmu, tmp_path)["mesh_torque_mean"][50]
    page.page.get_by_role("slider", name="time", exact=True).fill("5000")
    page.drawn()
    speeds, torques = (panel.inner_text() for panel in page.page.locator(".panel .legend").all())
    table = page.page.locator(".instruments").first.inner_text()
    assert "ω2 link 2, at instants" in speeds
    (told,) = re.findall(r"M2 mesh, mean\s+(\S+)\s+N·m", torques)
    (now,) = re.findall(r"torques: mean of a step.*mesh torque, M2\s+(\S+)", table, re.S)
    assert told == now
    assert float(now.replace("−", "-")) == pytest.approx(mean, abs=0.01)
    page.page.get_by_label("Scene", exact=True).select_option("reference")
    page.settled()
    assert "mean" not in page.page.locator(".panel .legend").nth(1).inner_text()


def test_a_row_of_a_long_run_has_the_means_and_peaks_of_those_left_out(monkeypatch):
    columns = {"time": np.arange(8.0), "torque_mean": np.arange(8.0), "force_peak": -np.arange(8.0)}
    record = Result(columns, {})
    monkeypatch.setattr(html, "MOST", 6)
    found = html.page_run(record)
    assert found["step"] == 3.0
    packed = zlib.decompress(base64.b64decode(found["numbers"]), -zlib.MAX_WBITS)
    torque, force = np.frombuffer(packed, "<f4").reshape(2, -1)
    assert (found["every"], found["rows"]) == (3, 3)
    assert torque.tolist() == [0.0, 2.0, 5.0]
    assert force.tolist() == [0.0, -1.0, -4.0]


def test_run_leaves_the_page_beside_its_table(fmu, tmp_path):
    told = left("run", REFERENCE, "--view", "--json", "--fmu", fmu, "-o", tmp_path)
    assert json.loads(told)["files"]["page"] == str(tmp_path / "page.html")
    assert "drive_turns" not in Result.from_csv(tmp_path / "table.csv")
    assert (tmp_path / "page.html").stat().st_size < MOST_BYTES


def test_page_that_cannot_be_made_is_refused_before_the_run(tmp_path, monkeypatch):
    def refused(*arguments):
        done = command(*arguments)
        assert done.exit_code == 1
        return done.stderr

    shaft = EXAMPLES / "papers" / "stelmashchuk_stepping.toml"
    page = tmp_path / "page.html"
    told = "--view must come with a scene of the module"
    assert told in refused("run", shaft, "--view", "-o", tmp_path)
    assert "must be a scene of the module, is one of a driven shaft" in refused("view", shaft, "-o", page)
    monkeypatch.setattr(html, "TEMPLATE", tmp_path / "template.html")
    told = "the page has not been built yet: `make page` in a clone builds it, and the wheel has it"
    for arguments in (("view", REFERENCE), ("run", REFERENCE, "--view")):
        assert refused(*arguments, "-o", page) == f"error: {told}\n"
    assert list(tmp_path.iterdir()) == []


def test_place_that_cannot_be_written_is_refused_before_the_run(tmp_path, monkeypatch):
    def worked(*_, **__):
        raise AssertionError("the work was begun, and what it gives would be lost")

    monkeypatch.setattr("inertia_module.scene.run_scene", worked)
    (tmp_path / "folder.html").mkdir()
    (tmp_path / "file").write_text("a file")
    places = {
        "folder.html": "the page must be a file, is the folder ",
        "page.txt": "the page must be a file with the ending .html, is ",
        "file/page.html": "file must be a folder that can be written to",
    }
    for place, sentence in places.items():
        done = command("view", ENGINE, "-o", tmp_path / place)
        assert done.exit_code == 1
        assert sentence in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.html"]


def test_page_is_whole_or_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("the disk is full")))
    done = command("view", REFERENCE, "-o", tmp_path / "page.html")
    assert (done.exit_code, done.stderr) == (1, "error: the disk is full\n")
    assert list(tmp_path.iterdir()) == []


def test_text_of_a_scene_cannot_break_out_of_the_page(opened, tmp_path):
    title = "</script><script>window.broken = 1</script><!-- & <b>"
    scene = tmp_path / "hostile.toml"
    scene.write_text(f'title = "{title}"\n' + REFERENCE.read_text().split("\n", 1)[1])
    page = opened(scene)
    check_page(page)
    assert page.page.title() == title
    assert page.page.evaluate("[window.inertiaModule.start.scene.title, window.broken]") == [title, None]
