"""The page on a phone and a desk, in light and dark, for a screen reader; and how quick it is."""

import pytest

from tests.system.chromium import DESK, FONTS, PHONE, REFERENCE, ROOT, Opened, set_font

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
        sized.keep_picture(f"{sized.page.viewport_size['width']}-{scheme}")


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
