"""The HTML file: the template that `make page` leaves, with kernel, tables, scene and run in it."""

from __future__ import annotations

import html
import json
from pathlib import Path
from typing import Any

from ..common.errors import Refused, must_be
from ..common.files import writable_folder
from ..contract.models import INERTIA_MODULE
from ..fmu.builder import WEB_KERNEL, content_of
from ..scene import Scene, SceneResult
from .recording import packed, page_run
from .start import page_scene
from .tables import page_tables

TEMPLATE = Path(__file__).parent / "template.html"
# where it takes the presets, which `make page` fills in, and the rest
PRESETS, DATA = "<!-- PRESETS -->", "<!-- DATA -->"
TITLE = "<title>Inertia module</title>"


def template() -> str:
    """The page without data.

    Raises:
        Refused: it has not been made.
    """
    try:
        return TEMPLATE.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise Refused(
            "the page has not been built yet: `make page` in a clone builds it, and the wheel has it"
        ) from None


def checked_path(path: Path) -> Path:
    """The path, if an HTML file can be written there.

    Raises:
        Refused: its ending is another, or it is a folder. OSError: its folder cannot be written to.
    """
    if path.suffix.lower() != ".html":
        raise Refused(must_be("the page", "a file with the ending .html", str(path)))
    if path.is_dir():
        raise Refused(must_be("the page", "a file", f"the folder {path}"))
    writable_folder(path.parent)
    return path


def html_file(scene: Scene, outcome: SceneResult | None) -> bytes:
    """The HTML file of a scene.

    Args:
        scene: whose fidelity is chosen.
        outcome: its run with all of variables.COMPUTED, or None where the page is to integrate.

    Raises:
        Refused: the template has not been made. CompilationUnavailable: the kernel cannot be compiled.
    """
    record, run = None, None
    if outcome is not None:
        record, run = outcome.record, page_run(outcome.record, outcome.warnings)
    start = {"scene": page_scene(scene, record), "run": run}
    data = [
        f'<script id="kernel" type="text/plain">{packed(content_of(WEB_KERNEL)[0])}</script>',
        script("tables", page_tables(INERTIA_MODULE)),
        script("start", start),
    ]
    title = f"<title>{html.escape(scene.title)}</title>"
    return template().replace(TITLE, title, 1).replace(DATA, "\n".join(data), 1).encode()


def script(name: str, content: Any) -> str:
    """Data for the page to parse; nothing in it ends the element."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f'<script id="{name}" type="application/json">{text}</script>'
