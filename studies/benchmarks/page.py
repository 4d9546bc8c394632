"""Scene R1 by the kernel in the page and by the compiled kernel, in turns, written into docs/performance.csv.

The page runs in headless Chromium; its time holds all that its simulate does. The compiled kernel is timed
without the Python around its calls. Each round takes the shortest of many runs.
Run: make page, then python -m studies.benchmarks.page
"""

import shutil
import statistics
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from inertia_module.kernel import codes
from inertia_module.memory import Module
from inertia_module.page.html import html_file
from inertia_module.scene import load_scene
from studies.benchmarks.figures import R1, keep_parts

SCENE = Path(__file__).parents[2] / "examples" / "reference.toml"
STEPS = {"steps of 1 s": 1, "steps of 1 ms": 1000}
# simulated time of a run, s: long enough for a clock of 0.1 ms
DURATION = 10
ROUNDS, RUNS = 11, 30
# runs before the browser has compiled all it wants to
WARM_UP = 100
SHORTEST = """([inputs, step, steps, runs]) => {
  const options = { parameters: {}, inputs, step, steps, outputs: ["omega_out"] };
  let shortest = Infinity;
  for (let n = 0; n < runs; n++) {
    const begin = performance.now();
    window.inertiaModule.simulate(options);
    shortest = Math.min(shortest, performance.now() - begin);
  }
  return shortest;
}"""


class ByKernel:
    """R1 by the compiled kernel."""

    def __init__(self):
        self.module = Module("compiled").start(**R1)
        self.begin = self.module.save()

    def shortest(self, size, steps):
        """Shortest time of RUNS runs of steps of this size, s, ms."""
        call, taken = self.module.call, []
        for _ in range(RUNS):
            self.module.restore(self.begin)
            begin = time.perf_counter()
            for _ in range(steps):
                call(codes.STEP, size)
            taken.append(time.perf_counter() - begin)
        return 1e3 * min(taken)

    def time(self, step, steps):
        """Time of the kernel alone: without what a call costs that is refused at once."""
        return self.shortest(step, steps) - self.shortest(-1.0, steps)


def measure(page):
    """Times of a simulated second by both, and the ratio of those of the same round."""
    figures, kernel = [], ByKernel()
    for name, per_second in STEPS.items():
        step, steps = 1.0 / per_second, DURATION * per_second
        page.evaluate(SHORTEST, [R1, step, steps, WARM_UP])
        rounds = [
            (page.evaluate(SHORTEST, [R1, step, steps, RUNS]), kernel.time(step, steps))
            for _ in range(ROUNDS)
        ]
        browser, native = (statistics.median(times) / DURATION for times in zip(*rounds, strict=True))
        ratio = statistics.median(one / other for one, other in rounds)
        print(f"{name}: page {browser:.3f} ms, compiled kernel {native:.3f} ms, ratio {ratio:.2f}")
        figures += [(name, "page", browser, "ms"), (name, "kernel", native, "ms"), (name, "ratio", ratio, "")]
    return figures


def main():
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        path = Path(folder) / "page.html"
        path.write_bytes(html_file(load_scene(SCENE), None))
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
