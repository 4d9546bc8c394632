"""Report of the check of an FMU, and the journal in which a child process writes the report."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ..common.files import write_atomically

# maximum number of listed messages of one kind
MAX_MESSAGES = 10
# maximum length of a printed message, characters
MAX_LENGTH = 1000
# minimum time between two writes of the progress, s
INTERVAL = 0.2


@dataclass
class Deviation:
    """Maximum deviation of a variable from its reference.

    Attributes:
        experiment: name of the experiment.
        variable: name of the variable.
        deviation: maximum deviation in the unit of the variable; 1 for texts that differ.
        allowed: allowed deviation in the unit of the variable.
        time: time of the maximum deviation, s.
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
        warnings: messages of the FMU, and omitted parts of the check.
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
    """Convert a text of an FMU to one line with a maximum of MAX_LENGTH printable characters.

    Args:
        text: the text.
    """
    line = " ".join(text.split())
    line = "".join(letter if letter.isprintable() else "\ufffd" for letter in line)
    return line if len(line) <= MAX_LENGTH else f"{line[:MAX_LENGTH]}…"


def listed(messages: Iterable[str]) -> list[str]:
    """Return the first MAX_MESSAGES different messages as lines, and a line with the number of the others.

    Args:
        messages: the messages.
    """
    different = list(dict.fromkeys(map(line_of, messages)))
    more = len(different) - MAX_MESSAGES
    return different[:MAX_MESSAGES] + [f"and {more} more messages"] * (more > 0)


class Journal:
    """A report and the progress of the examination, written to a file at each stage.

    Args:
        file: path of the file; None to write nothing.

    Attributes:
        report: the present report.
        stage: the present stage, as the subject of a sentence.
        time: simulation time in this stage, s, or None.
        share: completed share of this stage, 0 to 1.
        error: reason why there is no report, or "".
        is_done: True if the examination is complete.
    """

    def __init__(self, file: Path | None = None) -> None:
        self.report, self.stage, self.error, self.is_done = Report(), "", "", False
        self.time: float | None = None
        self.share = 0.0
        self._file, self._written = file, 0.0

    def begin(self, stage: str) -> None:
        """Begin a stage and write the file.

        Args:
            stage: the stage, as the subject of a sentence.
        """
        self.stage, self.time, self.share = stage, None, 0.0
        self.write()

    def reach(self, simulation_time: float, share: float) -> None:
        """Store the progress of the stage; write the file if the last write is older than INTERVAL.

        Args:
            simulation_time: simulation time, s.
            share: completed share of the stage, 0 to 1.
        """
        self.time, self.share = simulation_time, share
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
        """Read a journal; return an empty one if the process has not written it yet.

        Args:
            file: path of the file.
        """
        journal = cls()
        try:
            state = json.loads(file.read_bytes())
        except OSError:
            return journal
        report = state.pop("report")
        report["references"] = [Deviation(**row) for row in report["references"]]
        journal.report = Report(**report)
        vars(journal).update(state)
        return journal
