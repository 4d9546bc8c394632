"""Options of figures: format, and a single panel for a slide."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from ..common.files import write_figure
from .options import check_choice, enumeration, option

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
FigureFormat = Annotated[str, enumeration("Format of the figure.", FORMATS, "--format")]
FigurePanel = Annotated[
    int | None,
    option("Write only panel N of the figure (counted row by row), with large text for a slide.", "N", min=1),
]


def figure_path(folder: Path, name: str, file_format: str) -> Path:
    """Return the path of a figure.

    Args:
        folder: Output folder.
        name: Name of the figure without its ending.
        file_format: Value of --format.

    Raises:
        ValueError: The format is unknown.
    """
    check_choice("format", file_format, FORMATS)
    return folder / f"{name}.{file_format}"


def write_picture(path: Path, figure: Figure, panel: int | None) -> Path:
    """Write a figure or one of its panels.

    Args:
        path: Path of the file; its ending selects the format.
        figure: The figure.
        panel: Number of the panel; None for the whole figure.

    Returns:
        The path.

    Raises:
        ValueError: The figure has no such panel.
    """
    from ..plots.panels import single_panel

    return write_figure(path, figure if panel is None else single_panel(figure, panel))
