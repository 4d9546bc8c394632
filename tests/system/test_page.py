"""The page: as a reader uses it, the kernel in it against the native FMU, the commands that write it."""

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

from inertia_module.fmi.instance import Fmu, FmuError
from inertia_module.fmi.results import Result
from inertia_module.interface.variables import LOCAL, OUTPUT, with_causality
from inertia_module.scene import load_scene
from inertia_module.viewer import html
from inertia_module.viewer.html import TEMPLATE
from tests.system.chromium import DESK, FONTS, PHONE, REFERENCE, ROOT, Opened, set_font
from tests.system.programs import command, is_one_line, left
from tests.unit import scenes

POSITIONS = ("imbalance_x", "imbalance_y", "imbalance_z")
MESSAGE = "#message"


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
    # at rest nothing asks for frames
    page.drawn().page.evaluate(
        "() => { window.frames = 0; window.requestAnimationFrame = () => { window.frames += 1; }; }"
    )
    page.page.wait_for_timeout(200)
    assert (page.state("time"), page.page.evaluate("window.frames")) == (stopped, 0)
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


def test_slider_of_an_engagement_angle_lets_link_2_turn_back_and_takes_power(page):
    """The play that is drawn is the angle that link 2 still turns back until the housing freewheel holds."""
    assert (page.shown("omega2").min() >= -1e-9, np.abs(page.shown("energy_lost")).max()) == (True, 0.0)
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    for which in ("housing", "output"):
        page.page.get_by_role("slider", name=f"{which} engagement angle, deg", exact=True).fill("200")
        assert page.page.locator(f"#set-{which}_engagement_angle").input_value() == "1.5"
    parameters, angle = page.settled().state("run.parameters"), np.radians(1.5)
    assert parameters["housing_engagement_angle"] == parameters["output_engagement_angle"]
    assert parameters["output_engagement_angle"] == pytest.approx(angle)
    omega2, lost = page.shown("omega2"), page.shown("energy_lost")
    assert omega2.min() < -5.0
    assert 1.0 - lost[-1] / page.shown("energy_in")[-1] < 0.9
    assert page.shown("energy_lost_freewheel") == pytest.approx(lost, rel=1e-9)
    # both wheels of the drive have 20 teeth
    link2, holds = page.shown("theta1") - page.shown("q"), np.isin(page.shown("contact_mode"), (0, 3))
    engaged = np.flatnonzero(holds[1:] & ~holds[:-1] & (omega2[:-1] < -5.0))[-1] + 1
    rows = slice(engaged - 3, engaged + 1)
    played = []
    for time in page.shown("time")[rows]:
        page.page.evaluate("time => inertiaModule.seek(time)", time)
        played.append(page.drawn().state("play.housing"))
    assert played == pytest.approx((link2[rows] - link2[engaged]) / angle, abs=0.1)
    assert played[0] > 0.3 > played[-1] == 0.0
    # what the impacts take, and how many they are, is told
    page.page.evaluate("inertiaModule.seek(1.0)")
    page.page.get_by_role("combobox", name="Curves", exact=True).first.select_option("losses")
    legend = page.drawn().page.locator(".panel .legend").first.inner_text()
    assert float(re.search(r"freewheel\s+(\S+)\s+W", legend)[1]) > 10.0
    counts = [f"{page.shown(f'{which}_engagements')[-1]:.1f}" for which in ("housing", "output")]
    told = page.page.get_by_role("row", name="engagements per second").locator("td").first.inner_text()
    assert told == "/".join(counts)


def test_every_scene_of_the_page_is_accepted(page):
    names = page.ask("scenes")
    assert len(names) >= 8
    for name in names:
        page.page.get_by_label("Scene", exact=True).select_option(name)
        page.page.wait_for_function("name => inertiaModule.state().settings.scene === name", arg=name)
        page.settled()
        assert page.state("error") == ""
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
    told = [float(text.replace("−", "-").split()[0]) for text in page.ask("legend")]
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
        page.press("Next freewheel switching event")
        assert page.state("time") == pytest.approx(expected, abs=1e-9)
    page.press("Previous freewheel switching event")
    assert page.state("time") == pytest.approx(switches[1], abs=1e-9)
    scrub(page, "5000")
    page.page.get_by_role("button", name="one pulse").click()
    begin, end = page.state("loop")
    assert begin <= 0.5 < end
    assert 2 <= ((switches > begin - 1e-9) & (switches <= end + 1e-9)).sum() <= 6


def test_link_restores_the_state_and_names_what_is_wrong_in_it(page):
    set_field(page, "load_torque", "4.5")
    page.settled()  # places of the slider are shares of the run as far as it is
    page.page.get_by_label("cut-away").uncheck()
    page.page.get_by_label("Path of the unbalanced mass").select_option("fixed")
    scrub(page, "2500")
    page.page.wait_for_function(
        "location.hash.includes('t=0.25') && location.hash.includes('load_torque=4.5')"
    )
    link, output = page.page.evaluate("location.hash"), page.shown("omega_out")
    page.at(link)
    assert page.state("time") == pytest.approx(0.25)
    assert page.page.locator("#set-load_torque").input_value() == "4.5"
    assert not page.page.get_by_label("cut-away").is_checked()
    assert page.page.get_by_label("Path of the unbalanced mass").input_value() == "fixed"
    assert (page.shown("omega_out") == output).all()
    assert page.state("hash") == link
    page.at("#load_torque=much&colour=red&omega1=90")
    assert page.page.locator(MESSAGE).inner_text() == (
        "unknown settings in the link: load_torque=much, colour=red"
    )
    assert page.shown("input_speed")[-1] == 90.0


def test_bad_value_shows_a_sentence_and_keeps_the_last_good_run(page):
    good = page.shown("omega_out")
    page.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    for name, text, sentence in (
        ("imbalance_mass", "-3", "imbalance_mass must be between 0 and 100000 kg (got -3)"),
        ("tolerance", "7", "tolerance must be between 1e-12 and 0.01 (got 7)"),
        ("duration", "-1", "a run must have between 1 and 60000 steps (got duration -1 s, step 0.0005 s)"),
    ):
        set_field(page, name, text)
        page.page.wait_for_function(f"document.querySelector('{MESSAGE}').textContent !== ''")
        assert page.page.locator(MESSAGE).inner_text() == sentence
        assert (page.shown("omega_out") == good).all()
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
    page.settled().drawn()
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
        page.settled().drawn()
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
                apart = box["left"] >= other["right"] or other["left"] >= box["right"]
                assert apart or box["top"] >= other["bottom"] or other["top"] >= box["bottom"]


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


def test_files_of_the_run_and_the_scene(page):
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
    file = Path(scene.value.path())
    read = load_scene(file)
    assert tomllib.loads(file.read_text())["mechanism"] == {"layout": "planar"}
    assert (read.load.torque, read.run.stop_time, read.accuracy.tolerance) == (4.5, 1.0, 1e-9)


def test_converter_chart_is_that_of_the_package(page):
    """Stall torque and efficiency of scene R1 without losses, and the point of the run."""
    page.page.get_by_label("Phase plot or torque converter chart").select_option("chart")
    ready = "document.querySelector('.note:not([hidden])').textContent.startsWith('Periodic steady state')"
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

AXE = ROOT / "viewer" / "node_modules" / "axe-core" / "axe.min.js"
AXE_RUN = "axe.run({ rules: { 'target-size': { enabled: true } } })"
PAPER = "getComputedStyle(document.body).backgroundColor"


@pytest.fixture(params=[PHONE, DESK], ids=["phone", "desk"])
def sized(still, request):
    """The page of scene R1 at rest, loaded at a size."""
    still.page.set_viewport_size(request.param)
    return still.at("")


def test_nothing_hangs_over_in_any_font_and_the_theme_can_be_switched(sized):
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
    if not AXE.exists():
        pytest.skip("axe-core is not installed: `make page` installs it")
    sized.page.evaluate(AXE.read_text())
    for scheme in ("light", "dark"):
        sized.page.emulate_media(color_scheme=scheme)
        assert serious_faults(sized) == [], scheme
    set_field(sized, "omega1", "abc")
    assert serious_faults(sized) == [], "wrong text in a field"
    sized.press("Tour")
    sized.settled()
    assert serious_faults(sized) == [], "tour"
    sized.press("End tour")
    sized.press("What is this? Keys")
    assert serious_faults(sized) == [], "help"


def serious_faults(opened):
    """Return the serious faults that axe finds in the page as it is."""
    return [
        (fault["id"], node["target"], node["failureSummary"])
        for fault in opened.drawn().page.evaluate(AXE_RUN)["violations"]
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]


def test_touch_targets_have_24_pixels(sized):
    sized.page.evaluate("document.querySelectorAll('details').forEach(group => { group.open = true; })")
    small = """[...document.querySelectorAll('button, select, input, summary')].filter(
        box => box.checkVisibility() && Math.min(box.offsetWidth, box.offsetHeight) < 24
    ).map(box => box.outerHTML.slice(0, 80))"""
    assert sized.page.evaluate(small) == []


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


# --- the kernel in the page computes what the native FMU computes, and says what that says ---


INPUTS = ("omega1", "load_torque", "drive_torque")
READ = [variable.name for variable in with_causality(OUTPUT, LOCAL)]
LEVELS = {**scenes.LEVELS, "losses": scenes.ALL_LOSSES}
# each level with a layout driven by speed and the other one driven by torque
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
    """Options of simulate, from parameters and inputs in one table."""
    parameters = {name: float(value) for name, value in values.items() if name not in INPUTS}
    inputs = {name: values[name] for name in INPUTS if name in values}
    return {"parameters": parameters, "inputs": inputs, "step": STEP, "steps": STEPS, "outputs": READ}


def native(built, given, over_time=lambda time: {}):
    """Run the native FMU so, with inputs and their rates over time: columns of READ."""
    start = {name: value for name, (value, _) in over_time(0.0).items()}
    with Fmu(built / "InertiaModule.fmu", given["parameters"], given["inputs"] | start) as fmu:
        rows = [fmu.read(READ)]
        for n in range(given["steps"]):
            now = over_time(n * given["step"])
            fmu.set(**{name: value for name, (value, _) in now.items()})
            fmu.set_rates(**{name: rate for name, (_, rate) in now.items()})
            fmu.advance(given["step"])
            rows.append(fmu.read(READ))
    return dict(zip(READ, np.array(rows).T, strict=True))


@pytest.mark.parametrize("case", CASES)
def test_simulate_is_the_native_fmu_in_every_output(still, built, case):
    given = options(CASES[case])
    expected, found = native(built, given), still.simulate(given)
    assert found["time"] == pytest.approx([n * STEP for n in range(STEPS + 1)], abs=0.0, rel=1e-15)
    off = {
        name: np.abs(np.array(found[name]) - values).max() / max(np.abs(values).max(), 1.0)
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
        given = options(values)
        with pytest.raises(FmuError) as refused:
            native(built, given)
        assert still.simulate(given) == str(refused.value), case


# up to speed and, by a jump, to another load
OVER_TIME = {
    "omega1": {"times": [0.0, 0.05, 0.2], "values": [0.0, 20.0, 120.0]},
    "load_torque": {"times": [0.0, 0.1, 0.1, 0.3], "values": [2.0, 2.0, 12.0, 8.0]},
}


def over_time(time):
    """Value of each input just after a time, and its rate until the next point."""
    found = {}
    for name, signal in OVER_TIME.items():
        points = list(zip(signal["times"], signal["values"], strict=True))
        before = max(n for n, point in enumerate(points) if point[0] <= time)
        (begin, value), (end, last) = points[before], [*points, (math.inf, points[-1][1])][before + 1]
        rate = (last - value) / (end - begin)
        found[name] = value + rate * (time - begin), rate
    return found


def test_inputs_over_time_are_straight_lines_as_the_fmu_takes_them(still, built):
    given = {**options({}), "steps": 400}  # beyond the last point
    found = still.simulate({**given, "inputs": OVER_TIME})
    for name, values in native(built, given, over_time).items():
        assert found[name] == pytest.approx(values, rel=1e-9, abs=1e-9 * max(np.abs(values).max(), 1.0)), name


def test_integrate_is_simulate_in_slices_with_angles_whole(still):
    given = options({**scenes.PLANAR, "tolerance": 1e-12})  # which takes some slices
    run = still.ask("integrate", {**given, "duration": 2.0})
    at_once = still.simulate({**given, "steps": 2000})
    assert run["complete"]
    assert run["calls"] > 1
    assert run["time"] == at_once["time"]
    assert {name: run["columns"][name] for name in READ} == {name: at_once[name] for name in READ}
    turned = np.array(at_once["drive_angle"]) + 2.0 * np.pi * np.array(at_once["drive_turns"])
    assert run["columns"]["q"] == pytest.approx(turned, rel=1e-15)


def test_run_that_is_refused_on_its_way_keeps_what_it_has(still):
    given = options({"load_torque": 10.0})
    given["inputs"]["omega1"] = {"times": [0.0, 0.0105, 0.0105], "values": [100.0, 100.0, 1e300]}
    run = still.ask("integrate", {**given, "duration": 1.0})
    assert not run["complete"]
    assert len(run["time"]) == len(run["columns"]["omega2"]) == 12
    assert run["error"] == still.simulate(given)
    assert run["error"].startswith("omega1 must be between ")


def test_warnings_are_those_of_the_native_fmu(still, built):
    given = options({"layout": 1, "eccentricity": 0.05, "satellites": 12, "omega1": 10.0})
    run = still.ask("integrate", {**given, "duration": 0.01})
    with Fmu(built / "InertiaModule.fmu", given["parameters"], given["inputs"]) as fmu:
        assert run["warnings"] == fmu.warnings
    assert len(run["warnings"]) == 2


def test_thousand_instances_take_the_memory_of_one(still):
    """Instances are given back, also those that are refused."""
    good = {**options({"omega1": 100.0}), "steps": 2, "outputs": ["omega_out"]}
    bad = {**good, "parameters": {"tolerance": 7.0}}
    assert still.ask("thousand", [good, bad]) == still.simulate(good)["omega_out"][-1]


# --- the command view, and run --view: a page whole or not at all ---


EXAMPLES = ROOT / "examples"
ENGINE = EXAMPLES / "engine.toml"
COARSE = Path(__file__).with_name("coarse.toml")
MOST_BYTES = 2_500_000


def check_page(page):
    """It opens from disk, asks for nothing and is no larger than a page may be."""
    page.page.wait_for_timeout(500)
    assert (page.errors, page.requests) == ([], [])
    assert page.path.stat().st_size < MOST_BYTES


def table_of(scene, fmu, folder):
    """Run a scene by the command; its table."""
    left("run", scene, "-o", folder, "--fmu", fmu)
    return Result.from_csv(folder / "table.csv")


def test_run_is_played_as_it_was_recorded(opened, fmu, tmp_path):
    """The load of this scene follows the motion: the page cannot run it, so it holds the run."""
    page, table = opened(ENGINE), table_of(ENGINE, fmu, tmp_path)
    check_page(page)
    start, played = page.page.evaluate("window.inertiaModule.start"), page.ask("played")
    every = start["run"]["every"]
    assert not start["scene"]["exact"]
    assert start["scene"]["inputs"]["load_torque"] == pytest.approx(table["load_torque"].mean(), rel=1e-3)
    assert start["scene"]["inputs"]["drive_torque"]["values"] == [0.0, 40.0, 25.0, 15.0]
    assert played["time"] == pytest.approx(table.time[::every], abs=1e-9)
    assert played["omega_out"] == pytest.approx(table["omega_out"][::every], rel=1e-7)
    assert np.diff(played["q"]).max() < 0.4 * every  # no whole turn is lost between rows


def test_a_run_too_coarse_for_its_pulses_shows_means_and_dots_in_place_of_curves(opened, fmu, tmp_path):
    page = opened(COARSE, reduced_motion="reduce")
    mean = table_of(COARSE, fmu, tmp_path)["mesh_torque_mean"][50]
    page.page.get_by_role("slider", name="time", exact=True).fill("5000")
    page.drawn()
    speeds, torques = (panel.inner_text() for panel in page.page.locator(".panel .legend").all())
    table = page.page.locator(".instruments").first.inner_text()
    assert "ω2 link 2, instantaneous" in speeds
    (told,) = re.findall(r"M2 mesh, mean\s+(\S+)\s+N·m", torques)
    (now,) = re.findall(r"step-averaged torques.*mesh torque, M2\s+(\S+)", table, re.S)
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


def test_page_or_report_that_cannot_be_made_or_written_is_refused_before_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr("inertia_module.scene.run_scene", lambda *_, **__: pytest.fail("it was run"))
    (tmp_path / "folder.html").mkdir()
    (tmp_path / "file").write_text("a file")
    shaft, missing = EXAMPLES / "papers" / "stelmashchuk_stepping.toml", tmp_path / "template.html"
    told = "error: the viewer has not been built. Run `make page` in a clone, or install the wheel.\n"
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
        (missing, ("view", REFERENCE), "page.html", told),
        (missing, ("run", REFERENCE, "--view"), "page.html", told),
    ):
        monkeypatch.setattr(html, "TEMPLATE", template)
        is_one_line(command(*arguments, "-o", tmp_path / place), sentence)
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
