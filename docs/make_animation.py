"""Record the mechanism in motion: docs/mechanism.webp, by the page itself in headless Chromium.

make build page && .venv/bin/python docs/make_animation.py
"""

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[1]
# scene R1 over two turns of link 1 at 100 rad/s, slowed down 40 times
BEGIN, TURNS, FRAMES, SLOWER = 0.6, 2, 64, 40
SPAN = TURNS * 2.0 * np.pi / 100.0
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
]
WIDTH = 680


def frames(page):
    """Pictures of mechanism and curves at equal steps of time."""
    machine, curves = (page.locator(part).bounding_box() for part in ("#machine", "#curves"))
    clip = {**machine, "height": curves["y"] + curves["height"] - machine["y"]}
    for time in BEGIN + SPAN * np.arange(FRAMES) / FRAMES:
        page.evaluate("time => inertiaModule.seek(time)", time)
        # while frames are slow the viewer draws fewer pixels
        page.wait_for_function("inertiaModule.state().pixelRatio >= 1")
        # the mechanism follows in the next frame, the curves in the same or the following frame
        for _ in range(4):
            page.evaluate("new Promise(requestAnimationFrame)")
        picture = Image.open(io.BytesIO(page.screenshot(clip=clip))).convert("RGB")
        yield picture.resize((WIDTH, round(WIDTH * picture.height / picture.width)), Image.Resampling.LANCZOS)


def main():
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        path = Path(folder) / "page.html"
        scene = ROOT / "examples" / "reference.toml"
        subprocess.run(
            [sys.executable, "-m", "inertia_module", "view", scene, "-o", path], check=True, cwd=ROOT
        )
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(
            viewport={"width": 1280, "height": 860}, color_scheme="light", reduced_motion="reduce"
        )
        page.goto(path.as_uri())
        page.wait_for_function("window.inertiaModule && inertiaModule.state().run?.complete")
        page.get_by_label("Time range of the curves").select_option("2")
        first, *others = frames(page)
        browser.close()
    written = ROOT / "docs" / "mechanism.webp"
    milliseconds = round(1e3 * SLOWER * SPAN / FRAMES)
    first.save(
        written, save_all=True, append_images=others, duration=milliseconds, loop=0, quality=60, method=4
    )
    print(f"{written}: {written.stat().st_size / 1e6:.2f} MB, {FRAMES} frames")


main()
