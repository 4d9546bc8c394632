"""Writes the generated pages of the documentation; with --check only tells whether they are up to date."""

import re
import sys
from pathlib import Path

from inertia_module.fmu.documentation import variables_page
from inertia_module.papers.page import papers_page
from inertia_module.studies.coupling.page import coupling_page
from inertia_module.studies.stability.page import stability_page
from inertia_module.studies.stability.table import read_rows

HERE = Path(__file__).parent
README = HERE.parent / "README.md"


def start_page():
    """The README, with its links turned from the project's root to this folder."""
    return README.read_text().replace("](docs/", "](").replace('src="docs/', 'src="')


def extremes_page():
    """The verdicts that are committed in stability.csv."""
    return stability_page(read_rows(HERE / "stability.csv"))


def measured_coupling():
    """The rows that are committed in coupling_*.csv."""
    return coupling_page(HERE)


PAGES = {
    "variables.md": variables_page,
    "papers.md": papers_page,
    "stability.md": extremes_page,
    "coupling.md": measured_coupling,
    "index.md": start_page,
}


def is_current(path, text):
    """Whether a page is what would be written now; measured figures may differ from machine to machine."""
    if not path.exists():
        return False
    found = path.read_text()
    if path.name == "papers.md":
        found, text = (re.sub(r"[-+]?\d[\d.e+-]*|rounding", "#", page) for page in (found, text))
    return found == text


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
