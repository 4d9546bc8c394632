"""Typesets the mathematics of a page when the site is built: MathML, which browsers draw without a script."""

import html
import re

from latex2mathml.converter import convert

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)
DISPLAY = {"span": "inline", "div": "block"}
FUNCTION = re.compile(r"<mi>((?:arc)?(?:sin|cos|tan)|ln|exp)</mi>")


def typeset(found):
    """A formula in LaTeX as MathML; functions are operators, so that they keep their distance."""
    formula = convert(html.unescape(found[2]).strip(), display=DISPLAY[found[1]])
    return FUNCTION.sub(r'<mo lspace="0.17em" rspace="0.1em">\1</mo>', formula)


def on_page_content(content, **_):
    return FORMULA.sub(typeset, content)
