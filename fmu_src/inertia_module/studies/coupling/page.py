"""docs/coupling.md from the committed rows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from .figure import worst
from .limits import GREATEST_RATIO, STEPS, Limit
from .rows import read_rows
from .shafts import ShaftTrial
from .study import CRUISE
from .tables import percent, table
from .text import ADAPTIVE, HEAD, INDICATOR, LIMITS, MAP, RECOMMENDED, SHAFTS, URBAN
from .torque import TorqueTrial
from .torque_page import torque_section
from .trial import STABLE, Trial
from .urban import UrbanRun

GOOD = 0.01


def _ratio(value: float) -> str:
    return "none" if math.isinf(value) else f"{value:.2f}"


def limits_table(rows: Sequence[Limit]) -> Iterator[str]:
    """Limits of Phi/J_E by theory and as measured."""
    heads = ("scheme", "theory", *(f"measured, {1e3 * step:g} ms" for step in STEPS), "inertia felt")
    cells = [
        (row.scheme, _ratio(row.theory), _ratio(row.short), _ratio(row.long), f"{round(100 * row.felt)} %")
        for row in rows
    ]
    yield from table(heads, cells)


def longest_steps(rows: Sequence[Trial]) -> Iterator[str]:
    """The longest step up to which all errors are below GOOD, ms, by scheme and ratio."""
    for case in dict.fromkeys(row.case for row in rows):
        here = [row for row in rows if row.case == case]
        ratios = sorted({row.ratio for row in here})
        yield f"**{case}**, longest step with all errors below {100 * GOOD:g} %, ms, over Φ/J_E (–: none of"
        yield "those tried; unstable: the shortest is):\n"
        cells = []
        for name in dict.fromkeys(row.scheme for row in here):
            line = [name]
            for ratio in ratios:
                good = [row for row in here if (row.scheme, row.ratio) == (name, ratio)]
                steps: list[float] = []
                for row in sorted(good, key=lambda row: row.step):
                    if not worst(row) < GOOD:
                        break
                    steps.append(row.step)
                unstable = min(good, key=lambda row: row.step).word != STABLE
                line.append(f"{1e3 * steps[-1]:g}" if steps else ("unstable" if unstable else "–"))
            cells.append(line)
        yield from table(("scheme", *(f"{ratio:g}" for ratio in ratios)), cells)


def errors_table(rows: Sequence[Trial], case: str, ratio: float) -> Iterator[str]:
    """Errors in percent over the step: omega1 / omega_out / energy."""
    here = [row for row in rows if (row.case, row.ratio) == (case, ratio)]
    steps = sorted({row.step for row in here if row.word == STABLE})
    cells = []
    for name in dict.fromkeys(row.scheme for row in here):
        line = [name]
        for step in steps:
            row = next((row for row in here if row.scheme == name and row.step == step), None)
            if row is None or row.word != STABLE:
                line.append("unstable")
            else:
                errors = (row.speed_error, row.output_error, row.energy_error)
                line.append(" / ".join(percent(error) for error in errors))
        cells.append(line)
    yield from table(("scheme", *(f"{1e3 * step:g} ms" for step in steps)), cells)


def adaptive_table(rows: Sequence[Trial]) -> Iterator[str]:
    """Adaptive steps and equal ones at the same cost, side by side."""
    cells = []
    for found, equal in zip(rows[::2], rows[1::2], strict=True):
        name, _, tolerance = found.scheme.rpartition(", ")
        cells.append(
            [
                name,
                tolerance,
                f"{found.cost:.0f}",
                *(
                    f"{percent(a)} / {percent(b)}"
                    for a, b in (
                        (found.speed_error, equal.speed_error),
                        (found.output_error, equal.output_error),
                        (found.energy_error, equal.energy_error),
                    )
                ),
            ]
        )
    heads = ("scheme", "tolerance", "steps a second", "ω1, %", "ω_out, %", "energy, %")
    yield from table(heads, cells)


def indicator_table(rows: Sequence[Trial]) -> Iterator[str]:
    """How closely the residual of the bond goes with the errors, over steps, ratios and cases."""
    cells = []
    for name in dict.fromkeys(row.scheme for row in rows):
        known = [row for row in rows if row.scheme == name and row.word == STABLE and row.residual > 0.0]
        residuals = np.log([row.residual for row in known])
        errors = np.log([max(row.speed_error, row.output_error) for row in known])
        energy = np.log([max(abs(row.energy_error), 1e-9) for row in known])
        cells.append(
            (
                name,
                f"{len(known)}",
                f"{np.corrcoef(residuals, errors)[0, 1]:.2f}",
                f"{np.corrcoef(residuals, energy)[0, 1]:.2f}",
                f"{math.exp(float(np.median(residuals - errors))):.2g}",
            )
        )
    heads = (
        "scheme",
        "stable runs",
        "correlation with speed errors",
        "with energy lost",
        "residual / error, median",
    )
    yield from table(heads, cells)


def _share(value: float) -> str:
    """In percent; what is rounding has no sign."""
    return f"{round(100 * value, 3) + 0.0:.3f}" if abs(value) < 0.01 else f"{100 * value:.1f}"


def urban_table(rows: Sequence[UrbanRun]) -> Iterator[str]:
    """Energy balance over the urban cycle."""
    cells = [
        (
            row.scheme,
            f"{1e3 * row.step:g}",
            f"{row.engine / 1e3:.1f}",
            f"{row.output / 1e3:.1f}",
            f"{row.stored / 1e3:.2f}",
            _share(row.residual),
            f"{100 * row.gross:.1f}",
            f"{3.6 * row.speed_error:.2f}",
            f"{row.cost:.0f}",
        )
        for row in rows
    ]
    heads = (
        "scheme",
        "step, ms",
        "engine, kJ",
        "load, kJ",
        "stored, kJ",
        "not accounted for, %",
        "gross, %",
        "car, km/h rms",
        "cost a second",
    )
    yield from table(heads, cells)


def shafts_table(rows: Sequence[ShaftTrial]) -> Iterator[str]:
    """Errors of hub and driven mass and of the energy over step and stiffness."""
    for stiffness in dict.fromkeys(row.stiffness for row in rows):
        here = [row for row in rows if row.stiffness == stiffness]
        steps = sorted({row.step for row in here})
        swings = {row.step: row.swing for row in here}
        yield f"c = {stiffness:g} N·m/rad\n"
        cells = []
        for name in dict.fromkeys(row.scheme for row in here):
            line = [name]
            for step in steps:
                row = next(row for row in here if row.scheme == name and row.step == step)
                errors = (row.hub_error, row.driven_error, row.bond_error)
                line.append(" / ".join(percent(error) for error in errors) if row.stable else "unstable")
            cells.append(line)
        yield from table(("scheme", *(f"{step:g} s, {swings[step]:.2g}" for step in steps)), cells)


def coupling_page(folder: Path) -> str:
    """The page in Markdown.

    Args:
        folder: with the rows, coupling_PART.csv.
    """

    def rows(part: str, kind: type) -> list:  # type: ignore[type-arg]
        return read_rows(folder / f"coupling_{part}.csv", kind)

    trials = rows("map", Trial)
    lines = [
        HEAD,
        RECOMMENDED,
        *torque_section(rows("torque", TorqueTrial)),
        LIMITS.format(greatest=GREATEST_RATIO),
        *limits_table(rows("limits", Limit)),
        MAP,
        *longest_steps(trials),
        "**planar**, Φ/J_E = 0.3, errors of ω1 / ω_out / energy, %\n",
        *errors_table(trials, "planar", 0.3),
        "**planar**, Φ/J_E = 1\n",
        *errors_table(trials, "planar", 1.0),
        INDICATOR,
        *indicator_table(trials),
        ADAPTIVE.format(ratio=CRUISE.ratio, stop=CRUISE.stop_time),
        *adaptive_table(rows("adaptive", Trial)),
        URBAN,
        *urban_table([*rows("urban", UrbanRun), *rows("torque_urban", UrbanRun)]),
        SHAFTS,
        *shafts_table(rows("shafts", ShaftTrial)),
    ]
    return "\n".join(lines).rstrip() + "\n"
