"""The parts of the study: each gives rows, which are written as CSV; the map is drawn too."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from inertia_module.harness.results import heading, write_figure, write_rows
from inertia_module.harness.simulate import Progress

from .case import CASES
from .figure import map_figure
from .reference import one_piece
from .trial import COUPLINGS, Trial, trial

MAP, URBAN = PARTS = ("map", "urban")
RATIOS = (0.1, 0.3, 0.5, 1.0, 2.0, 5.0)
# 2 ms does not divide the sample time of the governor (5 ms); 10 and 20 ms are longer
STEPS = (2e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2)
QUICK_CASES, QUICK_RATIOS, QUICK_STEPS = ("planar",), (0.5,), (1e-3, 5e-3)


def coupling_map(fmu_path: Path, quick: bool, progress: Progress | None = None) -> list[Trial]:
    """All couplings over step, inertia ratio and case; quick: a corner of it."""
    names = QUICK_CASES if quick else tuple(CASES)
    ratios, steps = (QUICK_RATIOS, QUICK_STEPS) if quick else (RATIOS, STEPS)
    total = len(names) * len(ratios) * len(COUPLINGS)
    rows: list[Trial] = []
    for name in names:
        for ratio in ratios:
            case = CASES[name](ratio)
            reference = one_piece(case)
            for coupling in COUPLINGS:
                rows += [trial(case, coupling, step, reference, fmu_path) for step in steps]
                if progress is not None:
                    progress(len(rows) / len(steps) / total)
    return rows


def chosen_parts(only: str | None, quick: bool) -> tuple[str, ...]:
    """Names of the parts to run; quick: not the long one.

    Raises:
        ValueError: an unknown part.
    """
    if only is None:
        return (MAP,) if quick else PARTS
    if only not in PARTS:
        raise ValueError(f"--only must be one of {', '.join(PARTS)}, is {only}")
    return (only,)


def write_part(folder: Path, name: str, rows: Sequence[Any]) -> dict[str, str]:
    """Write the rows of a part as CSV, whole or not at all, and the picture of the map.

    Returns:
        Paths by what they are.
    """
    names = [heading(one.name, rows[0].UNITS.get(one.name, "")) for one in dataclasses.fields(rows[0])]
    # six digits: further ones depend on the machine
    cells = ([f"{v:.6g}" if isinstance(v, float) else v for v in dataclasses.astuple(row)] for row in rows)
    written = {name: str(write_rows(folder / f"coupling_{name}.csv", names, cells))}
    if name == MAP:
        written["picture of the map"] = str(write_figure(folder / "coupling.png", map_figure(rows)))
    return written


def print_rows(name: str, rows: Sequence[Any]) -> None:
    """Print rows as a table."""
    from rich.table import Table

    from inertia_module.common.terminal import terminal

    table = Table(title=name, title_justify="left")
    for field in dataclasses.fields(rows[0]):
        table.add_column(field.name.replace("_", " "), no_wrap=True)
    for row in rows:
        values = dataclasses.astuple(row)
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in values))
    terminal(200).print(table)
