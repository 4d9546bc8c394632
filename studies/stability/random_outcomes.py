"""What the motions of a campaign have shown, kept in a file as it comes: a stopped run goes on there."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from inertia_module.common.files import content_hash, sources

from .random_checks import Finding
from .verdict import Figure

STUDIES = Path(__file__).parents[1]


@dataclass(frozen=True)
class Outcome:
    """One motion of a campaign.

    Attributes:
        number: in the campaign. level: of fidelity. finding: what it showed.
        reproducer: the smallest motion found that fails or is refused in the same way, or None.
    """

    number: int
    level: str
    finding: Finding
    reproducer: dict[str, Any] | None = None

    @property
    def told(self) -> dict[str, Any]:
        """Its number, what fails or is refused, and what reproduces it."""
        figures = self.finding.figures
        failed = [
            f"{name}: {figures[name].value:.1e}, bound {figures[name].bound:.0e}"
            for name in self.finding.failed
        ]
        sentence = "; ".join(failed) or self.finding.refused
        return {"number": self.number, "sentence": sentence, "reproducer": self.reproducer}


def outcomes_file(folder: Path, seed: int, losses: bool = False) -> Path:
    """The file in a folder that keeps the outcomes of a seed with this code: a line for each, in order."""
    name = f"random-losses-{seed}" if losses else f"random-{seed}"
    own = {
        path.relative_to(STUDIES).as_posix(): path.read_bytes()
        for part in ("reference", "stability")
        for path in (STUDIES / part).glob("*.py")
    }
    code = sources("contract/*.py", "kernel/**/*.py", "memory.py") | own
    return folder / f"{name}-{content_hash(code)[:8]}.jsonl"


def as_line(outcome: Outcome) -> str:
    """An outcome as a line of its file."""
    return json.dumps(asdict(outcome)) + "\n"


def read_outcomes(path: Path) -> list[Outcome]:
    """The outcomes of a file, if there is one; its last line may be cut off."""
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    return [_outcome(json.loads(line)) for line in lines if line.endswith("\n")]


def _outcome(values: dict[str, Any]) -> Outcome:
    finding = values.pop("finding")
    figures = {name: Figure(**figure) for name, figure in finding.pop("figures").items()}
    return Outcome(**values, finding=Finding(figures, **finding))
