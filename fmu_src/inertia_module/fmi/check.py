"""Check of an FMU file: its validity, its simulation, and its embedded reference results.

No code of the FMU runs in this process: another process examines it, within limits of time and memory.
"""

from __future__ import annotations

import signal
import sys
import tempfile
from pathlib import Path

from ..common.errors import FmuError, must_be
from ..common.terminal import Progress
from .child import End, run_child
from .report import Journal, Report, line_of, listed

# limits of the examining process: time, s, and memory, bytes
TIMEOUT = 60.0
MAX_MEMORY = 4_000_000_000
# share of the memory limit above which a crash is reported as out of memory
OUT_OF_MEMORY_SHARE = 0.8


def check_fmu(
    path: Path, timeout: float = TIMEOUT, progress: Progress | None = None, memory: int = MAX_MEMORY
) -> Report:
    """Check an FMU file in a separate process.

    Args:
        path: path of the file.
        timeout: time limit, s.
        progress: function that receives the completed share of the present stage, 0 to 1.
        memory: memory limit, bytes.

    Raises:
        FmuError: the file is no FMU, or the process cannot start.
    """
    if not timeout > 0.0:
        raise FmuError(must_be("timeout", "a positive number of seconds", timeout))
    file = path.absolute()  # the process runs in another folder
    with tempfile.TemporaryDirectory(prefix="inertia-module-check-", ignore_cleanup_errors=True) as name:
        journal_file, folder = Path(name, "journal.json"), Path(name, "work")
        folder.mkdir()

        def watch() -> None:
            if progress is not None:
                progress(Journal.read(journal_file).share)

        module = f"{__package__}.examination"
        arguments = [str(file), str(journal_file), str(memory)]
        end = run_child([sys.executable, "-W", "ignore", "-m", module, *arguments], folder, timeout, watch)
        journal = Journal.read(journal_file)
    if journal.error:
        raise FmuError(journal.error.replace(str(file), str(path)))
    if not journal.stage and end.code:
        *_, reason = end.errors.strip().splitlines() or [f"exit code {end.code}"]
        raise FmuError(f"cannot start the process of the check: {reason}")
    report = journal.report
    if not journal.is_done:
        report.problems.append(_failure_message(journal, end, timeout, memory))
    if end.output.strip():
        report.problems.append(f"the FMU prints to standard output: {_first_line(end.output)}")
    if end.errors.strip():
        report.warnings.append(f"the FMU prints to standard error: {_first_line(end.errors)}")
    report.problems, report.warnings = listed(report.problems), listed(report.warnings)
    report.facts = {heading: line_of(text) for heading, text in report.facts.items()}
    return report


def _first_line(text: str) -> str:
    """Return the first line of a text, quoted."""
    return repr(text.strip().splitlines()[0][:200])


def _failure_message(journal: Journal, end: End, timeout: float, memory: int) -> str:
    """Return the message about an examination that has not reached its end."""
    stage = journal.stage or "starting"
    if end.code is None:
        place = "" if journal.time is None else f" (simulation time {journal.time:g} s)"
        return f"{stage}: time limit of {timeout:g} s exceeded{place}. Set a longer one with --timeout."
    if end.code >= 0:
        return f"{stage}: the FMU exits the process of its host with code {end.code}"
    try:
        cause = signal.Signals(-end.code).name
    except ValueError:
        cause = f"signal {-end.code}"
    if end.memory > OUT_OF_MEMORY_SHARE * memory:
        cause += f", out of memory: the limit is {memory / 1e9:g} GB"
    return f"{stage}: the FMU crashes ({cause})"
