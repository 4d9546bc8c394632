"""Losses by load, drag and wind-up, gravity: known limits, accounts that close, values that are refused."""

import math
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import DRIVEN, ELASTIC, FREEWHEELS, SCENES, advanced, started

from inertia_module.contract.variables import BY_NAME
from inertia_module.kernel.general import jam
from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.memory import Module, Refused

LOSSES = {
    "mesh": {"mesh_efficiency": 0.97},
    "satellite_mesh": {"satellite_mesh_efficiency": 0.97},
    "journal": {"journal_friction": 1e-3},
    "housing_drag": {"housing_drag": 0.5, "housing_drag_viscous": 0.01},
    "output_drag": {"output_drag": 0.5, "output_drag_viscous": 0.01},
    "viscous": {
        "input_friction": 0.01,
        "drive_friction": 0.01,
        "link2_friction": 0.01,
        "output_friction": 0.01,
    },
    "gravity": {"gravity": 9.81},
}
ALL = {name: value for one in LOSSES.values() for name, value in one.items()}
WIND_UP = {
    "housing_stiffness": 2e4,
    "housing_damping": 2.0,
    "freewheel_stiffness": 1e4,
    "freewheel_damping": 1.0,
}
LOCKED_UP = {"drive_angle_start": 3.0, "omega2_start": 100.0, "omega_out_start": 100.0}
# asks for the general equations, and adds nothing
NOTHING = {"gravity": 1e-250}
ACCOUNTS = [name for name in BY_NAME if name.startswith("energy_lost_")]
CAUSE = {"satellite_mesh": "mesh", "housing_drag": "freewheel", "output_drag": "freewheel"}
MOTION = ("omega2", "omega_out", "input_speed", "drive_angle", "energy_in", "energy_out", "energy_stored")
TORQUES = ("input_torque", "mesh_torque", "output_torque", "housing_torque", "output_acceleration")
MEANS = (
    "input_torque_mean",
    "output_torque_mean",
    "mesh_torque_mean",
    "housing_torque_mean",
    "torque_ripple",
)
KERNEL = "auto"


def all_scenes():
    for layout in SCENES:
        yield pytest.param(SCENES[layout], id=f"{layout} by speed")
        yield pytest.param(DRIVEN[layout], id=f"{layout} by torque")
        yield pytest.param(SCENES[layout] | ELASTIC, id=f"{layout} elastic")
        yield pytest.param(DRIVEN[layout] | ELASTIC, id=f"{layout} elastic by torque")


every_scene = pytest.mark.parametrize("scene", list(all_scenes()))


def passed(module):
    """Energies that went through a module, J."""
    return (
        abs(module["energy_in"])
        + abs(module["energy_out"])
        + abs(module["energy_stored"])
        + module["energy_lost"]
    )


@every_scene
def test_general_equations_without_a_loss_are_the_ideal_machine(scene):
    ideal, general = (started(KERNEL, scene, extra, tolerance=1e-10) for extra in ({}, NOTHING))
    for _ in range(10):
        ideal.advance(0.01)
        general.advance(0.01)
        for names, within in ((MOTION, 1e-8), (MEANS, 1e-7), (TORQUES, 1e-6)):
            largest = max(abs(ideal[name]) for name in names)
            for name in names:
                assert general[name] == pytest.approx(ideal[name], rel=within, abs=within * largest), name


@every_scene
@pytest.mark.parametrize("losses", [*LOSSES, "all", "wind-up"])
def test_accounts_close_and_only_what_is_there_loses(scene, losses):
    given = {"all": ALL | WIND_UP, "wind-up": WIND_UP}.get(losses) or LOSSES[losses]
    tolerance = 1e-6
    module = started(KERNEL, scene, given, tolerance=tolerance)
    lost = dict.fromkeys(ACCOUNTS, 0.0)
    for step in [0.001] * 20 + [0.05] * 5:
        module.advance(step)
        assert abs(module["energy_residual"]) < 100.0 * tolerance * passed(module)
        assert module["energy_lost"] == sum(module[name] for name in ACCOUNTS)
        for name in ACCOUNTS:
            assert module[name] >= lost[name] - 1e-9 * passed(module), name
            lost[name] = module[name]
    elastic = scene.get("fidelity") == 3
    expected = {"energy_lost_shaft"} if elastic else set()
    if losses == "all":
        expected |= {
            "energy_lost_viscous",
            "energy_lost_mesh",
            "energy_lost_journal",
            "energy_lost_freewheel",
        }
    elif losses == "wind-up":
        expected |= {"energy_lost_freewheel"} if elastic else set()
    elif losses != "gravity":
        expected |= {f"energy_lost_{CAUSE.get(losses, losses)}"}
    if losses == "satellite_mesh" and scene.get("layout"):
        expected -= {"energy_lost_mesh"}  # there is no such mesh in the planar layout
    assert {name for name in ACCOUNTS if lost[name] > 0.0} == expected


@every_scene
def test_long_and_short_steps_are_one_motion_and_a_state_is_restored(scene):
    long, short = (started(KERNEL, scene, ALL, tolerance=1e-9) for _ in range(2))
    long.advance(0.1)
    advanced(short, *[0.001] * 100)
    for name in (*MOTION, *ACCOUNTS):
        assert short[name] == pytest.approx(long[name], rel=1e-5, abs=1e-7 * passed(long)), name
    state = short.save()
    short.advance(0.013)
    other = started(KERNEL, scene, ALL, tolerance=1e-9)
    other.restore(state)
    other.advance(0.013)
    for name in (*MOTION, *ACCOUNTS, *TORQUES, *MEANS):
        assert other[name] == short[name], name


def test_locked_up_machine_with_friction_stays_so():
    """At a speed ratio of one, under a load that friction holds, nothing slips or is lost for ever."""
    module = started(
        KERNEL,
        SCENES["bevel"],
        {"journal_friction": 1.0},
        load_torque=1.0,
        **LOCKED_UP,
    )
    angle = module["drive_angle"]
    for _ in range(5):
        module.advance(1.0)
        assert module["omega2"] == module["omega_out"] == 100.0
        assert module["drive_angle"] == angle
        assert module["energy_lost"] == 0.0
        assert module["contact_mode"] == 2
        assert module["energy_out"] == pytest.approx(module["energy_in"], rel=1e-12)


def test_lock_up_ends_where_the_load_is_more_than_friction_holds():
    """The threshold is that of the journals: |T / k + I' omega1^2 / 2| = mu r s m |a|."""
    friction = 0.01
    start = started(KERNEL, SCENES["bevel"], LOCKED_UP, journal_friction=friction, load_torque=0.0)
    _, i1, *_ = reduced_inertia(start.derived, start.state.q)
    holds = friction * 1.7 * start["imbalance_acceleration"] - 0.5 * i1 * 100.0**2
    for share, sticks in ((1.0 - 1e-6, True), (1.0 + 1e-6, False)):
        module = started(
            KERNEL, SCENES["bevel"], LOCKED_UP, journal_friction=friction, load_torque=share * holds
        )
        assert (advanced(module, 1e-3)["omega2"] == 100.0) == sticks


@pytest.mark.parametrize("load", [5000.0, 0.01, -1.0])
@pytest.mark.parametrize("losses", ["mesh", "satellite_mesh", "journal", "all"])
def test_ramp_from_rest_breaks_friction_loose(losses, load):
    module = started(KERNEL, ALL if losses == "all" else LOSSES[losses], omega1=0.0, load_torque=load)
    for omega1 in (0.0, 2.0):
        module.set(omega1=omega1)
        module.set_rates(omega1=400.0)
        module.advance(0.005)
        assert abs(module["energy_residual"]) < 1e-4 * passed(module)
    assert module["input_speed"] == pytest.approx(4.0, rel=1e-12)
    assert module["drive_angle"] + module["drive_turns"] > 0.0


def test_drag_of_the_output_freewheel_slows_the_shaft_alone():
    """Link 2 is held by the drag of its own freewheel: the output coasts down evenly; its heat."""
    drag, inertia = 2.0, 0.5
    module = started(
        KERNEL, omega_out_start=10.0, output_drag=drag, housing_drag=1.01 * drag, output_inertia=inertia
    )
    module.advance(1.0)
    assert module["omega2"] == 0.0
    assert module["housing_torque"] == pytest.approx(-drag, rel=1e-12)
    assert module["omega_out"] == pytest.approx(10.0 - drag / inertia, rel=1e-12)
    assert module["energy_lost_freewheel"] == pytest.approx(drag * (10.0 - 0.5 * drag / inertia), rel=1e-12)


def test_freewheels_that_hardly_wind_up_are_rigid():
    rigid = advanced(started(KERNEL, SCENES["bevel"], ELASTIC), 0.1)
    errors = []
    for stiffness in (1e5, 1e6, 1e7):
        stiff = {"housing_stiffness": stiffness, "freewheel_stiffness": stiffness}
        damped = {"housing_damping": 1e-4 * stiffness, "freewheel_damping": 1e-4 * stiffness}
        module = advanced(started(KERNEL, SCENES["bevel"], ELASTIC, stiff, damped), 0.1)
        errors.append(abs(module["energy_in"] - rigid["energy_in"]) / rigid["energy_in"])
    assert errors[0] > 4.0 * errors[1] > 16.0 * errors[2]
    assert errors[2] < 2e-4


def test_wound_up_freewheel_swings_at_its_own_frequency():
    """Link 2 pushed back by a load that it is rigid with turns on the spring of the housing freewheel."""
    stiffness, inertia, load = 1e3, 0.5, 10.0
    module = started(
        KERNEL,
        ELASTIC,
        omega1=0.0,
        load_torque=0.0,
        imbalance_mass=0.0,
        output_freewheel=False,
        link2_inertia=inertia,
        output_inertia=1e-9,
        driven_inertia=1e-9,
        shaft_stiffness=1e9,
        shaft_damping=1.0,
        housing_stiffness=stiffness,
    )
    frequency = math.sqrt(stiffness / inertia)
    advanced(module, 0.25 * math.pi / frequency, load_torque=load)
    assert module["omega2"] == pytest.approx(-load / inertia / frequency * math.sin(0.25 * math.pi), rel=1e-3)


def test_wound_up_freewheel_never_pulls():
    """A random motion in which the spring began steps slightly below zero, and once did not let go."""
    planar = {"layout": 1, "sun_radius": 0.020447, "satellite_radius": 0.21185, "eccentricity": 0.099414}
    heavy = {"satellites": 2, "imbalance_mass": 10.525, "drive_inertia": 0.03, "link2_inertia": 2e-5}
    losses = {"mesh_efficiency": 0.5, "housing_drag": 0.004}
    spring = {"freewheel_stiffness": 84645.0, "freewheel_damping": 8.4645}
    start = {"fidelity": 3, "omega_out_start": 1.0, "drive_angle_start": -6.4794}
    module = started(KERNEL, planar, heavy, losses, spring, start, omega1=1.1326, load_torque=-0.085738)
    for n in range(1, 81):
        module.set_rates(omega1=-0.1)
        module.advance(0.1)
        module.set(omega1=1.1326 - 0.01 * n)
        assert module["contact_mode"] not in (2, 3) or module["output_torque"] > -1e-4


@pytest.mark.parametrize("wheel", ["housing", "freewheel"])
@pytest.mark.parametrize("scene", SCENES)
def test_wound_up_freewheel_never_pulls_whatever_its_stiffness_and_damping(scene, wheel):
    for stiffness, damping in product((1e3, 1e5, 1e7, 1e9), (0.0, 1.0, 1e2, 1e4)):
        spring, speeds = {f"{wheel}_stiffness": stiffness, f"{wheel}_damping": damping}, []
        for tolerance in (1e-3, 1e-6, 1e-9):
            module = started(KERNEL, SCENES[scene], ELASTIC, spring, tolerance=tolerance)
            torques = []
            for _ in range(40):
                module.advance(1e-3)
                torques += [module["housing_torque"], module["output_torque"]]
            assert min(torques) >= -tolerance * max(torques), (stiffness, damping, tolerance)
            speeds.append(module["omega_out"])
        assert speeds[:2] == pytest.approx([speeds[2]] * 2, rel=1e-2), (stiffness, damping)


DAMPINGS = st.sampled_from([0.0, 1e-3, 1.0, 1e3, 1e6, 1e12])
NOT_THERE = {
    "no housing freewheel": ("housing_drag", "housing_drag_viscous", "housing_stiffness", "housing_damping"),
    "no output freewheel": (
        *("output_drag", "output_drag_viscous"),
        *("freewheel_stiffness", "freewheel_damping"),
    ),
}


@given(
    scene=st.sampled_from([one.values[0] for one in all_scenes()]),
    freewheels=st.sampled_from(sorted(FREEWHEELS)),
    loss=st.sampled_from(sorted(LOSSES)),
    tolerance=st.sampled_from([1e-9, 1e-6, 1e-3]),
    dampings=st.tuples(DAMPINGS, DAMPINGS, DAMPINGS, DAMPINGS),
)
@settings(settings.get_profile("same"), max_examples=25)
def test_damping_without_a_spring_has_no_meaning(scene, freewheels, loss, tolerance, dampings):
    """Not at the start, not tuned between steps and not in a state that is restored."""

    def motion(housing, output, then_housing, then_output):
        damped = {"housing_damping": housing, "freewheel_damping": output}
        values = {**LOSSES[loss], **FREEWHEELS[freewheels], **damped, "tolerance": tolerance}
        first = advanced(started(KERNEL, scene, values), *[5e-4] * 20)
        second = Module(KERNEL)
        second.restore(first.save())
        # the load changes as well, for what is tuned ends the step in any case
        second.set(housing_damping=then_housing, freewheel_damping=then_output, output_friction=1e-3)
        return [*first.state.numbers, *advanced(second, *[5e-4] * 20).state.numbers]

    assert motion(*dampings) == motion(0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("missing", NOT_THERE)
@pytest.mark.parametrize("scene", SCENES)
def test_freewheel_that_is_not_there_takes_nothing(scene, missing):
    values = {**SCENES[scene], **ELASTIC, **FREEWHEELS[missing], **LOSSES["mesh"]}
    without = advanced(started(KERNEL, values), *[1e-3] * 20)
    for value in (1e-3, 1e2):
        module = advanced(started(KERNEL, values, dict.fromkeys(NOT_THERE[missing], value)), *[1e-3] * 20)
        assert list(module.state.numbers) == list(without.state.numbers), value


def test_stiff_freewheels_on_a_light_link_do_not_chatter():
    """A random motion of 1000 switches and more: the inside of steps as long as is stable is coarse."""
    planar = {"layout": 1, "sun_radius": 0.012402, "link2_inertia": 1.2678e-5, "input_inertia": 9.8187e-4}
    losses = {"drive_friction": 0.0173, "output_friction": 0.0029, "satellite_transverse_inertia": 1.1718e-5}
    shaft = {"fidelity": 3, "drive": 1, "driven_inertia": 0.41141, "shaft_stiffness": 164.17}
    springs = {"housing_stiffness": 514280.0, "housing_damping": 514.28, "freewheel_stiffness": 476.58}
    scene = planar | losses | shaft | springs | {"shaft_damping": 0.0, "tolerance": 4.3352e-7}
    module = started(KERNEL, scene, omega1=22.811, load_torque=0.091088)
    module.advance(0.06)
    assert module["contact_switches"] < 100
    assert abs(module["energy_residual"]) < 1e-6 * module["energy_stored"]


def test_jump_after_many_short_steps_of_a_freewheel_at_its_limit():
    """A random motion in which omega2 fell below zero by rounding step by step, and then omega1 jumped."""
    output = {"output_inertia": 0.016992, "driven_inertia": 60.0, "shaft_stiffness": 10.0}
    scene = output | {"fidelity": 3, "imbalance_mass": 0.0, "link2_inertia": 9e-4, "shaft_damping": 0.02}

    def run(split):
        module = started(KERNEL, scene, freewheel_stiffness=400.0, omega1=100.0, load_torque=0.04)
        for _ in range(split):
            module.advance(0.0010221 / split)
        assert module["omega2"] >= 0.0
        return advanced(module, 0.0075385, omega1=30.945, load_torque=-0.14931)

    # a ten-thousandth of what the tolerance allows
    assert run(7)["omega_hub"] == pytest.approx(run(1)["omega_hub"], rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("efficiency", [0.5, 0.9, 1.0 - 1e-12])
@pytest.mark.parametrize("name", ["mesh_efficiency", "satellite_mesh_efficiency"])
def test_any_efficiency_up_to_one_is_followed(name, efficiency):
    module = advanced(started(KERNEL, SCENES["bevel"], {name: efficiency}), 0.2)
    ideal = advanced(started(KERNEL, SCENES["bevel"]), 0.2)
    lost = module["energy_lost_mesh"]
    assert lost > 0.0 if efficiency < 0.99 else lost < 1e-8 * passed(module)
    if efficiency > 0.99:
        assert module["omega_out"] == pytest.approx(ideal["omega_out"], rel=1e-5)


def test_gravity_beyond_the_centrifugal_force_is_followed():
    module = started(KERNEL, omega1=3.0, load_torque=0.1, gravity=100.0)
    for _ in range(20):
        module.advance(0.1)
        assert abs(module["energy_residual"]) < 1e-4 * passed(module)


def test_gravity_of_modules_that_stand_evenly_balances():
    one, other = (
        advanced(started(KERNEL, SCENES["bevel"], modules=2, **g), 0.1) for g in ({}, {"gravity": 9.81})
    )
    assert [one[name] for name in MOTION] == [other[name] for name in MOTION]


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("mesh_efficiency", 0.0, "between 0.1 and 1"),
        ("mesh_efficiency", 1.01, "between 0.1 and 1"),
        ("satellite_mesh_efficiency", -0.5, "between 0.1 and 1"),
        ("journal_friction", -1e-3, "between 0 and"),
        ("housing_drag", -1.0, "between 0 and"),
        ("output_drag_viscous", -1.0, "between 0 and"),
        ("freewheel_stiffness", -1.0, "between 0 and"),
        ("gravity", -9.81, "between 0 and"),
    ],
)
def test_wrong_value_is_refused_with_what_is_allowed(name, value, allowed):
    with pytest.raises(Refused, match=f"{name} must be {allowed}.*is {value:g}"):
        started("plain", SCENES["bevel"], {name: value})


def test_meshes_that_jam_are_refused():
    askew = {"a": 1.4, "b": 0.7, "satellite_mesh_efficiency": 0.1, "link2_inertia": 1e-6}
    with pytest.raises(
        Refused, match=r"the meshes jam .* satellite_mesh_efficiency must be higher, are 1 and 0.1"
    ):
        started("plain", SCENES["bevel"], askew)


@pytest.mark.parametrize("drive", [0, 1], ids=["by speed", "by torque"])
@pytest.mark.parametrize("loss", ["mesh_efficiency", "satellite_mesh_efficiency"])
def test_jamming_is_looked_for_in_few_turns_of_many_teeth(monkeypatch, drive, loss):
    looks = []

    def look(*arguments):
        looks.append(True)
        assert len(looks) < 1e5
        return False

    monkeypatch.setattr(jam, "jams_at", look)
    teeth = {"z2": 99999, "z16": 100001, "z17": 99991, "z6": 99989}
    started("plain", teeth, {loss: 0.97}, drive=drive, input_inertia=0.01)
    assert bool(looks) == (drive == 1 or loss == "satellite_mesh_efficiency")


@pytest.mark.parametrize("drive", [0, 1], ids=["by speed", "by torque"])
@pytest.mark.parametrize("z6", [13, 61], ids=["all turns", "some turns"])
def test_meshes_jam_as_at_all_angles_of_the_period(drive, z6, monkeypatch):
    monkeypatch.setattr(jam, "ANGLES", 16)
    scene = {"a": 1.4, "b": 0.7, "z17": 31, "z6": z6, "satellite_mesh_efficiency": 0.2}
    d = started("plain", scene, drive=drive, input_inertia=10.0, link2_inertia=10.0).derived
    found = []
    for exponent in range(-12, 3):
        d.J1 = d.J2 = 10.0 ** (0.5 * exponent)
        whole = jam.jams_between(d, 0.0, d.period, jam.ANGLES * d.harmonic * d.period_turns)
        found.append(jam.jams(d))
        assert found[-1] == whole
    assert {True, False} == set(found)
