"""Write the reference of the command line from the help of each command."""

import re

import typer
from typer.testing import CliRunner

from inertia_module.cli import app

HEAD = """# Command line

This page contains the output of `inertia-module -h` and of `-h` for each command.
Each command has `--json`, which prints the result or the error as JSON.
An error is one line, and the exit code is then 1.
"""
NAME = "inertia-module"
# settings that make the help the same on every machine
PLAIN = {"COLUMNS": "80", "TERMINAL_WIDTH": "80", "NO_COLOR": "1", "TERM": "dumb"}


def help_of(*command):
    """Return the help of the program or of a command, 80 columns wide."""
    result = CliRunner().invoke(app, [*command, "-h"], prog_name=NAME, env=PLAIN)
    if result.exit_code:
        raise RuntimeError(f"the help of {' '.join((NAME, *command))} failed: {result.output}")
    return re.sub(r"[ \t]+$", "", result.output.strip("\n"), flags=re.M)


def commands():
    """Return the names of all visible commands, in the order of the help."""
    group = typer.main.get_command(app)
    return [name for name, command in group.commands.items() if not command.hidden]


def commands_page():
    """Return the page in Markdown."""
    parts = [HEAD, f"```text\n{help_of()}\n```"]
    parts += [f"## {name}\n\n```text\n{help_of(name)}\n```" for name in commands()]
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"
