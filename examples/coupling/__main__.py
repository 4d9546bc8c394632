"""Compare the recommended ways to couple an engine to the module.

Run: python -m examples.coupling -o out/coupling (at the root of the project)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import typer

from inertia_module.cli import Answer, OutputFolder, OutputPart, command
from inertia_module.common.files import OUTPUT_FOLDER, writable_folder
from inertia_module.common.terminal import progress_bar
from verification.__main__ import print_table

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


@app.command()
@command
def coupling(output: OutputFolder = None) -> Answer:
    """Compare the recommended ways to couple an engine.

    Default output folder: out/coupling.
    """
    from examples.coupling.study import MAP, URBAN, coupling_map, urban_runs, write_part
    from inertia_module import current_fmu

    folder = writable_folder(output or OUTPUT_FOLDER / "coupling")
    fmu_path = current_fmu()
    parts: dict[str, Callable[..., Sequence[Any]]] = {MAP: coupling_map, URBAN: urban_runs}
    data: dict[str, Any] = {}
    tables: list[OutputPart] = []
    files: dict[str, Path] = {}
    for name, measure in parts.items():
        with progress_bar(f"measuring: {name}") as progress:
            rows = measure(fmu_path, progress)
        data[name] = [row._asdict() for row in rows]
        tables.append(partial(print_table, name, rows[0]._fields, rows))
        files |= write_part(folder, name, rows)
    return Answer({"rows": data}, tables, files)


if __name__ == "__main__":
    app(prog_name="python -m examples.coupling")
