"""docs/papers.md: every equation and every claim of the papers, with the verdict and the figures found."""

from __future__ import annotations

import re
from importlib.resources import files
from types import ModuleType

from . import karetin, lysenko, stelmashchuk
from .symbols import symbols_tables

PAPERS: tuple[ModuleType, ...] = (karetin, lysenko, stelmashchuk)
# a section of equations.md: the name of an equation, and the rest of its heading
SECTION = re.compile(r"^#### (.+?): (.+)\n", re.M)


def papers_page() -> str:
    """The page in Markdown: the words of page.md of each paper, with what is found now in their places."""
    parts = [_words(__package__)]
    symbols = {"symbols": symbols_tables()}
    for paper in PAPERS:
        found = {claim.__name__: claim() for claim in paper.CLAIMS}
        found["equations"] = equations(paper)
        parts.append(_words(paper).format_map(found | symbols))
    return "\n".join(parts)


def equations(paper: ModuleType) -> str:
    """The words of equations.md of a paper, a verdict below each heading."""

    def judged(heading: re.Match[str]) -> str:
        return f"{heading[0]}\n{paper.EQUATIONS[heading[1]]}\n"

    return SECTION.sub(judged, _words(paper, "equations.md"))


def _words(package: ModuleType | str, name: str = "page.md") -> str:
    return files(package).joinpath(name).read_text(encoding="utf-8")
