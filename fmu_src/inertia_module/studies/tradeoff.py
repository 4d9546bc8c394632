"""The trade of speed for accuracy as a study: rows, and the files they are left in."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..common.errors import did_you_mean
from ..harness.results import write_figure
from ..harness.simulate import Progress, whole_steps
from ..scene import Scene
from .choice import Choice
from .errors import MEASURES
from .levels import all_levels
from .open_loop import measure
from .plots import all_errors, work_precision
from .reference import Agreement, agreement, converged
from .rows import Row, as_dict, failure_lines, write_rows
from .trajectory import Case, Peer, Unavailable
from .trials import has_elastic_output, measure_scene, trial_rows

R1 = Case()
# an output shaft for R1: hub, spring, damper and driven mass (DESIGN section 6)
R1_ELASTIC = Case(
    {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
)
# communication steps of a scene over its own
_LONGER = (1, 10, 100)
WORST = "worst"
# what counts in R1 unless something else is wanted
R1_WANTED = "omega_out_worst"


@dataclass(frozen=True)
class Study:
    """What was measured.

    Attributes:
        title: of table and plots. rows: all of them. names: errors to show. plotted: the one to plot.
        agreement: of the reference with the second method, or None.
    """

    title: str
    rows: list[Row]
    names: tuple[str, ...]
    plotted: str
    agreement: Agreement | None = None

    def as_dict(self) -> dict[str, Any]:
        """The same for machines."""
        found: dict[str, Any] = {"title": self.title, "rows": [as_dict(row) for row in self.rows]}
        agreed = {} if self.agreement is None else {"reference_agreement": dataclasses.asdict(self.agreement)}
        return found | agreed

    def write(self, folder: Path, stem: str = "tradeoff") -> dict[str, Path]:
        """Leave all rows as CSV and plots as PNG and SVG in a folder. Returns the files by name."""
        files = {"rows": write_rows(folder / f"{stem}.csv", self.rows)}
        figures = {
            stem: work_precision(self.rows, self.plotted, self.title),
            f"{stem}_errors": all_errors(self.rows, self.names, self.title),
        }
        for name, figure in figures.items():
            for kind in ("png", "svg"):
                files[f"{name}_{kind}"] = write_figure(folder / f"{name}.{kind}", figure)
        return files

    def closing_lines(self, choice: Choice | None) -> list[str]:
        """What failed, how far the reference can be trusted, and what is recommended."""
        lines = failure_lines(self.rows)
        if self.agreement is not None:
            lines.append(
                f"reference: two independent methods agree to {self.agreement.omega_out:.1e} in omega_out"
                f" (relative) and to {self.agreement.events:.1e} s in the times of"
                f" {self.agreement.switches[0]} switches"
            )
        return lines + ([] if choice is None else choice.lines())


def open_study(case: Case, title: str, peers: Sequence[Peer] = (), progress: Progress | None = None) -> Study:
    """Measure an open-loop case: fidelity, method, tolerance or step, and communication step; and peers.

    Args:
        case: what is run. title: of it. peers: beside it. progress: told how much is done (0 to 1).

    Raises:
        Refused: the module refuses the case.
    """
    reference = converged(case)
    try:
        agreed = agreement(case)
    except Unavailable:
        agreed = None
    rows = measure(reference, peers=peers, progress=progress)
    return Study(title, rows, tuple(MEASURES), R1_WANTED, agreed)


def _of_scene(scene: Scene, rows: Sequence[Row]) -> Study:
    """A study of the errors of the wanted outputs alone, and the worst of them."""
    wanted, kept = scene.run.outputs, []
    for row in rows:
        errors = {name: row.errors[name] for name in wanted if name in row.errors}
        kept.append(dataclasses.replace(row, errors={**errors, WORST: row.worst(wanted)} if errors else {}))
    return Study(scene.title, kept, (*wanted, WORST), WORST)


def scene_study(scene: Scene, progress: Progress | None = None) -> Study:
    """Measure a scene at all levels, in its own communication step and in longer ones.

    Raises:
        Refused: the module refuses the scene.
    """
    duration = scene.run.stop_time
    longer = (factor * scene.run.communication_step for factor in _LONGER)
    steps = [step for step in longer if whole_steps(duration, step)]
    levels = list(all_levels(has_elastic_output(scene), kinematic=False))
    return _of_scene(scene, measure_scene(scene, levels, steps, progress))


def scene_trials(scene: Scene, progress: Progress | None = None) -> Study:
    """The trials that `fidelity = "auto"` chooses from, measured or from the last time."""
    return _of_scene(scene, trial_rows(scene, progress))


def check_wanted(names: Sequence[str]) -> None:
    """Refuse errors that are not measured of an open-loop case.

    Raises:
        ValueError: a name is not in MEASURES.
    """
    for name in names:
        if name not in MEASURES:
            raise ValueError(f"--wanted must be a measure, is {name!r} {did_you_mean(name, MEASURES)}")
