"""The parts of the study: each gives rows, which are written as CSV and drawn."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ...cosimulation import SCHEMES, ErrorControl
from ...drive import Progress
from ...results import write_figure
from .case import CASES, URBAN_MODULE, CoupledCase
from .figure import map_figure, shafts_figure
from .limits import Limit, limits
from .monolithic import Monolith
from .rows import write_rows
from .shafts import ShaftTrial, shaft_trials
from .torque import TorqueTrial, torque_trials
from .trial import Trial, adaptive, fixed, trial
from .urban import SCENE, TORQUE_RUNS, UrbanRun, urban_runs

RATIOS = (0.1, 0.3, 0.5, 1.0, 2.0, 5.0)
STEPS = (2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
QUICK_RATIOS, QUICK_STEPS, QUICK_CASES = (0.3,), (1e-3, 1e-2), ("planar",)

# the adaptive step: launch, lock-up and cruise, so that the pulses cease on the way
CRUISE = CoupledCase("cruise", {**URBAN_MODULE, "output_inertia": 0.3}, 200.0, 8.0, 3.0, 0.3, 0.1)
ADAPTIVE_SCHEMES = (
    "mean module first held",
    "mean module first ramp",
    "inertia module first ramp",
    "implicit ramp",
)

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6)


class Files(NamedTuple):
    """FMUs that take part, and the scene of the urban cycle."""

    module: Path
    shaft: Path
    scene: Path = SCENE


def coupling_map(files: Files, quick: bool, progress: Progress | None = None) -> list[Trial]:
    """All schemes over step, inertia ratio and case."""
    cases = QUICK_CASES if quick else tuple(CASES)
    ratios, steps = (QUICK_RATIOS, QUICK_STEPS) if quick else (RATIOS, STEPS)
    total = len(cases) * len(ratios) * len(SCHEMES)
    rows: list[Trial] = []
    for name in cases:
        for ratio in ratios:
            case = CASES[name](ratio)
            reference = Monolith(case).run()
            for scheme_name, scheme in SCHEMES.items():
                for step in steps:
                    rows.append(trial(case, scheme_name, scheme, step, fixed(step), reference, files.module))
                if progress is not None:
                    progress(len(rows) / len(steps) / total)
    return rows


def adaptive_steps(files: Files, quick: bool, progress: Progress | None = None) -> list[Trial]:
    """The adaptive step at each tolerance, each followed by equal steps at the same cost."""
    reference = Monolith(CRUISE).run()
    names = ADAPTIVE_SCHEMES[2:3] if quick else ADAPTIVE_SCHEMES
    tolerances = TOLERANCES[1:2] if quick else TOLERANCES
    rows: list[Trial] = []
    for name in names:
        scheme = SCHEMES[name]
        for tolerance in tolerances:
            stepper = adaptive(ErrorControl(tolerance))
            found = trial(CRUISE, f"{name}, {tolerance:g}", scheme, 0.0, stepper, reference, files.module)
            step = found.step
            rows.append(found)
            rows.append(trial(CRUISE, f"{name}, fixed", scheme, step, fixed(step), reference, files.module))
            if progress is not None:
                progress(len(rows) / (2 * len(names) * len(tolerances)))
    return rows


class Part(NamedTuple):
    """A part of the study: what its rows are, and what makes them."""

    kind: type[Any]
    run: Callable[[Files, bool, Progress | None], Sequence[Any]]


PARTS = {
    "limits": Part(Limit, lambda files, quick, progress: limits(files.module, progress)),
    "map": Part(Trial, coupling_map),
    "torque": Part(TorqueTrial, lambda files, quick, progress: torque_trials(files.module, quick, progress)),
    "adaptive": Part(Trial, adaptive_steps),
    "urban": Part(UrbanRun, lambda files, quick, progress: urban_runs(files.module, files.scene, progress)),
    "torque_urban": Part(
        UrbanRun,
        lambda files, quick, progress: urban_runs(files.module, files.scene, progress, TORQUE_RUNS),
    ),
    "shafts": Part(
        ShaftTrial, lambda files, quick, progress: shaft_trials((files.module, files.shaft), progress)
    ),
}
# left out of a quick study
LONG_PARTS = ("urban", "torque_urban", "shafts")


def chosen_parts(only: str | None, quick: bool) -> list[str]:
    """Names of the parts to run.

    Raises:
        ValueError: an unknown part.
    """
    if only is not None and only not in PARTS:
        raise ValueError(f"--only = {only} is refused: allowed is {', '.join(PARTS)}")
    if only is not None:
        return [only]
    return [name for name in PARTS if not (quick and name in LONG_PARTS)]


def write_part(folder: Path, name: str, rows: Sequence[Any]) -> dict[str, str]:
    """Write the rows of a part, and its picture if it has one; paths by what they are."""
    written = {name: str(write_rows(folder / f"coupling_{name}.csv", rows))}
    if name == "map":
        written["picture of the map"] = str(write_figure(folder / "coupling.png", map_figure(rows)))
    if name == "shafts":
        written["picture of the shafts"] = str(
            write_figure(folder / "coupling_shafts.png", shafts_figure(rows))
        )
    return written


def print_rows(name: str, rows: Sequence[Any]) -> None:
    """Print rows as a table."""
    from rich.table import Table

    from ...terminal import terminal

    table = Table(title=name, title_justify="left")
    for field in dataclasses.fields(rows[0]):
        table.add_column(field.name.replace("_", " "), no_wrap=True)
    for row in rows:
        values = dataclasses.astuple(row)
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in values))
    terminal(200).print(table)
