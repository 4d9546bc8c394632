"""Shared by the commands: options, and what each does: errors in one line, --json, files, the exit code.

Libraries and rooms of the package are imported when a command runs: help needs none of them.
"""

from __future__ import annotations

import functools
import inspect
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import inertia_module

from ..common.files import OUTPUT_FOLDER, writable_folder
from ..common.terminal import terminal
from ..common.units import factor_between, split_quantity, to_si

if TYPE_CHECKING:
    from ..fmu.native_fmu import NativeFmu
    from ..scene import Scene

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")]
OutputFolder = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="Folder to write to; made if it is not there."),
]
FmuToRun = Annotated[
    Path | None, typer.Option("--fmu", metavar="FILE.fmu", help="FMU to run instead of the package's own.")
]
Keys = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Instead of the scene's: load.torque='8 N.m'; repeat."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines.")]


class Aside(str):
    """Line for the error output."""


# a line; headings and values under a title; what prints more than that
Shown = str | tuple[str, dict[str, str]] | Callable[[], None]


@dataclass
class Answer:
    """Outcome of a command.

    Attributes:
        told: for machines. shown: to people, in this order. failed: whether the exit code is 1.
        files: that were left, by name; a machine is told them as well, for people they are listed at the end.
    """

    told: dict[str, Any]
    shown: Sequence[Shown] = ()
    files: Mapping[str, Path] = field(default_factory=dict)
    failed: bool = False


def command(work: Callable[..., Answer]) -> Callable[..., None]:
    """Make a command of its work: with --json, errors in one line and the exit code."""

    @functools.wraps(work)
    def run(as_json: bool, **options: Any) -> None:
        try:
            answer = work(**options)
        except (ValueError, RuntimeError, OSError) as error:
            typer.echo("error: " + " ".join(str(error).split()), err=True)
            raise typer.Exit(1) from error
        listed = {name: str(file) for name, file in answer.files.items()}
        if as_json:
            typer.echo(json.dumps(answer.told | ({"files": listed} if listed else {})))
        else:
            for one in answer.shown:
                show(one)
            for name, file in listed.items():
                typer.echo(f"{name}: {file}")
        if answer.failed:
            raise typer.Exit(1)

    as_json = inspect.Parameter("as_json", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Json)
    signature = inspect.signature(work, eval_str=True)
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[*signature.parameters.values(), as_json]
    )
    run.__annotations__ = {**work.__annotations__, "as_json": Json}
    return run


def folder_for(output: Path | None, *default: str) -> Path:
    """Check the folder that a command writes to before its work begins.

    Args:
        output: as given by -o. default: its place in out/ without that.

    Raises:
        OSError: it cannot be written to.
    """
    return writable_folder(output or OUTPUT_FOLDER.joinpath(*default))


def load_scene(path: Path, keys: list[str] | None) -> Scene:
    """Read a scene of the module, with keys as --set gives them."""
    from ..scene.keys import keys_of

    return inertia_module.load_scene(path, keys_of(keys))


def show(one: Shown) -> None:
    """Print one of what an answer shows."""
    if isinstance(one, str):
        typer.echo(one, err=isinstance(one, Aside))
        return
    if not isinstance(one, tuple):
        one()
        return
    from rich.table import Table

    title, rows = one
    table = Table(title=title, title_justify="left", show_header=False)
    for heading, value in rows.items():
        table.add_row(heading, value)
    terminal().print(table)


def current_fmu(fmu: NativeFmu | None = None) -> Path:
    """The FMU of the module, or another: see builder.current_fmu."""
    from ..fmu.builder import MODULE_FMU
    from ..fmu.builder import current_fmu as current

    return current(fmu or MODULE_FMU, progress=lambda stage: typer.echo(stage, err=True))


def quantity_of(option: str, text: str, unit: str, **limits: float) -> float:
    """A quantity given on the command line, such as "2 s", in SI; limits: as of scene.keys.checked."""
    from ..scene.keys import checked

    try:
        return checked(text, unit, **limits)
    except ValueError as error:
        raise ValueError(f"{option} {error}") from None


def share(option: str, text: str | None) -> float | None:
    """An error given on the command line, such as 0.01 or "1 %"."""
    return None if text is None else quantity_of(option, text, "1", maximum=1.0, above=0.0)


def turning(text: str) -> float:
    """An input speed given on the command line, such as "3000 rpm", in rad/s; negative backwards."""
    from ..contract.variables import LARGEST_SPEED

    allowed = f"a speed up to {LARGEST_SPEED:g} rad/s, not 0, such as '3000 rpm', is {text!r}"
    try:
        omega1 = to_si(text, "rad/s")
    except ValueError as error:
        raise ValueError(f"--speed must be {allowed}: {error}") from None
    if not 0.0 < abs(omega1) <= LARGEST_SPEED:
        raise ValueError(f"--speed must be {allowed}")
    if not split_quantity(text)[1]:
        typer.echo(f"warning: --speed {text} has no unit, is taken as {speed_text(omega1)}", err=True)
    return omega1


def speed_text(omega1: float) -> str:
    """A speed, rad/s, in the units in which speeds are given."""
    return f"{omega1:.5g} rad/s ({omega1 / factor_between('rpm', 'rad/s'):.5g} rpm)"
