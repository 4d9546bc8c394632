"""The terminal: where all messages and tables are printed, character for character."""

from __future__ import annotations

from rich.console import Console
from rich.progress import Progress, TextColumn


def terminal(width: int | None = None) -> Console:
    """A console that prints texts as they are: "[fast]" is no style, ":key:" no picture, 3 no number.

    Args:
        width: in columns; by default that of the terminal, or 80.
    """
    return Console(markup=False, emoji=False, highlight=False, width=width)


def progress() -> Progress:
    """A progress bar that shows titles as they are, and vanishes when it is done."""
    _, *others = Progress.get_default_columns()
    title = TextColumn("{task.description}", markup=False)
    return Progress(title, *others, console=terminal(), transient=True)
