"""Shared by the commands: the application, options, errors in one line, tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from .. import __version__
from ..common.files import OUTPUT_FOLDER
from ..common.units import factor_between, split_quantity, to_si

# name of the page of a scene
PAGE = "page.html"

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    no_args_is_help=True,
    rich_markup_mode=None,  # with it "[free]" is a style and vanishes from the help
    pretty_exceptions_enable=False,
)

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


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"inertia-module {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Inertia module: an inertial torque transformer as an FMI 2.0 or 3.0 co-simulation FMU."""


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Errors a user can cause leave with one clear line and exit code 1."""
    try:
        yield
    except (ValueError, RuntimeError, OSError) as error:
        typer.echo("error: " + " ".join(str(error).split()), err=True)
        raise typer.Exit(1) from error


def folder_for(output: Path | None, *default: str) -> Path:
    """The folder that a command writes to, looked at before its work begins.

    Args:
        output: as given by -o. default: its place in out/ without that.

    Raises:
        OSError: it cannot be written to.
    """
    from ..common.files import writable_folder

    return writable_folder(output or OUTPUT_FOLDER.joinpath(*default))


def show_table(title: str, rows: dict[str, str]) -> None:
    """Print headings and values as a table."""
    from rich.table import Table

    from ..common.terminal import terminal

    table = Table(title=title, title_justify="left", show_header=False)
    for heading, value in rows.items():
        table.add_row(heading, value)
    terminal().print(table)


def current_fmu() -> Path:
    """The FMU of the module: see builder.current_fmu."""
    from ..fmu.builder import current_fmu as current

    return current(progress=lambda stage: typer.echo(stage, err=True))


def shaft_fmu() -> Path:
    """The FMU of the driven shaft: see builder.current_fmu."""
    from ..fmu.builder import SHAFT_FMU
    from ..fmu.builder import current_fmu as current

    return current(SHAFT_FMU, progress=lambda stage: typer.echo(stage, err=True))


def quantity_of(option: str, text: str, unit: str, **limits: float) -> float:
    """A quantity given on the command line, such as "2 s", in SI; limits: as of scene.fields.checked."""
    from ..scene.fields import checked

    try:
        return checked(text, unit, **limits)
    except ValueError as error:
        raise ValueError(f"{option} {error}") from None


def share(option: str, text: str | None) -> float | None:
    """An error given on the command line, such as 0.01 or "1 %"."""
    return None if text is None else quantity_of(option, text, "1", maximum=1.0, above=0.0)


def turning(text: str) -> float:
    """An input speed given on the command line, such as "3000 rpm", in rad/s; negative backwards."""
    from ..contract.variable import LARGEST_SPEED

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
