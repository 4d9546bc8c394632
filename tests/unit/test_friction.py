"""Viscous friction takes what Lagrange's equations say it takes, and nothing else."""

import math

import pytest
from scenes import DRIVEN, SCENES, reference

from inertia_module.memory import Module
from studies.reference.cases import OMEGA1, OMEGA2, OMEGA3

ELASTIC = {"fidelity": 3, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
FRICTION = {
    "input": {"input_friction": 0.02},
    "drive": {"drive_friction": 0.01},
    "link 2": {"link2_friction": 0.05},
    "output": {"output_friction": 0.2},
}
ALL = {name: value for one in FRICTION.values() for name, value in one.items()}


def module(values, **more):
    return Module("auto").start(**{**values, "tolerance": 1e-9, **more})


def largest_energy(one):
    return max(abs(one[name]) for name in ("energy_in", "energy_out", "energy_stored"))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("drive", [SCENES, DRIVEN], ids=["speed", "torque"])
@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
@pytest.mark.parametrize("friction", [*FRICTION.values(), ALL], ids=[*FRICTION, "all"])
def test_motion_is_that_of_lagranges_equations(scene, drive, output, friction):
    values = {**drive[scene], **output, **friction}
    found = module(values)
    exact = reference(values)
    for time in (0.02, 0.05):
        found.advance(time - exact.time)
        exact.advance(time)
        speeds = [found[name] for name in ("input_speed", "omega2", "omega_hub")]
        assert speeds == pytest.approx(exact.state[[OMEGA1, OMEGA2, OMEGA3]], abs=1e-7 * found["input_speed"])
        assert found["energy_stored"] == pytest.approx(exact.energy(), rel=1e-7)
        assert abs(found["energy_residual"]) < 1e-8 * largest_energy(found)


@pytest.mark.parametrize("drive", [SCENES, DRIVEN], ids=["speed", "torque"])
@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
def test_audit_closes_over_pulses_lock_up_and_ramps(drive, output):
    one = module({**drive["bevel"], **output, **ALL}, input_hold=1)
    lost = 0.0
    for n in range(60):
        one.set(omega1=100.0 - 2.0 * n, load_torque=10.0 if n % 20 < 10 else -3.0)
        one.advance(0.01)
        assert abs(one["energy_residual"]) < 1e-6 * largest_energy(one)
        assert one["energy_lost_viscous"] > lost
        lost = one["energy_lost_viscous"]
        assert one["energy_lost"] == one["energy_lost_viscous"] + one["energy_lost_shaft"]


@pytest.mark.parametrize("housing, load", [(1, 0.0), (1, 4.0), (0, -4.0)])
def test_free_output_spins_down_exponentially(housing, load):
    # link 1 at rest: nothing drives the shaft
    one = module(
        {}, omega1=0.0, load_torque=load, omega_out_start=50.0, output_friction=0.3, housing_freewheel=housing
    )
    rate, time = 0.3 / 0.5, 2.0
    expected = (50.0 + load / 0.3) * math.exp(-rate * time) - load / 0.3
    one.advance(time)
    assert one["omega_out"] == pytest.approx(max(expected, 0.0), rel=1e-9)
    gone = 0.25 * (50.0**2 - one["omega_out"] ** 2)
    assert one["energy_lost_viscous"] == pytest.approx(gone - one["energy_out"], rel=1e-9)


def test_prescribed_motion_pays_for_friction():
    plain, rubbed = (
        module(SCENES["bevel"], fidelity=0, kinematic_ratio=0.5, **friction) for friction in ({}, ALL)
    )
    for one in (plain, rubbed):
        one.advance(0.5)
    # k = 1: the drives turn at 50 rad/s, as link 2 does
    power = 0.02 * 100.0**2 + 0.01 * 50.0**2 + 0.05 * 50.0**2
    assert rubbed["energy_lost"] == pytest.approx(0.5 * power, rel=1e-12)
    assert abs(rubbed["energy_residual"]) < 1e-10 * rubbed["energy_in"]
    drag = 0.02 * 100.0 + 0.01 * 50.0
    assert rubbed["input_torque_mean"] - plain["input_torque_mean"] == pytest.approx(drag, rel=1e-9)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("drive", [SCENES, DRIVEN], ids=["speed", "torque"])
@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
def test_fixed_steps_converge_by_second_order_and_make_no_energy(scene, drive, output):
    values = {**drive[scene], **output, **ALL}
    exact = module(values)
    exact.advance(0.05)
    errors = []
    for step in (8e-4, 5e-5):
        coarse = module(values, method=1, max_step=step)
        coarse.advance(0.05)
        off = (abs(coarse[name] - exact[name]) for name in ("input_speed", "omega2", "omega_out"))
        errors.append(max(off) / exact["input_speed"])
        assert coarse["energy_residual"] > -1e-12 * largest_energy(coarse)
        assert coarse["energy_lost_viscous"] == pytest.approx(exact["energy_lost_viscous"], rel=1e-3)
    assert errors[1] < max(errors[0] / 50.0, 1e-6)


@pytest.mark.parametrize("step", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("size", [1e-12, 1.0, 1e3])
@pytest.mark.parametrize("drive", [SCENES, DRIVEN], ids=["speed", "torque"])
@pytest.mark.parametrize("output", [{}, ELASTIC], ids=["rigid", "elastic"])
def test_no_friction_makes_energy_in_steps_of_any_length(drive, output, size, step):
    for name in ALL:
        one = module({**drive["bevel"], **output, name: size}, method=1)
        for load in (10.0, -10.0, 3.0):
            one.set(load_torque=load)
            one.advance(step)
            assert one["energy_residual"] > -1e-10 * max(largest_energy(one), one["energy_lost"])
            assert one["energy_lost_viscous"] >= 0.0
