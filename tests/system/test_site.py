"""Test the documentation site in Chromium, at the width of a desktop and of a phone."""

import contextlib
import functools
import http.server
import os
import threading
from pathlib import Path

import pytest

from inertia_module.viewer.html import TEMPLATE
from tests.system.chromium import FONTS, serious_faults, set_font
from tests.system.programs import process

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "out" / "site"
WIDTHS = {"desktop": 1440, "phone": 360}
LOOKS = Path(__file__).with_name("site.js").read_text()
# Paths of the first search results.
FOUND = "links => links.map(link => new URL(link.href).pathname.slice(1)).filter(page => page)"
TABLES = {
    *("reference/variables.html", "reference/api.html", "reference/commands.html", "papers/index.html"),
    *("verification/performance.html", "verification/stability.html", "changelog.html"),
}
# A page of each kind: start, program with output, guide, table, formulas, measurements.
KINDS = (
    *("index.html", "tutorial/index.html", "how_to/fidelity.html", "reference/variables.html"),
    *("explanation/mechanics.html", "verification/performance.html"),
)
# Pages without text.
NO_TEXT = {"404.html", "machine.html"}


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Build the site as `make docs` does, serve it on this machine, and return its address and folder."""
    pytest.importorskip("material", reason="mkdocs-material is not installed")
    if not TEMPLATE.exists():
        pytest.skip("the page is not built: `make page` builds it")
    folder = tmp_path_factory.mktemp("site")
    process("-m", "mkdocs", "build", "--strict", "-d", folder, folder=ROOT)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/", folder
    server.shutdown()


@pytest.fixture
def visit(site, browser):
    """Return a function that opens a page of the site at a width in pixels."""
    address, _ = site
    with contextlib.ExitStack() as pages:

        def open_page(path, width="desktop"):
            page = pages.enter_context(browser.new_page(viewport={"width": WIDTHS[width], "height": 800}))
            page.goto(address + path)
            return page

        yield open_page


@pytest.mark.parametrize("width", WIDTHS)
def test_every_page_fits_this_width_in_any_font_without_network(site, visit, width):
    address, folder = site
    messages, requests = [], []
    page = visit("index.html", width)
    page.on("console", lambda message: message.type in ("error", "warning") and messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.on("request", lambda request: request.url.startswith(address) or requests.append(request.url))
    formulas = 0
    for path in sorted(folder.rglob("*.html")):
        name = path.relative_to(folder).as_posix()
        if name in NO_TEXT:
            continue
        page.goto(address + name, wait_until="load")
        if width == "desktop":
            assert page.locator("nav.md-nav--primary a[href$='machine.html']").is_visible(), name
        for look in ("rawFormulas", "unseenFormulas", "unloaded"):
            assert page.evaluate(f"{LOOKS}.{look}") == [], (name, look)
        for font in FONTS:
            set_font(page, font)
            for look in ("hangingOver", "broken", *(["scrolling"] if width == "desktop" else [])):
                assert page.evaluate(f"{LOOKS}.{look}") == [], (name, font, look)
            assert page.evaluate("document.documentElement.scrollWidth") <= WIDTHS[width], (name, font)
        formulas += page.locator("math").count()
        if "INERTIA_MODULE_PICTURES" in os.environ:  # Screenshots for review take half a minute.
            page.screenshot(path=PICTURES / f"{name.replace('/', '_')}_{width}.png", full_page=True)
    assert (messages, requests) == ([], [])
    assert formulas > 200


def test_machine_opens_from_the_first_page(visit):
    page = visit("index.html")
    page.locator("article a[href='machine.html']").click()
    page.wait_for_function("window.inertiaModule")


def test_long_page_has_a_button_to_the_top(visit):
    page = visit("explanation/mechanics.html", "phone")
    top = page.get_by_role("link", name="↑ top")
    for share in (0.3, 0.95):
        page.evaluate(f"scrollTo(0, {share} * document.documentElement.scrollHeight)")
        assert 0 < top.bounding_box()["y"] < page.viewport_size["height"]
        top.click()
        page.wait_for_function("scrollY === 0")


def test_search_finds_guides_before_tables(visit):
    for words in ("fidelity", "load torque", "freewheel", "step size"):
        page = visit(f"index.html?q={words}")
        page.wait_for_selector("a.md-search-result__link", state="attached")
        first, *_ = page.eval_on_selector_all("a.md-search-result__link", FOUND)
        assert first not in TABLES, words


def test_search_works_offline_from_a_folder(site, browser):
    _, folder = site
    page = browser.new_page()
    requests = []
    page.on("request", lambda request: request.url.startswith("file:") or requests.append(request.url))
    page.goto(f"{(folder / 'how_to' / 'run.html').as_uri()}?q=freewheel")
    page.wait_for_selector("a.md-search-result__link", state="attached")
    assert requests == []
    page.close()


def test_every_figure_links_to_its_file_and_a_caption_of_the_papers_is_text(visit):
    page = visit("papers/index.html")
    figures = page.locator("article figure")
    assert figures.count() > 20
    assert figures.locator("a[href$='.svg']").count() == figures.count()
    assert all("=" in caption for caption in figures.locator("figcaption").all_text_contents())


def test_site_is_dark_if_the_reader_prefers_it_and_links_are_underlined(site, browser):
    address, _ = site
    page = browser.new_page(color_scheme="dark")
    page.goto(address + "index.html")
    lightness = "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)"
    assert max(page.evaluate(lightness)) < 80
    line = page.locator("article p a").first.evaluate("link => getComputedStyle(link).textDecorationLine")
    assert line == "underline"
    page.close()


@pytest.mark.parametrize(("scheme", "width"), [("light", "phone"), ("dark", "desktop")])
def test_axe_finds_no_serious_fault(site, browser, scheme, width):
    address, _ = site
    page = browser.new_page(viewport={"width": WIDTHS[width], "height": 800}, color_scheme=scheme)
    for name in KINDS:
        page.goto(address + name)
        assert serious_faults(page) == [], name
    page.close()


def test_wide_table_takes_the_focus_and_a_narrow_one_does_not(visit):
    page = visit("reference/variables.html", "phone")
    boxes = page.locator(".md-typeset__scrollwrap")
    focusable = "boxes => boxes.map(box => [box.scrollWidth > box.clientWidth, box.tabIndex === 0])"
    scrolls, focuses = zip(*boxes.evaluate_all(focusable), strict=True)
    assert scrolls == focuses
    assert any(scrolls)
    page.set_viewport_size({"width": 2000, "height": 800})
    page.wait_for_function("!document.querySelector('.md-typeset__scrollwrap[tabindex]')")


def test_site_has_no_byte_code(site):
    _, folder = site
    assert not [path for path in folder.rglob("*") if path.suffix == ".pyc" or path.name == "__pycache__"]
