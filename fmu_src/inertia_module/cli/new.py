"""The command that leaves an example to begin with."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from .shared import Json, app, one_line_errors


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Example to copy: planar, reference, urban, ...")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE.toml", help="The scene file (NAME.toml).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Copy an example to files that are not there yet: the scene, and what was measured where it has that."""
    from ..common.examples import example
    from ..common.files import write_atomically

    with one_line_errors():
        source, scene = example(name), output or Path(f"{name}.toml")
        measured = source.with_suffix(".csv")
        files = {"scene": (source, scene)}
        if measured.exists():
            files["measured"] = (measured, scene.with_suffix(".csv"))
        for _, path in files.values():
            if path.exists():
                raise ValueError(f"{path} must be a new file, is there already: -o FILE.toml writes another")
        for origin, path in files.values():
            write_atomically(path, origin.read_bytes())
    listed = {kind: str(path) for kind, (_, path) in files.items()}
    if as_json:
        typer.echo(json.dumps(listed))
        return
    for kind, file in listed.items():
        typer.echo(f"{kind}: {file}")
    verb = "design" if "free" in tomllib.loads(source.read_text(encoding="utf-8")) else "run"
    typer.echo(f"next: inertia-module {verb} {scene}")
