"""What the commands share: the application, options, errors in one line, tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from ..common.files import BUILD_FOLDER, OUTPUT_FOLDER

# name of the page of a scene
PAGE = "page.html"

app = typer.Typer(
    help="Inertia module: an inertial torque transformer as an FMI 2.0 co-simulation FMU.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

OutputFolder = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="Folder to write to; made if it is not there."),
]
FmuToRun = Annotated[
    Path | None, typer.Option("--fmu", metavar="FILE.fmu", help="FMU to run (build/InertiaModule.fmu).")
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines.")]


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
    """The FMU of the module in build/, built anew where it is not current."""
    from ..fmu.builder import current_module_fmu

    return current_module_fmu(BUILD_FOLDER, lambda stage: typer.echo(stage, err=True))


def native_fmus() -> tuple[Path, Path]:
    """The native FMUs of module and driven shaft in build/, built anew where they are not current.

    Raises:
        RuntimeError: they cannot be compiled here.
    """
    from ..fmu.builder import MODULE_FMU, SHAFT_FMU, is_current
    from ..fmu.builder import build as build_fmus

    module, shaft = (BUILD_FOLDER / fmu.file_name for fmu in (MODULE_FMU, SHAFT_FMU))
    if not (is_current(module, MODULE_FMU) and is_current(shaft, SHAFT_FMU)):
        skipped = build_fmus(BUILD_FOLDER, lambda stage: typer.echo(stage, err=True)).skipped
        for path in (module, shaft):
            if path.name in skipped:
                raise RuntimeError(f"{path.name} cannot be built: {skipped[path.name]}")
    return module, shaft


def quantity_of(option: str, text: str, unit: str, **limits: float) -> float:
    """A quantity given on the command line, such as "2 s", in SI; limits: as of scene.units.checked."""
    from ..scene.units import checked

    try:
        return checked(text, unit, **limits)
    except ValueError as error:
        raise ValueError(f"{option} {error}") from None


def share(option: str, text: str | None) -> float | None:
    """An error given on the command line, such as 0.01 or "1 %"."""
    return None if text is None else quantity_of(option, text, "1", maximum=1.0, above=0.0)


def turning(text: str) -> float:
    """An input speed given on the command line, such as "3000 rpm", in rad/s; negative backwards."""
    from ..common.units import to_si
    from ..contract.variable import LARGEST_SPEED

    try:
        omega1 = to_si(text, "rad/s")
    except ValueError:
        omega1 = 0.0
    if not 0.0 < abs(omega1) <= LARGEST_SPEED:
        raise ValueError(
            f"--speed must be a speed up to {LARGEST_SPEED:g} rad/s, not 0, such as '3000 rpm', is {text!r}"
        )
    return omega1
