"""The trade of speed for accuracy as a study: rows, and the files they are left in."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..drive import Progress
from ..results import write_figure
from ..scene import Scene
from ..scene.mechanism import is_elastic, parameters
from .choice import Choice
from .errors import MEASURES
from .open_loop import communication_steps, measure
from .plots import all_errors, work_precision
from .reference import Agreement, agreement, converged
from .report import as_dict, failure_lines, write_rows
from .rungs import ladder
from .trajectory import Case, Peer, Row, Unavailable
from .trials import measure_scene, trial_rows

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


def open_study(case: Case, title: str, peers: Sequence[Peer] = (), progress: Progress | None = None) -> Study:
    """Measure an open-loop case: fidelity, method, tolerance or step, and communication step; and peers.

    Args:
        case: what is run. title: of it. peers: beside it. progress: told how much is done (0 to 1).

    Raises:
        Refused: the module refuses the case.
    """
    reference = converged(case)
    try:
        agreed = agreement(case) if not is_elastic(case.parameters) else None
    except Unavailable:
        agreed = None
    rows = measure(reference, None, peers, communication_steps(case), progress)
    return Study(title, rows, tuple(MEASURES), R1_WANTED, agreed)


def _of_outputs(rows: Sequence[Row], wanted: Sequence[str]) -> list[Row]:
    """Rows with the errors of the wanted outputs alone, and the worst of them."""
    kept = []
    for row in rows:
        errors = {name: row.errors[name] for name in wanted if name in row.errors}
        kept.append(dataclasses.replace(row, errors={**errors, WORST: row.worst(wanted)} if errors else {}))
    return kept


def scene_study(scene: Scene, progress: Progress | None = None) -> Study:
    """Measure a scene on the whole ladder, in its own communication step and in longer ones.

    Raises:
        Refused: the module refuses the scene.
    """
    own, duration = scene.run.communication_step, scene.run.stop_time
    whole = (factor * own for factor in _LONGER)
    steps = [step for step in whole if abs(duration / step - round(duration / step)) < 1e-6]
    rungs = list(ladder(is_elastic(parameters(scene.mechanism)), kinematic=False))
    rows = _of_outputs(measure_scene(scene, rungs, steps, progress), scene.run.outputs)
    return Study(scene.title, rows, (*scene.run.outputs, WORST), WORST)


def scene_trials(scene: Scene, progress: Progress | None = None) -> Study:
    """The trials that `fidelity = "auto"` chooses from, measured or from the last time."""
    rows = _of_outputs(trial_rows(scene, progress), scene.run.outputs)
    return Study(scene.title, rows, (*scene.run.outputs, WORST), WORST)


def check_wanted(names: Sequence[str]) -> None:
    """Refuse errors that are not measured of an open-loop case.

    Raises:
        ValueError: a name is none of MEASURES.
    """
    for name in names:
        if name not in MEASURES:
            raise ValueError(f"--wanted = {name!r} is refused: allowed are {', '.join(MEASURES)}")


def write_study(study: Study, folder: Path, stem: str = "tradeoff") -> dict[str, Path]:
    """Leave a study in a folder: all rows as CSV, plots as PNG and SVG. Returns the files by name."""
    files = {"rows": write_rows(folder / f"{stem}.csv", study.rows)}
    figures = {
        stem: work_precision(study.rows, study.plotted, study.title),
        f"{stem}_errors": all_errors(study.rows, study.names, study.title),
    }
    for name, figure in figures.items():
        for kind in ("png", "svg"):
            files[f"{name}_{kind}"] = write_figure(folder / f"{name}.{kind}", figure)
    return files


def study_as_dict(study: Study) -> dict[str, Any]:
    """A study for machines."""
    found: dict[str, Any] = {"title": study.title, "rows": [as_dict(row) for row in study.rows]}
    if study.agreement is not None:
        found["reference_agreement"] = dataclasses.asdict(study.agreement)
    return found


def closing_lines(study: Study, choice: Choice | None) -> list[str]:
    """What failed, how far the reference can be trusted, and what is recommended, in words."""
    lines = failure_lines(study.rows)
    if study.agreement is not None:
        lines.append(
            f"reference: two independent methods agree to {study.agreement.omega_out:.1e} in omega_out"
            f" (relative) and to {study.agreement.events:.1e} s in the times of"
            f" {study.agreement.switches[0]} switches"
        )
    return lines + ([] if choice is None else choice.lines())
