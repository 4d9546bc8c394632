"""Folders stay within their budgets (`make size`); words of docstrings."""

import ast
import re

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
    on_the_ground = {path.name for path in PACKAGE.glob("*.py")} - {"memory.py", "cli.py"}
    assert on_the_ground == {"__init__.py", "__main__.py"}
    rooms = HOUSE[: HOUSE.index(whole)]
    assert sum(room.files for room in rooms) + len(on_the_ground) == whole.files


def test_statements_are_counted_without_docstrings_and_however_they_are_laid_out():
    assert statements('"""Say."""\n\ndef f(x):\n    """Do."""\n    return (\n        x\n    )\n') == 2
    assert statements("a = 1; b = 2\n") == 2


# --- words of docstrings ---

FILES = [*sorted(PACKAGE.rglob("*.py")), *sorted((ROOT / "studies").rglob("*.py"))]


def docstrings(path):
    """First lines of the docstrings of a file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node):
            yield ast.get_docstring(node).splitlines()[0]


def test_docstrings_begin_with_a_verb_or_a_noun_of_the_field():
    found = [first for path in FILES for first in docstrings(path)]
    assert [first for first in found if re.match(r"(What|Whether|The same)\b", first)] == []
