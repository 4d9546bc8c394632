"""Terminals of the FMUs of FMI 3.0: flanges that fit each other."""

from pathlib import Path

import fmpy
import pytest
from lxml import etree

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
FLAVOURS = ("InertiaModule3", "DrivenShaft3")


def terminals_in(folder):
    """(variable, kind) by member, by terminal, of an unpacked FMU."""
    tree = etree.parse(str(folder / "terminalsAndIcons" / "terminalsAndIcons.xml"))
    assert etree.XMLSchema(file=str(SCHEMA)).validate(tree)
    return {
        terminal.get("name"): {
            member.get("memberName"): (member.get("variableName"), member.get("variableKind"))
            for member in terminal.findall("TerminalMemberVariable")
        }
        for terminal in tree.iter("Terminal")
    }


def test_icons_of_flanges_are_there_and_lie_at_the_edge_of_that_of_the_model(unpacked):
    folder = unpacked / "terminalsAndIcons"
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


def test_each_flange_has_a_speed_and_a_torque_of_which_one_is_given(description, unpacked):
    variables = {variable.name: variable for variable in description.modelVariables}
    found = terminals_in(unpacked)
    assert "load" in found
    assert len(found) > 1
    for members in found.values():
        speed, torque = (variables[members[name][0]] for name in ("speed", "torque"))
        assert (speed.unit, torque.unit) == ("rad/s", "N.m")
        assert {speed.causality, torque.causality} == {"input", "output"}
        assert (members["speed"][1], members["torque"][1] in ("inflow", "outflow")) == ("signal", True)
        if "angle" in members:
            angle = variables[members["angle"][0]]
            assert (angle.unit, angle.causality, members["angle"][1]) == ("rad", "output", "signal")


@pytest.mark.parametrize("drive", [0, 1])
def test_torques_at_the_flanges_bring_power_in_or_take_it_out_as_their_kinds_say(
    fmu_path, instance, unpacked, drive
):
    """The energy audit agrees: what comes in by inflows is energy_in, what goes by outflows energy_out."""
    start, given = {"omega1": 100.0, "load_torque": 10.0, "input_inertia": 1.0}, "input_flange"
    if fmu_path.stem == "DrivenShaft3":
        start, given = {"hub_speed": 20.0, "load_torque": 3.0, "omega_out_start": 20.0}, "hub"
    elif drive == 1:
        start |= {"drive": 1, "drive_torque": 20.0}
        given = "input_flange_by_torque"
    instance.start(**start)
    ends = terminals_in(unpacked)
    for terminal, kind, energy in ((given, "inflow", "energy_in"), ("load", "outflow", "energy_out")):
        assert ends[terminal]["torque"][1] == kind
        ends[terminal] = [ends[terminal][name][0] for name in ("speed", "torque")]
        ends[terminal].append(energy)
    done = {given: 0.0, "load": 0.0}
    for _ in range(200):
        before = {terminal: instance.get(ends[terminal][0]) for terminal in done}
        instance.step(1e-3)
        for terminal in done:
            speed = 0.5 * (before[terminal] + instance.get(ends[terminal][0]))
            done[terminal] += 1e-3 * speed * instance.get(ends[terminal][1])
    for terminal, work in done.items():
        assert work == pytest.approx(instance.get(ends[terminal][2]), rel=2e-2)


def test_terminals_that_fit_are_wired_as_by_names(opened):
    """So coupled by the FMU Manipulation Toolbox, module and shaft have the bits of any other host."""
    (module, folder), (_, other_folder) = opened("InertiaModule3"), opened("DrivenShaft3")
    flange, hub = terminals_in(folder)["output_flange"], terminals_in(other_folder)["hub"]
    causality = {variable.name: variable.causality for variable in module.modelVariables}
    wires = set()
    for member in flange.keys() & hub.keys():  # of each, one end is an output
        (own, kind), (there, kind_there) = flange[member], hub[member]
        assert (kind, kind_there) in (("signal", "signal"), ("outflow", "inflow"))  # no sign changes
        ends = [("module", own), ("shaft", there)]
        wires.add(tuple(ends if causality[own] == "output" else ends[::-1]))
    assert wires == {
        (("module", "omega_out"), ("shaft", "hub_speed")),
        (("shaft", "shaft_torque_mean"), ("module", "load_torque")),
    }
