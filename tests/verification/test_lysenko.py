"""Test Lysenko's exact forms with a chain of rotated bodies, and values of claims with the module."""

import cmath
import math

import numpy as np
import pytest
from geometry import derivatives, position, taylor, turn

from papers import lysenko
from papers.engine import claims_of
from papers.lysenko import EXAMPLE, EXAMPLE_SPEED, Mechanism, exact

OMEGA, OMEGA_RATE = 37.0, 210.0
MECHANISMS = {
    "l=r": EXAMPLE,
    "l<r": Mechanism(R0=0.05, r=0.03, arm=0.02, m=0.8),
    "l>r": Mechanism(R0=0.04, r=0.11, arm=0.2, m=0.3, J_carrier=1e-3, J_wheel=2e-4),
    "short arm": Mechanism(R0=2.0, r=0.05, arm=0.01, m=5.0, J_carrier=0.1),
}
ALPHAS = [0.0, 0.4, 1.3, 1.5707963267948966, 2.2, 3.141592653589793, 4.0, 6.1, 1e4]


def imbalance_motion(m, alpha, omega_rate=0.0):
    """Return position, velocity and acceleration of the imbalance, and its pin, as complex numbers.

    They follow from the chain of rotated bodies (geometry.py) and the Taylor series of its positions.
    """
    p = {"layout": 1, "satellites": 1, "sun_radius": m.R0, "satellite_radius": m.r, "eccentricity": m.arm}

    def place(t):
        angle = alpha + OMEGA * t + omega_rate * t * t / 2.0
        _, y, z = turn(0, m.b * angle) @ position(p, angle)
        return np.array([z, -y])

    motion = derivatives(taylor(place, 0.0, radius=0.1 / OMEGA / (1.0 + m.b)))
    return *(complex(*pair) for pair in motion), (m.R0 + m.r) * cmath.exp(1j * m.b * alpha)


def cross(a, b):
    return a.real * b.imag - a.imag * b.real


def torque_scale(mechanism):
    return mechanism.m * mechanism.centre_distance * mechanism.arm * OMEGA**2 * (1 + mechanism.b) ** 2


@pytest.fixture(params=MECHANISMS)
def mechanism(request):
    return MECHANISMS[request.param]


@pytest.mark.parametrize("alpha", ALPHAS)
def test_positions_speeds_forces_and_moments_agree_with_the_chain(mechanism, alpha):
    m, e = mechanism, exact(mechanism, alpha, OMEGA)
    place, velocity, acceleration, pin = imbalance_motion(m, alpha)
    size, max_speed = m.centre_distance + m.arm, float(exact(m, math.pi, OMEGA).V)
    assert complex(*e.epicycloid) == pytest.approx(place, abs=1e-11 * size)
    assert complex(e.place) == pytest.approx(place * cmath.exp(-1j * m.b * alpha), abs=1e-11 * size)
    assert float(e.rho) == pytest.approx(abs(place), abs=1e-11 * size)
    assert float(e.V) == pytest.approx(abs(velocity), abs=1e-10 * max_speed)
    # Angles keep their quadrant
    assert math.cos(float(e.beta1) - cmath.phase(place / (place - pin))) == pytest.approx(1.0, abs=1e-12)
    if abs(velocity) > 1e-6 * max_speed:
        delta = cmath.phase(1j * place / velocity)
        assert math.cos(float(e.delta) - delta) == pytest.approx(1.0, abs=1e-12)
    # The sum of the inertia forces is -m a; moments follow from it
    force = -m.m * acceleration
    total = (e.F1 + e.Fk) * (place - pin) / m.arm + float(e.F2) * place / abs(place)
    bound = m.m * OMEGA**2 * (m.arm * (1 + m.b) ** 2 + m.b**2 * m.centre_distance)
    assert abs(complex(total - force)) <= 1e-9 * bound
    for actual, expected in (
        (e.M1, cross(place - pin, force)),
        (e.M, cross(place, force)),
        (e.M - e.M1, cross(pin, force)),
        # Equations 9 and 10, corrected.
        (e.F2 * e.n2, e.M1),
        (-(e.F1 + e.Fk) * e.n1, e.M),
    ):
        assert float(actual) == pytest.approx(float(expected), abs=1e-9 * torque_scale(m))


@pytest.mark.parametrize("omega_rate", [0.0, OMEGA_RATE])
@pytest.mark.parametrize("alpha", ALPHAS)
def test_drive_and_fixed_wheel_balance_energy_and_momentum(mechanism, alpha, omega_rate):
    m, e = mechanism, exact(mechanism, alpha, OMEGA, omega_rate=omega_rate)
    place, velocity, acceleration, _ = imbalance_motion(m, alpha, omega_rate)
    # Carrier and wheel in the fixed frame
    inertias, speeds = np.array([m.J_carrier, m.J_wheel]), np.array([m.b, 1.0 + m.b])
    energy = 0.5 * (m.m * abs(velocity) ** 2 + inertias @ (speeds * OMEGA) ** 2)
    power = m.m * (velocity.conjugate() * acceleration).real + inertias @ speeds**2 * OMEGA * omega_rate
    scale = torque_scale(m) + abs(float(exact(m, math.pi, OMEGA, omega_rate=omega_rate).drive_torque))
    assert float(e.drive_torque) * m.b * OMEGA == pytest.approx(power, abs=1e-9 * scale * m.b * OMEGA)
    assert float(e.kinetic_energy) == pytest.approx(energy, rel=1e-9)
    if omega_rate:
        return
    momentum = inertias @ speeds * OMEGA + m.m * cross(place, velocity)
    scale = torque_scale(m) / min(m.b, 1.0)
    assert float(e.angular_momentum) == pytest.approx(momentum, abs=1e-9 * scale / OMEGA)
    # External torques are the drive and the fixed wheel. The drive power is minus the power of the inertia
    # forces. With forces moved to the pin, it uses the absolute speed of the wheel.
    for actual, expected, bound in (
        (e.drive_torque + e.M1 / m.b, m.m * cross(place, acceleration), 1.0),
        (e.drive_torque, -e.M - e.M1 / m.b, 1.0),
        (e.N1 + e.N, -e.drive_power, (1 + m.b) * OMEGA),
        (((e.M - e.M1) * m.b + e.M1 * (1 + m.b)) * OMEGA, -e.drive_power, (1 + m.b) * OMEGA),
    ):
        assert float(actual) == pytest.approx(float(expected), abs=1e-9 * scale * bound)


def test_results_are_finite_at_degenerate_dimensions():
    angle = np.linspace(-7.0, 7.0, 57)
    for mechanism in (
        Mechanism(1.0, 1.0, 2.0, 1.0),  # The imbalance passes through O
        Mechanism(1.0, 1e-9, 1e-12, 1.0),
        Mechanism(1e-9, 1.0, 1.0, 1.0),
        Mechanism(1.0, 1.0, 1.0, 1.0),
    ):
        forms = exact(mechanism, angle, 3.0)
        for name in ("rho", "beta1", "delta", "n1", "J_red", "V", "M1", "M", "drive_power"):
            assert forms[name].shape == angle.shape
            assert np.isfinite(forms[name]).all()


# --- free motion ---


def test_free_mechanism_has_no_drive_torque(mechanism):
    for alpha in ALPHAS:
        if mechanism.arm == mechanism.r or mechanism.J_carrier + mechanism.J_wheel > 0.0:
            free = exact(mechanism, alpha + 1e-30j).free_speed
            rate = OMEGA**2 * free.imag / free.real / 1e-30
            torque = float(exact(mechanism, alpha, OMEGA, omega_rate=rate).drive_torque)
            assert torque == pytest.approx(0.0, abs=1e-12 * torque_scale(mechanism) * (1 + mechanism.b))
            fastest = exact(mechanism, 0.0)
            assert 1.0 <= free.real <= fastest.speed_ratio * (1 + 1e-12)
            assert fastest.free_speed == pytest.approx(fastest.speed_ratio, rel=1e-12)


# --- values of claims by the module, against independent equations ---


def test_drive_power_is_the_rate_of_energy_and_lift_plus_losses():
    # At the ends of the steps over a turn of the carrier
    alpha, step = np.linspace(0.0, 2.0 * np.pi / EXAMPLE.b, lysenko.STEPS + 1), lysenko.TURN / lysenko.STEPS
    e, loss, power = exact(EXAMPLE, alpha, EXAMPLE_SPEED), lysenko.LOSSES, lysenko.drive_power(EXAMPLE)
    # Link 2 has the largest inertia in range and still moves a little
    assert power == pytest.approx(np.diff(e.kinetic_energy) / step, abs=1e-6 * power.max())
    lift_power = lysenko.drive_power(EXAMPLE, gravity=9.81) - power
    height = (e.place * np.exp(1j * EXAMPLE.b * alpha)).real
    assert lift_power == pytest.approx(EXAMPLE.m * 9.81 * np.diff(height) / step, abs=1e-6 * lift_power.max())
    viscous = loss["input_friction"] * lysenko.CARRIER_SPEED**2 + loss["drive_friction"] * EXAMPLE_SPEED**2
    journal = loss["journal_friction"] * np.abs(e.force[:-1]).mean() * EXAMPLE_SPEED
    mesh = (1.0 - loss["mesh_efficiency"]) * np.abs(e.M1[:-1]).mean() / EXAMPLE.b * lysenko.CARRIER_SPEED
    # The mesh also transmits the losses of journal and wheel
    assert lysenko.drive_power(EXAMPLE, **loss).mean() == pytest.approx(viscous + journal + mesh, rel=0.01)


def test_mesh_loss_is_a_share_of_the_transmitted_power():
    m, alpha = EXAMPLE, np.linspace(0.0, 2.0 * np.pi, 20001)
    inertia = m.J_wheel + m.m * m.arm * (m.arm - m.centre_distance * np.cos(alpha))
    shares = claims_of("lysenko", lysenko)["circulation"]["share"].value
    for speed, share in zip((1.0, exact(m, alpha).free_speed), shares, strict=True):
        square = (m.b * speed) ** 2 * np.ones_like(alpha)
        acceleration = 0.5 * np.gradient(square, m.b * alpha)
        # By links.py with omega2 = 0: k ((k G + B) alpha1 - I' omega1^2 / 2)
        torque = ((m.J_wheel + m.m * m.arm**2) / m.b + inertia) * acceleration
        torque -= m.m * m.arm * m.centre_distance * np.sin(alpha) * square
        lost = (1.0 - lysenko.LOSSES["mesh_efficiency"]) * np.trapezoid(np.abs(torque) / m.b, alpha)
        time = 1.0 / speed * np.ones_like(alpha)
        energy = 0.5 * exact(m, alpha).J_red * square
        mean = np.trapezoid(energy * time, alpha) / np.trapezoid(time, alpha)
        # Three cycles per turn, each m.b of a turn; in free motion the energy decreases by some percent per
        # cycle
        assert share == pytest.approx(lost / mean, rel=0.03)
