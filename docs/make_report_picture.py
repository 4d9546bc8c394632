"""Draw how_to/report.png: some pages of a printed report. Needs Chromium and pdftoppm (poppler-utils)."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

HERE = Path(__file__).parent
SCENE = HERE.parent / "examples" / "real_machine.toml"
# pages in the picture, dots per inch, pixels between pages
PAGES, DPI, GAP = (1, 4, 5, 9), 54, 8


def main():
    with tempfile.TemporaryDirectory() as folder:
        page_file, printed = Path(folder) / "report.html", Path(folder) / "report.pdf"
        subprocess.run(["inertia-module", "report", SCENE, "-o", page_file], check=True)
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page()
            page.goto(page_file.as_uri())
            page.pdf(path=printed, prefer_css_page_size=True)
        subprocess.run(["pdftoppm", "-r", str(DPI), "-png", printed, Path(folder) / "page"], check=True)
        files = sorted(Path(folder).glob("page-*.png"))
        pages = [Image.open(files[number - 1]) for number in PAGES]
        width, height = pages[0].size
        picture = Image.new("RGB", (len(pages) * (width + GAP) + GAP, height + 2 * GAP), "#b0b0b0")
        for n, page_image in enumerate(pages):
            picture.paste(page_image, (GAP + n * (width + GAP), GAP))
        picture.quantize(128).save(HERE / "how_to" / "report.png", optimize=True)


if __name__ == "__main__":
    main()
