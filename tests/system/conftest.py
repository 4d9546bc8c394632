"""Chromium, in which the page is opened as people open it: from disk."""

import contextlib
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from inertia_module.cli import app
from inertia_module.page.html import TEMPLATE

ROOT = Path(__file__).parents[2]
OUT, REFERENCE = ROOT / "out" / "page", ROOT / "examples" / "reference.toml"
# no sandbox: the tests may run as root. WebGL without a graphics card; nothing that calls home
FLAGS = (
    *("--no-sandbox", "--no-first-run", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
)


class Opened:
    """A page in the browser, and what it has said and asked for since.

    Attributes:
        page: of Playwright. path: the file.
        errors: on the console or thrown. requests: URLs besides the file.
    """

    def __init__(self, page, path):
        self.page, self.path = page, path
        self.errors, self.requests = [], []
        page.on("console", lambda said: said.type == "error" and self.errors.append(said.text))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda asked: asked.url != self.url and self.requests.append(asked.url))
        page.goto(self.url)
        page.wait_for_function("window.inertiaModule")

    @property
    def url(self):
        """Of the file, without what follows #."""
        return self.path.absolute().as_uri()

    def simulate(self, options):
        """Arrays by name from the page's own simulate, or the sentence it refuses with."""
        return self.page.evaluate(
            """options => {
              try {
                const found = window.inertiaModule.simulate(options);
                return Object.fromEntries(Object.entries(found).map(([name, array]) => [name, [...array]]));
              } catch (error) {
                return error.message;
              }
            }""",
            options,
        )

    def keep_picture(self, name):
        """Leave a screenshot in out/page."""
        OUT.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=OUT / f"{name}.png")


@pytest.fixture(scope="session")
def browser():
    """Debian's Chromium."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=chromium, args=[*FLAGS])
        yield found
        found.close()


@pytest.fixture(scope="session")
def written(built, tmp_path_factory):
    """A function from a scene file to its page, by `inertia-module view`."""
    if not TEMPLATE.exists():
        pytest.skip("the page is not built: `make page` builds it")
    folder = tmp_path_factory.mktemp("pages")

    def write(scene):
        path = folder / f"{Path(scene).stem}.html"
        if not path.exists():
            done = CliRunner().invoke(
                app, ["view", str(scene), "-o", str(path), "--fmu", str(built / "InertiaModule.fmu")]
            )
            assert done.exit_code == 0, done.output
        return path

    return write


@pytest.fixture
def opened(browser, written):
    """A function that opens the page of a scene file, with options of Playwright's new_page."""
    with contextlib.ExitStack() as pages:
        yield lambda scene, **options: Opened(
            pages.enter_context(browser.new_page(**options)), written(scene)
        )


@pytest.fixture(scope="module")
def still(browser, written):
    """The page of scene R1, not moving: for what it computes."""
    with browser.new_page(reduced_motion="reduce") as page:
        yield Opened(page, written(REFERENCE))
