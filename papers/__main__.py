"""Draw the figures of the papers.

Run: python -m papers -o out/papers
"""

from __future__ import annotations

import typer

from inertia_module.cli import Answer, OutputFolder, command
from inertia_module.common.files import OUTPUT_FOLDER, writable_folder, write_figure
from inertia_module.common.terminal import progress_bar

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


@app.command()
@command
def papers(output: OutputFolder = None) -> Answer:
    """Draw the figures of the papers.

    Writes PNG, SVG and the data as CSV. Default output folder: out/papers.
    """
    from inertia_module.fmi.results import write_columns

    from .figures import FIGURES, numbers

    files: list[str] = []
    with progress_bar("drawing the papers") as progress:
        folder = writable_folder(output or OUTPUT_FOLDER / "papers")
        for number, (name, draw) in enumerate(FIGURES.items(), 1):
            figure = draw()
            files += [str(write_figure(folder / f"{name}.{kind}", figure)) for kind in ("png", "svg")]
            files.append(str(write_columns(folder / f"{name}.csv", numbers(figure))))
            progress(number / len(FIGURES))
    return Answer({"files": files}, files)


if __name__ == "__main__":
    app(prog_name="python -m papers")
