"""Places, speeds, forces and moments of Lysenko exact against a chain of turned bodies in 30 digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from lysenko_chain import ALPHAS, MECHANISMS, OMEGA, Chain, cross, torque_scale

from studies.papers.lysenko.equations import Mechanism, exact


@pytest.fixture(params=MECHANISMS, ids=lambda m: f"b={m.b:.3g}, l={m.arm}")
def mechanism(request):
    return request.param


def test_imbalance_is_where_the_chain_carries_it(mechanism):
    for alpha in ALPHAS:
        place = Chain(mechanism, alpha).mass(0)
        x, y = exact(mechanism, alpha).epicycloid
        found = complex(exact(mechanism, alpha).place)
        in_frame = place * mp.expj(-Chain(mechanism, alpha).ratio * mp.mpf(alpha))
        size = mechanism.centre_distance + mechanism.arm
        assert [float(x), float(y)] == pytest.approx([float(place.real), float(place.imag)], abs=1e-12 * size)
        assert [found.real, found.imag] == pytest.approx(
            [float(in_frame.real), float(in_frame.imag)], abs=1e-12 * size
        )
        assert float(exact(mechanism, alpha).rho) == pytest.approx(float(abs(place)), rel=1e-13)


def test_speed_is_the_rate_of_the_place(mechanism):
    for alpha in ALPHAS:
        rate = abs(mp.diff(Chain(mechanism, alpha).mass, 0))
        largest = float(exact(mechanism, math.pi, OMEGA).V)
        assert float(exact(mechanism, alpha, OMEGA).V) == pytest.approx(float(rate), abs=1e-11 * largest)


def test_angles_keep_their_quadrant(mechanism):
    for alpha in ALPHAS:
        chain = Chain(mechanism, alpha)
        from_wheel, from_centre = chain.mass(0) - chain.pin(0), chain.mass(0)
        beta1 = float(mp.arg(from_centre / from_wheel))
        assert math.cos(float(exact(mechanism, alpha).beta1) - beta1) == pytest.approx(1.0, abs=1e-12)
        speed = mp.diff(chain.mass, 0)
        if abs(speed) > 1e-9 * float(exact(mechanism, math.pi, OMEGA).V):
            delta = float(mp.arg(1j * from_centre / speed))
            assert math.cos(float(exact(mechanism, alpha).delta) - delta) == pytest.approx(1.0, abs=1e-12)


def test_inertia_forces_add_up_to_minus_mass_times_acceleration(mechanism):
    for alpha in ALPHAS:
        chain = Chain(mechanism, alpha)
        outward = (chain.mass(0) - chain.pin(0)) / mechanism.arm
        from_centre = chain.mass(0) / abs(chain.mass(0))
        along_wheel = exact(mechanism, alpha, OMEGA).F1 + exact(mechanism, alpha, OMEGA).Fk
        total = along_wheel * outward + float(exact(mechanism, alpha, OMEGA).F2) * from_centre
        force = chain.inertia_force()
        assert abs(complex(total - force)) <= 1e-11 * mechanism.m * OMEGA**2 * (
            mechanism.arm * (1 + mechanism.b) ** 2 + mechanism.b**2 * mechanism.centre_distance
        )


def test_moments_are_those_of_the_inertia_force(mechanism):
    for alpha in ALPHAS:
        chain = Chain(mechanism, alpha)
        force = chain.inertia_force()
        about_wheel = float(cross(chain.mass(0) - chain.pin(0), force))
        about_centre = float(cross(chain.mass(0), force))
        moved_to_pin = float(cross(chain.pin(0), force))
        tolerance = 1e-11 * torque_scale(mechanism)
        assert float(exact(mechanism, alpha, OMEGA).M1) == pytest.approx(about_wheel, abs=tolerance)
        assert float(exact(mechanism, alpha, OMEGA).M) == pytest.approx(about_centre, abs=tolerance)
        at_pin = exact(mechanism, alpha, OMEGA).M - exact(mechanism, alpha, OMEGA).M1
        assert float(at_pin) == pytest.approx(moved_to_pin, abs=tolerance)


def test_moments_are_forces_times_arms(mechanism):
    for alpha in ALPHAS:
        # equations 9 and 10, put right
        about_wheel = exact(mechanism, alpha, OMEGA).F2 * exact(mechanism, alpha).n2
        along_wheel = exact(mechanism, alpha, OMEGA).F1 + exact(mechanism, alpha, OMEGA).Fk
        tolerance = 1e-12 * torque_scale(mechanism)
        assert float(about_wheel) == pytest.approx(float(exact(mechanism, alpha, OMEGA).M1), abs=tolerance)
        assert -along_wheel * float(exact(mechanism, alpha).n1) == pytest.approx(
            float(exact(mechanism, alpha, OMEGA).M), abs=tolerance
        )


# --- shapes, limits ---


def test_everything_is_finite_at_degenerate_dimensions():
    angle = np.linspace(-7.0, 7.0, 57)
    for mechanism in (
        Mechanism(1.0, 1.0, 2.0, 1.0),  # the imbalance passes through O
        Mechanism(1.0, 1e-9, 1e-12, 1.0),
        Mechanism(1e-9, 1.0, 1.0, 1.0),
        Mechanism(1.0, 1.0, 1.0, 1.0),
    ):
        found = exact(mechanism, angle, 3.0)
        for name in ("rho", "beta1", "delta", "n1", "J_red", "V", "M1", "M", "drive_power"):
            assert getattr(found, name).shape == angle.shape
            assert np.isfinite(getattr(found, name)).all()
