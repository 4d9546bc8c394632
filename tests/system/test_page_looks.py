"""The page on a phone and a desk, in light and dark, for a screen reader; and how quick it is."""

import pytest

from tests.system.chromium import FONTS, REFERENCE, ROOT, Opened, set_font
from tests.system.page_state import DESK, NEXT_FRAME, PHONE, settled, state

AXE = ROOT / "page" / "node_modules" / "axe-core" / "axe.min.js"

# boxes narrower than what is in them, all settings unfolded
TOO_NARROW = """() => {
  document.querySelectorAll('details').forEach(group => { group.open = true; });
  return [...document.querySelectorAll('body *:not(svg *)')].filter(
    box => getComputedStyle(box).display !== 'inline' && box.scrollWidth > box.clientWidth + 1
  ).map(box => `${box.tagName} ${box.className}: ${box.textContent.slice(0, 60)}`);
}"""


@pytest.mark.parametrize("font", FONTS)
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_nothing_hangs_over_in_any_font(opened, size, font):
    page = settled(opened(REFERENCE, viewport=size, reduced_motion="reduce"))
    set_font(page.page, font)
    page.page.evaluate(NEXT_FRAME)
    assert page.page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    assert page.page.evaluate(TOO_NARROW) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_axe_finds_no_serious_fault(opened, size, scheme):
    page = settled(opened(REFERENCE, viewport=size, color_scheme=scheme, reduced_motion="reduce"))
    if not AXE.exists():
        pytest.skip("axe-core is not installed: `make page` installs it")
    page.page.evaluate(AXE.read_text())
    found = page.page.evaluate("axe.run()")["violations"]
    serious = [
        (fault["id"], node["target"], node["failureSummary"])
        for fault in found
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]
    assert serious == []
    page.keep_picture(f"{size['width']}-{scheme}")


def test_theme_can_be_switched(opened):
    page = opened(REFERENCE)
    paper = "getComputedStyle(document.body).backgroundColor"
    before = page.page.evaluate(paper)
    page.page.get_by_role("button", name="Light or dark").click()
    assert page.page.evaluate(paper) != before


def test_first_picture_and_frames_are_quick(browser, written):
    """In time of the processor, for others may be at work on this machine."""
    with browser.new_page(viewport=DESK, reduced_motion="no-preference") as page:
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})

        def spent(what):
            metrics = session.send("Performance.getMetrics")["metrics"]
            return next(metric["value"] for metric in metrics if metric["name"] == what)

        opened = Opened(page, written(REFERENCE))
        settled(opened)
        assert spent("TaskDuration") < 1.5
        page.wait_for_timeout(2000)
        before = spent("ScriptDuration")
        page.evaluate("window.drawn = 0; (function count() { drawn++; requestAnimationFrame(count); })()")
        page.wait_for_function("drawn > 20")
        frame = (spent("ScriptDuration") - before) / page.evaluate("drawn")
        assert 0 < frame < 8e-3
        assert state(opened, "playing")
