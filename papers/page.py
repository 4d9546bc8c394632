"""Generate docs/papers/index.md: the equations and claims of the papers with verdicts and computed values."""

from __future__ import annotations

import re

from inertia_module.interface.models import DRIVEN_SHAFT, INERTIA_MODULE

from . import karetin, lysenko, stelmashchuk
from .engine import claims_of, read_file

PAPERS = {"karetin": karetin, "lysenko": lysenko, "stelmashchuk": stelmashchuk}
# Heading of an equation: its number and its title.
SECTION = re.compile(r"^#### (.+?): (.+)\n", re.M)


def papers_page() -> str:
    """Return the page in Markdown: the text of each paper with its computed values filled in."""
    # Table cells of each variable of the FMUs: name, unit, description.
    cells = {
        fmu: {
            name: f"`{name}` | {variable.unit} | " + variable.description.replace("|", r"\|")
            for name, variable in variables.items()
        }
        for fmu, variables in (("fmu", INERTIA_MODULE.by_name), ("shaft", DRIVEN_SHAFT.by_name))
    }
    parts = [read_file("papers.md")]
    for name, paper in PAPERS.items():
        values = {**claims_of(name, paper), **cells, "equations": equations(name)}
        parts.append(read_file(f"{name}.md").format_map(values))
    return "\n".join(parts)


def equations(paper: str) -> str:
    """Return the text on the equations of a paper, with the verdict below the heading of each equation.

    Args:
        paper: Name of the paper.
    """
    verdicts = PAPERS[paper].EQUATIONS

    def with_verdict(heading: re.Match[str]) -> str:
        return heading[0] + (f"\n{verdicts[heading[1]]}\n" if heading[1] in verdicts else "")

    return SECTION.sub(with_verdict, read_file(f"{paper}_equations.md"))
