"""Test that no name in an FMU is a reserved word of a language into which importers translate names."""

import keyword
import tomllib
from pathlib import Path

import pytest
from lxml import etree

from inertia_module.fmu.builder import FMUS, PYTHON_FMU
from inertia_module.fmu.description import model_description, terminals
from inertia_module.interface.variables import ENUMERATIONS

WORDS = tomllib.loads(Path(__file__).with_name("keywords.toml").read_text(encoding="utf-8"))
KEYWORDS = {language: set(words.split()) for language, words in WORDS.items()}
KEYWORDS["python"] = {*keyword.kwlist, *keyword.softkwlist}
ATTRIBUTES = ("name", "memberName", "modelName", "modelIdentifier")


def names_of(fmu):
    """(element, name) for all names in the XML files of an FMU."""
    version = 2 if fmu is PYTHON_FMU else fmu.fmi
    files = [model_description(fmu.model, fmu.identifier, "{guid}", "", version, python=fmu is PYTHON_FMU)]
    if version == 3:
        files.append(terminals(fmu.model))
    for file in files:
        for element in etree.fromstring(file).iter(etree.Element):
            yield from ((element.tag, element.get(name)) for name in ATTRIBUTES if element.get(name))


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_no_name_is_a_reserved_word(fmu):
    names = list(names_of(fmu))
    kinds = {kind for kind, _ in names}
    assert {"Item", "Unit"} <= kinds
    assert "ScalarVariable" in kinds or {"Float64", "Terminal", "TerminalMemberVariable"} <= kinds
    reserved = [
        (*name, language) for name in names for language, words in KEYWORDS.items() if name[1] in words
    ]
    assert reserved == []


@pytest.mark.parametrize("fmu", FMUS, ids=lambda fmu: fmu.identifier)
def test_names_except_units_and_files_are_identifiers(fmu):
    for kind, name in names_of(fmu):
        if kind not in ("Unit", "DisplayUnit", "File"):
            assert name.isascii(), name
            assert name.isidentifier(), name


def test_item_named_like_a_modelica_keyword_is_renamed():
    assert "constant" in KEYWORDS["modelica"]
    assert [item for item, *_ in ENUMERATIONS["InputHold"]] == ["zero_order", "linear"]
