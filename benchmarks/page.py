"""Scene R1 by the kernel in the page and by the compiled kernel, in turns, written into docs/verification/performance.csv.

The page runs in headless Chromium; its time holds all that its simulate does. The compiled kernel is timed
without the Python around its calls. Each round takes the median of many runs.
Run: make page, then python -m benchmarks.page
"""

import shutil
import statistics
import tempfile
from functools import partial
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.figures import R1, in_turns, keep_parts
from inertia_module.common.examples import example
from inertia_module.fidelity.trials import kernel_time
from inertia_module.model import Module
from inertia_module.scene import load_scene
from inertia_module.viewer.html import html_file

STEPS = {"steps of 1 s": 1, "steps of 1 ms": 1000}
# simulated time of a run, s: long enough for a clock of 0.1 ms
DURATION = 10
ROUNDS, RUNS = 11, 30
# runs before the browser has compiled all it wants to
WARM_UP = 100
MEDIAN = """([inputs, step, steps, runs]) => {
  const options = { parameters: {}, inputs, step, steps, outputs: ["omega_out"] };
  const times = Array.from({ length: runs }, () => {
    const begin = performance.now();
    window.inertiaModule.simulate(options);
    return performance.now() - begin;
  });
  return times.sort((one, other) => one - other)[runs >> 1];
}"""


def measure(page):
    """Times of a simulated second by both, and the ratio of those of the same round."""
    figures, module = [], Module("compiled").start(**R1)
    begin = module.save()
    for name, per_second in STEPS.items():
        step, steps = 1.0 / per_second, DURATION * per_second
        given = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
        page.evaluate(MEDIAN, [R1, step, steps, WARM_UP])
        ways = {
            "page": partial(page.evaluate, MEDIAN, [R1, step, steps, RUNS]),
            "kernel": lambda given=given, step=step: 1e3 * kernel_time(module, begin, given, step, RUNS),
        }
        times = in_turns(ways, ROUNDS)
        both = {way: statistics.median(of_way) / DURATION for way, of_way in times.items()}
        ratio = statistics.median(one / other for one, other in zip(*times.values(), strict=True))
        print(
            f"{name}: page {both['page']:.3f} ms, compiled kernel {both['kernel']:.3f} ms, ratio {ratio:.2f}"
        )
        figures += [(name, way, value, "ms") for way, value in both.items()] + [(name, "ratio", ratio, "")]
    return figures


def main():
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        path = Path(folder) / "page.html"
        path.write_bytes(html_file(load_scene(example("reference")), None))
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        page = browser.new_page(reduced_motion="reduce")  # it does not play
        page.goto(path.as_uri())
        page.wait_for_function("window.inertiaModule")
        keep_parts({"scene R1 in the page": measure(page)})
        browser.close()


if __name__ == "__main__":
    main()
