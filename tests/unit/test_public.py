"""Test that the public names of the package exist, have types and document each argument."""

import ast
import dataclasses
import importlib
import inspect
import math
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rejected import assert_rejected

import inertia_module
from inertia_module import PUBLIC, Result
from inertia_module.common.equality import ByContent
from inertia_module.common.errors import InertiaModuleError, unknown
from inertia_module.common.examples import example
from inertia_module.interface.variables import BY_NAME
from inertia_module.model import Module
from inertia_module.scene import SceneResult, load_scene
from inertia_module.scene.quantity import Quantity

NAMES = sorted(PUBLIC)


@pytest.mark.parametrize("name", NAMES)
def test_public_names_resolve_to_their_objects_for_type_checkers(name):
    assert getattr(inertia_module, name).__name__ == name
    folder = Path(inertia_module.__file__).parent.joinpath(*PUBLIC[name].split("."))
    assert not (folder / f"{name}.py").exists()


def test_stub_for_type_checkers_names_the_same_and_an_unknown_name_is_an_attribute_error():
    stub = ast.parse(Path(inertia_module.__file__).with_suffix(".pyi").read_text())
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    modules = {alias.name: node.module for node in imports for alias in node.names}
    assert modules == PUBLIC
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = inertia_module.nothing


def test_import_of_the_package_loads_only_the_deprecated_names():
    code = "import sys, inertia_module; print(*sorted(name for name in sys.modules if 'inertia' in name))"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules = ["inertia_module", "inertia_module.common", "inertia_module.common.deprecated"]
    assert process.stdout.split() == modules


def frozen_dataclasses():
    """Return all frozen dataclasses of the package."""
    for module in pkgutil.walk_packages(inertia_module.__path__, "inertia_module."):
        if module.name.endswith(("__main__", ".slave")):
            continue
        for kind in vars(importlib.import_module(module.name)).values():
            parameters = getattr(kind, "__dataclass_params__", None)
            if parameters and parameters.frozen and inspect.isclass(kind) and kind.__module__ == module.name:
                yield kind


HOLDS_OTHERS = re.compile(r"Array|NDArray|Complex|dict|list|Mapping")


def test_dataclasses_with_containers_are_compared_by_content():
    kinds = [*frozen_dataclasses()]
    for kind in kinds:
        if any(HOLDS_OTHERS.search(str(field.type)) for field in dataclasses.fields(kind)):
            assert issubclass(kind, ByContent) or not kind.__dataclass_params__.eq, kind
        if issubclass(kind, ByContent):
            assert not kind.__dataclass_params__.eq, kind
    assert sum(issubclass(kind, ByContent) for kind in kinds) > 10


def test_results_of_equal_content_are_equal_with_equal_hash():
    assert table() == table()
    assert table() != table().without({"M"})
    assert table() != Result(table().columns | {"M": table()["omega"]}, table().units)
    assert table() != 3
    assert len({table(), table()}) == 1
    assert of_scene() == of_scene()
    assert of_scene() != of_scene(warnings=("a warning",))
    missing = of_scene(quantities={"efficiency": Quantity(math.nan, "")})
    assert missing == of_scene(quantities={"efficiency": Quantity(math.nan, "")})
    assert len({missing, of_scene(quantities={"efficiency": Quantity(float("nan"), "")})}) == 1


def test_scenes_with_tables_have_a_hash():
    assert len({load_scene(example("urban")), load_scene(example("urban"))}) == 1


def table():
    time = np.linspace(0.0, 1.0, 21)
    columns = {"time": time, "omega": 3.0 * time, "M": time**2}
    return Result.from_columns(columns, {"omega": "rad/s", "M": "N.m"})


def of_scene(**others):
    return SceneResult(
        table().columns,
        table().units,
        scene=load_scene(example("planar")),
        **{"quantities": {}, **others},
    )


def test_result_as_pandas_has_units_in_its_headings():
    pytest.importorskip("pandas")
    frame = table().to_pandas()
    assert frame.index.name == "time [s]"
    assert list(frame.columns) == ["omega [rad/s]", "M [N.m]"]
    assert frame["omega [rad/s]"].iloc[-1] == 3.0


def test_result_plots_the_requested_columns():
    figure = table().plot("omega")
    assert [axis.get_ylabel() for axis in figure.axes] == ["rad/s"]
    assert len(table().plot().axes) == 2
    assert_rejected(r"^unknown column 'alpha'; available: time, omega, M$", table().plot, "alpha")


def test_result_of_a_scene_is_a_table_too(tmp_path):
    result = of_scene()
    assert (result["omega"] == result.record["omega"]).all()
    assert "omega" in result
    assert "alpha" not in result
    written = [table.to_csv(tmp_path / "t.csv").read_bytes() for table in (result, result.table)]
    assert written[0] == written[1]
    with pytest.raises(ValueError, match=r"unknown column 'omga'; did you mean 'omega'\?$"):
        result["omga"]


def test_missing_number_of_a_summary_is_reported():
    remarks = {"time_to_50_kmh": "not reached (maximum 40 km/h)"}
    result = of_scene(quantities={"efficiency": Quantity(0.5, "")}, remarks=remarks)
    with pytest.raises(KeyError, match=r"^unknown metric .* 'eficiency'; did you mean 'efficiency'\?$"):
        result.summary["eficiency"]
    with pytest.raises(ValueError, match=r"^time_to_50_kmh: not reached \(maximum 40 km/h\)$"):
        result.summary["time_to_50_kmh"]
    assert result.lines() == {"efficiency": "0.5", "time to 50 km/h": "not reached (maximum 40 km/h)"}


@pytest.mark.parametrize("name", ["omega_2", "Omega_out", "load torque", "torque", "imbalance", "xyz", ""])
@pytest.mark.parametrize(
    "lookup", [Module("plain").__getitem__, lambda name: unknown("output", name, BY_NAME)]
)
def test_unknown_name_suggests_similar_names_only(name, lookup):
    try:
        message = str(lookup(name))
    except InertiaModuleError as error:
        message = str(error)
    assert "did you mean" in message or (name in ("xyz", "") and "and 114 more" in message)
    assert len(message) < 400


def test_result_in_a_notebook_is_picture_and_table():
    assert table()._repr_png_().startswith(b"\x89PNG")
    html = table()._repr_html_()
    assert "<th>omega [rad/s]</th>" in html
    assert html.count("<tr>") == 12
    assert "<td>…</td>" in html
    assert Result.from_columns({"time": [0.0], "a<b": [1.0]})._repr_html_().count("<tr>") == 2
    assert "a&lt;b" in Result.from_columns({"time": [0.0], "a<b": [1.0]})._repr_html_()
