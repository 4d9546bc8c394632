"""Forces on mount and bearing through the FMU: values computed by hand, and what they have to agree with."""

import math

import pytest

LAYOUTS = {
    "bevel": {"omega1": 100.0, "load_torque": 10.0},
    "planar": {"layout": 1, "satellites": 3, "link2_inertia": 0.003, "omega1": 120.0, "load_torque": 8.0},
}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.3},
    "rigid": {"fidelity": 2},
    "timestepping": {"fidelity": 2, "method": 1, "max_step": 1e-3},
    "elastic": {"fidelity": 3, "shaft_damping": 0.5, "driven_friction": 0.01},
    "with losses": {
        **{"mesh_efficiency": 0.97, "satellite_mesh_efficiency": 0.98, "journal_friction": 1e-3},
        **{"housing_drag": 0.3, "output_drag": 0.2, "link2_friction": 0.01},
    },
    "by torque": {"drive": 1, "drive_torque": 20.0, "input_inertia": 1.0},
}
# greatest force, moment across Ox and about it of scene R1 at half the speed of link 1, by satellites
GREATEST = {1: (2928.0, 179.0, 106.0), 2: (2562.0, 256.0, 196.0), 3: (3844.0, 192.0, 124.0)}


def vector(instance, name):
    return [instance.get(f"{name}_{axis}") for axis in "xyz"]


@pytest.mark.parametrize("satellites", GREATEST)
def test_scene_r1_shakes_its_mount_as_much_as_computed_by_hand(instance, satellites):
    instance.start(omega1=100.0, fidelity=0, kinematic_ratio=0.5, satellites=satellites)
    found = []
    for _ in range(4000):
        instance.step(4.0 * math.pi / 10.0 / 4000)
        about, *across = vector(instance, "shaking_moment")
        found.append((math.hypot(*vector(instance, "shaking_force")), math.hypot(*across), abs(about)))
    assert [max(values) for values in zip(*found, strict=True)] == pytest.approx(
        GREATEST[satellites], abs=0.6
    )


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("level", LEVELS)
def test_loads_agree_with_torques_masses_and_energies(instance, layout, level):
    instance.start(tolerance=1e-9, **{**LAYOUTS[layout], **LEVELS[level]})
    lost = peak = 0.0
    for _ in range(20):
        instance.step(0.005)
        drive = instance.get("input_torque")
        own = instance.get("input_inertia") * instance.get("input_acceleration")
        mesh = instance.get("mesh_torque")
        scale = abs(drive) + abs(own) + abs(mesh)
        assert instance.get("shaking_moment_x") == pytest.approx(-(drive - own - mesh), abs=1e-11 * scale)
        force = instance.get("imbalance_mass") * instance.get("imbalance_acceleration")
        assert instance.get("satellite_force") == pytest.approx(force, rel=1e-15)
        assert instance.get("satellite_force_peak") >= instance.get("satellite_force")
        lost += 0.005 * instance.get("loss_power_mean")
        peak = max(peak, instance.get("satellite_force_peak"))
    assert lost == pytest.approx(instance.get("energy_lost"), rel=1e-12, abs=1e-15)
    assert peak > instance.get("satellite_force")
    assert instance.get("output_angle") + 2.0 * math.pi * instance.get("output_turns") > 0.0
