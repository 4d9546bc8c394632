"""docs/papers.md: every equation and every claim of the papers, with the verdict and the figures found."""

from __future__ import annotations

import re

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE

from . import karetin, lysenko, stelmashchuk
from .engine import claims_of, words

PAPERS = {"karetin": karetin, "lysenko": lysenko, "stelmashchuk": stelmashchuk}
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
        for fmu, known in (("fmu", INERTIA_MODULE.by_name), ("shaft", DRIVEN_SHAFT.by_name))
    }
    parts = [words("papers.md")]
    for name, paper in PAPERS.items():
        found = {**claims_of(name, paper), **cells, "equations": equations(name)}
        parts.append(words(f"{name}.md").format_map(found))
    return "\n".join(parts)


def equations(paper: str) -> str:
    """The words on the equations of a paper, below each heading the verdict on its forms, if it has them."""
    found = PAPERS[paper].EQUATIONS

    def judged(heading: re.Match[str]) -> str:
        return heading[0] + (f"\n{found[heading[1]]}\n" if heading[1] in found else "")

    return SECTION.sub(judged, words(f"{paper}_equations.md"))
