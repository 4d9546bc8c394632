"""Commands: functions that return an Answer; added are --json, errors in one line and the exit code."""

from __future__ import annotations

import contextlib
import functools
import inspect
import json
import signal
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import typer

from ..common.errors import sentence_of
from ..common.terminal import terminal
from .messages import print_to_stderr
from .options import Json

STANDARD_OUTPUT = "standard output"

# width of printed lines, characters
WIDTH = 80
# part of the output: a line, a title with values by heading, or a function that prints
OutputPart = str | tuple[str, dict[str, str]] | Callable[[], None]


@dataclass
class Answer:
    """Outcome of a command.

    Attributes:
        data: Result for --json.
        output: Printed parts, in this order.
        files: Written files by name, printed last; also in the result for --json.
        failed: True for exit code 1.
        warnings: Warnings, printed to the error output.
    """

    data: dict[str, Any]
    output: Sequence[OutputPart] = ()
    files: Mapping[str, Path] = field(default_factory=dict)
    failed: bool = False
    warnings: Sequence[str] = ()


# commands that reuse the results of an interrupted run
RESUMABLE = ("sweep", "design")


def command(work: Callable[..., Answer]) -> Callable[..., None]:
    """Turn a function into a command: add --json, errors in one line and the exit code.

    Args:
        work: Function of the options that returns the outcome.
    """

    @functools.wraps(work)
    def run(as_json: bool, **options: Any) -> None:
        try:
            answer = work(**options)
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            report_error(sentence_of(error), as_json)
            raise typer.Exit(1) from error
        except KeyboardInterrupt:
            print_to_stderr(
                "stopped; the same command continues" if work.__name__ in RESUMABLE else "stopped"
            )
            if as_json:
                print_json_error("stopped")
            raise typer.Exit(128 + signal.SIGINT) from None
        try:
            print_answer(answer, as_json)
        except OSError as error:
            error.filename = STANDARD_OUTPUT
            print_to_stderr(f"error: {sentence_of(error)}")
            raise typer.Exit(1) from error
        if answer.failed:
            raise typer.Exit(1)

    as_json = inspect.Parameter("as_json", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Json)
    signature = inspect.signature(work, eval_str=True)
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[*signature.parameters.values(), as_json]
    )
    run.__annotations__ = {**work.__annotations__, "as_json": Json}
    return run


def report_error(message: str, as_json: bool) -> None:
    """Print an error in one line to the error output and, for machines, as a JSON object.

    Args:
        message: The message, one line.
        as_json: True to print also {"error": message} to the standard output.
    """
    print_to_stderr(f"error: {message}")
    if as_json:
        print_json_error(message)


def print_json_error(message: str) -> None:
    """Print {"error": message} to the standard output, unless that is closed or full.

    Args:
        message: The message, one line.
    """
    with contextlib.suppress(OSError):
        typer.echo(json.dumps({"error": message}))


def print_answer(answer: Answer, as_json: bool) -> None:
    """Print the outcome of a command.

    Args:
        answer: The outcome.
        as_json: True to print one JSON object instead of text.
    """
    file_names = {name: str(file) for name, file in answer.files.items()}
    if as_json:
        typer.echo(json.dumps(answer.data | ({"files": file_names} if file_names else {})))
        return
    for warning in answer.warnings:
        print_to_stderr(f"warning: {warning}")
    for part in answer.output:
        print_part(part)
    for line in file_lines(list(answer.files.values())):
        typer.echo(line)


def file_lines(files: Sequence[Path]) -> list[str]:
    """Return the paths of written files as lines: "  FOLDER: FILE  FILE", one folder after the other.

    Args:
        files: Paths of the files.
    """
    names: dict[Path, list[str]] = {}
    for file in files:
        names.setdefault(file.parent, []).append(file.name)
    texts = [f"{folder}: {'  '.join(names_in_folder)}" for folder, names_in_folder in names.items()]
    return [line for text in texts for line in indented(text)]


def indented(text: str) -> list[str]:
    """Return a text as lines within WIDTH, indented as below a title; words stay whole.

    Args:
        text: The text.
    """
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent="  ",
        subsequent_indent="    ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def print_part(part: OutputPart) -> None:
    """Print one part of the output.

    Args:
        part: The part.
    """
    if isinstance(part, str):
        typer.echo(part)
    elif isinstance(part, tuple):
        from rich.table import Table

        title, rows = part
        # the table is at least as wide as its title, otherwise the title would break
        width = min(len(title), terminal().width)
        table = Table(title=title, title_justify="left", show_header=False, min_width=width)
        for heading, value in rows.items():
            table.add_row(heading, value)
        terminal().print(table)
    else:
        part()
