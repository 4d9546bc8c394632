"""Messages on the error output: one line each."""

from __future__ import annotations

import contextlib
import logging

import typer


def print_to_stderr(text: str) -> None:
    """Print a line to the error output; a closed or full error output is ignored.

    Args:
        text: The line.
    """
    with contextlib.suppress(OSError):
        typer.echo(text, err=True)


class StageLogHandler(logging.Handler):
    """Handler that prints the log of the package: the stages of a build during a command."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a message to the error output.

        Args:
            record: The message.
        """
        print_to_stderr(record.getMessage())


LOG = logging.getLogger("inertia_module")
LOG.addHandler(StageLogHandler())
LOG.setLevel(logging.INFO)
