"""The command ``inertia-module``: FMUs, scenes, jobs, what accuracy costs."""

from __future__ import annotations

import atexit
import os
import signal
import sys

from . import fmus, jobs, new, scenes, searches, view  # each adds its commands to app
from .shared import app, current_fmu

__all__ = ["app", "current_fmu", "fmus", "jobs", "main", "new", "scenes", "searches", "view"]


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
