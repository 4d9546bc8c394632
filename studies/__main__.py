"""Commands that reproduce pages of the documentation: the papers, the extremes, couplings.

Run: python -m studies papers, stability or coupling, at the root of the project.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from inertia_module.cli.shared import Json, OutputFolder, current_fmu, folder_for, one_line_errors

CAR_SCENE = Path("examples/urban.toml")
app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@app.command()
def papers(output: OutputFolder = None, as_json: Json = False) -> None:
    """Draw the figures of the papers.

    As PNG and SVG, their numbers as CSV (out/papers without -o).
    """
    from inertia_module.harness.results import write_columns, write_figure
    from inertia_module.harness.simulate import progress_bar

    from .papers.figures import all_figures

    figures = all_figures()
    files: list[str] = []
    with one_line_errors(), progress_bar("drawing the papers", len(figures)) as progress:
        folder = folder_for(output, "papers")
        for number, (name, draw) in enumerate(figures.items(), 1):
            figure, columns = draw()
            files += [str(write_figure(folder / f"{name}.{kind}", figure)) for kind in ("png", "svg")]
            files.append(str(write_columns(folder / f"{name}.csv", columns)))
            progress(number)
    typer.echo(json.dumps({"files": files}) if as_json else "\n".join(files))


@app.command()
def stability(
    output: OutputFolder = None,
    as_json: Json = False,
    quick: Annotated[bool, typer.Option("--quick", help="Leave out the long runs.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="AXIS", help="One axis of the map.")] = None,
    random: Annotated[
        int, typer.Option("--random", metavar="N", min=0, help="N random motions in place of the map.")
    ] = 0,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Of the random motions.")] = 1,
    losses: Annotated[
        bool, typer.Option("--losses", help="Random motions with losses by load, drag and gravity.")
    ] = False,
) -> None:
    """Try the extremes and give each a verdict.

    In out/stability without -o. With --random they are random mechanisms under random inputs. Exit code 1 if
    one is broken or fails.
    """
    if random:
        _random_motions(random, seed, losses, output, as_json)
        return
    from inertia_module.harness.results import write_figure
    from inertia_module.harness.simulate import progress_bar

    from .stability import verdicts as extremes

    with one_line_errors():
        folder = folder_for(output, "stability")
        chosen = extremes.chosen_cases(only, quick)
        with progress_bar("trying the extremes") as progress:
            verdicts = extremes.run_study(chosen, progress)
        rows = extremes.rows_of(verdicts)
        files = {
            "verdicts": extremes.write_rows(folder / "stability.csv", rows),
            "cases": extremes.write_cases(folder / "cases.csv", verdicts),
            "map": write_figure(folder / "stability.png", extremes.verdict_map(rows)),
            "summary": write_figure(folder / "stability_summary.png", extremes.summary(rows)),
        }
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        typer.echo(json.dumps({"verdicts": [verdict.as_record() for verdict in verdicts], "files": listed}))
    else:
        extremes.print_rows(rows)
        for name, file in files.items():
            typer.echo(f"{name}: {file}")
    if any(verdict.outcome == "broken" for verdict in verdicts):
        raise typer.Exit(1)


def _random_motions(number: int, seed: int, losses: bool, output: Path | None, as_json: bool) -> None:
    """Run random motions, print what does not hold with what reproduces it, write the counts."""
    from inertia_module.harness.results import write_rows
    from inertia_module.harness.simulate import progress_bar

    from .stability.random_motions import HEADINGS, findings, print_outcomes, rows_of, run_random

    with one_line_errors():
        folder = folder_for(output, "stability")
        with progress_bar("trying random motions") as progress:
            outcomes = run_random(number, seed, folder, progress, losses)
        path = folder / ("random_losses.csv" if losses else "random.csv")
        file = write_rows(path, HEADINGS, rows_of(outcomes))
    if as_json:
        typer.echo(json.dumps({"findings": findings(outcomes), "files": {"invariants": str(file)}}))
    else:
        print_outcomes(outcomes)
        typer.echo(f"invariants: {file}")
    if any(outcome.finding.failed for outcome in outcomes):
        raise typer.Exit(1)


@app.command()
def coupling(
    scene: Annotated[
        Path, typer.Argument(metavar="[SCENE.toml]", help="Scene of the car in the urban cycle.")
    ] = CAR_SCENE,
    output: OutputFolder = None,
    as_json: Json = False,
    quick: Annotated[bool, typer.Option("--quick", help="A corner of the map.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="PART", help="map or urban.")] = None,
) -> None:
    """Measure the recommended ways to couple an engine.

    In out/coupling without -o.
    """
    from dataclasses import asdict

    from inertia_module.harness.simulate import progress_bar

    from .coupling import MAP, chosen_parts, coupling_map, print_rows, urban_runs, write_part

    with one_line_errors():
        folder = folder_for(output, "coupling")
        chosen = chosen_parts(only, quick)
        fmu_path = current_fmu()
        found: dict[str, Sequence[Any]] = {}
        written: dict[str, str] = {}
        for name in chosen:
            with progress_bar(f"measuring: {name}") as progress:
                if name == MAP:
                    found[name] = coupling_map(fmu_path, quick, progress)
                else:
                    found[name] = urban_runs(fmu_path, scene, progress)
            written.update(write_part(folder, name, found[name]))
    if as_json:
        rows = {name: [asdict(row) for row in part] for name, part in found.items()}
        typer.echo(json.dumps({"rows": rows, "files": written}))
        return
    for name, part in found.items():
        print_rows(name, part)
    for name, file in written.items():
        typer.echo(f"{name}: {file}")


if __name__ == "__main__":
    app(prog_name="python -m studies")
