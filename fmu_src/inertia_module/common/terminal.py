"""The terminal: where all messages and tables are printed, character for character.

Its library is imported when something is printed: help needs none.
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

# is told the share of some work that is done, 0 to 1
Progress = Callable[[float], None]
# work that takes longer than this, s, shows a bar
PATIENCE = 2.0


def terminal(width: int | None = None) -> Console:
    """A console that prints texts as they are: "[fast]" is no style, ":key:" no picture, 3 no number."""
    from rich.console import Console

    class PlainConsole(Console):
        def on_broken_pipe(self) -> None:
            """Raise the error, which Rich turns into a silent end of the process."""
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))

    return PlainConsole(markup=False, emoji=False, highlight=False, width=width)


def progress() -> rich_progress.Progress:
    """A progress bar that shows titles as they are, and vanishes when it is done."""
    from rich.progress import Progress, TextColumn

    _, *others = Progress.get_default_columns()
    title = TextColumn("{task.description}", markup=False)
    return Progress(title, *others, console=terminal(), transient=True)


@contextmanager
def progress_bar(title: str) -> Iterator[Progress]:
    """A progress bar that appears once some work has taken more than PATIENCE seconds."""
    started = time.monotonic()
    bar = progress()
    task = bar.add_task(title, total=1.0)

    def report(done: float) -> None:
        if not bar.live.is_started and time.monotonic() - started > PATIENCE:
            bar.start()
        bar.update(task, completed=done)

    try:
        yield report
    finally:
        if bar.live.is_started:
            bar.stop()
