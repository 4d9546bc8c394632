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

from inertia_module.cli import Answer, OutputFolder, OutputPart, command, print_to_stderr
from inertia_module.common.files import OUTPUT_FOLDER, writable_folder, write_atomically
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
        int,
        typer.Option("--random", metavar="N", min=0, help="Run N random machines instead of the extremes."),
    ] = 0,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Random seed of the machines.")] = 1,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", metavar="W", min=1, help="Processes of the random machines (all processors)."
        ),
    ] = None,
) -> Answer:
    """Run extreme cases or random machines and classify each one.

    Writes stability.csv or random.csv. Exits with code 1 if any case is broken or any random machine fails a
    check. Default output folder: out/stability. Example: python -m verification stability --random 100
    """
    folder = writable_folder(output or OUTPUT_FOLDER / "stability")
    if random:
        return _random_machines(random, seed, workers, folder)
    from .stability import verdicts

    cases = verdicts.chosen_cases(only, quick)
    with progress_bar("running extreme cases") as progress:
        results = verdicts.run_study(cases, progress)
    rows = verdicts.rows_of(results)
    counts = [(axis, *cells) for axis, *cells in verdicts.counts(rows)]
    total = Counter(verdict.outcome for verdict in results)
    parts: list[OutputPart] = [
        partial(print_table, "", ("axis", "cases", *verdicts.VERDICTS, "maximum error"), counts),
        *verdicts.reasons(rows),
        ", ".join(f"{total[name]} {name}" for name in verdicts.VERDICTS),
    ]
    files = {"verdicts": verdicts.write_rows(folder / "stability.csv", rows)}
    data = {"verdicts": [verdict.as_record() for verdict in results]}
    return Answer(data, parts, files, total[verdicts.BROKEN] > 0)


def _random_machines(count: int, seed: int, workers: int | None, folder: Path) -> Answer:
    """Run random machines, print a row for each level and all that are not exact, write random.csv.

    Args:
        count: number of machines.
        seed: random seed.
        workers: number of processes; None for one per processor.
        folder: output folder.
    """
    from .stability import random_motions as machines
    from .stability.verdicts import BROKEN, DEGRADED, EXACT, VERDICTS

    with progress_bar("running random machines") as progress:
        rows = machines.examine_machines(count, seed, workers, progress)
    headings = "fidelity level", "cases", *VERDICTS, "judged", "median error", "maximum error"
    others = [row for row in rows if row.verdict != EXACT]
    parts: list[OutputPart] = [
        partial(print_table, "", headings, machines.counts(rows)),
        *(f"number {row.number} ({row.level}): {row.verdict}: {row.reason}" for row in others),
    ]
    files = {"machines": machines.write_rows(folder / "random.csv", rows)}
    has_failed = any(row.verdict in (DEGRADED, BROKEN) for row in rows)
    return Answer({"machines": [row._asdict() for row in rows]}, parts, files, has_failed)


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

    paths, problems = write_tree(writable_folder(output or OUTPUT_FOLDER / "compatibility"), print_to_stderr)
    parts = [*(f"wrote {path}" for path in paths), *problems, f"{len(problems) or 'no'} problems found"]
    return Answer({"files": list(map(str, paths)), "problems": problems}, parts, failed=bool(problems))


if __name__ == "__main__":
    app(prog_name="python -m verification")
