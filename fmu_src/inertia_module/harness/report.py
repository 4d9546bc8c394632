"""Report of the check of an FMU, and the journal by which a child process writes it."""

from __future__ import annotations

import json
import stat
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ..common.files import write_atomically

# messages of one kind that are listed
MAX_MESSAGES = 10
# length of a message that is printed, characters
MAX_LENGTH = 1000
# size of a journal that is read, bytes
MAX_JOURNAL = 50_000_000
# time between two entries of the progress, s
INTERVAL = 0.2


@dataclass
class Deviation:
    """Largest deviation of a variable from its reference.

    Attributes:
        experiment: name of the experiment.
        variable: name of the variable.
        deviation: in the unit of the variable; for texts 1 if they differ.
        allowed: likewise.
        time: of the largest deviation, s.
    """

    experiment: str
    variable: str
    deviation: float
    allowed: float
    time: float

    def __str__(self) -> str:
        return f"{self.deviation:.2g} at t = {self.time:g} s (tolerance {self.allowed:g})"


@dataclass
class Report:
    """Results of the check of an FMU file.

    Attributes:
        problems: one sentence each; empty if the FMU is correct.
        warnings: messages of the FMU, and parts of the check that are left out.
        facts: properties of the FMU by heading.
        outputs: last value of each output; a list for an array, None for a value that is not finite.
        references: deviations from the reference results in the FMU.
    """

    problems: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, Any] = field(default_factory=dict)
    references: list[Deviation] = field(default_factory=list)


def line_of(text: str) -> str:
    """Return a text of an FMU as one line of printable characters, at most MAX_LENGTH."""
    line = " ".join(text.split())
    line = "".join(letter if letter.isprintable() else "\ufffd" for letter in line)
    return line if len(line) <= MAX_LENGTH else f"{line[:MAX_LENGTH]}…"


def listed(messages: Iterable[str]) -> list[str]:
    """Return different messages as lines, at most MAX_MESSAGES, and the number of the others."""
    different = list(dict.fromkeys(map(line_of, messages)))
    more = len(different) - MAX_MESSAGES
    return different[:MAX_MESSAGES] + [f"and {more} more messages"] * (more > 0)


def reason_of(error: BaseException) -> str:
    """Return the reason of a failure as one line."""
    if isinstance(error, MemoryError):
        return "the memory limit is exceeded"
    return " ".join(str(error).split()) or type(error).__name__


class Journal:
    """A report and the state of the work on it, written to a file at each stage.

    Attributes:
        report: so far.
        stage: the work that is being done, as the subject of a sentence.
        time: simulation time reached in this stage, s, or None.
        share: share of this stage that is done, 0 to 1.
        error: reason why there is no report, or "".
        is_done: True if the work has come to its end.
    """

    def __init__(self, file: Path | None = None) -> None:
        self.report, self.stage, self.error, self.is_done = Report(), "", "", False
        self.time: float | None = None
        self.share = 0.0
        self._file, self._written = file, 0.0

    def begin(self, stage: str) -> None:
        """Begin a stage."""
        self.stage, self.time, self.share = stage, None, 0.0
        self.write()

    def reach(self, time_reached: float, share: float) -> None:
        """Note a simulation time, s, and the share of the stage that is done; write them now and then."""
        self.time, self.share = time_reached, share
        if time.monotonic() - self._written > INTERVAL:
            self.write()

    def write(self) -> None:
        """Write the file, if there is one."""
        self._written = time.monotonic()
        if self._file is not None:
            state = {name: value for name, value in vars(self).items() if not name.startswith("_")}
            content = json.dumps({**state, "report": asdict(self.report)})
            write_atomically(self._file, content.encode())

    @classmethod
    def read(cls, file: Path) -> Journal:
        """Read a journal; return an empty one if the file is missing or no journal.

        The file may be of an FMU that has exchanged it: a link or a pipe is not opened.
        """
        journal = cls()
        try:
            status = file.lstat()
            if not stat.S_ISREG(status.st_mode) or status.st_size > MAX_JOURNAL:
                return journal
            state = json.loads(file.read_bytes())
            report = state.pop("report")
            report["references"] = [Deviation(**row) for row in report["references"]]
            journal.report = Report(**report)
            vars(journal).update(state)
        except (OSError, ValueError, TypeError, LookupError):
            return cls()
        return journal
