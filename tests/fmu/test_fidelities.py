"""Every fidelity and method of both layouts through the FMU: check values, state, the same as in memory."""

import math

import pytest

from inertia_module.memory import Module

LAYOUTS = {
    "bevel": {"omega1": 100.0, "load_torque": 10.0},
    "planar": {"layout": 1, "satellites": 3, "link2_inertia": 0.003, "omega1": 120.0, "load_torque": 8.0},
}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.3},
    "averaged": {"fidelity": 1},
    "rigid": {"fidelity": 2},
    "rigid, timestepping": {"fidelity": 2, "method": 1, "max_step": 1e-3},
    "elastic": {"fidelity": 3, "shaft_damping": 0.5, "driven_friction": 0.01, "balancer": 0.2},
    "elastic, timestepping": {"fidelity": 3, "method": 1, "max_step": 1e-3, "shaft_damping": 0.5},
}
OUTPUTS = (
    "omega2", "omega_out", "omega_hub", "shaft_twist", "input_torque", "mesh_torque", "output_torque", "housing_torque",
    "input_torque_mean", "output_torque_mean", "imbalance_acceleration", "drive_angle", "contact_mode", "energy_in",
    "energy_out", "energy_stored", "energy_lost", "torque_ripple", "torque_peak", "contact_switches",
    "mesh_torque_mean", "housing_torque_mean", "input_acceleration", "output_acceleration", "output_angle", "output_turns",
    "loss_power_mean", "satellite_force", "satellite_force_peak", "shaking_force_x", "shaking_force_y", "shaking_force_z",
    "shaking_moment_x", "shaking_moment_y", "shaking_moment_z", "input_flange_angle", "output_flange_angle",
)  # fmt: skip


@pytest.fixture(params=LAYOUTS)
def layout(request):
    return LAYOUTS[request.param]


@pytest.fixture(params=LEVELS)
def level(request):
    return LEVELS[request.param]


def test_elastic_scene_gives_the_check_values(instance):
    shaft = {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
    instance.start(tolerance=1e-11, fidelity=3, omega1=100.0, load_torque=10.0, **shaft)
    instance.step(1.0)
    assert instance.get("omega_hub") == pytest.approx(3.908460340, rel=1e-8)
    assert instance.get("omega_out") == pytest.approx(16.766411224, rel=1e-9)
    assert instance.get("shaft_twist") == pytest.approx(-1.550114589e-3, rel=1e-6)


def speeds(layout):
    return [layout["omega1"] * (1.0 + 0.3 * math.sin(0.5 * n)) for n in range(30)]


def test_the_fmu_is_the_module_in_memory(instance, layout, level):
    instance.start(tolerance=1e-8, **layout, **level)
    module = Module("auto").start(tolerance=1e-8, **layout, **level)
    for omega1 in speeds(layout):
        instance.set(omega1=omega1)
        module.set(omega1=omega1)
        instance.step(0.01)
        module.advance(0.01)
    assert [instance.get(name) for name in OUTPUTS] == [module[name] for name in OUTPUTS]


def test_a_state_taken_back_runs_the_same_again(instance, layout, level):
    instance.start(tolerance=1e-8, **layout, **level)
    instance.step(0.05)
    state = instance.fmu.getFMUstate()
    results = []
    for _ in range(2):
        instance.fmu.setFMUstate(state)
        for omega1 in speeds(layout):
            instance.set(omega1=omega1)
            instance.step(0.007)
        results.append([instance.get(name) for name in OUTPUTS])
    instance.fmu.freeFMUstate(state)
    assert results[0] == results[1]


def test_energy_audit_is_within_what_the_level_promises(instance, layout, level):
    promise = 0.05 if level.get("method") else 1e-5
    instance.start(tolerance=1e-8, **layout, **level)
    turnover = 0.0
    for omega1 in speeds(layout):
        instance.set(omega1=omega1)
        instance.step(0.01)
        turnover = max(turnover, abs(instance.get("energy_in")), instance.get("energy_stored"))
    assert abs(instance.get("energy_residual")) < promise * turnover
