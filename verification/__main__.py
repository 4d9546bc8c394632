"""Commands that reproduce pages of the documentation and the reference results of the FMUs.

Run: python -m verification stability, references or compatibility, at the root of the project.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.table import Table

from inertia_module.cli import Answer, OutputFolder, Shown, aside, command
from inertia_module.common.files import OUTPUT_FOLDER, writable_folder, write_atomically, write_figure
from inertia_module.common.terminal import progress_bar, terminal
from inertia_module.interface.models import MODELS

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def print_table(title: str, headings: Iterable[str], rows: Iterable[Iterable[Any]]) -> None:
    """Print a table; floats have three significant digits.

    Args:
        title: Title of the table.
        headings: Headings of the columns.
        rows: Cells by row.
    """
    table = Table(*headings, title=title, box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for row in rows:
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row))
    terminal(200).print(table)


@app.command()
@command
def stability(
    output: OutputFolder = None,
    quick: Annotated[bool, typer.Option("--quick", help="Omit the long runs.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="AXIS", help="Run only this axis.")] = None,
    random: Annotated[
        int, typer.Option("--random", metavar="N", min=0, help="Run N random motions instead of the map.")
    ] = 0,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Random seed of the random motions.")] = 1,
    losses: Annotated[
        bool,
        typer.Option("--losses", help="Add load-dependent losses, windage and gravity."),
    ] = False,
) -> Answer:
    """Run extreme cases and classify each one.

    With --random the cases are random mechanisms with random inputs. Exits with code 1 if any case is broken
    or fails. Default output folder: out/stability.
    """
    folder = writable_folder(output or OUTPUT_FOLDER / "stability")
    if random:
        return _random_motions(random, seed, losses, folder)
    from .stability import verdicts

    cases = verdicts.chosen_cases(only, quick)
    with progress_bar("running extreme cases") as progress:
        results = verdicts.run_study(cases, progress)
    rows = verdicts.rows_of(results)
    files = {
        "verdicts": verdicts.write_rows(folder / "stability.csv", rows),
        "summary": write_figure(folder / "stability_summary.png", verdicts.summary(rows)),
    }
    counts = [
        (axis, level, *(count[name] for name in verdicts.OUTCOMES), max_error)
        for axis in dict.fromkeys(row.axis for row in rows)
        for level, (count, max_error) in verdicts.counts([row for row in rows if row.axis == axis]).items()
    ]
    headings = "axis", "fidelity level", *verdicts.OUTCOMES, "maximum error"
    total = Counter(verdict.outcome for verdict in results)
    parts: list[Shown] = [
        partial(print_table, "", headings, counts),
        *verdicts.reasons(rows),
        ", ".join(f"{total[name]} {name}" for name in verdicts.OUTCOMES),
    ]
    data = {"verdicts": [verdict.as_record() for verdict in results]}
    return Answer(data, parts, files, total[verdicts.BROKEN] > 0)


def _random_motions(number: int, seed: int, losses: bool, folder: Path) -> Answer:
    """Run random motions, print violated invariants with a reproducer, and write the counts.

    Args:
        number: Number of motions.
        seed: Random seed.
        losses: True to add losses and gravity.
        folder: Output folder.
    """
    from inertia_module.fmi.results import write_rows

    from .stability.random_motions import HEADINGS, findings, rows_of, run_random

    with progress_bar("running random motions") as progress:
        outcomes = run_random(number, seed, folder, progress, losses)
    rows, violations = rows_of(outcomes), findings(outcomes)
    path = folder / ("random_losses.csv" if losses else "random.csv")
    template = "{count} of {level}: {what}\nnumber {number}: {sentence}\n{reproducer}"
    parts: list[Shown] = [
        partial(print_table, "", HEADINGS, rows),
        *(template.format_map(violation) for violation in violations),
    ]
    files = {"invariants": write_rows(path, HEADINGS, rows)}
    failed = any(outcome.finding.failed for outcome in outcomes)
    return Answer({"findings": violations}, parts, files, failed)


@app.command()
@command
def references() -> Answer:
    """Recompute the reference results of the FMUs in the package."""
    from .reference.experiments import files, package_folder

    paths = list[Path]()
    with progress_bar("integrating the references") as progress:
        for number, model in enumerate(MODELS.values(), 1):
            for name, content in files(model).items():
                paths.append(package_folder(model) / name)
                write_atomically(paths[-1], content)
            progress(number / len(MODELS))
    return Answer({"files": list(map(str, paths))}, [f"wrote {path}" for path in paths])


@app.command()
@command
def compatibility(output: OutputFolder = None) -> Answer:
    """Write the FMUs with their inputs for importer tests.

    Exits with code 1 if FMPy finds problems. Default output folder: out/compatibility.
    """
    from .compatibility import write_tree

    paths, problems = write_tree(writable_folder(output or OUTPUT_FOLDER / "compatibility"), aside)
    parts = [*(f"wrote {path}" for path in paths), *problems, f"{len(problems) or 'no'} problems found"]
    return Answer({"files": list(map(str, paths)), "problems": problems}, parts, failed=bool(problems))


if __name__ == "__main__":
    app(prog_name="python -m verification")
