"""Build the site: formulas as MathML, figures with captions, and pages that come from other folders."""

import html
import os
import re
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.structure.files import File
from outside import DRAWING, ROOT, page_from_root
from tutorial_page import Tutorial

from inertia_module.scene import load_scene
from inertia_module.viewer.html import html_file

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)
FUNCTION = re.compile(r"<mi>((?:arc)?(?:sin|cos|tan)|ln|exp)</mi>")
# weight of a page in the search, by its section
BOOST = {"How-to": 2.0, "Tutorial": 1.5, "Reference": 0.5, "Verification": 0.5, "Papers": 0.5, "Project": 0.5}
# link at the end of a page; it stays at the edge of the window before that
TO_TOP = '<p class="to-top" data-search-exclude><a href="#">↑ top</a></p>'
# image that is a paragraph, and a caption in italics below
FIGURE = re.compile(r'<p>(<img alt="([^"]*)" src="([^"]*)" ?/?>)</p>(?:\n<p><em>(.*?)</em></p>)?', re.S)
DESCRIPTION = re.compile(r"<dc:description>(.*?)</dc:description>", re.S)
# alternative texts that are no captions
NO_CAPTION = ("Output of the program above",)


def mathml(formula, display):
    """Convert a formula from LaTeX to MathML; bars stretch, and functions have the spacing of operators."""
    text = convert(formula, display=display)
    text = text.replace('<mo accent="true">&#x02015;</mo>', '<mo stretchy="true">&#xAF;</mo>')
    return FUNCTION.sub(r'<mo lspace="0.17em" rspace="0.1em">\1</mo>', text)


def typeset(match):
    """Convert a formula of a page; a displayed formula may wrap at \\quad."""
    formula = html.unescape(match[2]).strip()
    if match[1] == "span":
        return mathml(formula, "inline")
    parts = [formula] if r"\begin" in formula else re.split(r"\\q?quad", formula)
    body = "".join(mathml(part, "block") for part in parts)
    return f'<div class="formula" tabindex="0" role="group" aria-label="formula">{body}</div>'


def caption_of(alternative, file):
    """Return the caption of an image: the description in an SVG file, otherwise the alternative text."""
    description = DESCRIPTION.search(file.read_text(encoding="utf-8")) if file.suffix == ".svg" else None
    if description:
        return description[1]
    return "" if alternative in NO_CAPTION else alternative


def on_files(files, config):
    """Add pages from other folders: the viewer of scene R1, the tutorial, contributing, changelog."""
    scene = load_scene(ROOT / "examples" / "reference.toml")
    tutorial = Tutorial.read(ROOT / "examples" / "tutorial.ipynb")
    pages = {
        "machine.html": html_file(scene, None),
        Path(DRAWING).name: (ROOT / DRAWING).read_bytes(),
        "tutorial/index.md": tutorial.text,
        **{f"tutorial/{name}": content for name, content in tutorial.images.items()},
        "contributing.md": page_from_root("CONTRIBUTING.md"),
        "changelog.md": page_from_root("CHANGELOG.md"),
    }
    for name, content in pages.items():
        files.append(File.generated(config, name, content=content))
    return files


def on_page_markdown(markdown, **_):
    return markdown.replace("](../CONTRIBUTING.md", "](contributing.md")


def on_page_content(content, page, config, **_):
    page.meta["search"] = {"boost": BOOST.get(page.parent.title if page.parent else "", 1.0)}
    folder = os.path.dirname(page.file.src_uri)

    def figure(match):
        image, alternative, source, italics = match.groups()
        caption = italics or caption_of(alternative, Path(config.docs_dir, folder, source))
        below = f"<figcaption>{caption}</figcaption>" if caption else ""
        return f'<figure><a href="{source}" title="full size">{image}</a>{below}</figure>'

    return FORMULA.sub(typeset, FIGURE.sub(figure, content)) + TO_TOP


def on_post_page(output, **_):
    """Name the dialog of the search."""
    return output.replace('role="dialog">', 'role="dialog" aria-label="Search">')
