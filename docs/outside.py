"""Files outside docs/ that the site shows."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
# section through the mechanism, which the documentation of the FMUs contains too (make_icons.py)
DRAWING = "fmu_src/inertia_module/fmu/pictures/module_named.png"


def page_from_root(name):
    """Return a Markdown page of the root folder with links relative to docs/."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return text.replace("](docs/", "](").replace("](CHANGELOG.md)", "](changelog.md)")
