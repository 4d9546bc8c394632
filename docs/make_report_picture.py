"""Draw how_to/report.png: some sections of a report as they look in print. Needs Chromium."""

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

HERE = Path(__file__).parent
SCENE = HERE.parent / "examples" / "real_machine.toml"
# headings of the sections in the picture after the first page
SECTIONS = ("Curves", "Torque converter chart", "Orders")
# width of the printed area of A4 at 96 dots per inch, pixels, and height over width of a page
PAPER_WIDTH, ASPECT = 680, 1.414
# width of a page and margin in the picture, pixels
WIDTH, MARGIN = 420, 16


def sheet(content):
    """Return a page with a section at its top, as an image; a longer section is cut off."""
    image = Image.open(io.BytesIO(content)).convert("RGB")
    inner = WIDTH - 2 * MARGIN
    image = image.resize((inner, round(inner * image.height / image.width)), Image.Resampling.LANCZOS)
    page = Image.new("RGB", (WIDTH, round(ASPECT * WIDTH)), "white")
    page.paste(image.crop((0, 0, inner, min(image.height, page.height - 2 * MARGIN))), (MARGIN, MARGIN))
    return page


def main():
    """Make the report, take pictures of its sections and paste them side by side."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        file = Path(folder) / "report.html"
        subprocess.run(
            [sys.executable, "-m", "inertia_module", "report", SCENE, "-o", file], check=True, cwd=HERE.parent
        )
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(
            viewport={"width": PAPER_WIDTH, "height": 960}, color_scheme="light", device_scale_factor=2
        )
        page.emulate_media(media="print")
        page.goto(file.as_uri())
        sections = [page.locator("section.answer")]
        sections += [page.locator(f"section:has(> h2:text-is('{title}'))") for title in SECTIONS]
        sheets = [sheet(section.screenshot()) for section in sections]
        browser.close()
    gap = MARGIN // 2
    width, height = sheets[0].size
    picture = Image.new("RGB", (len(sheets) * (width + gap) + gap, height + 2 * gap), "#b0b0b0")
    for number, image in enumerate(sheets):
        picture.paste(image, (gap + number * (width + gap), gap))
    picture.quantize(128).save(HERE / "how_to" / "report.png", optimize=True)


if __name__ == "__main__":
    main()
