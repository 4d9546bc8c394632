"""documentation/index.html of an FMU: picture, what it computes, how to couple it, limits, variables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape

from .. import __version__
from ..contract.models import Model
from .documentation import Table, flanges, tables
from .guide import COMPUTES, COUPLING, LIMITS, ORDER, PICTURE, REFUSALS, blocks, guide, inline

# name of the picture beside the page
MECHANISM = "mechanism.png"
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; }
body { max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
p, li { max-width: 44rem; }
h2 { margin-top: 2.2rem; border-bottom: 1px solid #ccc; }
figure { margin: 0; }
figcaption { color: #555; font-size: 0.9rem; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; font-size: 0.85rem; width: 100%; }
td, th { border-bottom: 1px solid #ddd; padding: 0.25rem 0.6rem 0.25rem 0; }
td, th { text-align: left; vertical-align: top; }
td:first-child { width: 15rem; }
td:nth-child(2) { width: 5rem; }
"""
HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>{style}</style></head><body>
<h1>{title}</h1>
<p>{description}.</p>
<figure><img src="{picture}" alt="{caption}" width="640"><figcaption>{caption}</figcaption></figure>"""
FOOT = """<h2>Licences</h2>
<p>inertia-module {version}, MIT licence. Texts: {texts}.</p>
</body></html>
"""


def _table(table: Table) -> Iterator[str]:
    yield "<table><tr>" + "".join(f"<th>{column}</th>" for column in table.columns) + "</tr>"
    for name, *rest in table.rows:
        cells = "".join(f"<td>{inline(cell)}</td>" for cell in rest)
        yield f"<tr><td><code>{name}</code></td>{cells}</tr>"
    yield "</table>"


def index_page(model: Model, licences: Iterable[str]) -> str:
    """The page, whole in itself but for the picture and the licences beside it; licences: their names."""
    own, common = guide(model.name), guide("all")
    head = {"title": model.title, "description": model.description, "caption": own[PICTURE]}
    escaped = {key: escape(text) for key, text in head.items()}
    parts = [HEAD.format(style=STYLE, picture=MECHANISM, **escaped)]
    for heading, section in (
        *((heading, own[heading]) for heading in (COMPUTES, COUPLING)),
        *((heading, common[heading]) for heading in (ORDER, REFUSALS)),
        (LIMITS, own[LIMITS]),
    ):
        parts += [f"<h2>{heading}</h2>", *blocks(section)]
    ends = flanges(model)
    parts += [f"<h2>{ends.heading}</h2>", *_table(ends)]
    for causality, found in tables(model):
        parts.append(f"<h2>{causality}</h2>")
        for table in found:
            parts += [f"<h3>{table.heading}</h3>", *_table(table)]
    texts = ", ".join(f'<a href="licenses/{name}.txt">{name}.txt</a>' for name in licences)
    return "\n".join([*parts, FOOT.format(version=__version__, texts=texts)])
