import datetime
import io
import re
import zipfile
from xml.etree import ElementTree

import pytest
from fmpy.validation import validate_fmu

from inertia_module.contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.contract.variable import DISPLAY_UNITS, ENUMERATIONS, INPUT, PARAMETER, REAL, UNITS
from inertia_module.fmu import python_fmu
from inertia_module.fmu.builder import FMUS, PYTHON_FMU, content_of

FLAVOURS = tuple(fmu.identifier for fmu in FMUS)
# names of types in FMI 3.0, where they are others
TYPES = {REAL: "Float64", "Integer": "Int32"}
BASE = {
    INERTIA_MODULE: {
        "omega1": 80.0,
        "load_torque": 5.0,
        "drive_torque": 7.0,
        "input_inertia": 0.1,
        "omega_out_start": 3.0,
        "omega2_start": 1.0,
    },
    DRIVEN_SHAFT: {"hub_speed": 80.0, "load_torque": 5.0, "omega_out_start": 3.0, "shaft_damping": 2.0},
}
CHANGES = {
    INERTIA_MODULE: {
        "omega1": 90.0,
        "load_torque": 6.0,
        "drive_torque": 9.0,
        "drive": 1,
        "input_inertia": 0.2,
        "wheel_radius": 0.1,
        "z17": 30,
        "epsilon": 0.2,
        "link2_inertia": 0.01,
        "output_inertia": 0.7,
        "tolerance": 1e-3,
        "max_step": 1e-3,
        "omega2_start": 2.0,
        "omega_out_start": 4.0,
        "drive_angle_start": 0.7,
        "input_hold": 1,
        "driven_inertia": 2.0,
        "satellites": 3,
        "fidelity": 0,
    },
    DRIVEN_SHAFT: {
        "hub_speed": 90.0,
        "load_torque": 6.0,
        "driven_inertia": 2.0,
        "shaft_stiffness": 7e3,
        "shaft_damping": 0.3,
        "driven_friction": 0.2,
        "balancer": 1.0,
        "input_hold": 1,
        "omega_out_start": 4.0,
        "twist_start": 0.1,
    },
}


def is_fmi3(description):
    return description.fmiVersion == "3.0"


@pytest.fixture
def model(description):
    """The model an FMU is made from."""
    return {fmu.identifier: fmu.model for fmu in FMUS}[description.modelName]


def test_fmpy_finds_nothing_to_say(fmu_path):
    assert validate_fmu(str(fmu_path)) == []


def test_every_variable_is_described_as_in_the_table(description, model):
    assert len(description.modelVariables) == len(model.variables) + is_fmi3(description)
    for reference, expected in enumerate(model.variables):
        found = description.modelVariables[reference]
        assert (found.name, found.type, found.causality) == (
            expected.name,
            TYPES.get(expected.kind, expected.kind) if is_fmi3(description) else expected.kind,
            expected.causality,
        )
        assert (found.variability, found.description) == (expected.variability, expected.description)
        assert found.valueReference == reference
        if expected.kind == REAL:
            assert found.displayUnit == DISPLAY_UNITS.get(expected.unit, (None,))[0]
            assert found.unit == expected.unit != ""
            for name, value in (
                ("min", expected.minimum),
                ("max", expected.maximum),
                ("nominal", expected.nominal),
            ):
                text = getattr(found, name)
                assert (text is None) == (value is None)
                assert value is None or float(text) == value
        if expected.start is not None:
            text = {"true": "1", "false": "0"}.get(found.start, found.start)
            assert float(text) == expected.start


def test_each_variable_is_described_by_words_of_its_own_before_letters(model):
    descriptions = [variable.description for variable in model.variables]
    assert len(set(descriptions)) == len(descriptions)
    for text in descriptions:
        first = text.split()[0]
        assert re.fullmatch("[a-z]{2,}", first), text
        assert first not in ("its", "their"), text


def test_time_is_the_last_variable_of_fmi_3(description):
    if is_fmi3(description):
        *_, time = description.modelVariables
        assert (time.name, time.causality, time.unit) == ("time", "independent", "s")


def test_what_is_continuous_and_calculated_can_be_read_in_an_intermediate_update(fmu_path, model):
    with zipfile.ZipFile(fmu_path) as packed:
        root = ElementTree.fromstring(packed.read("modelDescription.xml"))
    names = [v.get("name") for v in root.find("ModelVariables") if v.get("intermediateUpdate") == "true"]
    calculated = [v for v in model.variables if v.causality not in (INPUT, PARAMETER)]
    expected = [v.name for v in calculated if v.variability == "continuous"]
    assert names == (expected if root.get("fmiVersion") == "3.0" else [])


def test_units_have_their_base_unit_exponents(description, model):
    found = {unit.name: unit for unit in description.unitDefinitions}
    of_time = {"s"} if is_fmi3(description) else set()
    assert set(found) == {variable.unit for variable in model.variables} - {""} | of_time
    for name, unit in found.items():
        exponents = UNITS[name]
        for base in ("kg", "m", "s", "rad"):
            assert int(getattr(unit.baseUnit, base)) == exponents.get(base, 0)
    for name, (display, factor) in DISPLAY_UNITS.items():
        assert [(unit.name, float(unit.factor)) for unit in found[name].displayUnits] == [(display, factor)]


def test_choices_are_enumerations_with_their_numbers(description, model):
    used = {variable.enumeration for variable in model.variables} - {""}
    assert {t.name for t in description.typeDefinitions} == used
    for name in used:
        items = ENUMERATIONS[name]
        (found,) = [t for t in description.typeDefinitions if t.name == name]
        assert [(item.name, int(item.value)) for item in found.items] == [(i, n) for i, n, _ in items]
        assert [number for _, number, _ in items] == list(range(len(items)))  # the shell knows ranges


def test_structure_lists_every_output_and_what_it_depends_on_at_first(description):
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    assert [unknown.variable.name for unknown in description.outputs] == outputs
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    initial = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    assert list(initial) == outputs
    if "omega1" in {v.name for v in description.modelVariables}:
        assert initial["omega_out"] == {"omega1", "fidelity", "kinematic_ratio", "omega_out_start"}
        assert initial["output_torque_mean"] == set()
        assert initial["input_speed"] == {"omega1"}
        assert {"drive", "drive_torque", "input_inertia"} <= initial["input_torque"]
        assert {"omega1", "load_torque", "link2_inertia"} <= initial["output_torque"]
    else:
        assert initial["omega_out"] == {"omega_out_start"}
        assert initial["shaft_torque_mean"] == set()
        assert {"hub_speed", "shaft_stiffness", "twist_start"} <= initial["shaft_torque"]
        assert {"load_torque", "driven_inertia"} <= initial["driven_acceleration"]


@pytest.mark.fmi2  # that of FMI 3.0 declares the same, see above, by the same core
@pytest.mark.parametrize("fidelity, drive", [(1, 0), (2, 0), (1, 1), (2, 1), (3, 1)])
def test_declared_initial_dependencies_are_all_there_are(instances, description, model, fidelity, drive):
    """Change one known at a time: no output changes that does not declare it."""
    initial = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    base = BASE[model] | ({"fidelity": fidelity, "drive": drive} if model is INERTIA_MODULE else {})

    def outputs(**changes):
        instance = instances().start(**(base | changes))
        return {name: instance.get(name) for name in initial}

    reference = outputs()
    for known, value in CHANGES[model].items():
        if drive == 1 and known == "fidelity":
            continue  # no torque makes a prescribed motion
        changed = outputs(**{known: value})
        touched = {name for name in initial if changed[name] != reference[name]}
        assert touched <= {name for name in initial if known in initial[name]}, known


STARTS = {
    INERTIA_MODULE: [
        {},
        {"drive": 1},
        {"fidelity": 3},
        {"layout": 1},
        {"mesh_efficiency": 0.95, "housing_drag": 1.0},
    ],
    DRIVEN_SHAFT: [{}],
}


def test_derivatives_by_all_that_is_declared_are_those_of_the_initial_values(instances, description, model):
    if not description.coSimulation.providesDirectionalDerivative and not is_fmi3(description):
        pytest.skip("pythonfmu has no derivatives")
    initial = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    for start in STARTS[model]:
        one, other = instances(), instances()
        for instance in (one, other):
            instance.fmu.setupExperiment()
            instance.set(**BASE[model], **start)
            instance.fmu.enterInitializationMode()
        for variable in model.with_causality(INPUT, PARAMETER):
            if variable.kind != REAL:
                continue
            found = one.directional(list(initial), [variable.name], [2.0])
            value = other.get(variable.name)
            change = 1e-5 * (abs(value) or 0.01)
            ends = [min(max(value + end, variable.minimum), variable.maximum) for end in (change, -change)]
            rows = []
            for end in ends:
                other.set(**{variable.name: end})
                rows.append([other.get(name) for name in initial])
            other.set(**{variable.name: value})
            for name, slope, high, low in zip(initial, found, *rows, strict=True):
                expected = 2.0 * (high - low) / (ends[0] - ends[1])
                allowed = pytest.approx(expected, rel=1e-3, abs=1e-4 * (1.0 + abs(high)))
                assert slope == allowed, (name, variable.name, start)
                assert slope == 0.0 or variable.name in initial[name], (name, variable.name)
        for instance in (one, other):
            instance.fmu.exitInitializationMode()
            instance.step(0.01)
        assert one.all_values() == other.all_values()


def test_parameters_are_no_knowns_after_the_start(instance, description):
    if description.modelName == "InertiaModulePy":
        pytest.skip("pythonfmu has no derivatives")
    instance.start()
    said = instance.refusal(lambda: instance.directional(["omega_out"], ["driven_inertia"], [1.0]))
    assert said.startswith("a value reference must be that of an input, is ")


def test_capabilities_and_default_experiment_are_declared(description, model):
    cs = description.coSimulation
    assert cs.canHandleVariableCommunicationStepSize
    assert cs.canGetAndSetFMUstate
    assert cs.canSerializeFMUstate
    assert not cs.canBeInstantiatedOnlyOncePerProcess
    experiment = description.defaultExperiment
    assert float(experiment.stopTime) == 1.0
    assert (experiment.tolerance is None) == ("tolerance" not in model.by_name)
    assert experiment.tolerance is None or float(experiment.tolerance) == 1e-6


def test_date_is_utc_ending_in_z(description):
    moment = datetime.datetime.strptime(description.generationDateAndTime, "%Y-%m-%dT%H:%M:%SZ")
    assert moment.year >= 2026


def guid_in(content):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return re.search(
            r'(?:guid|instantiationToken)="([^"]+)"', archive.read("modelDescription.xml").decode()
        )[1]


@pytest.mark.parametrize("fmu", FMUS, ids=FLAVOURS)
def test_same_content_is_the_same_bytes_and_the_date_is_no_part_of_the_guid(monkeypatch, fmu):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    first = content_of(fmu)[0]
    assert content_of(fmu)[0] == first
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    other = content_of(fmu)[0]
    assert other != first
    assert guid_in(other) == guid_in(first)


def test_python_fmu_with_another_source_has_another_guid(monkeypatch):
    before = guid_in(content_of(PYTHON_FMU)[0])
    files = python_fmu.bundled_files()
    changed = files | {"contract/messages.py": b"# another build\n" + files["contract/messages.py"]}
    monkeypatch.setattr(python_fmu, "bundled_files", lambda: changed)
    assert guid_in(content_of(PYTHON_FMU)[0]) != before


def test_native_fmus_say_what_they_can_and_the_python_one_no_more(description, model):
    cs = description.coSimulation
    native = description.modelName != "InertiaModulePy"
    assert not cs.needsExecutionTool  # PyFMI refuses an FMU that needs one; Python is a library
    if is_fmi3(description):
        assert cs.providesAdjointDerivatives
        assert cs.providesIntermediateUpdate
        assert cs.hasEventMode == cs.mightReturnEarlyFromDoStep == ("contact_switches" in model.by_name)
    else:
        assert cs.canInterpolateInputs == native
        assert cs.providesDirectionalDerivative == native
    assert int(cs.maxOutputDerivativeOrder) == int(native)
