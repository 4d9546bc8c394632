"""docs/papers.md: every equation and every claim of the papers, with the verdict and the figures found."""

from __future__ import annotations

from importlib.resources import files
from types import ModuleType

from . import karetin, lysenko, stelmashchuk
from .symbols import symbols_tables

PAPERS: tuple[ModuleType, ...] = (karetin, lysenko, stelmashchuk)


def papers_page() -> str:
    """The page in Markdown: the words of page.md of each paper, with what is found now in their places."""
    parts = [files(__package__).joinpath("page.md").read_text(encoding="utf-8")]
    symbols = {"symbols": symbols_tables()}
    for paper in PAPERS:
        found = {claim.__name__: claim() for claim in paper.CLAIMS}
        words = files(paper).joinpath("page.md").read_text(encoding="utf-8")
        parts.append(words.format_map(paper.EQUATIONS | found | symbols))
    return "\n".join(parts)
