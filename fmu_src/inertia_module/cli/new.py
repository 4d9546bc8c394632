"""The command that leaves an example to begin with."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from .shared import Json, app, one_line_errors


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Example to copy: planar, planar.py, urban, tutorial, ...")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Its file (NAME.toml).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Copy an example to a new file.

    What belongs to it goes along: a measurement, programs that it imports.
    """
    from ..common.examples import belonging, example
    from ..common.files import write_atomically

    with one_line_errors():
        source = example(name)
        path = output or Path(source.name)
        copies = {path: source}
        for part in belonging(source):
            same = part.stem == source.stem
            copies[path.with_suffix(part.suffix) if same else path.with_name(part.name)] = part
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
    for command in _commands(source, path):
        typer.echo(f"next: {command}")


def _commands(source: Path, path: Path) -> list[str]:
    """The commands that an example is for, one after the other, with the path of its copy."""
    text = source.read_text(encoding="utf-8")
    if source.suffix == ".ipynb":
        return ["pip install 'inertia-module[jobs,notebook]' jupyterlab", f"jupyter lab {path}"]
    if source.suffix == ".py":
        return [*re.findall(r"Run `(.+?)` first", text), f"python {path}"]
    if told := re.match("# (inertia-module .*)", text):
        return [told[1].replace(f"{source.stem}.", f"{path.with_suffix('')}.")]
    return [f"inertia-module {'design' if 'free' in tomllib.loads(text) else 'run'} {path}"]
