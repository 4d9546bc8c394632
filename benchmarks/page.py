"""Scene R1 by the kernel in the page and by the compiled kernel, in turns, written into docs/performance.csv.

The page runs in headless Chromium; its time holds all that its simulate does. The compiled kernel is timed
without the Python around its calls.
Run: make page, then python benchmarks/page.py
"""

import shutil
import statistics
import tempfile
from pathlib import Path

from figures import R1, keep_parts
from playwright.sync_api import sync_playwright

from inertia_module.memory.instances import Module
from inertia_module.page.html import html_file
from inertia_module.scene import load_scene
from inertia_module.studies.timing import kernel_time

SCENE = Path(__file__).parents[1] / "examples" / "reference.toml"
STEPS = {"one step of 1 s": 1, "steps of 1 ms": 1000}
ROUNDS = 31
# runs before the browser has compiled all it wants to, and in a row for a clock of 0.1 ms
WARM_UP, IN_A_ROW = 300, 20
RUNS = """([inputs, steps, count]) => {
  const options = { parameters: {}, inputs, step: 1 / steps, steps, outputs: ["omega_out"] };
  const begin = performance.now();
  let last = 0;
  for (let n = 0; n < count; n++) last = window.inertiaModule.simulate(options).omega_out.at(-1);
  return [(performance.now() - begin) / count, last];
}"""


def native_time(steps):
    """Time of the compiled kernel for a second of R1, ms."""
    module = Module("compiled").start(**R1)
    given = [(R1["omega1"], R1["load_torque"], 0.0)] * steps
    return 1e3 * kernel_time(module, module.save(), given, 1.0 / steps, repeats=IN_A_ROW)


def measure(page):
    """Figures of both, and of their ratio in the same round."""
    figures = []
    for name, steps in STEPS.items():
        page.evaluate(RUNS, [R1, steps, WARM_UP])
        rounds = [(page.evaluate(RUNS, [R1, steps, IN_A_ROW])[0], native_time(steps)) for _ in range(ROUNDS)]
        browser, native = (statistics.median(times) for times in zip(*rounds, strict=True))
        ratio = statistics.median(one / other for one, other in rounds)
        print(f"{name}: page {browser:.3f} ms, compiled kernel {native:.3f} ms, ratio {ratio:.2f}")
        figures += [
            (name, "page", browser, "ms"),
            (name, "compiled kernel", native, "ms"),
            (name, "ratio", ratio, ""),
        ]
    return figures


def main():
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        path = Path(folder) / "page.html"
        path.write_bytes(html_file(load_scene(SCENE), None))
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        page = browser.new_page()
        page.goto(path.as_uri())
        page.wait_for_function("window.inertiaModule")
        keep_parts({"scene R1 in the page": measure(page)})
        browser.close()


if __name__ == "__main__":
    main()
