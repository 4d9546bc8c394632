"""What the page shows, read from it."""

import numpy as np

PHONE, DESK = {"width": 360, "height": 740}, {"width": 1440, "height": 900}
# column by name of the run that is shown, as a list
SHOWN = """name => {
  const { run } = inertiaModule.state();
  return [...(name === "time" ? run.time : run.columns[name])];
}"""

# what has changed is drawn by the frame after the one that is on its way
NEXT_FRAME = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def settled(page):
    """The page once nothing is being integrated."""
    page.page.wait_for_function("inertiaModule.state().run?.complete && !inertiaModule.state().busy")
    return page


def state(page, name):
    return page.page.evaluate(f"inertiaModule.state().{name}")


def at(page, change):
    """The same page at another address."""
    page.page.goto("about:blank")
    page.page.goto(page.url + change)
    page.page.wait_for_function("window.inertiaModule")
    return settled(page)


def shown(page, name):
    return np.array(page.page.evaluate(SHOWN, name))
