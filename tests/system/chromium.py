"""Chromium: content, console messages and requests of a page."""

import base64
from pathlib import Path

import matplotlib
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "examples" / "reference.toml"
PHONE, DESK = {"width": 360, "height": 740}, {"width": 1440, "height": 900}
SMALL = {"width": 640, "height": 480}
COARSE = {"viewport": SMALL, "device_scale_factor": 0.25}  # Small frames are fast without a graphics card.
# No sandbox, because the tests may run as root. WebGL without a graphics card. No background services.
FLAGS = (
    *("--no-sandbox", "--no-first-run", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
)

# Fonts of matplotlib and their letter spacing. Text has the same width on all machines, and is wider or
# narrower than in common fonts.
FONTS = {"narrow": ("STIXGeneral.ttf", "-0.02em"), "wide": ("DejaVuSansMono.ttf", "0.04em")}
AXE = ROOT / "viewer" / "node_modules" / "axe-core" / "axe.min.js"
AXE_RUN = "axe.run({ rules: { 'target-size': { enabled: true } } })"
PAGE_FUNCTIONS = Path(__file__).with_name("page.js").read_text()


def set_font(page, name):
    """Show a page of Playwright in one of FONTS, except its formulas."""
    file, spacing = FONTS[name]
    data = base64.b64encode((Path(matplotlib.get_data_path()) / "fonts" / "ttf" / file).read_bytes()).decode()
    page.add_style_tag(
        content=f"@font-face {{ font-family: {name}; src: url(data:font/ttf;base64,{data}); }}"
        f" :not(math, math *) {{ font-family: {name} !important; letter-spacing: {spacing} !important; }}"
    )
    page.evaluate(f"document.fonts.load('16px {name}')")


def serious_faults(page):
    """Return the serious faults that axe-core finds in a page of Playwright as it is."""
    if not AXE.exists():
        pytest.skip("axe-core is not installed: `make page` installs it")
    if not page.evaluate("'axe' in window"):
        page.evaluate(AXE.read_text())
    return [
        (fault["id"], node["target"], node["failureSummary"])
        for fault in page.evaluate(AXE_RUN)["violations"]
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]


class Opened:
    """Page in the browser with its messages and requests.

    Attributes:
        page: Page of Playwright.
        path: Path of the file.
        errors: Errors on the console, and exceptions.
        requests: Requested URLs except the file.
    """

    def __init__(self, page, path):
        self.page, self.path = page, path
        self.errors, self.requests = [], []
        page.on("console", lambda message: message.type == "error" and self.errors.append(message.text))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: request.url != self.url and self.requests.append(request.url))
        page.goto(self.url)
        page.wait_for_function("window.inertiaModule")

    @property
    def url(self):
        """Return the URL of the file without the fragment."""
        return self.path.absolute().as_uri()

    def at(self, change):
        """Load the page at another address, and return it after the integration has ended."""
        self.page.goto("about:blank")
        self.page.goto(self.url + change)
        self.page.wait_for_function("window.inertiaModule")
        return self.integrated()

    def integrated(self):
        """Wait until the integration has ended, and return the page."""
        self.page.wait_for_function("inertiaModule.state().run?.complete && !inertiaModule.state().busy")
        return self

    def drawn(self):
        """Return the page after changes are drawn, at the latest with the second next frame."""
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return self

    def state(self, name):
        """Return a part of the state of the page."""
        return self.page.evaluate(f"inertiaModule.state().{name}")

    def ask(self, name, *arguments):
        """Return the value of a function of page.js."""
        return self.page.evaluate(f"{PAGE_FUNCTIONS}.{name}", *arguments)

    def column(self, name):
        """Return the displayed column of the run."""
        return np.array(self.ask("shown", name))

    def press(self, name):
        """Press a button."""
        self.page.get_by_role("button", name=name, exact=True).click()

    def simulate(self, options):
        """Return arrays by name from the function `simulate` of the page, or the error message."""
        return self.ask("simulate", options)
