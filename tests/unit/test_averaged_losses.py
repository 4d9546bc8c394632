"""Fidelity averaged with losses: its means against those of the pulses, its balance, what it refuses."""

import math

import pytest
from averaged_errors import MECHANISMS, REALISTIC, of_map, of_pulses

from inertia_module.bridge import averaged_system
from inertia_module.memory import Module, Refused

PLANAR = MECHANISMS["planar"]
CAUSES = ("viscous", "mesh", "journal", "freewheel")
# each loss alone, large, and its cause
ALONE = {
    "mesh_efficiency": (0.95, "mesh"),
    "satellite_mesh_efficiency": (0.9, "mesh"),
    "journal_friction": (2e-3, "journal"),
    "drive_friction": (0.03, "viscous"),
    "link2_friction": (0.03, "viscous"),
    "housing_drag": (1.0, "freewheel"),
    "housing_drag_viscous": (0.03, "freewheel"),
    "output_drag": (1.0, "freewheel"),
    "output_drag_viscous": (0.03, "freewheel"),
}


def agree(ours, rigid, bound):
    torque = max(abs(rigid[0]), rigid[1])
    assert ours[:2] == pytest.approx(rigid[:2], abs=bound * torque)
    assert ours[2:] == pytest.approx(rigid[2:], abs=bound)


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize(
    ("omega1", "ratio", "bound"),
    [
        (15.0, 0.1, 0.03),
        (15.0, 0.9, 0.03),
        (30.0, 0.5, 0.01),
        (200.0, 0.1, 0.01),
        (200.0, 0.9, 0.01),
        (-60.0, 0.5, 0.01),
    ],
)
def test_steady_means_are_those_of_the_pulses(compiled, mechanism, omega1, ratio, bound):
    case = compiled, {**MECHANISMS[mechanism], **REALISTIC}, omega1, ratio
    agree(of_map(*case), of_pulses(*case), bound)


@pytest.mark.parametrize("name", ALONE)
def test_each_loss_alone_is_that_of_the_pulses(compiled, name):
    value, cause = ALONE[name]
    # the satellites of the planar layout meet no wheel 17
    shape = {} if name == "satellite_mesh_efficiency" else PLANAR
    case = compiled, {**shape, name: value}, 60.0, 0.5
    agree(of_map(*case), of_pulses(*case), 0.005)
    module = Module(compiled).start(**case[1], fidelity=1, omega1=60.0, omega_out_start=30.0, load_torque=5.0)
    module.advance(0.1)
    assert module[f"energy_lost_{cause}"] == module["energy_lost"] > 0.0


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_energies_balance_whatever_the_speeds_do(compiled, mechanism):
    values = {**MECHANISMS[mechanism], **REALISTIC, "output_inertia": 0.4, "input_hold": 1}
    module = Module(compiled).start(**values, fidelity=1, omega1=0.0, load_torque=5.0)
    lost = dict.fromkeys(CAUSES, 0.0)
    modes = set()
    moved = 0.0
    for n in range(160):
        omega1 = 2.0 * n if n < 60 else 120.0 if n < 100 else max(120.0 - 4.0 * (n - 99), -60.0)
        load = -20.0 if 70 <= n < 80 else 40.0 if 80 <= n < 90 else 5.0
        module.set(omega1=omega1, load_torque=load)
        module.advance(0.05)
        modes.add(module["contact_mode"])
        moved = max(moved, abs(module["energy_in"]) + abs(module["energy_out"]) + module["energy_stored"])
        assert abs(module["energy_residual"]) <= 1e-5 * moved
        for cause, before in lost.items():
            assert module[f"energy_lost_{cause}"] >= before
            lost[cause] = module[f"energy_lost_{cause}"]
    assert sum(lost.values()) == pytest.approx(module["energy_lost"], rel=1e-12)
    assert modes == {1.0, 2.0, 3.0}


def test_locked_to_link_1_friction_and_drag_alone_are_lost(compiled):
    module = Module(compiled).start(
        **{**PLANAR, **REALISTIC}, fidelity=1, omega1=100.0, omega_out_start=100.0, load_torque=10.0
    )
    module.advance(0.5)
    assert module["omega_out"] == 100.0
    assert module["output_torque"] == pytest.approx(11.0, rel=1e-12)
    assert module["mesh_torque"] == pytest.approx(12.3, rel=2e-3)
    assert module["input_torque_mean"] == pytest.approx(13.3, rel=2e-3)
    assert module["housing_torque_mean"] == pytest.approx(-0.3, abs=0.02)
    assert module["housing_torque"] == pytest.approx(-0.3, abs=0.02)
    assert module["energy_lost_freewheel"] == pytest.approx(15.0, rel=2e-3)


@pytest.mark.parametrize("step", [0.01, 3.0])
def test_a_coasting_shaft_slows_by_friction_and_drag(compiled, step):
    slow = {"output_friction": 0.02, "output_drag": 0.3, "output_drag_viscous": 0.01}
    module = Module(compiled).start(
        **{**PLANAR, **slow}, fidelity=1, omega1=0.0, omega_out_start=80.0, load_torque=0.0
    )
    for _ in range(round(3.0 / step)):
        module.advance(step)
    left = (80.0 + 10.0) * math.exp(-0.03 * 3.0 / PLANAR["output_inertia"]) - 10.0
    assert module["omega_out"] == pytest.approx(left, rel=1e-9)
    gone = 0.5 * PLANAR["output_inertia"] * (80.0**2 - left**2)
    assert module["energy_lost"] == pytest.approx(gone, rel=1e-9)
    assert module["energy_in"] == pytest.approx(0.0, abs=1e-9 * gone)


def test_friction_of_the_output_that_brakes_fast_takes_what_the_shaft_had(compiled):
    module = Module(compiled).start(fidelity=1, omega1=0.0, omega_out_start=10.0, output_friction=90.0)
    had = module["energy_stored"]
    module.advance(0.02)
    assert module["omega_out"] < 0.3
    assert module["energy_lost_viscous"] == module["energy_lost"]
    assert module["energy_residual"] == pytest.approx(0.0, abs=1e-9 * had)


@pytest.mark.parametrize("load", [-0.5, -2.0])
def test_drag_of_both_freewheels_holds_a_shaft_at_rest(compiled, load):
    drag = {"output_drag": 1.5, "housing_drag": 0.8}
    module = Module(compiled).start(**{**PLANAR, **drag}, fidelity=1, omega1=0.0, load_torque=load)
    module.advance(0.1)
    assert (module["omega_out"] == 0.0) == (load == -0.5)


def test_longest_internal_step_leaves_the_map_as_it_is(compiled):
    means = []
    # (another efficiency, so that both have maps of their own)
    for efficiency, longest in ((0.96, 1e-3), (0.96 + 1e-9, 0.0)):
        values = {**PLANAR, "mesh_efficiency": efficiency, "max_step": longest}
        module = Module(compiled).start(**values, fidelity=1, omega1=50.0, omega_out_start=20.0)
        module.advance(0.01)
        means.append([module["omega_out"], module["output_torque_mean"], module["energy_lost_mesh"]])
    assert means[1] == pytest.approx(means[0], rel=1e-6)


def test_journals_that_leave_no_pulse_take_the_output_up_to_link_1(compiled):
    module = Module(compiled).start(fidelity=1, omega1=50.0, journal_friction=1000.0)
    module.advance(0.05)
    assert module["omega_out"] == 50.0
    assert module["energy_residual"] == pytest.approx(0.0, abs=1e-4 * module["energy_in"])


def test_friction_of_link_1_adds_to_its_torque_alone(compiled):
    def after(**values):
        module = Module(compiled).start(**{**PLANAR, **values}, fidelity=1, omega1=100.0, load_torque=5.0)
        module.advance(1.0)
        return module

    ideal, rubbed = after(), after(input_friction=0.02)
    assert rubbed["omega_out"] == pytest.approx(ideal["omega_out"], rel=1e-3)
    assert rubbed["input_torque_mean"] - ideal["input_torque_mean"] == pytest.approx(2.0, rel=0.02)
    assert rubbed["energy_lost"] == pytest.approx(0.02 * 100.0**2, rel=1e-9)


def test_gravity_has_no_mean(compiled):
    def results(**values):
        module = Module(compiled).start(fidelity=1, omega1=100.0, load_torque=5.0, **values)
        module.advance(0.3)
        return (
            module["omega_out"],
            module["input_torque_mean"],
            module["output_torque_mean"],
            module["energy_in"],
        )

    assert results(gravity=9.81) == results()


@pytest.mark.parametrize("name", [*ALONE, "input_friction", "output_friction"])
def test_losses_under_the_torque_of_link_1_are_refused(name):
    value = ALONE.get(name, (0.03, ""))[0]
    with pytest.raises(Refused, match=rf"drive = 1 \(torque\) losses must be off, are .*{name} = {value:g}"):
        Module("plain").check(fidelity=1, drive=1, input_inertia=1.0, **{name: value})


def test_the_continuous_system_is_the_module(compiled):
    values = {**PLANAR, **REALISTIC}
    system = averaged_system(values, outputs=("input_torque", "output_torque"), kernel=compiled)
    for omega1, speed in ((50.0, 10.0), (50.0, 50.0), (-80.0, 40.0), (60.0, 90.0)):
        module = Module(compiled).start(
            **values, fidelity=1, omega1=omega1, omega_out_start=speed, load_torque=3.0
        )
        taken, passed = system.output(0.0, [speed], [omega1, 3.0])
        assert passed == pytest.approx(module["output_torque"], rel=1e-9)
        assert taken == pytest.approx(module["input_torque"], rel=1e-9)


def test_each_module_has_the_map_of_its_losses_also_where_they_change_between_steps(compiled):
    def started(**values):
        scene = {**PLANAR, "omega_out_start": 40.0, "load_torque": 0.0, **values}
        return Module(compiled).start(**scene, fidelity=1, omega1=100.0)

    tuned = started()
    ideal = tuned["output_torque"]
    tuned.set(journal_friction=2e-3)
    tuned.advance(0.01)
    other = started(journal_friction=2e-3)
    assert other["output_torque"] > 1.05 * ideal
    other.advance(0.01)
    assert tuned["output_torque_mean"] == other["output_torque_mean"]
    assert tuned["energy_lost_journal"] == other["energy_lost_journal"] > 0.0
    assert started()["output_torque"] == ideal
