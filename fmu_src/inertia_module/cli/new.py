"""The command that leaves an example to begin with."""

from __future__ import annotations

import json
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
    """Copy an example scene to a file that is not there yet: to run, view, chart and change."""
    from ..common.examples import example
    from ..common.files import write_atomically

    with one_line_errors():
        source = example(name)
        path = output or Path(f"{name}.toml")
        if path.exists():
            raise ValueError(f"{path} must be a new file, is there already: -o FILE.toml writes another")
        write_atomically(path, source.read_bytes())
    if as_json:
        typer.echo(json.dumps({"scene": str(path)}))
        return
    typer.echo(f"scene: {path}\nnext: inertia-module run {path}")
