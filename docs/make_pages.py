"""Writes the generated pages of the documentation; with --check only tells whether they are up to date."""

import sys
from pathlib import Path

from inertia_module.fmu.documentation import variables_page

HERE = Path(__file__).parent
README = HERE.parent / "README.md"


def start_page():
    """The README, with its links turned from the project's root to this folder."""
    return README.read_text().replace("](docs/", "](").replace('src="docs/', 'src="')


PAGES = {"variables.md": variables_page, "index.md": start_page}


def main():
    stale = []
    for name, page in PAGES.items():
        path = HERE / name
        if not path.exists() or path.read_text() != page():
            stale.append(name)
            if "--check" not in sys.argv:
                path.write_text(page())
    if stale and "--check" in sys.argv:
        sys.exit(f"docs/{', docs/'.join(stale)} are out of date: run python docs/make_pages.py")


if __name__ == "__main__":
    main()
