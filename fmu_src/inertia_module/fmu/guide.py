"""Guides for the user of an FMU (guides/*.md), for its documentation and for docs/fmu.md."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape
from pathlib import Path

PICTURE, COMPUTES, COUPLING, LIMITS = (
    "Picture",
    "What it computes",
    "How to couple it",
    "What is not modelled",
)
ORDER, REFUSALS = "Order of calls", "Refusals"
_ITEM = re.compile(r"^(?:-|\d+\.) ", re.M)


def guide(name: str) -> dict[str, str]:
    """Markdown of the sections of a guide by heading; name: of a model, or "all" for what holds for each."""
    text = (Path(__file__).parent / "guides" / f"{name}.md").read_text(encoding="utf-8")
    parts = re.split(r"^## (.*)\n", text, flags=re.M)
    return {heading: section.strip() for heading, section in zip(parts[1::2], parts[2::2], strict=True)}


def inline(text: str) -> str:
    """HTML of a sentence with names in `backticks` and what it is about in **stars**."""
    code = re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text, quote=False))
    return re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", code)


def blocks(section: str) -> Iterator[str]:
    """HTML of the paragraphs and lists of a section: as much of Markdown as the guides use."""
    for block in section.split("\n\n"):
        if not _ITEM.match(block):
            yield f"<p>{inline(block)}</p>"
            continue
        kind = "ul" if block.startswith("-") else "ol"
        yield f"<{kind}>"
        yield from (f"<li>{inline(item.strip())}</li>" for item in _ITEM.split(block)[1:])
        yield f"</{kind}>"
