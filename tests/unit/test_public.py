"""What is imported from the package itself: there, typed, documented argument by argument."""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import inertia_module
from inertia_module import PUBLIC, Result

NAMES = sorted(PUBLIC)


@pytest.mark.parametrize("name", NAMES)
def test_public_name_is_what_it_says(name):
    assert getattr(inertia_module, name).__name__ == name


def test_stub_for_type_checkers_names_the_same():
    stub = ast.parse(Path(inertia_module.__file__).with_suffix(".pyi").read_text())
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    found = {alias.name: node.module for node in imports for alias in node.names}
    assert found == PUBLIC


def test_import_of_the_package_loads_nothing_else():
    code = "import sys, inertia_module; print([name for name in sys.modules if 'inertia' in name])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['inertia_module']"


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = inertia_module.nothing


def functions():
    """Public functions, and the public methods of public classes."""
    for name in NAMES:
        found = getattr(inertia_module, name)
        if inspect.isfunction(found):
            yield name, found
            continue
        yield name, found
        for method, value in vars(found).items():
            if inspect.isfunction(value) and not method.startswith("_"):
                yield f"{name}.{method}", value


DOCUMENTED = dict(functions())


@pytest.mark.parametrize("name", sorted(DOCUMENTED))
def test_every_argument_is_told_of(name):
    found = DOCUMENTED[name]
    text = inspect.getdoc(found)
    assert text, f"{name} has no docstring"
    if inspect.isclass(found) and found.__init__ in (
        object.__init__,
        Exception.__init__,
        ValueError.__init__,
    ):
        return
    arguments = [argument for argument in inspect.signature(found).parameters if argument != "self"]
    for argument in arguments:
        assert re.search(rf"\b{argument}\b", text), f"{name} does not tell of {argument}"


def table():
    time = np.linspace(0.0, 1.0, 21)
    return Result.from_columns(
        {"time": time, "omega": 3.0 * time, "M": time**2}, {"omega": "rad/s", "M": "N.m"}
    )


def test_result_as_pandas_has_units_in_its_headings():
    pytest.importorskip("pandas")
    frame = table().to_pandas()
    assert frame.index.name == "time [s]"
    assert list(frame.columns) == ["omega [rad/s]", "M [N.m]"]
    assert frame["omega [rad/s]"].iloc[-1] == 3.0


def test_result_plots_the_columns_asked_for():
    figure = table().plot("omega")
    assert [axis.get_ylabel() for axis in figure.axes] == ["rad/s"]
    assert len(table().plot().axes) == 2
    with pytest.raises(ValueError, match="alpha must be a column: time, omega, M"):
        table().plot("alpha")


def test_result_in_a_notebook_is_picture_and_table():
    assert table()._repr_png_().startswith(b"\x89PNG")
    shown = table()._repr_html_()
    assert "<th>omega [rad/s]</th>" in shown
    assert shown.count("<tr>") == 12
    assert "<td>…</td>" in shown
    assert Result.from_columns({"time": [0.0], "a<b": [1.0]})._repr_html_().count("<tr>") == 2
    assert "a&lt;b" in Result.from_columns({"time": [0.0], "a<b": [1.0]})._repr_html_()
