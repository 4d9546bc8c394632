"""The command ``inertia-module``: FMUs, scenes, jobs, what accuracy costs."""

from __future__ import annotations

import atexit
import os
import signal
import sys
from typing import Annotated

import typer

from .. import __version__
from .commands import build, chart, check, design, export, fit, new, orders, run, sweep, tradeoff, view

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    no_args_is_help=True,
    rich_markup_mode=None,  # with it "[free]" is a style and vanishes from the help
    pretty_exceptions_enable=False,
)
for one in (build, check, export, orders, fit, new, run, tradeoff, chart, sweep, design, view):
    app.command()(one)


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


def main() -> None:
    """Entry of the console script.

    A process that has loaded a Python FMU is ended without the destructors of its libraries: that of
    pythonfmu 0.7 uses memory it has freed, and now and then aborts a run that has succeeded.
    """
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # nothing is left behind
    try:
        app()
        code: object = 0
    except SystemExit as leave:
        code = leave.code
    if isinstance(code, str):
        sys.stderr.write(code + "\n")
        code = 1
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 0)
