"""The program: its commands in the order of work, and its entry point."""

from __future__ import annotations

import atexit
import contextlib
import io
import os
import signal
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import inertia_module

from ..common.errors import sentence_of
from .answer import STANDARD_OUTPUT, print_json_error
from .converter_charts import chart
from .example_files import new
from .fmu_files import build, check, export
from .messages import print_to_stderr
from .options import option
from .scene_runs import report, run, view
from .studies import design, fit, orders, sweep, tradeoff

# error of the command line, such as an unknown option
UsageError: Any = typer.BadParameter.__base__


class Program(TyperGroup):
    """Group of the commands; with --json it prints usage errors also as a JSON object."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the options of the program and note whether the command has --json.

        Args:
            ctx: Context of the command line.
            args: Arguments of the program.
        """
        ctx.meta["as_json"] = "--json" in args
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command.

        Args:
            ctx: Context of the command line.

        Raises:
            UsageError: An argument is invalid.
        """
        try:
            return super().invoke(ctx)
        except UsageError as error:
            if ctx.meta["as_json"]:
                print_json_error(" ".join(error.format_message().split()))
            raise


app = typer.Typer(
    cls=Program,
    context_settings={"help_option_names": ["-h", "--help"]},
    no_args_is_help=True,
    rich_markup_mode=None,  # Rich markup would remove "[free]" from the help
    pretty_exceptions_enable=False,
)
# commands in the order of work, each with an example
EXAMPLES = {
    new: "new planar",
    run: "run planar.toml --set imbalance_mass='1 kg'",
    view: "view planar.toml --open",
    report: "report planar.toml -o planar.html",
    chart: "chart planar.toml reference.toml --speed '3000 rpm'",
    orders: "orders orders.toml --highest 8",
    sweep: "sweep planar.toml --vary imbalance_mass=0.5:2:7",
    design: "design design_car.toml",
    fit: "fit fit_rig.csv fit_rig.toml --free imbalance_mass=0.5:2",
    tradeoff: "tradeoff planar.toml --recommend 1%",
    export: "export planar.toml",
    check: "check build/InertiaModule.fmu",
    build: "build -o build",
}
for work, example in EXAMPLES.items():
    app.command(epilog=f"\b\nExample:\n  inertia-module {example}")(work)


def _print_version(is_requested: bool) -> None:
    if is_requested:
        typer.echo(f"inertia-module {inertia_module.__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, option("Print the version.", None, "--version", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Inertia module: an inertial torque transformer as an FMI 2.0 or 3.0 co-simulation FMU."""


def replace_closed_streams() -> None:
    """Replace each closed standard stream by a stream to the null device.

    Otherwise the next opened file would get its descriptor. Writing to the standard output then fails; text
    for the error output is discarded.
    """
    readable, writable = os.O_RDONLY, os.O_WRONLY
    streams = (("stdin", readable, "r"), ("stdout", readable, "w"), ("stderr", writable, "w"))
    for name, flags, mode in streams:
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, flags), mode, encoding="utf-8"))


def replace_unprintable_characters() -> None:
    """Print "?" for each character that the encoding of a standard stream does not contain."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def main() -> None:
    """Run the command line (entry point of the console script).

    The process ends without the destructors of its libraries, because the destructor of pythonfmu 0.7 uses
    freed memory and can abort a successful run.
    """
    for name in ("SIGTERM", "SIGHUP"):  # exit normally, so that temporary files are removed
        kind = getattr(signal, name, None)  # None on Windows; nohup ignores SIGHUP
        if kind is not None and signal.getsignal(kind) is not signal.SIG_IGN:
            signal.signal(kind, lambda number, _: sys.exit(128 + number))
    replace_closed_streams()
    replace_unprintable_characters()
    code: object = 0
    try:
        app()
    except SystemExit as leave:
        code = leave.code
    except KeyboardInterrupt:
        print_to_stderr("stopped")
        code = 128 + signal.SIGINT
    except OSError as error:  # of the help, which is printed before any command runs
        error.filename = STANDARD_OUTPUT
        print_to_stderr(f"error: {sentence_of(error)}")
        code = 1
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):
            stream.flush()
    os._exit(code if isinstance(code, int) else int(code is not None))
