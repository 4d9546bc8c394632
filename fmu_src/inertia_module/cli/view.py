"""The command that shows a scene in a browser."""

from __future__ import annotations

import json
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from ..common.files import OUTPUT_FOLDER
from .scenes import at_fidelity
from .shared import PAGE, FmuToRun, Json, Keys, app, current_fmu, one_line_errors


@app.command()
def view(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.html", help="The page (out/SCENE/page.html)."),
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open it in the browser.")] = False,
    fmu: FmuToRun = None,
    keys: Keys = None,
    as_json: Json = False,
) -> None:
    """Leave a scene as a page that shows the machine moving.

    It is one HTML file, with the kernel in it. What the page cannot integrate itself, a load that follows
    the motion or a controller, is run here first and played in it.
    """
    from ..common.files import write_atomically
    from ..contract.variables import COMPUTED
    from ..harness.simulate import progress_bar
    from ..page.html import checked_path, html_file, is_exact, template
    from ..scene import Scene, load_any_scene, run_scene
    from ..scene.keys import keys_of

    with one_line_errors():
        path = checked_path(output or OUTPUT_FOLDER / scene.stem / PAGE)
        template()
        found = load_any_scene(scene, keys_of(keys))
        if not isinstance(found, Scene):
            raise ValueError(f"{scene.name} must be a scene of the module, is one of a driven shaft")
        read, _ = at_fidelity(found, None, None)
        outcome = None
        if not is_exact(read):
            with progress_bar(read.title) as progress:
                outcome = run_scene(read, fmu or current_fmu(), progress, COMPUTED)
        content = html_file(read, outcome)
        write_atomically(path, content)
    if as_json:
        warnings = [] if outcome is None else list(outcome.warnings)
        typer.echo(
            json.dumps({"scene": str(scene), "page": str(path), "bytes": len(content), "warnings": warnings})
        )
    else:
        typer.echo(f"page: {path} ({len(content) / 1e6:.1f} MB)")
    if show:
        webbrowser.open(path.absolute().as_uri())
