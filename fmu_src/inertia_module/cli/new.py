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
    name: Annotated[str, typer.Argument(help="Example to copy: planar, reference, urban, tutorial, ...")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Its file (NAME.toml).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Copy an example to a new file.

    A measurement that belongs to it goes along.
    """
    from ..common.examples import example
    from ..common.files import write_atomically

    with one_line_errors():
        source = example(name)
        path, measured = output or Path(source.name), source.with_suffix(".csv")
        copies = {path: source}
        if measured.exists():
            copies[path.with_suffix(".csv")] = measured
        for copy in copies:
            if copy.exists():
                raise ValueError(f"{copy} must be a new file, is there already: -o FILE writes another")
        for copy, original in copies.items():
            write_atomically(copy, original.read_bytes())
    if as_json:
        typer.echo(json.dumps({"files": [str(copy) for copy in copies]}))
        return
    for copy in copies:
        typer.echo(f"new: {copy}")
    typer.echo(f"next: {_command(source)} {path}")


def _command(example: Path) -> str:
    """The command that an example is for."""
    if example.suffix == ".ipynb":
        return "jupyter lab"
    is_specification = "free" in tomllib.loads(example.read_text(encoding="utf-8"))
    return f"inertia-module {'design' if is_specification else 'run'}"
