"""Test the page: its controls, its kernel compared with the native FMU, and the commands that write it."""

import base64
import json
import math
import re
import tomllib
import zlib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from inertia_module.common.errors import FmuError
from inertia_module.fmi.instance import Fmu
from inertia_module.fmi.results import Result
from inertia_module.interface.variables import LOCAL, OUTPUT, with_causality
from inertia_module.scene import load_scene
from inertia_module.viewer import html
from inertia_module.viewer.html import TEMPLATE
from tests.system.chromium import DESK, FONTS, PHONE, REFERENCE, ROOT, Opened, serious_faults, set_font
from tests.system.programs import assert_one_line_error, command, stdout_of
from tests.unit import scenes

POSITIONS = ("imbalance_x", "imbalance_y", "imbalance_z")
MESSAGE = "#message"


def set_field(page, name, text):
    field = page.page.locator(f"#set-{name}")
    field.fill(text)
    field.press("Enter")


def scrub(page, place):
    """Move the time slider, which has 10,000 positions."""
    page.page.get_by_role("slider", name="time", exact=True).fill(place)
    return page.drawn()


def test_clock_runs_only_while_playing(page, opened):
    assert (page.state("playing"), page.state("time")) == (False, 0)
    page.press("Play")
    page.page.wait_for_function("inertiaModule.state().time > 0.005")
    page.press("Pause")
    stopped = page.state("time")
    # At rest the page requests no frame.
    page.drawn().page.evaluate(
        "() => { window.frames = 0; window.requestAnimationFrame = () => { window.frames += 1; }; }"
    )
    page.page.wait_for_timeout(200)
    assert (page.state("time"), page.page.evaluate("window.frames")) == (stopped, 0)
    assert page.errors == []
    # The page starts automatically if the user allows motion.
    moving = opened(REFERENCE, reduced_motion="no-preference")
    moving.page.wait_for_function("inertiaModule.state().playing && inertiaModule.state().time > 0")


def test_slider_changes_the_run_like_simulate(page):
    before = page.column("omega_out")
    slider = page.page.get_by_role("slider", name="imbalance mass, kg")
    slider.focus()
    for _ in range(20):
        slider.press("ArrowRight")
    mass = float(page.page.locator("#set-imbalance_mass").input_value())
    assert mass > 1.0
    page.page.wait_for_function(
        "mass => inertiaModule.state().run.parameters.imbalance_mass === mass", arg=mass
    )
    page.integrated()
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
        assert page.column(name).tolist() == expected[name]
    assert np.abs(page.column("omega_out") - before).max() > 0.5


def test_engagement_angle_lets_link_2_turn_back_and_loses_power(page):
    """The drawn backlash is the angle that link 2 can turn back until the housing freewheel locks."""
    assert (page.column("omega2").min() >= -1e-9, np.abs(page.column("energy_lost")).max()) == (True, 0.0)
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    for which in ("housing", "output"):
        page.page.get_by_role("slider", name=f"{which} engagement angle, deg", exact=True).fill("200")
        assert page.page.locator(f"#set-{which}_engagement_angle").input_value() == "1.5"
    parameters, angle = page.integrated().state("run.parameters"), np.radians(1.5)
    assert parameters["housing_engagement_angle"] == parameters["output_engagement_angle"]
    assert parameters["output_engagement_angle"] == pytest.approx(angle)
    omega2, lost = page.column("omega2"), page.column("energy_lost")
    assert omega2.min() < -5.0
    assert 1.0 - lost[-1] / page.column("energy_in")[-1] < 0.9
    assert page.column("energy_lost_freewheel") == pytest.approx(lost, rel=1e-9)
    # Both wheels of the drive have 20 teeth.
    link2, holds = page.column("theta1") - page.column("q"), np.isin(page.column("contact_mode"), (0, 3))
    engaged = np.flatnonzero(holds[1:] & ~holds[:-1] & (omega2[:-1] < -5.0))[-1] + 1
    rows = slice(engaged - 3, engaged + 1)
    played = []
    for time in page.column("time")[rows]:
        page.page.evaluate("time => inertiaModule.seek(time)", time)
        played.append(page.drawn().state("play.housing"))
    assert played == pytest.approx((link2[rows] - link2[engaged]) / angle, abs=0.1)
    assert played[0] > 0.3 > played[-1] == 0.0
    # The page prints power and frequency of the impacts.
    page.page.evaluate("inertiaModule.seek(1.0)")
    page.page.get_by_role("combobox", name="Curves", exact=True).first.select_option("losses")
    legend = page.drawn().page.locator(".panel .legend").first.inner_text()
    assert float(re.search(r"freewheel\s+(\S+)\s+W", legend)[1]) > 10.0
    counts = [f"{page.column(f'{which}_engagements')[-1]:.1f}" for which in ("housing", "output")]
    text = page.page.get_by_role("row", name="engagements per second").locator("td").first.inner_text()
    assert text == "/".join(counts)


def test_every_scene_of_the_page_is_accepted(page):
    names = page.ask("scenes")
    assert len(names) >= 8
    for name in names:
        page.page.get_by_label("Scene", exact=True).select_option(name)
        page.page.wait_for_function("name => inertiaModule.state().settings.scene === name", arg=name)
        page.integrated()
        assert page.state("error") == ""
        assert np.isfinite(page.column("omega_out")).all()
    assert page.errors == []


def test_modules_that_do_not_fit_have_a_remark(page):
    for modules, words in ((2, ""), (6, "6 modules do not fit around the central axis, at most 2")):
        set_field(page, "modules", str(modules))
        page.page.wait_for_function(
            "modules => inertiaModule.state().run?.parameters.modules === modules", arg=modules
        )
        page.integrated()
        assert page.page.locator(MESSAGE).inner_text().startswith(words)
        assert bool(page.page.locator(MESSAGE).inner_text()) == bool(words)


def test_imbalance_is_drawn_at_its_kernel_position(page):
    """The picture consists of rotated groups; the arrows have formulas of the page."""
    askew = "reference&satellites=2&epsilon=0.4&gamma=-0.7&shaft_angle=1.2"
    for scene in (askew, "planar", "real-bevel", "elastic"):
        page.at(f"#scene={scene}")
        time, columns = page.column("time"), np.array([page.column(name) for name in POSITIONS])
        for row in (1, len(time) // 3, len(time) - 1):
            follow = page.state("settings.shown.follow")
            page.page.keyboard.press("f")  # The frame changes between housing and link 1.
            assert page.integrated().state("settings.shown.follow") != follow
            page.page.evaluate("time => inertiaModule.seek(time)", time[row])
            position = page.drawn().state("imbalance")
            assert position["drawn"] == pytest.approx(columns[:, row], abs=1e-6)
            assert position["arrow"] == pytest.approx(columns[:, row], abs=1e-9)


def test_clock_curves_and_switches_agree(page):
    time = scrub(page, "4321").state("time")
    assert time == pytest.approx(0.4321, rel=1e-3)
    row = np.searchsorted(page.column("time"), time, side="right") - 1
    values = [page.column(name)[row] for name in ("input_speed", "omega2", "omega_out")]
    printed = [float(text.replace("−", "-").split()[0]) for text in page.ask("legend")]
    assert printed == pytest.approx(values, abs=0.01)
    # The cursor of the curves is at this time; a click on the curves moves it.
    curves = page.page.locator(".panel:first-child .u-over")
    over = curves.bounding_box()
    mark = page.page.locator(".panel:first-child .mark").bounding_box()
    assert mark["x"] + mark["width"] / 2 - over["x"] == pytest.approx(time * over["width"], abs=2)
    curves.click(position={"x": 0.75 * over["width"], "y": 20})
    assert page.state("time") == pytest.approx(0.75, abs=0.01)
    # The buttons step from event to event. One pulse can be repeated.
    scrub(page, "0")
    switches = page.column("time")[1:][np.diff(page.column("contact_mode")) != 0]
    for expected in switches[:3]:
        page.press("Next freewheel switching event")
        assert page.state("time") == pytest.approx(expected, abs=1e-9)
    page.press("Previous freewheel switching event")
    assert page.state("time") == pytest.approx(switches[1], abs=1e-9)
    scrub(page, "5000")
    page.page.get_by_role("button", name="one pulse").click()
    begin, end = page.state("loop")
    assert begin <= 0.5 < end
    assert 2 <= ((switches > begin - 1e-9) & (switches <= end + 1e-9)).sum() <= 6


def test_link_restores_the_state_and_reports_invalid_values(page):
    set_field(page, "load_torque", "4.5")
    page.integrated()  # Slider positions are fractions of the finished part of the run.
    page.page.get_by_label("cut-away").uncheck()
    page.page.get_by_label("Path of the unbalanced mass").select_option("fixed")
    scrub(page, "2500")
    page.page.wait_for_function(
        "location.hash.includes('t=0.25') && location.hash.includes('load_torque=4.5')"
    )
    link, output = page.page.evaluate("location.hash"), page.column("omega_out")
    page.at(link)
    assert page.state("time") == pytest.approx(0.25)
    assert page.page.locator("#set-load_torque").input_value() == "4.5"
    assert not page.page.get_by_label("cut-away").is_checked()
    assert page.page.get_by_label("Path of the unbalanced mass").input_value() == "fixed"
    assert (page.column("omega_out") == output).all()
    assert page.state("hash") == link
    page.at("#load_torque=much&colour=red&omega1=90")
    assert page.page.locator(MESSAGE).inner_text() == (
        "unknown settings in the link: load_torque=much, colour=red"
    )
    assert page.column("input_speed")[-1] == 90.0


def test_bad_value_shows_a_sentence_and_keeps_the_last_good_run(page):
    good = page.column("omega_out")
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    for name, text, sentence in (
        ("imbalance_mass", "-3", "imbalance_mass must be between 0 and 100000 kg (got -3)"),
        ("tolerance", "7", "tolerance must be between 1e-12 and 0.01 (got 7)"),
        ("duration", "-1", "a run must have between 1 and 60000 steps (got duration -1 s, step 0.0005 s)"),
    ):
        set_field(page, name, text)
        page.page.wait_for_function(f"document.querySelector('{MESSAGE}').textContent !== ''")
        assert page.page.locator(MESSAGE).inner_text() == sentence
        assert (page.column("omega_out") == good).all()
        page.press("Reset")
        page.page.wait_for_function(f"document.querySelector('{MESSAGE}').textContent === ''")
    assert page.errors == []


def test_field_takes_a_unit_and_leaves_a_wrong_text(page):
    field, reason = page.page.locator("#set-omega1"), page.page.locator("#set-omega1-reason")
    set_field(page, "omega1", "3000 rpm")
    page.page.wait_for_function("Math.abs(inertiaModule.state().settings.changed.omega1 - 314.159265) < 1e-5")
    assert field.input_value() == "314.1593"
    reasons = {"abc": "not a number with a unit", "5 rpmm": "unknown unit 'rpmm'", "": "not a number"}
    for text, words in reasons.items():
        set_field(page, "omega1", text)
        assert (field.input_value(), field.get_attribute("aria-invalid")) == (text, "true")
        assert words in reason.inner_text()
        assert page.state("settings.changed.omega1") == pytest.approx(100 * np.pi)
    # a value of the scene is no change
    row = page.page.locator(".field", has=field)
    assert "changed" in row.get_attribute("class")
    set_field(page, "omega1", "100")
    assert (page.state("settings.changed"), reason.inner_text()) == ({}, "")
    assert "changed" not in row.get_attribute("class")
    assert page.errors == []


def test_speeds_are_in_rpm_in_the_whole_page(page):
    page.page.get_by_label("Unit of rotational speeds").select_option("rpm")
    page.integrated().drawn()
    assert page.page.locator("#set-omega1").input_value() == "954.9297"
    table = page.page.locator(".instruments").first.inner_text()
    assert "rpm" in table
    assert "rad/s" not in table
    legend = page.page.locator(".panel .legend").first.inner_text()
    assert float(re.search(r"input (\S+) rpm", legend)[1]) == pytest.approx(954.93, abs=0.05)
    set_field(page, "omega1", "1000")
    page.page.wait_for_function("inertiaModule.state().settings.changed.omega1 > 104.7")
    assert page.state("settings.changed.omega1") == pytest.approx(1000 * np.pi / 30)
    assert "speed-unit=rpm" in page.state("hash")


def test_tour_sets_view_curves_and_time(page):
    page.press("Tour")
    tour = page.page.locator("#tour")
    for step, locked in enumerate((None, None, "housing freewheel", "output freewheel", None), start=1):
        page.page.wait_for_function("!inertiaModule.state().busy")
        page.integrated().drawn()
        assert tour.inner_text().startswith(f"{step} of 5")
        assert page.state("time") > 0
        if locked:
            row = page.page.get_by_role("row", name=locked).locator("td").first
            assert row.inner_text() == "locked"
            assert page.state("loop") is not None
        page.press("Finish" if step == 5 else "Next")
    assert tour.is_hidden()
    assert page.page.get_by_label("Phase plot or torque converter chart").input_value() == "chart"
    assert page.errors == []


def test_view_turns_by_keys_and_buttons_and_names_do_not_overlap(page):
    page.page.set_viewport_size(DESK)
    page.drawn()
    labels = "[...document.querySelectorAll('.label:not([hidden])')]"
    places = f"{labels}.map(box => box.getBoundingClientRect().toJSON())"
    seen = [page.page.evaluate(places)]
    for press in ("front", "along the shaft", "isometric", "Zoom in"):
        page.press(press)
        seen.append(page.drawn().page.evaluate(places))
    for key in ("Shift+ArrowLeft", "Shift+ArrowUp", "o", "1"):
        page.page.keyboard.press(key)
        seen.append(page.drawn().page.evaluate(places))
    assert all(before != after for before, after in pairwise(seen))
    for boxes in seen:
        for n, box in enumerate(boxes):
            for other in boxes[:n]:
                is_apart = box["left"] >= other["right"] or other["left"] >= box["right"]
                assert is_apart or box["top"] >= other["bottom"] or other["top"] >= box["bottom"]


def test_keyboard_works(page):
    keys = page.page.keyboard
    time = page.column("time")
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
    # A checkbox keeps the focus after a click.
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
    # A text field receives its keys.
    page.page.locator("#set-omega1").focus()
    keys.press(" ")
    assert page.state("playing")


def test_files_of_the_run_and_the_scene(page):
    set_field(page, "load_torque", "4.5")
    page.page.get_by_label("layout", exact=True).select_option("planar")
    page.integrated()
    with page.page.expect_download() as table:
        page.page.get_by_role("button", name="CSV").click()
    with page.page.expect_download() as scene:
        page.page.get_by_role("button", name="TOML").click()
    heading, *rows = Path(table.value.path()).read_text().splitlines()
    assert heading.startswith("time [s],omega2 [rad/s],omega_out [rad/s]")
    assert len(rows) == 2001
    assert [float(row.split(",")[2]) for row in rows] == page.column("omega_out").tolist()
    file = Path(scene.value.path())
    read = load_scene(file)
    assert tomllib.loads(file.read_text())["mechanism"] == {"layout": "planar"}
    assert (read.load.torque, read.run.stop_time, read.accuracy.tolerance) == (4.5, 1.0, 1e-9)


def test_converter_chart_agrees_with_the_package(page):
    """Compare stall torque and efficiency of scene R1 without losses, and the point of the run."""
    page.page.get_by_label("Phase plot or torque converter chart").select_option("chart")
    ready = "document.querySelector('.note:not([hidden])').textContent.startsWith('Periodic steady state')"
    page.page.wait_for_function(ready)
    points = page.state("chart")
    assert [point["ratio"] for point in points] == pytest.approx(np.arange(25) / 25)
    assert [point["efficiency"] for point in points[1:15]] == pytest.approx([100.0] * 14, abs=0.1)
    torques = [point["output"] for point in points]
    assert torques == sorted(torques[:12], reverse=True) + torques[12:]
    # Output power equals input power without losses.
    for point in points[1:15]:
        assert point["input"] == pytest.approx(point["ratio"] * point["output"], abs=0.02 * torques[0])


# --- sizes, colour schemes, accessibility and speed ---

PAPER = "getComputedStyle(document.body).backgroundColor"


@pytest.fixture(params=[PHONE, DESK], ids=["phone", "desk"])
def sized(still, request):
    """Return the page of scene R1 at rest, loaded at a window size."""
    still.page.set_viewport_size(request.param)
    return still.at("")


def test_no_text_overflows_in_any_font_and_the_theme_switches(sized):
    before = sized.page.evaluate(PAPER)
    sized.press("Light or dark theme")
    assert sized.page.evaluate(PAPER) != before
    for font in FONTS:
        set_font(sized.page, font)
        sized.drawn()
        width = sized.page.viewport_size["width"]
        assert sized.page.evaluate("document.documentElement.scrollWidth") <= width, font
        assert sized.ask("tooNarrow") == [], font


def test_axe_finds_no_serious_fault(sized):
    for scheme in ("light", "dark"):
        sized.page.emulate_media(color_scheme=scheme)
        assert serious_faults(sized.drawn().page) == [], scheme
    set_field(sized, "omega1", "abc")
    assert serious_faults(sized.drawn().page) == [], "wrong text in a field"
    sized.press("Tour")
    sized.integrated()
    assert serious_faults(sized.drawn().page) == [], "tour"
    sized.press("End tour")
    sized.press("What is this? Keys")
    assert serious_faults(sized.drawn().page) == [], "help"


def test_touch_targets_have_24_pixels(sized):
    sized.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    small = """[...document.querySelectorAll('button, select, input, summary')].filter(
        box => box.checkVisibility() && Math.min(box.offsetWidth, box.offsetHeight) < 24
    ).map(box => box.outerHTML.slice(0, 80))"""
    assert sized.page.evaluate(small) == []


def test_first_picture_and_frames_are_quick(browser, written):
    """Measure CPU time, because other processes may use this machine."""
    with browser.new_page(viewport=DESK, reduced_motion="no-preference") as page:
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})

        def metric(name):
            metrics = session.send("Performance.getMetrics")["metrics"]
            return next(item["value"] for item in metrics if item["name"] == name)

        opened = Opened(page, written(REFERENCE)).integrated()
        assert metric("TaskDuration") < 1.5
        page.wait_for_timeout(2000)
        before = metric("ScriptDuration")
        page.evaluate("window.drawn = 0; (function count() { drawn++; requestAnimationFrame(count); })()")
        page.wait_for_function("drawn > 20")
        frame = (metric("ScriptDuration") - before) / page.evaluate("drawn")
        assert 0 < frame < 8e-3
        assert opened.state("playing")


# Delay each frame of the page; count frames, draw calls, and movements of the cursor of the curves.
SLOW_FRAMES = """{
    window.counts = { frames: 0, calls: 0, moves: 0 };
    const request = window.requestAnimationFrame;
    window.requestAnimationFrame = draw => setTimeout(() => { counts.frames += 1; request(draw); }, 60);
    const { prototype } = window.WebGL2RenderingContext;
    for (const name of Object.keys(prototype).filter(name => /^draw(A|E)/.test(name))) {
        const call = prototype[name];
        prototype[name] = function (...values) { counts.calls += 1; call.apply(this, values); };
    }
    const mark = document.querySelector('.panel .mark');
    new MutationObserver(() => { counts.moves += 1; }).observe(mark, { attributes: true });
}"""


def test_slow_frames_lower_the_resolution_and_a_picture_at_rest_is_sharp_and_not_drawn(page):
    counts = "Object.values(window.counts)"
    full = page.page.evaluate("devicePixelRatio")
    page.page.evaluate(SLOW_FRAMES)

    def wait_for(condition):
        page.page.wait_for_function(f"full => {condition}", arg=full, polling=50)

    page.press("Play")
    wait_for("inertiaModule.state().pixelRatio === 0.5 * full")
    before = page.page.evaluate(counts)
    page.page.wait_for_timeout(2000)
    frames, calls, moves = np.subtract(page.page.evaluate(counts), before)
    # A processor draws one call after the other. The cursors move less often than the picture.
    assert 0 < calls < 30 * frames
    assert 0 < moves < 0.8 * frames
    page.press("Pause")
    wait_for("inertiaModule.state().pixelRatio >= full")
    page.page.wait_for_timeout(300)
    before = page.page.evaluate(counts)
    page.page.wait_for_timeout(500)
    assert page.page.evaluate(counts) == before


# --- the kernel of the page has the results and messages of the native FMU ---


INPUTS = ("omega1", "load_torque", "drive_torque")
READ = [variable.name for variable in with_causality(OUTPUT, LOCAL)]
LEVELS = {**scenes.LEVELS, "losses": scenes.ALL_LOSSES}
# Each level drives one layout by speed and the other one by torque.
CASES = {
    f"{level}, {layout}, {drive}": {**scenes.DRIVES[drive][layout], **values}
    for n, (level, values) in enumerate(LEVELS.items())
    for drive, layout in zip(
        ("speed", "torque"), (("bevel", "planar"), ("planar", "bevel"))[n % 2], strict=True
    )
    if (level, drive) != ("kinematic", "torque")
}
STEP, STEPS = 1e-3, 200


def options(values):
    """Return options of `simulate` from a single table of parameters and inputs."""
    parameters = {name: float(value) for name, value in values.items() if name not in INPUTS}
    inputs = {name: values[name] for name in INPUTS if name in values}
    return {"parameters": parameters, "inputs": inputs, "step": STEP, "steps": STEPS, "outputs": READ}


def native(built, values, over_time=lambda time: {}):
    """Run the native FMU with inputs and their rates over time, and return the columns of READ."""
    start = {name: value for name, (value, _) in over_time(0.0).items()}
    with Fmu(built / "InertiaModule.fmu", values["parameters"], values["inputs"] | start) as fmu:
        rows = [fmu.read(READ)]
        for n in range(values["steps"]):
            now = over_time(n * values["step"])
            fmu.set(**{name: value for name, (value, _) in now.items()})
            fmu.set_rates(**{name: rate for name, (_, rate) in now.items()})
            fmu.advance(values["step"])
            rows.append(fmu.read(READ))
    return dict(zip(READ, np.array(rows).T, strict=True))


@pytest.mark.parametrize("case", CASES)
def test_simulate_is_the_native_fmu_in_every_output(still, built, case):
    run_options = options(CASES[case])
    expected, actual = native(built, run_options), still.simulate(run_options)
    assert actual["time"] == pytest.approx([n * STEP for n in range(STEPS + 1)], abs=0.0, rel=1e-15)
    off = {
        name: np.abs(np.array(actual[name]) - values).max() / max(np.abs(values).max(), 1.0)
        for name, values in expected.items()
    }
    assert {name: error for name, error in off.items() if not error <= 1e-9} == {}


BAD = {
    "out of range": {"tolerance": 7.0, "a": -1.0},
    "no number": {"imbalance_mass": float("nan")},
    "no whole teeth": {"z2": 0},
    "together": {"link2_inertia": 0.0, "imbalance_mass": 1e-9},
    "a bad start": {"omega2_start": -3.25},
    "an input": {"omega1": 1e300},
    "an input that is tiny elsewhere": {"load_torque": -1.25e-7, "drive_torque": float("inf")},
}


def test_bad_value_gives_the_sentence_of_the_native_fmu(still, built):
    for case, values in BAD.items():
        run_options = options(values)
        with pytest.raises(FmuError) as rejected:
            native(built, run_options)
        assert still.simulate(run_options) == str(rejected.value), case


# Run up to speed, then let the load jump.
OVER_TIME = {
    "omega1": {"times": [0.0, 0.05, 0.2], "values": [0.0, 20.0, 120.0]},
    "load_torque": {"times": [0.0, 0.1, 0.1, 0.3], "values": [2.0, 2.0, 12.0, 8.0]},
}


def over_time(time):
    """Return each input just after a time, and its rate until the next point."""
    values = {}
    for name, signal in OVER_TIME.items():
        points = list(zip(signal["times"], signal["values"], strict=True))
        before = max(n for n, point in enumerate(points) if point[0] <= time)
        (begin, value), (end, last) = points[before], [*points, (math.inf, points[-1][1])][before + 1]
        rate = (last - value) / (end - begin)
        values[name] = value + rate * (time - begin), rate
    return values


def test_inputs_over_time_are_linear_as_in_the_fmu(still, built):
    run_options = {**options({}), "steps": 400}  # The run continues after the last point.
    actual = still.simulate({**run_options, "inputs": OVER_TIME})
    for name, values in native(built, run_options, over_time).items():
        assert actual[name] == pytest.approx(values, rel=1e-9, abs=1e-9 * max(np.abs(values).max(), 1.0)), (
            name
        )


def test_integrate_in_slices_equals_simulate_with_full_angles(still):
    run_options = options({**scenes.PLANAR, "tolerance": 1e-12})  # The run takes some slices.
    run = still.ask("integrate", {**run_options, "duration": 2.0})
    at_once = still.simulate({**run_options, "steps": 2000})
    assert run["complete"]
    assert run["calls"] > 1
    assert run["time"] == at_once["time"]
    assert {name: run["columns"][name] for name in READ} == {name: at_once[name] for name in READ}
    turned = np.array(at_once["drive_angle"]) + 2.0 * np.pi * np.array(at_once["drive_turns"])
    assert run["columns"]["q"] == pytest.approx(turned, rel=1e-15)


def test_run_that_fails_in_the_middle_keeps_its_rows(still):
    run_options = options({"load_torque": 10.0})
    run_options["inputs"]["omega1"] = {"times": [0.0, 0.0105, 0.0105], "values": [100.0, 100.0, 1e300]}
    run = still.ask("integrate", {**run_options, "duration": 1.0})
    assert not run["complete"]
    assert len(run["time"]) == len(run["columns"]["omega2"]) == 12
    assert run["error"] == still.simulate(run_options)
    assert run["error"].startswith("omega1 must be between ")


def test_warnings_agree_with_the_native_fmu(still, built):
    run_options = options({"layout": 1, "eccentricity": 0.05, "satellites": 12, "omega1": 10.0})
    run = still.ask("integrate", {**run_options, "duration": 0.01})
    with Fmu(built / "InertiaModule.fmu", run_options["parameters"], run_options["inputs"]) as fmu:
        assert run["warnings"] == fmu.warnings
    assert len(run["warnings"]) == 2


def test_memory_does_not_grow_over_a_thousand_instances(still):
    """Instances are freed, also after a rejection."""
    good = {**options({"omega1": 100.0}), "steps": 2, "outputs": ["omega_out"]}
    bad = {**good, "parameters": {"tolerance": 7.0}}
    assert still.ask("thousand", [good, bad]) == still.simulate(good)["omega_out"][-1]


# --- commands view and run --view: a complete page or none ---


EXAMPLES = ROOT / "examples"
ENGINE = EXAMPLES / "engine.toml"
COARSE = Path(__file__).with_name("coarse.toml")
MAX_BYTES = 2_500_000


def check_page(page):
    """Check that the page opens from disk, sends no requests and is small enough."""
    page.page.wait_for_timeout(500)
    assert (page.errors, page.requests) == ([], [])
    assert page.path.stat().st_size < MAX_BYTES


def table_of(scene, fmu, folder):
    """Run a scene with the command and return its table."""
    stdout_of("run", scene, "-o", folder, "--fmu", fmu)
    return Result.from_csv(folder / "table.csv")


def test_page_plays_the_recorded_run(opened, fmu, tmp_path):
    """The load depends on the motion. The page cannot compute such a run, so it contains the record."""
    page, table = opened(ENGINE), table_of(ENGINE, fmu, tmp_path)
    check_page(page)
    start, played = page.page.evaluate("window.inertiaModule.start"), page.ask("played")
    every = start["run"]["every"]
    assert not start["scene"]["exact"]
    assert start["scene"]["inputs"]["load_torque"] == pytest.approx(table["load_torque"].mean(), rel=1e-3)
    assert start["scene"]["inputs"]["drive_torque"]["values"] == [0.0, 40.0, 25.0, 15.0]
    assert played["time"] == pytest.approx(table.time[::every], abs=1e-9)
    assert played["omega_out"] == pytest.approx(table["omega_out"][::every], rel=1e-7)
    assert np.diff(played["q"]).max() < 0.4 * every  # Rows are closer than a whole turn.


def test_run_too_coarse_for_its_pulses_shows_means_and_dots_instead_of_curves(opened, fmu, tmp_path):
    page = opened(COARSE, reduced_motion="reduce")
    mean = table_of(COARSE, fmu, tmp_path)["mesh_torque_mean"][50]
    page.page.get_by_role("slider", name="time", exact=True).fill("5000")
    page.drawn()
    speeds, torques = (panel.inner_text() for panel in page.page.locator(".panel .legend").all())
    table = page.page.locator(".instruments").first.inner_text()
    assert "ω2 link 2, instantaneous" in speeds
    (value,) = re.findall(r"M2 mesh, mean\s+(\S+)\s+N·m", torques)
    (now,) = re.findall(r"step-averaged torques.*mesh torque, M2\s+(\S+)", table, re.S)
    assert value == now
    assert float(now.replace("−", "-")) == pytest.approx(mean, abs=0.01)
    page.page.get_by_label("Scene", exact=True).select_option("reference")
    page.integrated()
    assert "mean" not in page.page.locator(".panel .legend").nth(1).inner_text()


def test_row_of_a_long_run_includes_means_and_peaks_of_omitted_rows(monkeypatch):
    columns = {"time": np.arange(8.0), "torque_mean": np.arange(8.0), "force_peak": -np.arange(8.0)}
    record = Result(columns, {})
    monkeypatch.setattr(html, "MAX_NUMBERS", 6)
    run = html.page_run(record)
    assert run["step"] == 3.0
    packed = zlib.decompress(base64.b64decode(run["numbers"]), -zlib.MAX_WBITS)
    torque, force = np.frombuffer(packed, "<f4").reshape(2, -1)
    assert (run["every"], run["rows"]) == (3, 3)
    assert torque.tolist() == [0.0, 2.0, 5.0]
    assert force.tolist() == [0.0, -1.0, -4.0]


def test_run_writes_the_page_next_to_its_table(fmu, tmp_path):
    printed = stdout_of("run", REFERENCE, "--view", "--json", "--fmu", fmu, "-o", tmp_path)
    assert json.loads(printed)["files"]["page"] == str(tmp_path / "page.html")
    assert "drive_turns" not in Result.from_csv(tmp_path / "table.csv")
    assert (tmp_path / "page.html").stat().st_size < MAX_BYTES


def test_impossible_page_or_report_is_rejected_before_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr("inertia_module.scene.run_scene", lambda *_, **__: pytest.fail("it was run"))
    (tmp_path / "folder.html").mkdir()
    (tmp_path / "file").write_text("a file")
    shaft, missing = EXAMPLES / "papers" / "stelmashchuk_stepping.toml", tmp_path / "template.html"
    message = "error: the viewer has not been built. Run `make page` in a clone, or install the wheel.\n"
    for template, arguments, place, sentence in (
        (
            TEMPLATE,
            ("run", shaft, "--view"),
            "",
            "--fidelity, --error and --view require a scene of the module",
        ),
        (TEMPLATE, ("view", shaft), "page.html", "must be a scene of the module (got a driven shaft)"),
        (TEMPLATE, ("view", ENGINE), "folder.html", "--output must be a file (got the folder "),
        (TEMPLATE, ("view", ENGINE), "page.txt", "--output must be a file with the ending .html (got "),
        (TEMPLATE, ("view", ENGINE), "file/page.html", "cannot write to "),
        (TEMPLATE, ("report", ENGINE), "report.pdf", "--output must be a file with the ending .html (got "),
        (TEMPLATE, ("report", ENGINE), "file/report.html", "cannot write to "),
        (missing, ("view", REFERENCE), "page.html", message),
        (missing, ("run", REFERENCE, "--view"), "page.html", message),
    ):
        monkeypatch.setattr(html, "TEMPLATE", template)
        assert_one_line_error(command(*arguments, "-o", tmp_path / place), sentence)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.html"]


def test_page_is_complete_or_absent(tmp_path, monkeypatch):
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
