"""Measure scene R1 in the viewer and in the compiled kernel alternately; update the table of results.

The viewer runs in headless Chromium, and its time includes its whole function simulate. The time of the
compiled kernel excludes the Python calls. Each round takes the median of many runs.
Run: make page, then python -m benchmarks.page
"""

import shutil
import statistics
import tempfile
from functools import partial
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.results_table import R1, alternating_results, update_table
from inertia_module.common.examples import example
from inertia_module.fidelity.timing import kernel_time
from inertia_module.model import Module
from inertia_module.scene import load_scene
from inertia_module.viewer.html import html_file

STEPS = {"steps of 1 s": 1, "steps of 1 ms": 1000}
# simulated time of a run, s; long enough for a clock resolution of 0.1 ms
DURATION = 10
ROUNDS, RUNS = 11, 30
# runs until the browser has compiled the code
WARM_UP = 100
MEDIAN = """([inputs, step, steps, runs]) => {
  const options = { parameters: {}, inputs, step, steps, outputs: ["omega_out"] };
  const times = Array.from({ length: runs }, () => {
    const begin = performance.now();
    window.inertiaModule.simulate(options);
    return performance.now() - begin;
  });
  return times.sort((a, b) => a - b)[runs >> 1];
}"""


def measure(page):
    """Measure the time of a simulated second in the viewer and in the kernel, and their ratio.

    Args:
        page: Page of Playwright with the viewer.

    Returns:
        List of (case, quantity, value, unit).
    """
    rows, module = [], Module("compiled").start(**R1)
    begin = module.save()
    for name, per_second in STEPS.items():
        step, steps = 1.0 / per_second, DURATION * per_second
        values = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
        page.evaluate(MEDIAN, [R1, step, steps, WARM_UP])
        calls = {
            "page": partial(page.evaluate, MEDIAN, [R1, step, steps, RUNS]),
            "kernel": lambda values=values, step=step: 1e3 * kernel_time(module, begin, values, step, RUNS),
        }
        times = alternating_results(calls, ROUNDS)
        medians = {way: statistics.median(samples) / DURATION for way, samples in times.items()}
        ratio = statistics.median(
            viewer_time / kernel_time_of_round
            for viewer_time, kernel_time_of_round in zip(*times.values(), strict=True)
        )
        print(
            f"{name}: page {medians['page']:.3f} ms, compiled kernel {medians['kernel']:.3f} ms,"
            f" ratio {ratio:.2f}"
        )
        rows += [(name, way, value, "ms") for way, value in medians.items()] + [(name, "ratio", ratio, "")]
    return rows


def main():
    """Open the viewer in Chromium, measure, and update the table."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        path = Path(folder) / "page.html"
        path.write_bytes(html_file(load_scene(example("reference")), None))
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        page = browser.new_page(reduced_motion="reduce")  # the viewer does not start playing
        page.goto(path.as_uri())
        page.wait_for_function("window.inertiaModule")
        update_table({"scene R1 in the page": measure(page)})
        browser.close()


if __name__ == "__main__":
    main()
