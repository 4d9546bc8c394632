"""Test that value references stay the same, because other programs store them."""

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from inertia_module.fmu.description import model_description
from inertia_module.fmu.tables import generated, rows_by_reference
from inertia_module.interface.models import MODELS

PINNED = tomllib.loads(Path(__file__).with_name("value_references.toml").read_text(encoding="utf-8"))


def described(model, fmi):
    """Return value references by name in modelDescription.xml."""
    root = etree.fromstring(model_description(model, model.name, "{guid}", "", fmi))
    path = "ModelVariables/ScalarVariable" if fmi == 2 else "ModelVariables/*"
    return {element.get("name"): int(element.get("valueReference")) for element in root.iterfind(path)}


def structure(model, fmi):
    """Return names of unknowns and their dependencies in the structure of the model."""
    root = etree.fromstring(model_description(model, model.name, "{guid}", "", fmi))
    numbers = described(model, fmi)
    if fmi == 2:  # FMI 2.0 uses indices from 1.
        numbers = {name: place for place, name in enumerate(numbers, 1)}
    names = {str(number): name for name, number in numbers.items()}
    attribute = "index" if fmi == 2 else "valueReference"
    return {
        (element.tag, names[element.get(attribute)]): {names[n] for n in element.get("dependencies").split()}
        for element in root.find("ModelStructure").iter()
        if element.get(attribute)
    }


@pytest.fixture(params=MODELS)
def model(request):
    return MODELS[request.param]


def test_each_variable_has_its_own_number_and_so_has_the_time(model):
    references = [variable.reference for variable in model.in_fmu(3)]
    assert len(set(references)) == len(references)


def test_pinned_numbers_stay_and_new_ones_are_appended(model):
    pinned = PINNED[model.name]
    known = {variable.name: variable.reference for variable in model.in_fmu(3)}
    assert {name: known.get(name) for name in pinned} == pinned
    added = sorted(set(known.values()) - set(pinned.values()))
    assert added == list(range(max(pinned.values()) + 1, max(pinned.values()) + 1 + len(added)))


@pytest.mark.parametrize("fmi", [2, 3])
def test_order_of_the_table_differs_from_the_value_references(model, fmi):
    """A new row may be at any place in the table: other rows keep their numbers, in XML and in C."""
    *rows, last = model.variables
    changed = replace(model, variables=(*rows[:5], last, *rows[5:]))
    assert described(changed, fmi) == described(model, fmi)
    assert structure(changed, fmi) == structure(model, fmi)
    assert (
        generated(changed, "{guid}", fmi)["tables.c"].split("};", 1)[0]
        == (generated(model, "{guid}", fmi)["tables.c"].split("};", 1)[0])
    )


@pytest.mark.parametrize("fmi", [2, 3])
def test_inserted_row_changes_no_value_reference(model, fmi):
    highest = max(variable.reference for variable in (*model.variables, model.time))
    row = replace(model.variables[0], name="new", reference=highest + 1)
    changed = replace(model, variables=(*model.variables[:5], row, *model.variables[5:]))
    assert described(changed, fmi) == described(model, fmi) | {"new": row.reference}
    rows = rows_by_reference(changed, fmi)
    assert rows[: len(model.variables)] == list(rows_by_reference(model, fmi)[: len(model.variables)])
    # The number of the time is reserved, even if it is unused.
    assert rows[model.time.reference] == (model.time if fmi == 3 else None)
    assert rows[row.reference] == row
