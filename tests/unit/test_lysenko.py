"""Lysenko's wheel mechanism is the planar layout with link 2 held: b = r/R0, angle phi = q."""

import math

import pytest
from scenes import advanced, drive_angle, started, vector

R0, LENGTH, MASS = 0.05, 0.013, 0.8
SPEED = 120.0  # of the carrier, b w in the paper


@pytest.fixture(params=[0.02, 0.03, 0.05, 0.11], ids=lambda radius: f"r={radius}")
def b(request):
    return request.param / R0


@pytest.fixture(params=["prescribed", "held by the freewheel"])
def module(request, kernel, b):
    """Link 2 at rest, by fidelity kinematic or by a load that is too large to be moved."""
    held = {"fidelity": 0, "kinematic_ratio": 0.0} if request.param == "prescribed" else {"load_torque": 1e6}
    return started(
        kernel,
        held,
        layout=1,
        sun_radius=R0,
        satellite_radius=b * R0,
        eccentricity=LENGTH,
        imbalance_mass=MASS,
        omega1=SPEED,
    )


def angles(module, b):
    """phi again and again: it grows 1/b times as fast as the angle of the carrier."""
    passed = 0.0
    for time in (1e-6, 0.004, 0.0171, 0.03, 0.2):
        advanced(module, time - passed)
        passed = time
        assert drive_angle(module) == pytest.approx(SPEED * time / b, rel=1e-13)
        yield SPEED * time / b


def test_imbalance_is_on_the_epicycloid(module, b):
    for angle in angles(module, b):
        # equation 1
        x = R0 * (1 + b) * math.cos(b * angle) - LENGTH * math.cos((1 + b) * angle)
        y = R0 * (1 + b) * math.sin(b * angle) - LENGTH * math.sin((1 + b) * angle)
        assert vector(module, "imbalance") == pytest.approx([0.0, -y, x], abs=1e-13)


def test_distance_from_the_centre_is_rho(module, b):
    for angle in angles(module, b):
        # equation 2, phi being the angle of the satellite on the carrier
        rho = math.sqrt((R0 * (1 + b)) ** 2 + LENGTH**2 - 2 * R0 * LENGTH * (1 + b) * math.cos(angle))
        assert math.hypot(*vector(module, "imbalance")) == pytest.approx(rho, rel=1e-12)


def test_mesh_torque_is_the_moment_about_the_satellite_through_the_gear(module, b):
    for angle in angles(module, b):
        w = SPEED / b
        moment = MASS * b**2 * w**2 * LENGTH * R0 * (1 + b) * math.sin(angle)
        # of the inertia force: the sun wheel turns the satellite back, and is itself turned 1/b times as much
        scale = MASS * b**2 * w**2 * LENGTH * R0
        assert module["mesh_torque"] == pytest.approx(-moment / b, rel=1e-11, abs=1e-11 * scale)


def test_torques_on_the_whole_balance_the_corrected_moment_about_the_centre(module, b):
    for angle in angles(module, b):
        w = SPEED / b
        moment = -MASS * R0 * (1 + b) * (1 + 2 * b) * LENGTH * w**2 * math.sin(angle)
        # what acts from outside: the input on the carrier, and the housing on link 2 against the mesh
        outside = module["input_torque"] - module["mesh_torque"]
        assert outside == pytest.approx(-moment, rel=1e-11, abs=1e-11 * MASS * R0 * LENGTH * w**2)


def test_carrier_at_constant_speed_takes_only_the_power_that_changes_the_energy(module, b):
    for angle in angles(module, b):
        w = SPEED / b
        speed = LENGTH**2 * w**2 * (1 + b) ** 2 + (R0 * (1 + b) * b * w) ** 2
        speed -= 2 * LENGTH * w * (1 + b) * R0 * (1 + b) * b * w * math.cos(angle)
        assert module["energy_stored"] == pytest.approx(0.5 * MASS * speed, rel=1e-12)
        start = 0.5 * MASS * ((R0 * (1 + b) * b - LENGTH * (1 + b)) * w) ** 2
        gained = module["energy_stored"] - start
        assert module["energy_in"] == pytest.approx(gained, rel=1e-9, abs=1e-11 * module["energy_stored"])
        assert module["energy_out"] == 0.0
