"""Commands that reproduce pages of the documentation: the papers, the extremes, couplings.

Run: python -m studies papers, stability or coupling, at the root of the project.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from inertia_module.cli import (
    Answer,
    OutputFolder,
    command,
    current_fmu,
    folder_for,
)
from inertia_module.common.files import write_figure
from inertia_module.common.terminal import progress_bar

CAR_SCENE = Path("examples/urban.toml")
app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@app.command()
@command
def papers(output: OutputFolder = None) -> Answer:
    """Draw the figures of the papers.

    As PNG and SVG, their numbers as CSV (out/papers without -o).
    """
    from inertia_module.harness.results import write_columns

    from .papers.figures import FIGURES, numbers

    files: list[str] = []
    with progress_bar("drawing the papers") as progress:
        folder = folder_for(output, "papers")
        for number, (name, draw) in enumerate(FIGURES.items(), 1):
            figure = draw()
            files += [str(write_figure(folder / f"{name}.{kind}", figure)) for kind in ("png", "svg")]
            files.append(str(write_columns(folder / f"{name}.csv", numbers(figure))))
            progress(number / len(FIGURES))
    return Answer({"files": files}, files)


@app.command()
@command
def stability(
    output: OutputFolder = None,
    quick: Annotated[bool, typer.Option("--quick", help="Leave out the long runs.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="AXIS", help="One axis of the map.")] = None,
    random: Annotated[
        int, typer.Option("--random", metavar="N", min=0, help="N random motions in place of the map.")
    ] = 0,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Of the random motions.")] = 1,
    losses: Annotated[
        bool, typer.Option("--losses", help="Random motions with losses by load, drag and gravity.")
    ] = False,
) -> Answer:
    """Try the extremes and give each a verdict.

    In out/stability without -o. With --random they are random mechanisms under random inputs. Exit code 1 if
    one is broken or fails.
    """
    folder = folder_for(output, "stability")
    if random:
        return _random_motions(random, seed, losses, folder)
    from .stability import verdicts

    chosen = verdicts.chosen_cases(only, quick)
    with progress_bar("trying the extremes") as progress:
        found = verdicts.run_study(chosen, progress)
    rows = verdicts.rows_of(found)
    files = {
        "verdicts": verdicts.write_rows(folder / "stability.csv", rows),
        "cases": verdicts.write_cases(folder / "cases.csv", found),
        "map": write_figure(folder / "stability.png", verdicts.verdict_map(rows)),
        "summary": write_figure(folder / "stability_summary.png", verdicts.summary(rows)),
    }
    told = {"verdicts": [verdict.as_record() for verdict in found]}
    broken = any(verdict.outcome == "broken" for verdict in found)
    return Answer(told, [partial(verdicts.print_rows, rows)], files, broken)


def _random_motions(number: int, seed: int, losses: bool, folder: Path) -> Answer:
    """Run random motions, print what does not hold with what reproduces it, write the counts."""
    from inertia_module.harness.results import write_rows

    from .stability.random_motions import HEADINGS, findings, print_outcomes, rows_of, run_random

    with progress_bar("trying random motions") as progress:
        outcomes = run_random(number, seed, folder, progress, losses)
    path = folder / ("random_losses.csv" if losses else "random.csv")
    files = {"invariants": write_rows(path, HEADINGS, rows_of(outcomes))}
    failed = any(outcome.finding.failed for outcome in outcomes)
    return Answer({"findings": findings(outcomes)}, [partial(print_outcomes, outcomes)], files, failed)


@app.command()
@command
def coupling(
    scene: Annotated[
        Path, typer.Argument(metavar="[SCENE.toml]", help="Scene of the car in the urban cycle.")
    ] = CAR_SCENE,
    output: OutputFolder = None,
    quick: Annotated[bool, typer.Option("--quick", help="A corner of the map.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="PART", help="map or urban.")] = None,
) -> Answer:
    """Measure the recommended ways to couple an engine.

    In out/coupling without -o.
    """
    from .coupling import MAP, PARTS, coupling_map, print_rows, urban_runs, write_part

    folder = folder_for(output, "coupling")
    if only is not None and only not in PARTS:
        raise ValueError(f"--only must be one of {', '.join(PARTS)}, is {only}")
    # the cycle is not quick
    chosen = (only,) if only else (MAP,) if quick else PARTS
    fmu_path = current_fmu()
    told: dict[str, Any] = {}
    shown: list[partial[None]] = []
    files: dict[str, Path] = {}
    for name in chosen:
        with progress_bar(f"measuring: {name}") as progress:
            rows: Sequence[Any] = (
                coupling_map(fmu_path, quick, progress)
                if name == MAP
                else urban_runs(fmu_path, scene, progress)
            )
        told[name] = [asdict(row) for row in rows]
        shown.append(partial(print_rows, name, rows))
        files |= write_part(folder, name, rows)
    return Answer({"rows": told}, shown, files)


if __name__ == "__main__":
    app(prog_name="python -m studies")
