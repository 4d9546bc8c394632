import datetime
import functools
import re
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from lxml import etree

from inertia_module.interface import variables
from inertia_module.interface.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.interface.variables import INPUT, PARAMETER, REAL

from .conftest import MODELS

FLAVOURS = tuple(MODELS)
# Names of types that differ in FMI 3.0.
TYPES = {REAL: "Float64", "Integer": "Int32"}
BASE = {
    INERTIA_MODULE: {
        **{"omega1": 80.0, "load_torque": 5.0, "drive_torque": 7.0, "input_inertia": 0.1},
        **{"omega_out_start": 3.0, "omega2_start": 1.0},
        # A stiffness of 0 is rigid, and the smallest valid stiffness is far away.
        **{"housing_stiffness": 4e3, "freewheel_stiffness": 5e3},
    },
    DRIVEN_SHAFT: {"hub_speed": 80.0, "load_torque": 5.0, "omega_out_start": 3.0, "shaft_damping": 2.0},
}
# Parameters of the averaged map that this test omits.
OF_MAP = set(variables.MAP_KEY) - {"wheel_radius", "z17", "epsilon", "link2_inertia", "satellites"}
STARTS = {
    INERTIA_MODULE: [
        *({"fidelity": fidelity, "drive": drive} for fidelity in (1, 2, 3) for drive in (0, 1)),
        *({"fidelity": 0}, {"layout": 1, "windage": 1e-3}, {"mesh_efficiency": 0.95, "housing_drag": 1.0}),
    ],
    DRIVEN_SHAFT: [{}],
}


def is_fmi3(description):
    return description.fmiVersion == "3.0"


def test_every_variable_is_described_as_in_the_table(description, model):
    *_, time = description.modelVariables
    assert len(description.modelVariables) == len(model.variables) + is_fmi3(description)
    if is_fmi3(description):
        assert (time.name, time.causality, time.unit) == ("time", "independent", "s")
        assert time.valueReference == model.time.reference
    for actual, expected in zip(description.modelVariables, model.variables, strict=False):
        assert (actual.name, actual.type, actual.causality) == (
            expected.name,
            TYPES.get(expected.kind, expected.kind) if is_fmi3(description) else expected.kind,
            expected.causality,
        )
        assert (actual.variability, actual.description) == (expected.variability, expected.description)
        assert actual.valueReference == expected.reference
        if expected.kind == REAL:
            assert actual.displayUnit == variables.DISPLAY_UNITS.get(expected.unit, (None,))[0]
            assert actual.unit == expected.unit != ""
            numbers = {"min": expected.minimum, "max": expected.maximum, "nominal": expected.nominal}
            for name, value in numbers.items():
                text = getattr(actual, name)
                assert (text is None) == (value is None)
                assert value is None or float(text) == value
        if expected.start is not None:
            text = {"true": "1", "false": "0"}.get(actual.start, actual.start)
            assert float(text) == expected.start


def test_each_variable_is_described_by_words_of_its_own_before_letters(model):
    descriptions = [variable.description for variable in model.variables]
    assert len(set(descriptions)) == len(descriptions)
    for text in descriptions:
        first = text.split()[0]
        assert re.fullmatch("[a-z]{2,}", first), text
        assert first not in ("its", "their"), text


def test_continuous_outputs_are_readable_in_an_intermediate_update(unpacked, model):
    root = etree.parse(str(unpacked / "modelDescription.xml")).getroot()
    names = [v.get("name") for v in root.find("ModelVariables") if v.get("intermediateUpdate") == "true"]
    calculated = [v for v in model.variables if v.causality not in (INPUT, PARAMETER)]
    expected = [v.name for v in calculated if v.variability == "continuous"]
    assert names == (expected if root.get("fmiVersion") == "3.0" else [])


def test_units_have_their_base_unit_exponents(description, model):
    units = {unit.name: unit for unit in description.unitDefinitions}
    of_time = {"s"} if is_fmi3(description) else set()
    assert set(units) == {variable.unit for variable in model.variables} - {""} | of_time
    for name, unit in units.items():
        exponents = variables.UNITS[name]
        for base in ("kg", "m", "s", "rad"):
            assert int(getattr(unit.baseUnit, base)) == exponents.get(base, 0)
    for name, (display, factor) in variables.DISPLAY_UNITS.items():
        assert [(unit.name, float(unit.factor)) for unit in units[name].displayUnits] == [(display, factor)]


def test_choices_are_enumerations_with_their_numbers(description, model):
    used = {variable.enumeration for variable in model.variables} - {""}
    assert {t.name for t in description.typeDefinitions} == used
    for name in used:
        items = variables.ENUMERATIONS[name]
        (result,) = [t for t in description.typeDefinitions if t.name == name]
        assert [(item.name, int(item.value)) for item in result.items] == [(i, n) for i, n, _ in items]
        assert [number for _, number, _ in items] == list(range(len(items)))  # The shell checks ranges.


def dependencies(description):
    """Return the dependencies of the outputs at the start, by name."""
    return {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}


def test_structure_lists_outputs_and_their_initial_dependencies(description, model, opened):
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    assert [unknown.variable.name for unknown in description.outputs] == outputs
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    initial = dependencies(description)
    assert list(initial) == outputs
    assert initial == dependencies(opened(f"{model.name}3")[0])
    idle = {variable.name for variable in model.variables if variable.idle}
    assert not idle & set().union(*initial.values())
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


@pytest.fixture(scope="module", params=["InertiaModule3", "DrivenShaft3"])
def of_fmi3(request, opened):
    """Return description and folder of an FMU of FMI 3.0."""
    return opened(request.param)


def neighbours(variable, value):
    """Return two values of a variable: close on both sides, or the whole number and its neighbour."""
    if variable.kind == variables.BOOLEAN:
        return value, not value
    if variable.kind != REAL:
        return value, value + 1 if value < variable.maximum else value - 1
    change = 1e-5 * (abs(value) or 0.01)
    return [min(max(value + end, variable.minimum), variable.maximum) for end in (change, -change)]


def test_declared_initial_dependencies_agree_with_derivatives(of_fmi3, instances_of):
    description, _ = of_fmi3
    model = MODELS[description.modelName]
    instances = functools.partial(instances_of, description.modelName)
    initial = dependencies(description)
    for start in STARTS[model]:
        first, second = instances(), instances()
        for instance in (first, second):
            instance.fmu.setupExperiment()
            instance.set(**BASE[model], **start)
            instance.fmu.enterInitializationMode()
        averaged = start.get("fidelity") == 1
        for variable in model.with_causality(INPUT, PARAMETER):
            if averaged and (variable.group == variables.Group.LOSSES or variable.name in OF_MAP):
                continue  # Each value needs another map.
            value = second.get(variable.name)
            ends, rows = neighbours(variable, value), []
            for end in ends:
                second.set(**{variable.name: end})
                try:
                    rows.append([second.get(name) for name in initial])
                except FMICallException:  # The value contradicts other parameters.
                    assert variable.kind != REAL or variable.name.endswith("engagement_angle")
            second.set(**{variable.name: value})
            if len(rows) < 2:
                continue
            for name, high, low in zip(initial, *rows, strict=True):
                assert high == low or variable.name in initial[name], (name, variable.name, start)
            if averaged or variable.kind != REAL:
                continue
            derivatives = first.directional(list(initial), [variable.name], [2.0])
            for name, slope, high, low in zip(initial, derivatives, *rows, strict=True):
                expected = 2.0 * (high - low) / (ends[0] - ends[1])
                allowed = pytest.approx(expected, rel=1e-3, abs=1e-4 * (1.0 + abs(high)))
                assert slope == allowed, (name, variable.name, start)
                assert slope == 0.0 or variable.name in initial[name], (name, variable.name)
        for instance in (first, second):
            instance.fmu.exitInitializationMode()
            instance.step(0.01)
        assert first.all_values() == second.all_values()


def test_capabilities_default_experiment_and_date_are_declared(description, model):
    cs = description.coSimulation
    assert cs.canHandleVariableCommunicationStepSize
    assert cs.canGetAndSetFMUstate
    assert cs.canSerializeFMUstate
    assert not cs.canBeInstantiatedOnlyOncePerProcess
    assert not cs.needsExecutionTool  # PyFMI rejects FMUs with an execution tool; Python is a library.
    # The Python FMU has the capabilities of pythonfmu.
    native = description.modelName != "InertiaModulePy"
    if is_fmi3(description):
        assert cs.providesAdjointDerivatives
        assert cs.providesIntermediateUpdate
        assert cs.hasEventMode == cs.mightReturnEarlyFromDoStep == ("contact_switches" in model.by_name)
    else:
        assert cs.canInterpolateInputs == native
        assert cs.providesDirectionalDerivative == native
    assert int(cs.maxOutputDerivativeOrder) == int(native)
    experiment = description.defaultExperiment
    assert float(experiment.stopTime) == 1.0
    assert (experiment.tolerance is None) == ("tolerance" not in model.by_name)
    assert experiment.tolerance is None or float(experiment.tolerance) == 1e-6
    moment = datetime.datetime.strptime(description.generationDateAndTime, "%Y-%m-%dT%H:%M:%SZ")
    assert moment.year >= 2026


# --- terminals of FMI 3.0: matching flanges ---

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"


def terminals_in(folder):
    """Return (variable, kind) by member, by terminal, of an unpacked FMU."""
    tree = etree.parse(str(folder / "terminalsAndIcons" / "terminalsAndIcons.xml"))
    assert etree.XMLSchema(file=str(SCHEMA)).validate(tree)
    return {
        terminal.get("name"): {
            member.get("memberName"): (member.get("variableName"), member.get("variableKind"))
            for member in terminal.findall("TerminalMemberVariable")
        }
        for terminal in tree.iter("Terminal")
    }


def test_icons_of_flanges_are_at_the_edge_of_the_icon_of_the_model(of_fmi3):
    folder = of_fmi3[1] / "terminalsAndIcons"
    root = etree.parse(str(folder / "terminalsAndIcons.xml")).getroot()
    (edge,) = root.iter("Icon")
    drawn = list(root.iter("TerminalGraphicalRepresentation"))
    assert len(drawn) == len(list(root.iter("Terminal")))
    places = set()
    for flange in drawn:
        left, low, right, high = (float(flange.get(name)) for name in ("x1", "y1", "x2", "y2"))
        assert left < right
        assert low < high
        assert float(edge.get("y1")) <= low
        assert high <= float(edge.get("y2"))
        assert (left + right) / 2.0 in (float(edge.get("x1")), float(edge.get("x2")))
        places.add((left, low))
        assert (folder / f"{flange.get('iconBaseName')}.png").read_bytes().startswith(b"\x89PNG")
        assert etree.parse(str(folder / f"{flange.get('iconBaseName')}.svg")).getroot().tag.endswith("svg")
    assert len(places) == len(drawn)


def test_each_flange_has_a_speed_and_a_torque_and_a_single_input(of_fmi3):
    description, unpacked = of_fmi3
    described = {variable.name: variable for variable in description.modelVariables}
    terminals = terminals_in(unpacked)
    assert "load" in terminals
    assert len(terminals) > 1
    for members in terminals.values():
        speed, torque = (described[members[name][0]] for name in ("speed", "torque"))
        assert (speed.unit, torque.unit) == ("rad/s", "N.m")
        assert {speed.causality, torque.causality} == {"input", "output"}
        assert (members["speed"][1], members["torque"][1] in ("inflow", "outflow")) == ("signal", True)
        if "angle" in members:
            angle = described[members["angle"][0]]
            assert (angle.unit, angle.causality, members["angle"][1]) == ("rad", "output", "signal")


@pytest.mark.parametrize("drive", [0, 1])
def test_direction_of_power_at_flanges_agrees_with_their_kind(of_fmi3, instances_of, drive):
    """Energy through inflows is energy_in, energy through outflows is energy_out."""
    description, unpacked = of_fmi3
    instance = instances_of(description.modelName)
    start, flange = {"omega1": 100.0, "load_torque": 10.0, "input_inertia": 1.0}, "input_flange"
    if description.modelName == "DrivenShaft3":
        start, flange = {"hub_speed": 20.0, "load_torque": 3.0, "omega_out_start": 20.0}, "hub"
    elif drive == 1:
        start |= {"drive": 1, "drive_torque": 20.0}
        flange = "input_flange_by_torque"
    instance.start(**start)
    ends = terminals_in(unpacked)
    for terminal, kind, energy in ((flange, "inflow", "energy_in"), ("load", "outflow", "energy_out")):
        assert ends[terminal]["torque"][1] == kind
        ends[terminal] = [ends[terminal][name][0] for name in ("speed", "torque")]
        ends[terminal].append(energy)
    done = {flange: 0.0, "load": 0.0}
    for _ in range(200):
        before = {terminal: instance.get(ends[terminal][0]) for terminal in done}
        instance.step(1e-3)
        for terminal in done:
            speed = 0.5 * (before[terminal] + instance.get(ends[terminal][0]))
            done[terminal] += 1e-3 * speed * instance.get(ends[terminal][1])
    for terminal, work in done.items():
        assert work == pytest.approx(instance.get(ends[terminal][2]), rel=2e-2)


def test_matching_terminals_are_connected_like_names(opened):
    """The FMU Manipulation Toolbox uses these connections and then has the bits of other hosts."""
    (module, folder), (_, other_folder) = opened("InertiaModule3"), opened("DrivenShaft3")
    flange, hub = terminals_in(folder)["output_flange"], terminals_in(other_folder)["hub"]
    causality = {variable.name: variable.causality for variable in module.modelVariables}
    wires = set()
    for member in flange.keys() & hub.keys():  # One of both ends is an output.
        (own, kind), (there, kind_there) = flange[member], hub[member]
        assert (kind, kind_there) in (("signal", "signal"), ("outflow", "inflow"))  # The signs are equal.
        ends = [("module", own), ("shaft", there)]
        wires.add(tuple(ends if causality[own] == "output" else ends[::-1]))
    assert wires == {
        (("module", "omega_out"), ("shaft", "hub_speed")),
        (("shaft", "shaft_torque_mean"), ("module", "load_torque")),
    }
