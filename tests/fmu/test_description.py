import datetime
import re
import zipfile

import pytest
from fmpy.validation import validate_fmu

from inertia_module.fmu.builder import bundled_files, content_hash, python_fmu
from inertia_module.variables import DISPLAY_UNITS, ENUMERATIONS, UNITS, VARIABLES


def test_fmpy_finds_nothing_to_say(fmu_path):
    assert validate_fmu(str(fmu_path)) == []


@pytest.mark.parametrize("reference", range(len(VARIABLES)), ids=lambda n: VARIABLES[n].name)
def test_every_variable_is_described_as_in_the_table(description, reference):
    expected = VARIABLES[reference]
    found = description.modelVariables[reference]
    assert (found.name, found.type, found.causality) == (expected.name, expected.kind, expected.causality)
    assert (found.variability, found.description) == (expected.variability, expected.description)
    assert found.valueReference == reference
    if expected.kind == "Real":
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


def test_units_have_their_base_unit_exponents(description):
    found = {unit.name: unit for unit in description.unitDefinitions}
    assert set(found) == set(UNITS)
    for name, exponents in UNITS.items():
        for base in ("kg", "m", "s", "rad"):
            assert int(getattr(found[name].baseUnit, base)) == exponents.get(base, 0)
    for name, (display, factor) in DISPLAY_UNITS.items():
        assert [(unit.name, float(unit.factor)) for unit in found[name].displayUnits] == [(display, factor)]


def test_choices_are_enumerations_with_their_numbers(description):
    for name, items in ENUMERATIONS.items():
        (found,) = [t for t in description.typeDefinitions if t.name == name]
        assert [(item.name, int(item.value)) for item in found.items] == [(i, n) for i, n, _ in items]


def test_structure_lists_every_output_and_what_it_depends_on_at_first(description):
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    assert [unknown.variable.name for unknown in description.outputs] == outputs
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    initial = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    assert list(initial) == outputs
    assert initial["omega_out"] == {"omega1", "fidelity", "kinematic_ratio", "omega_out_start"}
    assert initial["output_torque_mean"] == set()
    assert {"omega1", "load_torque", "link2_inertia"} <= initial["output_torque"]


@pytest.mark.parametrize("fidelity", [1, 2])
def test_declared_initial_dependencies_are_all_there_are(instances, description, fidelity):
    """Change one known at a time: no output changes that does not declare it."""
    initial = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    base = {"omega1": 80.0, "load_torque": 5.0, "omega_out_start": 3.0, "omega2_start": 1.0}
    base["fidelity"] = fidelity

    def outputs(**changes):
        instance = instances().start(**(base | changes))
        return {name: instance.get(name) for name in initial}

    reference = outputs()
    changes = {
        "omega1": 90.0,
        "load_torque": 6.0,
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
    }
    for known, value in changes.items():
        changed = outputs(**{known: value})
        touched = {name for name in initial if changed[name] != reference[name]}
        assert touched <= {name for name in initial if known in initial[name]}, known


def test_capabilities_and_default_experiment_are_declared(description):
    cs = description.coSimulation
    assert cs.canHandleVariableCommunicationStepSize
    assert cs.canGetAndSetFMUstate
    assert cs.canSerializeFMUstate
    assert not cs.canBeInstantiatedOnlyOncePerProcess
    experiment = description.defaultExperiment
    assert float(experiment.stopTime) == 1.0
    assert float(experiment.tolerance) == 1e-6


def test_date_is_utc_ending_in_z(description):
    moment = datetime.datetime.strptime(description.generationDateAndTime, "%Y-%m-%dT%H:%M:%SZ")
    assert moment.year >= 2026


def test_documentation_and_picture_are_inside(fmu_path):
    with zipfile.ZipFile(fmu_path) as archive:
        page = archive.read("documentation/index.html").decode()
        assert all(variable.name in page for variable in VARIABLES)
        assert archive.read("model.png").startswith(b"\x89PNG")


def test_guid_is_a_hash_of_the_content(monkeypatch, built):
    def guid():
        archive = python_fmu()
        found = re.search(rb'guid="([^"]+)"', _read(archive))
        return found.group(1), archive

    def _read(archive):
        import io

        with zipfile.ZipFile(io.BytesIO(archive)) as opened:
            return opened.read("modelDescription.xml")

    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    first, first_bytes = guid()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1900000000")
    assert guid()[0] == first
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    assert guid()[1] == first_bytes
    changed = bundled_files() | {"messages.py": b"# another build\n" + bundled_files()["messages.py"]}
    assert content_hash(changed) != content_hash(bundled_files())
    monkeypatch.setattr("inertia_module.fmu.builder.bundled_files", lambda: changed)
    assert guid()[0] != first
