"""The terminal: prints all messages and tables without interpreting markup.

The library Rich is imported at the first output: the help does not require it.
"""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich import progress as rich_progress
    from rich.console import Console

# function that receives the completed share of the work, 0 to 1
Progress = Callable[[float], None]
# duration of the work after which a progress bar appears, s
PATIENCE = 2.0


def terminal(width: int | None = None, stderr: bool = False) -> Console:
    """Return a console that prints texts unchanged: "[fast]" is not a style, ":key:" not an emoji.

    Args:
        width: width of the console, characters; None for the width of the terminal.
        stderr: True to print to the error output.
    """
    from rich.console import Console

    class PlainConsole(Console):
        def on_broken_pipe(self) -> None:
            """Raise the error, which Rich turns into a silent end of the process."""
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))

    return PlainConsole(markup=False, emoji=False, highlight=False, width=width, stderr=stderr)


def progress() -> rich_progress.Progress:
    """Return a progress bar on the error output that shows titles unchanged and disappears at its end."""
    from rich.progress import Progress, TextColumn

    _, *others = Progress.get_default_columns()
    title = TextColumn("{task.description}", markup=False)
    return Progress(title, *others, console=terminal(stderr=True), transient=True)


@contextmanager
def progress_bar(title: str) -> Iterator[Progress]:
    """Show a progress bar after PATIENCE seconds of work, if the error output is a terminal.

    Args:
        title: title of the bar.

    Yields:
        Function that takes the completed share of the work, 0 to 1.
    """
    started = time.monotonic()
    bar = progress()
    task = bar.add_task(title, total=1.0)

    def report(share: float) -> None:
        is_late = time.monotonic() - started > PATIENCE
        if is_late and bar.console.is_terminal and not bar.live.is_started:
            bar.start()
        bar.update(task, completed=share)

    try:
        yield report
    finally:
        if bar.live.is_started:
            bar.stop()
