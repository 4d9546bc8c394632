"""docs/papers.md: every equation and every claim of the papers, with the verdict and the figures found."""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

from inertia_module.contract import driven_shaft, variables

from . import karetin, lysenko, stelmashchuk
from .engine import claims_of

PAPERS: tuple[ModuleType, ...] = (karetin, lysenko, stelmashchuk)
# a section of the equations of a paper: the name of an equation, and the rest of its heading
SECTION = re.compile(r"^#### (.+?): (.+)\n", re.M)


def papers_page() -> str:
    """The page in Markdown: the words beside the code of each paper, with what is found in their places."""
    # of a symbol, the cells of a table that tell what variable of the FMU it is
    cells = {
        fmu: {
            name: f"`{name}` | {variable.unit} | " + variable.description.replace("|", r"\|")
            for name, variable in known.items()
        }
        for fmu, known in (("fmu", variables.BY_NAME), ("shaft", driven_shaft.BY_NAME))
    }
    parts = [words("papers.md")]
    for paper in PAPERS:
        found = {**claims_of(paper), **cells, "equations": equations(paper)}
        parts.append(words(f"{name_of(paper)}.md").format_map(found))
    return "\n".join(parts)


def equations(paper: ModuleType) -> str:
    """The words on the equations of a paper, a verdict below each heading."""

    def judged(heading: re.Match[str]) -> str:
        return f"{heading[0]}\n{paper.EQUATIONS[heading[1]]}\n"

    return SECTION.sub(judged, words(f"{name_of(paper)}_equations.md"))


def name_of(paper: ModuleType) -> str:
    """Name of a paper, that of its first author."""
    return paper.__name__.rpartition(".")[2]


def words(name: str) -> str:
    """A text beside the code."""
    return Path(__file__).with_name(name).read_text(encoding="utf-8")
