"""Test the first words of docstrings, and that planted changes match the kernel."""

import re
from pathlib import Path

import inertia_module
from tests.planted_changes import CHANGES, edited

PACKAGE = Path(inertia_module.__file__).parent
ROOT = Path(__file__).parents[2]


def test_docstrings_begin_with_a_verb_or_a_noun_of_the_field():
    files = [
        path
        for folder in (PACKAGE, ROOT / "verification", ROOT / "papers", ROOT / "benchmarks", ROOT / "tests")
        for path in folder.rglob("*.py")
    ]
    assert len(files) > 200
    pattern = re.compile(r'^ *r?"""(?:What|Whether|The same)\b.*', re.M)
    matches = [
        (path.name, line) for path in files for line in pattern.findall(path.read_text(encoding="utf-8"))
    ]
    assert matches == []


def test_every_planted_change_occurs_once_in_the_package():
    for change in CHANGES:
        path, source = edited(change)
        assert source != (PACKAGE / path).read_text(encoding="utf-8")
