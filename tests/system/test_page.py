"""The page as a reader uses it: clock, settings, curves, link, sentences, keys."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from inertia_module.scene import read_scene
from tests.system.chromium import DESK, FONTS, PHONE, REFERENCE, ROOT, Opened, set_font

LEGEND = "[...document.querySelectorAll('.panel:first-child .legend output')].map(cell => cell.textContent)"
POSITIONS = ("imbalance_x", "imbalance_y", "imbalance_z")
SCENES = "[...document.querySelectorAll('select[aria-label=Scene] option')].map(one => one.value)"
SENTENCE = "#sentence"


def set_field(page, name, text):
    field = page.page.locator(f"#set-{name}")
    field.fill(text)
    field.press("Enter")


def scrub(page, place):
    """Move the slider of the time, which has 10,000 places."""
    page.page.get_by_role("slider", name="time", exact=True).fill(place)
    return page.drawn()


def test_clock_runs_when_it_is_played_alone(page, opened):
    assert (page.state("playing"), page.state("time")) == (False, 0)
    page.press("Play")
    page.page.wait_for_function("inertiaModule.state().time > 0.005")
    page.press("Pause")
    stopped = page.state("time")
    page.page.wait_for_timeout(200)
    assert page.state("time") == stopped
    assert page.errors == []
    # and by itself where motion is wanted
    moving = opened(REFERENCE, reduced_motion="no-preference")
    moving.page.wait_for_function("inertiaModule.state().playing && inertiaModule.state().time > 0")


def test_slider_changes_the_run_to_what_simulate_gives(page):
    before = page.shown("omega_out")
    slider = page.page.get_by_role("slider", name="imbalance mass, kg")
    slider.focus()
    for _ in range(20):
        slider.press("ArrowRight")
    mass = float(page.page.locator("#set-imbalance_mass").input_value())
    assert mass > 1.0
    page.page.wait_for_function(
        "mass => inertiaModule.state().run.parameters.imbalance_mass === mass", arg=mass
    )
    page.settled()
    start = page.page.evaluate("inertiaModule.start.scene")
    expected = page.simulate(
        {
            "parameters": start["parameters"] | {"imbalance_mass": mass},
            "inputs": start["inputs"],
            "step": start["step"],
            "steps": round(start["duration"] / start["step"]),
            "outputs": ["omega_out", "energy_in"],
        }
    )
    for name in ("omega_out", "energy_in"):
        assert page.shown(name).tolist() == expected[name]
    assert np.abs(page.shown("omega_out") - before).max() > 0.5


def test_every_scene_of_the_page_is_accepted(page):
    names = page.page.evaluate(SCENES)
    assert len(names) >= 8
    for name in names:
        page.page.get_by_label("Scene", exact=True).select_option(name)
        page.page.wait_for_function("name => inertiaModule.state().settings.scene === name", arg=name)
        page.settled()
        assert page.state("refusal") == ""
        assert np.isfinite(page.shown("omega_out")).all()
    assert page.errors == []


def test_imbalance_is_drawn_where_the_kernel_has_it(page):
    """The picture is built of turned groups, its arrows by the page's own formulas."""
    askew = "reference&satellites=2&epsilon=0.4&gamma=-0.7&shaft_angle=1.2"
    for scene in (askew, "planar", "real-bevel", "elastic"):
        page.at(f"#scene={scene}")
        time, columns = page.shown("time"), np.array([page.shown(name) for name in POSITIONS])
        for row in (1, len(time) // 3, len(time) - 1):
            follow = page.state("settings.shown.follow")
            page.page.keyboard.press("f")  # now from the housing, now from link 1
            assert page.settled().state("settings.shown.follow") != follow
            page.page.evaluate("time => inertiaModule.seek(time)", time[row])
            found = page.drawn().state("imbalance")
            assert found["drawn"] == pytest.approx(columns[:, row], abs=1e-6)
            assert found["arrow"] == pytest.approx(columns[:, row], abs=1e-9)


def test_clock_curves_and_switches_agree(page):
    time = scrub(page, "4321").state("time")
    assert time == pytest.approx(0.4321, rel=1e-3)
    row = np.searchsorted(page.shown("time"), time, side="right") - 1
    values = [page.shown(name)[row] for name in ("input_speed", "omega2", "omega_out")]
    told = [float(text.replace("−", "-").split()[0]) for text in page.page.evaluate(LEGEND)]
    assert told == pytest.approx(values, abs=0.01)
    # the cursor of the curves stands there, and a press on them goes there
    curves = page.page.locator(".panel:first-child .u-over")
    over = curves.bounding_box()
    mark = page.page.locator(".panel:first-child .mark").bounding_box()
    assert mark["x"] + mark["width"] / 2 - over["x"] == pytest.approx(time * over["width"], abs=2)
    curves.click(position={"x": 0.75 * over["width"], "y": 20})
    assert page.state("time") == pytest.approx(0.75, abs=0.01)
    # steps go from switch to switch, and a pulse is repeated
    scrub(page, "0")
    switches = page.shown("time")[1:][np.diff(page.shown("contact_mode")) != 0]
    for expected in switches[:3]:
        page.press("On to the next switch of a freewheel")
        assert page.state("time") == pytest.approx(expected, abs=1e-9)
    page.press("Back to the last switch of a freewheel")
    assert page.state("time") == pytest.approx(switches[1], abs=1e-9)
    scrub(page, "5000")
    page.page.get_by_role("button", name="one pulse").click()
    begin, end = page.state("loop")
    assert begin <= 0.5 < end
    assert 2 <= ((switches > begin - 1e-9) & (switches <= end + 1e-9)).sum() <= 6


def test_link_restores_the_state_and_names_what_it_says_wrongly(page):
    set_field(page, "load_torque", "4.5")
    page.settled()  # places of the slider are shares of the run as far as it is
    page.page.get_by_label("cut-away").uncheck()
    page.page.get_by_label("Path of the imbalance").select_option("fixed")
    scrub(page, "2500")
    page.page.wait_for_function(
        "location.hash.includes('t=0.25') && location.hash.includes('load_torque=4.5')"
    )
    link, output = page.page.evaluate("location.hash"), page.shown("omega_out")
    page.at(link)
    assert page.state("time") == pytest.approx(0.25)
    assert page.page.locator("#set-load_torque").input_value() == "4.5"
    assert not page.page.get_by_label("cut-away").is_checked()
    assert page.page.get_by_label("Path of the imbalance").input_value() == "fixed"
    assert (page.shown("omega_out") == output).all()
    assert page.state("hash") == link
    page.at("#load_torque=much&colour=red&omega1=90")
    assert page.page.locator(SENTENCE).inner_text() == (
        "not understood in the address: load_torque=much, colour=red"
    )
    assert page.shown("input_speed")[-1] == 90.0


def test_bad_value_shows_a_sentence_and_keeps_the_last_good_run(page):
    good = page.shown("omega_out")
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    for name, text, sentence in (
        ("imbalance_mass", "-3", "imbalance_mass must be between 0 and 1000000000 kg, is -3"),
        ("tolerance", "7", "tolerance must be between 1e-13 and 0.1, is 7"),
        ("duration", "-1", "a run must have between 1 and 60000 steps: duration is -1 s, step is 0.0005 s"),
    ):
        set_field(page, name, text)
        page.page.wait_for_function(f"document.querySelector('{SENTENCE}').textContent !== ''")
        assert page.page.locator(SENTENCE).inner_text() == sentence
        assert (page.shown("omega_out") == good).all()
        page.press("Reset")
        page.page.wait_for_function(f"document.querySelector('{SENTENCE}').textContent === ''")
    assert page.errors == []


def test_keyboard_works(page):
    keys = page.page.keyboard
    time = page.shown("time")
    keys.press("ArrowRight")
    keys.press("ArrowRight")
    assert page.state("time") == time[2]
    keys.press("ArrowLeft")
    assert page.state("time") == time[1]
    keys.press("End")
    assert page.state("time") == time[-1]
    keys.press("Home")
    keys.press(".")
    assert 0 < page.state("time") < 0.1
    keys.press("f")
    assert page.state("settings.shown.follow")
    # a box that is ticked keeps the focus
    box = page.page.get_by_label("torques", exact=True)
    box.focus()
    keys.press(" ")
    assert page.state("settings.shown.torques")
    assert box.evaluate("box => box === document.activeElement")
    page.page.locator("canvas").first.focus()
    speed = page.state("speed")
    keys.press("-")
    assert page.state("speed") == speed / 2
    keys.press(" ")
    assert page.state("playing")
    # a field keeps its keys
    page.page.locator("#set-omega1").focus()
    keys.press(" ")
    assert page.state("playing")


def test_files_of_the_run_and_the_scene(page, tmp_path):
    set_field(page, "load_torque", "4.5")
    page.page.get_by_label("layout", exact=True).select_option("planar")
    page.settled()
    with page.page.expect_download() as table:
        page.page.get_by_role("button", name="CSV").click()
    with page.page.expect_download() as scene:
        page.page.get_by_role("button", name="TOML").click()
    heading, *rows = Path(table.value.path()).read_text().splitlines()
    assert heading.startswith("time [s],omega2 [rad/s],omega_out [rad/s]")
    assert len(rows) == 2001
    assert [float(row.split(",")[2]) for row in rows] == page.shown("omega_out").tolist()
    text = Path(scene.value.path()).read_text()
    read = read_scene(text, tmp_path)
    assert tomllib.loads(text)["mechanism"] == {"layout": "planar"}
    assert (read.load.torque, read.run.stop_time, read.accuracy.tolerance) == (4.5, 1.0, 1e-9)


def test_converter_chart_is_that_of_the_package(page):
    """Stall torque and efficiency of scene R1 without losses, and the point of the run."""
    page.page.get_by_label("Phase plot or converter chart").select_option("chart")
    ready = "document.querySelector('.note:not([hidden])').textContent.startsWith('Steady pulses')"
    page.page.wait_for_function(ready)
    points = page.state("chart")
    assert [point["ratio"] for point in points] == pytest.approx(np.arange(25) / 25)
    assert [point["efficiency"] for point in points[1:15]] == pytest.approx([100.0] * 14, abs=0.1)
    torques = [point["output"] for point in points]
    assert torques == sorted(torques[:12], reverse=True) + torques[12:]
    # what goes in comes out, for nothing is lost
    for point in points[1:15]:
        assert point["input"] == pytest.approx(point["ratio"] * point["output"], abs=0.02 * torques[0])


# --- on a phone and a desk, in light and dark, for a screen reader; and how quick it is ---

AXE = ROOT / "page" / "node_modules" / "axe-core" / "axe.min.js"
# boxes narrower than what is in them, all settings unfolded
TOO_NARROW = """() => {
  document.querySelectorAll('details').forEach(group => { group.open = true; });
  return [...document.querySelectorAll('body *:not(svg *)')].filter(
    box => getComputedStyle(box).display !== 'inline' && box.scrollWidth > box.clientWidth + 1
  ).map(box => `${box.tagName} ${box.className}: ${box.textContent.slice(0, 60)}`);
}"""
PAPER = "getComputedStyle(document.body).backgroundColor"


@pytest.fixture(params=[PHONE, DESK], ids=["phone", "desk"])
def sized(still, request):
    """The page of scene R1 at rest, loaded at a size."""
    still.page.set_viewport_size(request.param)
    return still.at("")


def test_nothing_hangs_over_in_any_font_and_the_theme_can_be_switched(sized):
    before = sized.page.evaluate(PAPER)
    sized.press("Light or dark")
    assert sized.page.evaluate(PAPER) != before
    for font in FONTS:
        set_font(sized.page, font)
        sized.drawn()
        width = sized.page.viewport_size["width"]
        assert sized.page.evaluate("document.documentElement.scrollWidth") <= width, font
        assert sized.page.evaluate(TOO_NARROW) == [], font


def test_axe_finds_no_serious_fault(sized):
    if not AXE.exists():
        pytest.skip("axe-core is not installed: `make page` installs it")
    sized.page.evaluate(AXE.read_text())
    for scheme in ("light", "dark"):
        sized.page.emulate_media(color_scheme=scheme)
        sized.drawn()
        serious = [
            (fault["id"], node["target"], node["failureSummary"])
            for fault in sized.page.evaluate("axe.run()")["violations"]
            if fault["impact"] in ("serious", "critical")
            for node in fault["nodes"]
        ]
        assert serious == [], scheme


def test_first_picture_and_frames_are_quick(browser, written):
    """In time of the processor, for others may be at work on this machine."""
    with browser.new_page(viewport=DESK, reduced_motion="no-preference") as page:
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})

        def spent(what):
            metrics = session.send("Performance.getMetrics")["metrics"]
            return next(metric["value"] for metric in metrics if metric["name"] == what)

        opened = Opened(page, written(REFERENCE)).settled()
        assert spent("TaskDuration") < 1.5
        page.wait_for_timeout(2000)
        before = spent("ScriptDuration")
        page.evaluate("window.drawn = 0; (function count() { drawn++; requestAnimationFrame(count); })()")
        page.wait_for_function("drawn > 20")
        frame = (spent("ScriptDuration") - before) / page.evaluate("drawn")
        assert 0 < frame < 8e-3
        assert opened.state("playing")
