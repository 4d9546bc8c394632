"""Write the generated pages of the documentation; with --check only compare them."""

import re
import sys
from decimal import Decimal
from pathlib import Path

import coupling_page
import performance_page
import stability_page
from commands_page import commands_page
from outside import DRAWING

from inertia_module.fmu.documentation import guide, variables_page
from papers.page import papers_page

HERE = Path(__file__).parent
README = HERE.parent / "README.md"
# link of the README to a file outside this folder
OUTSIDE = re.compile(r"(?<!!)\[([^]]+)\]\((?!docs/|https?:|#)[^)]+\)")
# pages and pictures that only the site contains (hooks.py), by their file outside this folder
SITE_PAGES = {
    DRAWING: Path(DRAWING).name,
    "examples/tutorial.ipynb": "tutorial/index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
MACHINE = "\n**[Interactive machine](machine.html)**: turn it and change its parameters in your browser.\n"
# placeholder for a section of a guide, which the documentation in the FMU contains too
SECTION = re.compile(r"(<!-- (\w+): (.*?) -->\n).*?(<!-- end -->)", re.S)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def start_page():
    """Return the README with links relative to this folder; links to other files become plain text."""
    text = README.read_text()
    for outside, page in SITE_PAGES.items():
        text = text.replace(f"]({outside})", f"](docs/{page})")
    text = OUTSIDE.sub(r"\1", text)
    text = text.replace("\n## How it works", f"{MACHINE}\n## How it works", 1)
    return text.replace("](docs/", "](").replace('src="docs/', 'src="')


def render(name, values):
    """Return a page from its template, filled with values of committed tables."""
    return (HERE / "templates" / name).read_text().format_map(values)


def with_sections(name):
    """Return a page with the sections of the guides filled in."""
    text = (HERE / name).read_text()
    return SECTION.sub(lambda match: f"{match[1]}\n{guide(match[2])[match[3]]}\n\n{match[4]}", text)


PAGES = {
    "index.md": start_page,
    "how_to/tools.md": lambda: with_sections("how_to/tools.md"),
    "reference/commands.md": commands_page,
    "reference/fmu.md": lambda: with_sections("reference/fmu.md"),
    "reference/variables.md": variables_page,
    "verification/coupling.md": coupling_page.page,
    "verification/performance.md": lambda: render("performance.md", performance_page.values()),
    "verification/stability.md": lambda: render("stability.md", stability_page.values()),
    "papers/index.md": papers_page,
}
# pages whose numbers depend on the last digits of this machine
COMPUTED = ("papers/index.md",)


def is_current(name, text):
    """Return True if a page equals the new text; numbers of the papers may differ in the last digit."""
    path = HERE / name
    if not path.exists():
        return False
    old = path.read_text()
    return same_figures(old, text) if name in COMPUTED else old == text


def same_figures(old, new):
    """Return True if two texts have equal words, and numbers that differ by at most 1 in the last digit."""
    if NUMBER.sub("#", old) != NUMBER.sub("#", new):
        return False
    pairs = zip(map(Decimal, NUMBER.findall(old)), map(Decimal, NUMBER.findall(new)), strict=True)
    return all(abs(a - b) <= Decimal(1).scaleb(a.as_tuple().exponent) for a, b in pairs)


def main():
    stale = []
    for name, page in PAGES.items():
        text = page()
        if not is_current(name, text):
            stale.append(name)
        if "--check" not in sys.argv:
            (HERE / name).write_text(text)
    if stale and "--check" in sys.argv:
        sys.exit(f"docs/{', docs/'.join(stale)} are out of date: run python docs/make_pages.py")


if __name__ == "__main__":
    main()
