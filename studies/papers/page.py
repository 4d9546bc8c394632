"""docs/papers.md: every equation and every claim of the papers, with the verdict and the figures found."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.resources import files
from types import ModuleType

from inertia_module.contract import driven_shaft_variables, variables
from inertia_module.contract.variable import Variable

from . import karetin, lysenko, stelmashchuk

PAPERS: tuple[ModuleType, ...] = (karetin, lysenko, stelmashchuk)
# a section of equations.md: the name of an equation, and the rest of its heading
SECTION = re.compile(r"^#### (.+?): (.+)\n", re.M)


def papers_page() -> str:
    """The page in Markdown: the words of page.md of each paper, with what is found now in their places."""
    cells = {"fmu": _cells(variables.BY_NAME), "shaft": _cells(driven_shaft_variables.BY_NAME)}
    parts = [words(__package__)]
    for paper in PAPERS:
        found = {**paper.findings(), **cells, "equations": equations(paper)}
        parts.append(words(paper).format_map(found))
    return "\n".join(parts)


def _cells(known: Mapping[str, Variable]) -> dict[str, str]:
    """Cells of a table that tell of a symbol what variable of the FMU it is."""
    return {
        name: f"`{name}` | {variable.unit} | " + variable.description.replace("|", r"\|")
        for name, variable in known.items()
    }


def equations(paper: ModuleType) -> str:
    """The words of equations.md of a paper, a verdict below each heading."""

    def judged(heading: re.Match[str]) -> str:
        return f"{heading[0]}\n{paper.EQUATIONS[heading[1]]}\n"

    return SECTION.sub(judged, words(paper, "equations.md"))


def words(package: ModuleType | str, name: str = "page.md") -> str:
    """A text beside the code of a paper."""
    return files(package).joinpath(name).read_text(encoding="utf-8")
