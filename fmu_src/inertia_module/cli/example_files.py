"""Command that copies examples: new."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Annotated

import typer

import inertia_module

from ..common.files import write_atomically
from .answer import Answer, command
from .options import File, option


@command
def new(
    name: Annotated[str, typer.Argument(help="Example to copy: planar, planar.py, urban, tutorial, ...")],
    output: Annotated[File, option("Output file (default: NAME.toml).", "FILE", "--output", "-o")] = None,
) -> Answer:
    """Copy an example to a new file.

    Also copies its data files and helper scripts.
    """
    from ..common.examples import belonging

    source = inertia_module.example(name)
    path = output or Path(source.name)
    copies = {path: source}
    for part in belonging(source):
        has_same_name = part.stem == source.stem
        copies[path.with_suffix(part.suffix) if has_same_name else path.with_name(part.name)] = part
    for copy in copies:
        if copy.exists():
            raise ValueError(f"{copy} already exists. Choose another name with -o.")
    for copy, original in copies.items():
        write_atomically(copy, original.read_bytes())

    lines = [*(f"created: {copy}" for copy in copies), "Next steps:"]
    lines += [f"  {line}" for line in _commands(source, path)]
    return Answer({"files": [str(copy) for copy in copies]}, lines)


def _commands(source: Path, path: Path) -> list[str]:
    """Return the commands to run after an example has been copied, in order."""
    text = source.read_text(encoding="utf-8")
    if source.suffix == ".ipynb":
        return ["pip install 'inertia-module[studies,notebook]' jupyterlab", f"jupyter lab {path}"]
    if source.suffix == ".py":
        return [*re.findall(r"Run `(.+?)` first", text), f"python {path}"]
    if match := re.match("# (inertia-module .*)", text):
        return [match[1].replace(f"{source.stem}.", f"{path.with_suffix('')}.")]
    return [f"inertia-module {'design' if 'free' in tomllib.loads(text) else 'run'} {path}"]
