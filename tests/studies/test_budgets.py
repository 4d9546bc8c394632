"""Folders stay within their budgets (`make size`); words of docstrings and comments."""

import ast
import io
import re
import tokenize
from itertools import pairwise

import pytest

from studies.size import MARGIN, OVER, PACKAGE, ROOT, house, statements

HOUSE = house()


@pytest.mark.parametrize("room", HOUSE, ids=lambda room: room.name)
def test_a_room_stays_within_its_budget_or_where_it_is_over_does_not_grow(room):
    assert room.lines <= room.allowed


def test_what_is_within_its_budget_is_struck_from_the_list_of_what_is_over():
    over = {room.name for room in HOUSE if room.lines > (1.0 + MARGIN) * room.budget}
    assert set(OVER) == over


def test_every_file_of_the_package_is_in_a_room():
    whole = next(room for room in HOUSE if room.name == "package")
    on_the_ground = {path.name for path in PACKAGE.glob("*.py")} - {"memory.py"}
    assert on_the_ground == {"__init__.py", "__main__.py"}
    rooms = HOUSE[: HOUSE.index(whole)]
    assert sum(room.files for room in rooms) + len(on_the_ground) == whole.files


def test_statements_are_counted_without_docstrings_and_however_they_are_laid_out():
    assert statements('"""Say."""\n\ndef f(x):\n    """Do."""\n    return (\n        x\n    )\n') == 2
    assert statements("a = 1; b = 2\n") == 2


# --- words of docstrings and comments ---


FILES = [*sorted(PACKAGE.rglob("*.py")), *sorted((ROOT / "studies").rglob("*.py"))]
# a line shorter than this is one or two words
SHORT, LONGEST = 30, 106


def docstrings(text):
    """Lines of each docstring with their indents."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node):
            yield (ast.get_docstring(node, clean=False) or "").splitlines()


def comments(text):
    """Lines of each comment that has lines of its own."""
    block, last = [], 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and token.line.lstrip().startswith("#"):
            if token.start[0] != last + 1:
                yield block
                block = []
            block, last = [*block, token.string.removeprefix("#")], token.start[0]
    yield block


def short_lines(block):
    """Lines of one or two words inside a sentence whose next word had room beside them."""
    for line, after in pairwise(block):
        together = bool(line.strip() and after.strip()) and not re.match(r"\s{4,}\S.*=", after)
        fits = line.strip() != "fmt: on" and len(line) + 1 + len((after.split() or [""])[0]) <= LONGEST
        broken_off = len(line.strip()) < SHORT and not line.rstrip().endswith((".", ":", ";", ","))
        if together and fits and broken_off:
            yield line.strip()


def test_the_tool_finds_a_line_of_one_word():
    block = ["the matrices of a step", "are", "kept row by row."]
    assert list(short_lines(block)) == block[:2]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_line_of_a_comment_is_left_short_by_a_reflow(path):
    text = path.read_text(encoding="utf-8")
    assert [line for block in [*docstrings(text), *comments(text)] for line in short_lines(block)] == []


def test_docstrings_begin_with_a_verb_or_a_noun_of_the_field():
    found = [block[0] for path in FILES for block in docstrings(path.read_text(encoding="utf-8"))]
    assert [first for first in found if re.match(r"(What|Whether|The same)\b", first)] == []
