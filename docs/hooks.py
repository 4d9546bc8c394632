"""When the site is built: mathematics as MathML, without a script; the machine; guides are found first."""

import html
import re
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.structure.files import File

from inertia_module.scene import load_scene
from inertia_module.viewer.html import html_file

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)
# how much a page counts in a search, by its section
BOOST = {"Guide": 2.0, "Reference": 0.5, "Evidence": 0.5}
# at the end of a page, and at the edge of the window before that
TO_TOP = '<p class="to-top"><a href="#">↑ top</a></p>'
FUNCTION = re.compile(r"<mi>((?:arc)?(?:sin|cos|tan)|ln|exp)</mi>")


def mathml(formula, display):
    """A formula in LaTeX as MathML; bars stretch, and functions keep their distance, as operators do."""
    text = convert(formula, display=display)
    text = text.replace('<mo accent="true">&#x02015;</mo>', '<mo stretchy="true">&#xAF;</mo>')
    return FUNCTION.sub(r'<mo lspace="0.17em" rspace="0.1em">\1</mo>', text)


def typeset(found):
    """A formula of a page; one on its own line may wrap where LaTeX has \\quad."""
    formula = html.unescape(found[2]).strip()
    if found[1] == "span":
        return mathml(formula, "inline")
    parts = [formula] if r"\begin" in formula else re.split(r"\\q?quad", formula)
    return f'<div class="formula">{"".join(mathml(part, "block") for part in parts)}</div>'


def on_files(files, config):
    """The machine of scene R1 is a page of the site, as `inertia-module view` leaves it."""
    scene = load_scene(Path(config.docs_dir).parent / "examples" / "reference.toml")
    files.append(File.generated(config, "machine.html", content=html_file(scene, None)))
    return files


def on_page_content(content, page, **_):
    page.meta["search"] = {"boost": BOOST.get(page.parent.title, 1.0)}
    return FORMULA.sub(typeset, content) + TO_TOP
