"""Writes the generated pages of the documentation; with --check only tells whether they are up to date."""

import re
import sys
from decimal import Decimal
from pathlib import Path

import coupling_page
import performance_page
import random_page
import stability_page

from inertia_module.fmu.documentation import guide, variables_page
from studies.papers.page import papers_page

HERE = Path(__file__).parent
README = HERE.parent / "README.md"
# a link of the README to what is not in this folder
OUTSIDE = re.compile(r"(?<!!)\[([^]]+)\]\((?!docs/|https?:|#)[^)]+\)")
# what the site has beside it (hooks.py)
MACHINE = "\n**[Interactive machine](machine.html)**: turn it and change its parameters in your browser.\n"
# a place in a page for a section of a guide, which stands in the documentation of the FMU too
SECTION = re.compile(r"(<!-- (\w+): (.*?) -->\n).*?(<!-- end -->)", re.S)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def start_page():
    """The README, with its links turned from the project's root to this folder; others are none."""
    text = OUTSIDE.sub(r"\1", README.read_text())
    text = text.replace("\n## How it works", f"{MACHINE}\n## How it works", 1)
    return text.replace("](docs/", "](").replace('src="docs/', 'src="')


def filled(name, values):
    """A page from its template, whose places are filled with figures of committed tables."""
    return (HERE / "templates" / name).read_text().format_map(values)


def with_sections(name):
    """A page with the sections of guides in their places."""
    text = (HERE / name).read_text()
    return SECTION.sub(lambda found: f"{found[1]}\n{guide(found[2])[found[3]]}\n\n{found[4]}", text)


PAGES = {
    "variables.md": variables_page,
    "papers.md": papers_page,
    "stability.md": lambda: filled("stability.md", stability_page.values()),
    "random.md": lambda: filled("random.md", random_page.values()),
    "performance.md": lambda: filled("performance.md", performance_page.values()),
    "coupling.md": coupling_page.page,
    "index.md": start_page,
    "fmu.md": lambda: with_sections("fmu.md"),
}


def is_current(path, text):
    """Whether a page is what would be written now, but for the last digit of figures of the papers."""
    if not path.exists():
        return False
    found = path.read_text()
    return same_figures(found, text) if path.name == "papers.md" else found == text


def same_figures(found, text):
    """Whether two texts have the same words, and figures that differ by one in the last digit at most."""
    if NUMBER.sub("#", found) != NUMBER.sub("#", text):
        return False
    pairs = zip(map(Decimal, NUMBER.findall(found)), map(Decimal, NUMBER.findall(text)), strict=True)
    return all(abs(one - other) <= Decimal(1).scaleb(one.as_tuple().exponent) for one, other in pairs)


def main():
    stale = []
    for name, page in PAGES.items():
        path = HERE / name
        text = page()
        if not is_current(path, text):
            stale.append(name)
        if "--check" not in sys.argv:
            path.write_text(text)
    if stale and "--check" in sys.argv:
        sys.exit(f"docs/{', docs/'.join(stale)} are out of date: run python docs/make_pages.py")


if __name__ == "__main__":
    main()
