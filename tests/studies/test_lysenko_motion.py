"""Drive, energy and free motion of Lysenko exact against the chain, integration, and the module."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lysenko_chain import ALPHAS, MECHANISMS, OMEGA, OMEGA_RATE, Chain, torque_scale
from scenes import advanced, drive_angle, started
from scipy.integrate import solve_ivp

from studies.papers.lysenko.equations import EXAMPLE, Mechanism, exact, speed_ratio


@pytest.fixture(params=MECHANISMS, ids=lambda m: f"b={m.b:.3g}, l={m.arm}")
def mechanism(request):
    return request.param


@pytest.mark.parametrize("omega_rate", [0.0, OMEGA_RATE])
def test_drive_supplies_the_change_of_energy(mechanism, omega_rate):
    for alpha in ALPHAS:
        chain = Chain(mechanism, alpha, OMEGA, omega_rate)
        power = float(mp.diff(chain.energy, 0))
        torque = float(exact(mechanism, alpha, OMEGA, omega_rate=omega_rate).drive_torque)
        scale = torque_scale(mechanism) + abs(
            float(exact(mechanism, math.pi, OMEGA, omega_rate=omega_rate).drive_torque)
        )
        assert torque * mechanism.b * OMEGA == pytest.approx(power, abs=1e-11 * scale * mechanism.b * OMEGA)
        energy = float(exact(mechanism, alpha, OMEGA).kinetic_energy)
        assert energy == pytest.approx(float(chain.energy(0)), rel=1e-9)


def test_power_of_the_drive_is_minus_that_of_the_inertia_forces(mechanism):
    for alpha in ALPHAS:
        taken = exact(mechanism, alpha, OMEGA).N1 + exact(mechanism, alpha, OMEGA).N
        power = float(exact(mechanism, alpha, OMEGA).drive_power)
        scale = torque_scale(mechanism) * mechanism.b * OMEGA
        assert power == pytest.approx(-float(taken), abs=1e-12 * scale)
        assert float(exact(mechanism, alpha, OMEGA).drive_torque) == pytest.approx(
            -float(exact(mechanism, alpha, OMEGA).M) - float(exact(mechanism, alpha, OMEGA).M1) / mechanism.b,
            abs=1e-12 * torque_scale(mechanism) / mechanism.b,
        )


def test_wheel_power_belongs_to_the_absolute_speed_where_forces_are_moved_to_the_pin(mechanism):
    for alpha in ALPHAS:
        b = mechanism.b
        moved = (exact(mechanism, alpha, OMEGA).M - exact(mechanism, alpha, OMEGA).M1) * b * OMEGA
        moved += exact(mechanism, alpha, OMEGA).M1 * (1 + b) * OMEGA
        scale = torque_scale(mechanism) * (1 + b) * OMEGA
        assert float(moved) == pytest.approx(
            -float(exact(mechanism, alpha, OMEGA).drive_power), abs=1e-12 * scale
        )


def test_drive_and_held_wheel_change_the_angular_momentum(mechanism):
    for alpha in ALPHAS:
        chain = Chain(mechanism, alpha)
        assert float(exact(mechanism, alpha, OMEGA).angular_momentum) == pytest.approx(
            float(chain.momentum(0)), abs=1e-12 * torque_scale(mechanism) / OMEGA / min(mechanism.b, 1.0)
        )
        outside = (
            exact(mechanism, alpha, OMEGA).drive_torque + exact(mechanism, alpha, OMEGA).M1 / mechanism.b
        )
        assert float(outside) == pytest.approx(
            float(mp.diff(chain.momentum, 0)), abs=1e-11 * torque_scale(mechanism)
        )


@given(
    st.floats(0.02, 5.0),
    st.floats(0.05, 3.0),
    st.floats(0.0, 1e-2),
    st.floats(0.0, 1e-4),
    st.floats(1.0, 500.0),
)
def test_mean_power_over_a_cycle_is_zero(b, arm, carrier, wheel, omega):
    mechanism = Mechanism(0.06, b * 0.06, arm * b * 0.06, 1.0, carrier, wheel)
    angle = np.linspace(0.0, 2.0 * math.pi, 1000, endpoint=False)
    power = exact(mechanism, angle, omega).drive_power
    assert abs(power.mean()) <= 1e-13 * np.abs(power).max()


def _free_motion(mechanism, omega_start, turns):
    """Lagrange's equation of the carrier from derivatives of the place of the imbalance."""
    b, D, arm = mechanism.b, mechanism.centre_distance, mechanism.arm
    fixed = mechanism.J_carrier + mechanism.J_wheel * (1 + 1 / b) ** 2

    def rates(_, state):
        theta, speed = state
        turn, wheel = np.exp(1j * theta), (1 + 1 / b) * np.exp(1j * (1 + 1 / b) * theta)
        first = 1j * (D * turn - arm * wheel)
        second = -(D * turn - arm * (1 + 1 / b) * wheel)
        inertia = fixed + mechanism.m * abs(first) ** 2
        return speed, -mechanism.m * (first.conjugate() * second).real * speed**2 / inertia

    period = 2 * math.pi * turns / (b * omega_start)
    times = np.linspace(0.0, period, 400)
    start = (b * math.pi, b * omega_start)
    run = solve_ivp(rates, (0.0, period), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return run.y[0] / b, run.y[1] / b


@pytest.mark.parametrize("mechanism", MECHANISMS[:3], ids=["l=r", "l<r", "l>r"])
def test_free_mechanism_keeps_its_energy(mechanism):
    alpha, omega = _free_motion(mechanism, 10.0, turns=2)
    energy = exact(mechanism, alpha, omega).kinetic_energy
    assert energy == pytest.approx(np.full_like(energy, energy[0]), rel=1e-9)
    assert omega == pytest.approx(exact(mechanism, alpha, 10.0).free_speed, rel=1e-8)
    assert omega.min() == pytest.approx(10.0, rel=1e-9)
    assert omega.max() <= 10.0 * speed_ratio(mechanism) * (1 + 1e-9)
    assert omega.max() == pytest.approx(10.0 * speed_ratio(mechanism), rel=2e-2)


def test_free_mechanism_does_not_keep_its_angular_momentum():
    alpha, omega = _free_motion(EXAMPLE, 10.0, turns=1)
    momentum = exact(EXAMPLE, alpha, omega).angular_momentum
    assert momentum.min() < 0.4 * momentum.max()


def test_free_mechanism_accelerates_as_no_drive_asks(mechanism):
    for alpha in ALPHAS:
        if mechanism.arm == mechanism.r or mechanism.J_carrier + mechanism.J_wheel > 0.0:
            free = exact(mechanism, alpha + 1e-30j).free_speed
            rate = OMEGA**2 * free.imag / free.real / 1e-30
            torque = float(exact(mechanism, alpha, OMEGA, omega_rate=rate).drive_torque)
            assert torque == pytest.approx(0.0, abs=1e-12 * torque_scale(mechanism) * (1 + mechanism.b))


# --- the module ---


def _held_module(kernel, mechanism, **values):
    return started(
        kernel,
        layout=1,
        fidelity=0,
        kinematic_ratio=0.0,
        sun_radius=mechanism.R0,
        satellite_radius=mechanism.r,
        eccentricity=mechanism.arm,
        imbalance_mass=mechanism.m,
        input_inertia=mechanism.J_carrier,
        drive_inertia=mechanism.J_wheel,
        **values,
    )


@pytest.mark.parametrize("mechanism", MECHANISMS[:3], ids=["l=r", "l<r", "l>r"])
def test_module_with_link_2_held_is_the_mechanism(kernel, mechanism):
    carrier = 120.0
    omega = carrier / mechanism.b
    module = _held_module(kernel, mechanism, omega1=carrier)
    scale = torque_scale(mechanism) * (omega / OMEGA) ** 2
    for step in (1e-6, 0.003, 0.0131, 0.4):
        advanced(module, step)
        alpha = drive_angle(module)
        forces = (
            (module["input_torque"], exact(mechanism, alpha, omega).drive_torque),
            (module["mesh_torque"], -exact(mechanism, alpha, omega).M1 / mechanism.b),
            (
                module["input_torque"] - module["mesh_torque"],
                -exact(mechanism, alpha, omega).M,
            ),
        )
        for found, expected in forces:
            assert found == pytest.approx(float(expected), abs=1e-11 * scale)
        assert module["energy_stored"] == pytest.approx(
            float(exact(mechanism, alpha, omega).kinetic_energy), rel=1e-11
        )


def test_module_accelerated_takes_the_torque_of_lagrange(kernel):
    step, rate, carrier = 0.01, 400.0, 120.0
    module = _held_module(kernel, EXAMPLE, omega1=carrier, input_hold=1)
    for number in range(1, 4):
        advanced(module, step, omega1=carrier + number * rate * step)
    # the input is extrapolated from its last two values to the end of the step
    speed = carrier + 4 * rate * step
    torque = exact(EXAMPLE, drive_angle(module), speed / EXAMPLE.b, omega_rate=rate / EXAMPLE.b).drive_torque
    assert module["input_torque"] == pytest.approx(float(torque), rel=1e-9)
