"""Test that the walk from doStep to the equations in docs/development.md agrees with the code."""

import ast
import itertools
import re
from pathlib import Path

import pytest

import inertia_module

PACKAGE = Path(inertia_module.__file__).parent
PAGE = Path(__file__).parents[2] / "docs" / "development.md"
SECTION = PAGE.read_text(encoding="utf-8").split("### From doStep to the equations and back")[1]
PLACES = re.findall(r"`([\w/]+\.(?:py|c)): (\w+)`", SECTION.split("\n#")[0])
# The first functions of each numbered line, without those in brackets
LINES = re.findall(r"^\d\. (.*)$", SECTION, re.MULTILINE)
CHAIN = [place for line in LINES for place in re.findall(r"`kernel/(\S+): (\w+)`", line.split(" (")[0])]


def functions(file):
    tree = ast.parse((PACKAGE / file).read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("file, name", PLACES)
def test_the_walk_names_functions_that_exist(file, name):
    if file.endswith(".c"):
        text = (PACKAGE / file).read_text(encoding="utf-8")
        assert re.search(rf"^\w+ (?:\w+ )?{name}\(", text, re.MULTILINE)
    else:
        assert name in functions(file)


@pytest.mark.parametrize("caller, called", list(itertools.pairwise(CHAIN)))
def test_each_function_of_the_walk_calls_the_next(caller, called):
    file, name = caller
    calls = [node for node in ast.walk(functions(f"kernel/{file}")[name]) if isinstance(node, ast.Call)]
    assert called[1] in {node.func.id for node in calls if isinstance(node.func, ast.Name)}


def test_seven_calls_lead_from_the_entry_to_the_geometry():
    assert len(CHAIN) - 1 == 7
