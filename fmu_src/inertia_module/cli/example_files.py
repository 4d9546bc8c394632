"""Command that copies examples: new."""

from __future__ import annotations

import re
import textwrap
import tomllib
from pathlib import Path
from typing import Annotated

import typer

import inertia_module

from ..common.examples import companion_files, examples, title_of
from ..common.files import write_atomically
from .answer import WIDTH, Answer, command
from .options import File, Text, option


@command
def new(
    name: Annotated[
        Text,
        typer.Argument(
            help="Example to copy, such as planar or urban (default: list all examples).",
            autocompletion=lambda: list(examples()),
        ),
    ] = None,
    output: Annotated[File, option("Output file (default: NAME.toml).", "FILE", "--output", "-o")] = None,
) -> Answer:
    """Copy an example to a new file, or list all examples.

    Also copies its data files and helper scripts.
    """
    if name is None:
        return _list_of_examples()
    source = inertia_module.example(name)
    path = output or Path(source.name)
    copies = {path: source}
    for part in companion_files(source):
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


# kinds of examples by folder and ending of their files
KINDS = {
    ("examples", ".toml"): "Scenes and design specifications",
    ("papers", ".toml"): "Scenes of the source papers",
    ("examples", ".ipynb"): "Notebook",
    ("examples", ".py"): "Programs",
    ("control", ".py"): "Programs with python-control",
    ("studies", ".py"): "Programs that run scenes",
}


def _list_of_examples() -> Answer:
    """Return the list of all examples by kind, with their titles."""
    titles = {name: title_of(path) for name, path in examples().items()}
    width = max(map(len, titles)) + 4
    lines: list[str] = []
    for kind, heading in KINDS.items():
        lines.append(heading)
        for name, path in examples().items():
            if (path.parent.name, path.suffix) == kind:
                lines += textwrap.wrap(
                    titles[name],
                    WIDTH,
                    initial_indent=f"  {name}".ljust(width),
                    subsequent_indent=" " * width,
                )
    lines.append("Copy an example with its data files: inertia-module new NAME")
    return Answer({"examples": titles}, lines)


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
