"""The public API has one grammar: names and types of arguments, errors, representations and documentation."""

import functools
import inspect
import pydoc
import re
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

import inertia_module
from inertia_module import (
    PUBLIC,
    Fmu,
    InertiaModuleError,
    Module,
    ParameterError,
    Result,
    SceneError,
    SceneResult,
    example,
    load_scene,
    torque_converter_chart,
)
from inertia_module.common.deprecated import MODULES, RenamedModule, new_module, renamed_arguments
from inertia_module.scene.quantity import Quantity
from inertia_module.scene.run import SceneRunner
from inertia_module.studies import axes
from inertia_module.studies.design_judge import Judge
from inertia_module.studies.design_result import DesignResult
from inertia_module.studies.design_specification import read_spec
from inertia_module.studies.evaluation import Row
from inertia_module.studies.order_spectra import spectra
from inertia_module.studies.parameter_sweep import SweepResult
from inertia_module.studies.search import Searched
from inertia_module.studies.steady_metrics import STEADY_METRICS

NAMES = sorted(PUBLIC)
PLANAR = example("planar")
MAX_HELP_LINES, MAX_REPR_LINES = 200, 10
# Former names of arguments.
FORMER = {"fmu_path", "figure", "figures"}
# Signatures that contain systems of python-control, which has no types
UNTYPED = {"Scene.surroundings", "Scene.systems"}


def callables():
    """Yield the name and the function of each public function, method and property of the package."""
    for name in NAMES:
        value = getattr(inertia_module, name)
        if not inspect.isclass(value):
            yield name, value
            continue
        if inspect.isfunction(value.__init__) and not issubclass(value, BaseModel):
            yield f"{name}.__init__", value.__init__
        for kind in value.__mro__:
            for member, attribute in (
                vars(kind).items() if kind.__module__.startswith("inertia_module") else ()
            ):
                function = getattr(attribute, "fget", None) or getattr(attribute, "func", attribute)
                function = getattr(function, "__func__", function)
                if inspect.isfunction(function) and not member.startswith("_"):
                    yield f"{name}.{member}", function


CALLABLES = dict(callables())


def signature_of(name):
    """Return the signature of a public callable; None for one in C."""
    try:
        return inspect.signature(CALLABLES[name])
    except ValueError:
        return None


# --- arguments ---


@pytest.mark.parametrize("name", sorted(CALLABLES))
def test_no_signature_contains_any(name):
    signature = signature_of(name)
    if signature is None or name in UNTYPED:
        return
    annotations = [parameter.annotation for parameter in signature.parameters.values()]
    for annotation in [*annotations, signature.return_annotation]:
        assert not re.search(r"\bAny\b|AnyArray", str(annotation)), signature


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"Result", "example"}))
def test_arguments_have_one_name_and_one_type_for_one_thing(name):
    value = getattr(inertia_module, name)
    try:
        parameters = inspect.signature(value).parameters
    except ValueError:  # An error
        return
    assert not FORMER & parameters.keys()
    if "fmu" in parameters:
        assert str(parameters["fmu"].annotation) == "Path | str | None"
    if "scene" in parameters and not inspect.isclass(value):
        assert {"Scene", "Path", "str"} <= set(re.findall(r"\w+", str(parameters["scene"].annotation)))


@pytest.mark.parametrize("name", ["sweep", "fit", "orders", "run_scene", "torque_converter_chart"])
def test_each_function_of_a_scene_reads_its_file(name, tmp_path):
    function = getattr(inertia_module, name)
    missing = str(tmp_path / "missing.toml")
    more = {"sweep": [{"imbalance_mass": "1:2:2"}], "fit": [{"imbalance_mass": None}]}.get(name, [])
    first = [{"time": [0.0]}] if name == "fit" else []
    with pytest.raises(SceneError, match=r"^cannot read .*missing.toml: no such file"):
        function(*first, missing, *more)


def test_keys_are_short_or_dotted_everywhere():
    masses = [
        load_scene(PLANAR, {key: "2 kg"}).explicit_parameters["imbalance_mass"]
        for key in ("imbalance_mass", "mechanism.imbalance_mass")
    ]
    scene = load_scene(PLANAR).with_keys({"imbalance_mass": 2, "title": "heavy"})
    assert [*masses, scene.explicit_parameters["imbalance_mass"]] == [2.0, 2.0, 2.0]
    assert scene.title == "heavy"
    assert [axis.name for axis in axes.axes_of({"imbalance_mass": "1:2:2"}, scene)] == [
        "mechanism.imbalance_mass"
    ]


def test_texts_as_keys_and_ranges_are_deprecated():
    with pytest.warns(DeprecationWarning, match="use a mapping"):
        scene = load_scene(PLANAR, ["imbalance_mass=2 kg"])
    assert scene == load_scene(PLANAR, {"imbalance_mass": 2})
    with pytest.warns(DeprecationWarning, match="use a mapping"):
        texts = axes.axes_of(["imbalance_mass=1:2:2"], scene)
    assert texts == axes.axes_of({"imbalance_mass": "1:2:2"}, scene)


def test_chart_of_a_scene_equals_the_chart_of_its_parameters():
    scene = load_scene(PLANAR)
    charts = [torque_converter_chart(model) for model in (scene, PLANAR, str(PLANAR), scene.parameters())]
    assert all(chart == charts[0] for chart in charts)


# --- simulate ---


def test_simulate_runs_a_scene_or_an_fmu(fmu):
    scene = load_scene(PLANAR)
    whole = inertia_module.simulate(scene.with_keys({"run.stop_time": 0.02}), fmu=fmu)
    assert (
        whole["omega2"].tolist()
        == inertia_module.simulate(PLANAR, stop_time=0.02, fmu=fmu)["omega2"].tolist()
    )
    assert isinstance(whole, SceneResult)
    inputs = {"omega1": 120.0, "load_torque": 8.0}
    table = inertia_module.simulate(
        fmu, inputs, stop_time=0.02, step=5e-4, outputs="omega2", parameters=scene.parameters()
    )
    assert list(table.keys()) == ["time", "omega1", "load_torque", "omega2"]
    assert table["omega2"] == pytest.approx(whole["omega2"], rel=1e-6, abs=1e-9)
    every = inertia_module.simulate(fmu, inputs, stop_time=1e-3, step=5e-4)
    assert {"omega2", "omega_out", "input_torque"} < set(every.keys())


def test_simulate_explains_missing_and_superfluous_arguments(fmu):
    with pytest.raises(ParameterError, match="inputs, stop_time and step are required with an FMU"):
        inertia_module.simulate(fmu)
    with pytest.raises(ParameterError, match="inputs are allowed only with an FMU"):
        inertia_module.simulate(PLANAR, {"omega1": 1.0})
    with pytest.raises(ParameterError, match="fmu is allowed only with a scene"):
        inertia_module.simulate(fmu, {}, 1.0, 1.0, fmu=fmu)


def test_drive_is_a_deprecated_name_of_simulate(fmu):
    with pytest.warns(DeprecationWarning, match=r"drive is deprecated; use inertia_module.simulate$"):
        drive = inertia_module.__getattr__("drive")
    vars(inertia_module).pop("drive", None)
    with pytest.warns(DeprecationWarning, match="use model="):
        table = drive(path=fmu, inputs={"omega1": 100.0}, stop_time=0.01, step=0.01, outputs="omega2")
    assert len(table) == 2


# --- results ---


def table():
    time = np.linspace(0.0, 1.0, 2001)
    columns = {"time": time, "omega2": 3.0 * time, "energy_in": time**2}
    return Result.from_columns(columns, {"omega2": "rad/s", "energy_in": "J"})


def scene_result():
    quantities = {"efficiency": Quantity(0.9, "")}
    return SceneResult(table().columns, table().units, scene=load_scene(PLANAR), quantities=quantities)


@pytest.mark.parametrize("make", [table, scene_result])
def test_a_result_has_the_same_columns_for_all_uses(make, tmp_path):
    result = make()
    names = list(result.keys())
    assert names == ["time", "omega2", "energy_in"]
    assert all(name in result and result[name].size == len(result) for name in names)
    assert "omega3" not in result
    assert list(Result.from_csv(result.to_csv(tmp_path / "t.csv")).keys()) == names
    for name in names[1:]:
        assert result.plot(name).axes[0].get_ylabel() == result.units[name]
    for use in (result.__getitem__, result.plot):
        with pytest.raises(InertiaModuleError, match="unknown column 'omega3'; did you mean 'omega2'"):
            use("omega3")
    assert result == make()
    assert hash(result) == hash(make())
    assert list(dict(result)) == names
    pandas = pytest.importorskip("pandas")
    assert list(pandas.DataFrame(result.to_pandas()).columns) == ["omega2 [rad/s]", "energy_in [J]"]


def test_results_of_different_kinds_are_different():
    assert table() != scene_result()
    assert repr(table()) == "Result(2001 rows × 3 columns, 0…1 s)"
    assert scene_result().metric_units == {"efficiency": ""}


def objects():
    """Return one object of each public class with content."""
    scene = load_scene(PLANAR)
    spec = read_spec(Path(__file__).with_name("specification.toml"))
    rows = [Row({"mechanism.imbalance_mass": float(mass)}, {"efficiency": 0.5}, 0.1) for mass in range(30)]
    turned = np.linspace(0.0, 100.0, 4001)
    record = Result.from_columns({"time": turned, "input_speed": 0.0 * turned + 6.28, "x": np.cos(turned)})
    sweep_axes = axes.axes_of({"imbalance_mass": "1:2:30"}, scene)
    design = DesignResult(
        Judge(
            spec,
            {name: metric.unit for name, metric in STEADY_METRICS.items()} | {"omega_out_final": "rad/s"},
        ),
        rows,
        [],
        [],
        30,
        {},
        Searched(rows, [], False),
    )
    return {
        "Result": table(),
        "SceneResult": scene_result(),
        "Scene": scene,
        "TorqueConverterChart": torque_converter_chart(scene),
        "Orders": spectra(record, turned, ["x"], highest=8.0),
        "SweepResult": SweepResult(sweep_axes, rows, {}, 30, {}, [], {}),
        "DesignResult": design,
        "Module": Module("plain"),
    }


def test_representations_are_short():
    for name, value in objects().items():
        text = repr(value)
        assert text.startswith(f"{name}("), text
        assert text.count("\n") < MAX_REPR_LINES
        assert len(text) < 400
    assert str(load_scene(PLANAR)) == repr(load_scene(PLANAR))


def test_metrics_of_a_sweep_have_a_former_name():
    sweep = objects()["SweepResult"]
    assert sweep.metrics == ["efficiency"]
    with pytest.warns(DeprecationWarning, match=r"SweepResult.figure is deprecated; use SweepResult.metric"):
        assert sweep.figure("efficiency").tolist() == sweep.metric("efficiency").tolist()
    with pytest.raises(AttributeError, match="'SweepResult' object has no attribute 'nothing'"):
        _ = sweep.nothing


def test_a_specification_may_use_the_former_table_of_metrics(tmp_path):
    text = Path(__file__).with_name("specification.toml").read_text(encoding="utf-8")
    former = tmp_path / "former.toml"
    former.write_text(text.replace("[metrics]", "[figures]"), encoding="utf-8")
    with pytest.warns(DeprecationWarning, match=r"\[figures\] is deprecated; use \[metrics\]"):
        specification = read_spec(former)
    assert specification == read_spec(Path(__file__).with_name("specification.toml"))


# --- errors ---


def test_all_errors_have_one_base_class():
    errors = [getattr(inertia_module, name) for name in NAMES if name.endswith("Error")]
    assert len(errors) == 5
    for error in [*errors, inertia_module.SimulationTerminated]:
        assert issubclass(error, InertiaModuleError)
    assert issubclass(inertia_module.SimulationTerminated, inertia_module.FmuError)


# --- documentation ---


@pytest.mark.parametrize("name", NAMES)
def test_help_is_short(name):
    text = pydoc.render_doc(getattr(inertia_module, name), renderer=pydoc.plaintext)
    own = re.split(r"^ \|  [\w ]+ inherited from pydantic", text, flags=re.MULTILINE)[0]
    assert len(own.splitlines()) <= MAX_HELP_LINES


def documented():
    """Return the objects of griffe that docs/api.md shows."""
    griffe = pytest.importorskip("griffe")
    root = Path(inertia_module.__file__).parent
    package = griffe.load("inertia_module", search_paths=[str(root.parent)], docstring_parser="google")
    page = root.parent.parent / "docs" / "api.md"
    if not page.exists():
        pytest.skip("the documentation is not installed")
    paths = re.findall(r"^::: inertia_module\.([\w.]+)", page.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(paths) > 25
    return [package[path] for path in paths]


def functions_of(member):
    """Yield the public functions of an object of griffe."""
    member = member.final_target if member.is_alias else member
    if member.is_function:
        yield member
    elif member.is_class or member.is_module:
        for name, inner in member.members.items():
            is_here = not inner.is_alias or (
                member.is_module and inner.target_path.startswith("inertia_module")
            )
            if is_here and not inner.is_module and (not name.startswith("_") or name == "__init__"):
                yield from functions_of(inner)


def entries_of(text, kind):
    """Return the names of the entries of one section of a docstring."""
    sections = text.parse("google") if text else []
    return [entry.name for section in sections if section.kind.value == kind for entry in section.value]


def test_the_reference_documents_exactly_the_parameters_of_the_signatures():
    wrong, number = {}, 0
    for member in documented():
        for function in functions_of(member):
            names = [p.name for p in function.parameters if p.name not in ("self", "cls")]
            docstring = function.parent.docstring if function.name == "__init__" else function.docstring
            entries = [entry.lstrip("*") for entry in entries_of(docstring, "parameters")]
            number += len(entries)
            if function.name == "__init__" and not entries:  # A dataclass
                attributes = entries_of(docstring, "attributes")
                entries = [name for name in names if name in attributes]
            if sorted(entries) != sorted(names):
                wrong[function.path] = (entries, names)
    assert number > 150
    assert wrong == {}


def test_the_reference_documents_the_fields_of_the_results():
    for name in ("Result", "SceneResult", "SweepResult", "DesignResult", "FitResult", "Orders"):
        kind = getattr(inertia_module, name)
        text = inspect.getdoc(kind)
        for field in kind.__dataclass_fields__:
            assert re.search(rf"^    {field}: ", text, re.MULTILINE), (name, field)


# --- deprecated names ---

# A name in each renamed module
MOVED = {"bridge": "fmu_system", "contract": "__doc__", "figures": "__doc__", "figures.jobs": "fit_figure"}
MOVED |= {"figures.report": "report_file", "harness": "__doc__", "harness.chart": "SteadyMachine"}
MOVED |= {"harness.fmu": "Fmu", "harness.results": "Result", "jobs": "fit", "jobs.batch": "batch"}
MOVED |= {"jobs.design": "design", "jobs.fit": "fit", "jobs.orders": "Orders", "jobs.sweep": "sweep"}
MOVED |= {"loops": "shaft_load", "loops.engine": "EngineMap", "memory": "Module", "page": "__doc__"}
MOVED |= {"page.html": "html_file", "contract.variables": "BY_NAME", "fidelity.trials": "run_in_process"}


@pytest.fixture
def no_renamed_module():
    """Forget the renamed modules of other tests."""
    for module in [name for name, value in sys.modules.items() if isinstance(value, RenamedModule)]:
        parent, _, last = module.rpartition(".")
        vars(sys.modules.get(parent, inertia_module)).pop(last, None)
        del sys.modules[module]


@pytest.mark.parametrize("old", sorted({*MODULES, *MOVED}))
@pytest.mark.parametrize("form", ["from {parent} import {last}", "from {parent}.{last} import {name}"])
@pytest.mark.usefixtures("no_renamed_module")
def test_renamed_modules_work_with_one_warning_that_contains_the_new_name(old, form):
    new, name = f"inertia_module.{new_module(old)}", MOVED[old]
    parent, _, last = f"inertia_module.{old}".rpartition(".")
    if (name == "__doc__") == form.endswith("{name}") or ("." in old and form.endswith("{last}")):
        pytest.skip("the folder contains no name, or the file is no attribute of the folder")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", DeprecationWarning)
        exec(form.format(parent=parent, last=last, name=name), {"__name__": "user"})
    texts = [str(warning.message) for warning in caught if "inertia_module" in str(warning.message)]
    assert texts == [f"inertia_module.{old} is deprecated; use {new}"]


@pytest.mark.usefixtures("no_renamed_module")
def test_functions_of_a_renamed_folder_work():
    with pytest.warns(DeprecationWarning, match=r"jobs is deprecated; use inertia_module.studies$"):
        assert inertia_module.jobs.fit is inertia_module.fit
    with pytest.raises(ModuleNotFoundError, match=r"inertia_module\.loops\.nothing"):
        __import__("inertia_module.loops.nothing")


@pytest.mark.parametrize(
    "place, old, new",
    [
        ("", "Refused", "InertiaModuleError"),
        ("common.errors", "Refused", "InertiaModuleError"),
        ("common.extras", "NotInstalled", "MissingDependencyError"),
        ("fmi.instance", "Ended", "SimulationTerminated"),
    ],
)
def test_former_names_of_errors_are_the_new_errors(place, old, new):
    module = __import__(f"inertia_module.{place}".rstrip("."), fromlist=["x"])
    vars(module).pop(old, None)
    with pytest.warns(DeprecationWarning, match=rf"{old} is deprecated; use .*{new}$"):
        assert getattr(module, old) is getattr(inertia_module, new)
    vars(module).pop(old, None)


def test_former_arguments_are_the_new_arguments(fmu):
    with pytest.warns(DeprecationWarning, match=r"^Fmu.__init__\(path=...\) is deprecated; use fmu=...$"):
        Fmu(path=fmu).close()
    with pytest.warns(DeprecationWarning, match="use fmu="):
        inertia_module.run_scene(load_scene(PLANAR, {"run.stop_time": 0.01}), fmu_path=fmu)

    @renamed_arguments(old="new")
    def function(new):
        return new

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(TypeError, match="got both old and new"):
            function(old=1, new=2)
    assert functools.partial(function, new=3)() == 3
    assert list(inspect.signature(function).parameters) == ["new"]


def test_a_runner_of_scenes_gives_the_same_kind_of_result(fmu):
    with SceneRunner(fmu) as runner:
        assert isinstance(runner.run(load_scene(PLANAR, {"run.stop_time": 0.01})), Result)
