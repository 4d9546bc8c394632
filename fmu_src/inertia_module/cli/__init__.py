"""Command line ``inertia-module``: scenes, engineering tasks, FMUs.

All commands have errors in one line, the option --json, output files and an exit code. Libraries and modules
of the package are imported when a command runs, so that help starts fast.
"""

from .answer import Answer, Shown, command, show
from .messages import aside
from .options import OutputFolder
from .program import app, main

__all__ = ["Answer", "OutputFolder", "Shown", "app", "aside", "command", "main", "show"]
