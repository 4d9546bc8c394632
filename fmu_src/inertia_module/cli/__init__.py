"""Command line ``inertia-module``: scenes, engineering tasks, FMUs.

All commands print errors in one line and have the option --json, output files and an exit code. Libraries
and modules of the package are imported when a command runs, so that help starts fast.
"""

from .answer import Answer, OutputPart, command, print_part
from .messages import print_to_stderr
from .options import OutputFolder
from .program import app, main

__all__ = ["Answer", "OutputFolder", "OutputPart", "app", "command", "main", "print_part", "print_to_stderr"]
