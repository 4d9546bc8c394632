"""Test reports of scenes: a single file with all results, and reasons for omitted parts."""

import json
import math
from xml.etree import ElementTree

import numpy as np
import pytest
from scenes import MECHANISMS

from inertia_module.kernel import layout
from inertia_module.model import Module
from inertia_module.plots.mechanism import mechanism_figure
from inertia_module.report import html_report as report
from inertia_module.report.html_report import RECORDED
from inertia_module.scene import Scene, load_any_scene, run_scene, run_shaft_scene
from inertia_module.scene.keys import keys_from_options
from tests.system.chromium import FONTS, REFERENCE, set_font
from tests.system.programs import stdout_of

EXAMPLES = REFERENCE.parent
SHAFT = EXAMPLES / "papers" / "stelmashchuk_stepping.toml"
# Overlapping satellites and an imbalance outside its satellite. The constant input causes a remark.
CROWDED = ("satellites=6", "a=1.5", "mesh_efficiency=98 %", "run.stop_time=0.1 s")
STALLED = ("load.torque=500 N.m", "run.stop_time=0.2 s", "omega_out_start=0")
SECTIONS = [
    *("Checks", "Inputs", "Mechanism", "Results", "Energy and losses", "Freewheel duty"),
    *("Curves", "Torque converter chart", "Orders"),
]
# Computing times differ between runs.
TIMES = {"wall-clock time", "real time factor"}


@pytest.fixture
def reported(built, tmp_path):
    """Return a function that writes the report of a scene with keys, and returns its HTML and its result."""

    def reported(scene, *keys):
        shaft = "[shaft]" in scene.read_text(encoding="utf-8")
        fmu, path = built / f"{'DrivenShaft' if shaft else 'InertiaModule'}.fmu", tmp_path / "report.html"
        printed = stdout_of(
            "report", scene, *(f"--set={key}" for key in keys), "--fmu", fmu, "--json", "-o", path
        )
        assert json.loads(printed)["bytes"] == path.stat().st_size
        read = load_any_scene(scene, keys_from_options(keys))
        module = isinstance(read, Scene)
        return ElementTree.parse(path).getroot(), (
            run_scene(read, fmu, also=RECORDED) if module else run_shaft_scene(read, fmu)
        )

    return reported


@pytest.fixture
def undrawn(monkeypatch):
    """Replace the figures of reports, because each takes half a second."""
    monkeypatch.setattr(report, "picture_of", lambda *_: b"")


def sections(root):
    """Return the sections by title."""
    return {section.find("h2").text: section for section in root.iter("section")}


def texts(section):
    return [paragraph.text for paragraph in section.findall("p")]


def checks(root, kind):
    """Texts of the checks on the first page that are "met" or "unmet"."""
    return [line.find("b").tail for line in root.iter("li") if line.get("class") == kind]


def rows(section):
    """Return the cells of all table rows of a section."""
    return [[cell.text or "" for cell in row.findall("td")] for row in section.iter("tr")]


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("scene, keys", [(REFERENCE, CROWDED), (REFERENCE, STALLED), (SHAFT, ())])
def test_report_has_every_section_every_warning_and_the_numbers_of_the_summary(reported, scene, keys):
    root, result = reported(scene, *keys)
    by_title = sections(root)
    titles = list(by_title)
    assert titles[: len(SECTIONS)] == SECTIONS
    assert {title.partition(": ")[0] for title in titles[len(SECTIONS) : -1]} == {"Parameters"}
    assert titles[-1] == "How to reproduce this report"
    assert (root.find("head/title").text, root.find(".//h1").text) == (result.scene.title,) * 2
    cells = [cell for row in rows(by_title["Results"]) for cell in row]
    numbers = dict(zip(cells[::2], cells[1::2], strict=True))
    expected = result.lines()
    assert {name for name in numbers if name} == set(expected)
    assert {name: numbers[name] for name in expected if name not in TIMES} == {
        name: text for name, text in expected.items() if name not in TIMES
    }
    warnings = checks(root, "unmet")
    assert (
        len(warnings) == len(result.warnings) + len(result.remarks) == {CROWDED: 2, STALLED: 1, (): 0}[keys]
    )
    # the numbers are in the units of the scene, with fewer digits
    starts = [text.partition(":")[0].partition(" (")[0] for text in result.warnings]
    assert all(any(line.startswith(start) for line in warnings) for start in starts)
    numbers = root.find(".//dl[@class='numbers']")
    assert len(numbers.findall("div")) == 5
    assert all(number.find("dd").text for number in numbers)
    assert by_title["How to reproduce this report"].find("pre").text == scene.read_text(encoding="utf-8")


def test_report_needs_no_network_and_escapes_the_title(reported, tmp_path):
    title = '</title></h1><script>alert(1)</script><!-- & <b> \\"x'
    scene = tmp_path / "hostile.toml"
    scene.write_text(f'title = "{title}"\n' + REFERENCE.read_text().split("\n", 1)[1])
    root, _ = reported(scene)
    assert root.find("head/title").text == root.find(".//h1").text == title.replace("\\", "")
    assert {element.tag for element in root.iter()}.isdisjoint({"script", "a", "link", "iframe", "object"})
    links = [
        element.get(name) for element in root.iter() for name in ("src", "href", "style") if element.get(name)
    ]
    assert len(links) == 5
    assert all(link.startswith("data:image/") for link in links)
    assert "url(" not in root.find("head/style").text


@pytest.mark.usefixtures("undrawn")
def test_parameters_have_their_source(reported, tmp_path):
    (tmp_path / "speed.csv").write_text("time,omega1 [rpm]\n0,900\n1,900\n")
    scene = tmp_path / "scene.toml"
    text = (EXAMPLES / "planar.toml").read_text().replace('kind = "constant"\nomega1 = "120 rad/s"', "")
    text = text.replace("[drive]", '[drive]\nkind = "table"\nfile = "speed.csv"')
    scene.write_text(text.replace('kind = "torque"', 'kind = "shaft"\ninertia = 2.0'))
    root, result = reported(scene, "imbalance_mass=900 g", "run.stop_time=0.1 s")
    by_title = sections(root)
    inputs = {key: (value, source) for key, value, source in rows(by_title["Inputs"])[1:]}
    assert inputs["drive.omega1"] == ("94.2478 rad/s, 94.2478 rad/s", "scene file: speed.csv")
    assert inputs["run.stop_time"] == ("0.1 s", "--set")
    assert inputs["accuracy.window"] == ("1 s", "default")
    parameters = {
        name: (value, source)
        for title, section in by_title.items()
        if title.startswith("Parameters: ")
        for name, value, source, _ in rows(section)[1:]
    }
    assert parameters["sun_radius"] == ("0.05 m", "scene file: 50 mm")
    assert parameters["imbalance_mass"] == ("0.9 kg", "--set: 900 g")
    assert parameters["output_inertia"] == ("2.4 kg.m2", "scene file: 0.4 kg.m2")
    assert parameters["tolerance"] == ("1e-09", "scene file")
    assert parameters["layout"] == ("planar", "scene file")
    assert parameters["gravity"] == ("0 m/s2", "default")
    assert "z17" not in parameters
    assert "shaft_stiffness" not in parameters
    assert result.scene.parameters()["output_inertia"] == pytest.approx(2.4)


LEFT_OUT = [
    ((REFERENCE, "output_freewheel=false"), {"Torque converter chart": "output_freewheel must be 1"}),
    (
        (REFERENCE, "fidelity=averaged"),
        {"Orders": "this fidelity level has no pulses", "Freewheel duty": "averaged has no pulses"},
    ),
    (
        (REFERENCE, "drive.omega1=0", "load.torque=0"),
        {"Orders": "does not turn", "Torque converter chart": "does not turn"},
    ),
    ((SHAFT,), dict.fromkeys(("Mechanism", "Torque converter chart", "Orders"), "a driven shaft without")),
]


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("arguments, expected", LEFT_OUT, ids=lambda arguments: "-".join(map(str, arguments)))
def test_missing_sections_have_a_reason(reported, arguments, expected):
    scene, *keys = arguments
    by_title = sections(reported(scene, *keys)[0])
    for title, words in expected.items():
        (text,) = texts(by_title[title])
        assert text.startswith("Not available: ")
        assert words in text
        assert not rows(by_title[title])
        assert by_title[title].find("img") is None


def test_duty_is_shown_with_limits_and_an_exceeded_limit_is_a_warning(reported):
    limits = ("freewheels.indexing_frequency=2 Hz", "freewheels.output.torque=150 N.m")
    root, result = reported(REFERENCE, *limits, "housing_freewheel=false")
    by_title, numbers = sections(root), result.lines()
    duty = rows(by_title["Freewheel duty"])[1:]
    assert [row[1] for row in duty] == ["not present"] * 4
    assert [row[2] for row in duty] == [numbers[f"output {row[0]}"] for row in duty]
    assert duty[1][2].endswith(" Hz, limit 2")
    assert duty[2][2].endswith(" N·m, limit 150")
    (warning,) = checks(root, "unmet")
    assert warning.startswith("output engagement frequency maximum exceeds its limit of 2 Hz: ")
    (met,) = [text for text in checks(root, "met") if "(limit" in text]
    assert met.startswith("output torque peak ")


def test_report_is_as_wide_as_the_paper(browser, reported, tmp_path):
    reported(EXAMPLES / "real_machine.toml", "run.stop_time=0.5 s")
    with browser.new_page(viewport={"width": 680, "height": 1000}) as page:  # 180 mm
        page.emulate_media(media="print")
        page.goto((tmp_path / "report.html").as_uri())
        for font in FONTS:
            set_font(page, font)
            assert page.evaluate("document.documentElement.scrollWidth") <= 680, font
            page.emulate_media(media="screen")
            page.set_viewport_size({"width": 390, "height": 844})  # a phone
            assert page.evaluate("document.documentElement.scrollWidth") <= 390, font
            page.set_viewport_size({"width": 680, "height": 1000})
            page.emulate_media(media="print")
        pages = page.pdf(prefer_css_page_size=True).count(b"/Type /Page\n")
    assert 5 <= pages <= 10


# --- sketch ---


def test_planar_sketch_is_to_scale():
    (along,) = mechanism_figure(MECHANISMS["planar"]).axes
    sun, arm, satellite, path, imbalance = (np.array(line.get_data()) for line in along.lines[:5])
    assert np.hypot(*sun) == pytest.approx(50.0)
    assert arm[:, 1] == pytest.approx([0.0, 80.0])
    assert np.hypot(*(satellite - arm[:, 1:])) == pytest.approx(30.0)
    assert np.hypot(*(path - arm[:, 1:])) == pytest.approx(20.0)
    assert imbalance[:, 0] == pytest.approx([0.0, 60.0])  # The imbalance points towards the sun.
    assert along.get_aspect() == 1.0


def test_bevel_sketch_is_to_scale():
    module = Module("plain")
    module.check(satellites=2)
    section, _ = mechanism_figure({"satellites": 2.0}).axes
    lines = [np.array(line.get_data()) for line in section.lines if len(line.get_xdata()) > 2]
    wheel, _, satellite = lines[:3]
    apex = 80.0 / 1.7  # OQ of scene R1, where c = 1 puts the base of wheel 17 on the central axis.
    assert (wheel[0].min(), wheel[0].max()) == pytest.approx((-80.0, 80.0))
    assert wheel[1] == pytest.approx(0.0, abs=1e-9)
    # The base of the satellite touches the base of the wheel at a right angle.
    assert satellite[0] == pytest.approx(80.0)
    assert (satellite[1].min(), satellite[1].max()) == pytest.approx((0.0, 2.0 * apex))
    path = next(line for line in lines if line.shape[1] > 1000)
    for n in (0, 500):
        x, _, z = layout.imbalance_position(module.derived, n * math.tau * 10 / (181 * 10 - 1), 0.0)[:3]
        assert path[:, n] == pytest.approx([1e3 * x, 1e3 * z])
