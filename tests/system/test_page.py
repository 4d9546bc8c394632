"""The page as a reader uses it: clock, settings, curves, link, sentences, keys, a phone, a screen reader."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from inertia_module.scene import read_scene
from tests.system.chromium import REFERENCE
from tests.system.page_state import DESK, NEXT_FRAME, at, settled, shown, state

LEGEND = "[...document.querySelectorAll('.panel:first-child .legend output')].map(cell => cell.textContent)"
POSITIONS = ("imbalance_x", "imbalance_y", "imbalance_z")


@pytest.fixture
def page(opened):
    """The page of scene R1, at rest."""
    return settled(opened(REFERENCE, viewport=DESK, reduced_motion="reduce"))


def set_field(page, name, text):
    field = page.page.locator(f"#set-{name}")
    field.fill(text)
    field.press("Enter")


def number(text):
    return float(text.replace("−", "-").split()[0])


def test_play_advances_the_clock_and_pause_stops_it(page):
    assert (state(page, "playing"), state(page, "time")) == (False, 0)
    page.page.get_by_role("button", name="Play", exact=True).click()
    page.page.wait_for_function("inertiaModule.state().time > 0.005")
    page.page.get_by_role("button", name="Pause").click()
    stopped = state(page, "time")
    page.page.wait_for_timeout(200)
    assert state(page, "time") == stopped
    assert page.errors == []


def test_it_plays_by_itself_where_motion_is_wanted(opened):
    page = opened(REFERENCE, reduced_motion="no-preference")
    page.page.wait_for_function("inertiaModule.state().playing && inertiaModule.state().time > 0")


def test_slider_changes_the_run_to_what_simulate_gives(page):
    before = shown(page, "omega_out")
    slider = page.page.get_by_role("slider", name="imbalance mass, kg")
    slider.focus()
    for _ in range(20):
        slider.press("ArrowRight")
    mass = float(page.page.locator("#set-imbalance_mass").input_value())
    assert mass > 1.0
    page.page.wait_for_function(
        "mass => inertiaModule.state().run.parameters.imbalance_mass === mass", arg=mass
    )
    settled(page)
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
        assert shown(page, name).tolist() == expected[name]
    assert np.abs(shown(page, "omega_out") - before).max() > 0.5


@pytest.mark.parametrize("scene", ["reference", "planar", "real-bevel", "elastic"])
def test_imbalance_is_drawn_where_the_kernel_has_it(page, scene):
    """The picture is built of turned groups, its arrows by the page's own formulas."""
    page.page.set_viewport_size({"width": 640, "height": 480})  # drawn without a graphics card
    changed = "&satellites=2&epsilon=0.4&gamma=-0.7&shaft_angle=1.2" if scene == "reference" else ""
    at(page, f"#scene={scene}{changed}")
    columns = np.array([shown(page, name) for name in POSITIONS])
    time = shown(page, "time")
    for row in (1, len(time) // 3, len(time) - 1):
        at(page, f"#scene={scene}{changed}&t={time[row]:.9g}&show-follow={row % 2}")
        page.page.evaluate(NEXT_FRAME)
        found = state(page, "imbalance")
        assert found["drawn"] == pytest.approx(columns[:, row], abs=1e-6)
        assert found["arrow"] == pytest.approx(columns[:, row], abs=1e-9)


def test_scrub_and_curves_agree(page):
    page.page.get_by_role("slider", name="time", exact=True).fill("4321")
    time = state(page, "time")
    assert time == pytest.approx(0.4321, rel=1e-3)
    # the next frame writes them
    page.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    row = np.searchsorted(shown(page, "time"), time, side="right") - 1
    values = [shown(page, name)[row] for name in ("input_speed", "omega2", "omega_out")]
    assert [number(text) for text in page.page.evaluate(LEGEND)] == pytest.approx(values, abs=0.01)
    # the cursor of the curves stands there, and a press on them goes there
    over = page.page.locator(".panel:first-child .u-over").bounding_box()
    mark = page.page.locator(".panel:first-child .mark").bounding_box()
    assert mark["x"] + mark["width"] / 2 - over["x"] == pytest.approx(time * over["width"], abs=2)
    page.page.mouse.click(over["x"] + 0.75 * over["width"], over["y"] + 20)
    assert state(page, "time") == pytest.approx(0.75, abs=0.01)


def test_steps_go_from_switch_to_switch_and_a_pulse_is_repeated(page):
    time, modes = shown(page, "time"), shown(page, "contact_mode")
    switches = time[1:][np.diff(modes) != 0]
    forwards = page.page.get_by_role("button", name="On to the next switch of a freewheel")
    for expected in switches[:3]:
        forwards.click()
        assert state(page, "time") == pytest.approx(expected, abs=1e-9)
    page.page.get_by_role("button", name="Back to the last switch of a freewheel").click()
    assert state(page, "time") == pytest.approx(switches[1], abs=1e-9)
    page.page.get_by_role("slider", name="time", exact=True).fill("5000")
    page.page.get_by_role("button", name="one pulse").click()
    begin, end = state(page, "loop")
    assert begin <= 0.5 < end
    assert 2 <= ((switches > begin - 1e-9) & (switches <= end + 1e-9)).sum() <= 6


def test_link_restores_the_state(page):
    set_field(page, "load_torque", "4.5")
    page.page.get_by_label("cut-away").uncheck()
    page.page.get_by_label("Path of the imbalance").select_option("fixed")
    page.page.get_by_role("slider", name="time", exact=True).fill("2500")
    page.page.wait_for_function(
        "location.hash.includes('t=0.25') && location.hash.includes('load_torque=4.5')"
    )
    settled(page)
    link, output = page.page.evaluate("location.hash"), shown(page, "omega_out")
    at(page, link)
    assert state(page, "time") == pytest.approx(0.25)
    assert page.page.locator("#set-load_torque").input_value() == "4.5"
    assert not page.page.get_by_label("cut-away").is_checked()
    assert page.page.get_by_label("Path of the imbalance").input_value() == "fixed"
    assert (shown(page, "omega_out") == output).all()
    assert state(page, "hash") == link


def test_what_a_link_says_wrongly_is_named(page):
    at(page, "#load_torque=much&colour=red&omega1=90")
    assert page.page.locator("#sentence").inner_text() == (
        "not understood in the address: load_torque=much, colour=red"
    )
    assert shown(page, "input_speed")[-1] == 90.0


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("imbalance_mass", "-3", "imbalance_mass must be between 0 and 1000000000 kg, is -3"),
        ("tolerance", "7", "tolerance must be between 1e-13 and 0.1, is 7"),
        ("duration", "-1", "a run must have between 1 and 60000 steps: duration is -1 s, step is 0.0005 s"),
    ],
)
def test_bad_value_shows_a_sentence_and_keeps_the_last_good_run(page, name, text, sentence):
    good = shown(page, "omega_out")
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    set_field(page, name, text)
    page.page.wait_for_function("document.querySelector('#sentence').textContent !== ''")
    assert page.page.locator("#sentence").inner_text() == sentence
    assert (shown(page, "omega_out") == good).all()
    page.page.get_by_role("button", name="Reset").click()
    page.page.wait_for_function("document.querySelector('#sentence').textContent === ''")
    assert page.errors == []


def test_keyboard_works(page):
    keys = page.page.keyboard
    time = shown(page, "time")
    keys.press("ArrowRight")
    keys.press("ArrowRight")
    assert state(page, "time") == time[2]
    keys.press("ArrowLeft")
    assert state(page, "time") == time[1]
    keys.press("End")
    assert state(page, "time") == time[-1]
    keys.press("Home")
    keys.press(".")
    assert 0 < state(page, "time") < 0.1
    keys.press("f")
    assert state(page, "settings.shown.follow")
    # a box that is ticked keeps the focus
    box = page.page.get_by_label("torques", exact=True)
    box.focus()
    keys.press(" ")
    assert state(page, "settings.shown.torques")
    assert box.evaluate("box => box === document.activeElement")
    page.page.locator("canvas").first.focus()
    speed = state(page, "speed")
    keys.press("-")
    assert state(page, "speed") == speed / 2
    keys.press(" ")
    assert state(page, "playing")
    # a field keeps its keys
    page.page.locator("#set-omega1").focus()
    keys.press(" ")
    assert state(page, "playing")


def test_presets_are_all_accepted(page):
    names = page.page.eval_on_selector_all(
        "select[aria-label=Scene] option", "all => all.map(one => one.value)"
    )
    assert len(names) >= 8
    page.page.set_viewport_size({"width": 640, "height": 480})
    for name in names:
        page.page.get_by_label("Scene", exact=True).select_option(name)
        page.page.wait_for_function("name => inertiaModule.state().settings.scene === name", arg=name)
        settled(page)
        assert state(page, "refusal") == ""
        assert np.isfinite(shown(page, "omega_out")).all()
    assert page.errors == []


def test_files_of_the_run_and_the_scene(page, tmp_path):
    set_field(page, "load_torque", "4.5")
    page.page.get_by_label("layout", exact=True).select_option("planar")
    settled(page)
    with page.page.expect_download() as table:
        page.page.get_by_role("button", name="CSV").click()
    with page.page.expect_download() as scene:
        page.page.get_by_role("button", name="TOML").click()
    heading, *rows = Path(table.value.path()).read_text().splitlines()
    assert heading.startswith("time [s],omega2 [rad/s],omega_out [rad/s]")
    assert len(rows) == 2001
    assert [float(row.split(",")[2]) for row in rows] == shown(page, "omega_out").tolist()
    text = Path(scene.value.path()).read_text()
    read = read_scene(text, tmp_path)
    assert tomllib.loads(text)["mechanism"] == {"layout": "planar"}
    assert (read.load.torque, read.run.stop_time, read.accuracy.tolerance) == (4.5, 1.0, 1e-9)


def test_converter_chart_is_that_of_the_package(page):
    """Stall torque and efficiency of scene R1 without losses, and the point of the run."""
    page.page.get_by_label("Phase plot or converter chart").select_option("chart")
    ready = "document.querySelector('.note:not([hidden])').textContent.startsWith('Steady pulses')"
    page.page.wait_for_function(ready)
    points = page.page.evaluate("inertiaModule.state().chart")
    assert [point["ratio"] for point in points] == pytest.approx(np.arange(25) / 25)
    assert [point["efficiency"] for point in points[1:15]] == pytest.approx([100.0] * 14, abs=0.1)
    torques = [point["output"] for point in points]
    assert torques == sorted(torques[:12], reverse=True) + torques[12:]
    # what goes in comes out, for nothing is lost
    for point in points[1:15]:
        assert point["input"] == pytest.approx(point["ratio"] * point["output"], abs=0.02 * torques[0])
