"""Folders stay within their budgets (`make size`); words of docstrings; planted changes fit the kernel."""

import re

from studies.size import MARGIN, OVER, PACKAGE, ROOT, house, statements
from tests.planted_changes import CHANGES, edited


def test_rooms_stay_within_their_budgets_or_where_they_are_over_do_not_grow():
    rooms = house()
    assert [room for room in rooms if room.lines > room.allowed] == []
    # what is within its budget is struck from the list of what is over
    assert set(OVER) == {room.name for room in rooms if room.lines > (1.0 + MARGIN) * room.budget}
    # every file of the package is in a room
    whole = next(room for room in rooms if room.name == "package")
    on_the_ground = {path.name for path in PACKAGE.glob("*.py")} - {"memory.py", "cli.py"}
    assert on_the_ground == {"__init__.py", "__main__.py"}
    assert sum(room.files for room in rooms[: rooms.index(whole)]) + len(on_the_ground) == whole.files


def test_statements_are_counted_without_docstrings_and_however_they_are_laid_out():
    assert statements('"""Say."""\n\ndef f(x):\n    """Do."""\n    return (\n        x\n    )\n') == 2
    assert statements("a = 1; b = 2\n") == 2


def test_docstrings_begin_with_a_verb_or_a_noun_of_the_field():
    files = [path for folder in (PACKAGE, ROOT / "studies", ROOT / "tests") for path in folder.rglob("*.py")]
    assert len(files) > 200
    begun = re.compile(r'^ *r?"""(?:What|Whether|The same)\b.*', re.M)
    found = [(path.name, line) for path in files for line in begun.findall(path.read_text(encoding="utf-8"))]
    assert found == []


def test_every_planted_change_stands_once_in_the_kernel_and_changes_it():
    for change in CHANGES:
        path, source = edited(change)
        assert source != (PACKAGE / "kernel" / path).read_text()
