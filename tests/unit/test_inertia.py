"""Test reduced inertia and geometry of the kernel: closed sums, derivatives, special cases by hand."""

import math

import numpy as np
import pytest
from differences import assert_rates
from geometry import direct_sums, position
from hypothesis import given
from hypothesis import strategies as st
from scenes import LAYOUTS, parameters, started

from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.kernel.layout import imbalance_position

ANGLES = (-7.3, 0.0, 0.4, 1.9, 30.0)  # rad
GEARS = {"satellite_inertia": 0.004, "satellite_transverse_inertia": 0.003, "drive_inertia": 0.002}


@pytest.fixture(params=LAYOUTS)
def mechanism(request):
    return LAYOUTS[request.param]


@pytest.mark.parametrize("modules", [1, 2])
@pytest.mark.parametrize("satellites", [1, 2, 3, 5])
def test_closed_sums_are_the_sums_over_the_satellites(mechanism, satellites, modules):
    """I = sum m (y^2 + z^2), B = sum m (y z' - z y'), G = sum m |r'|^2, with masses alone."""
    d = started("plain", mechanism, satellites=satellites, modules=modules).derived
    mass = d.mass / satellites
    for q in ANGLES:
        sums = [0.0] * 6
        for n in range(satellites):
            azimuth = 0.0 if d.planar else math.tau * n / satellites
            _, y, z, x1, y1, z1, x2, y2, z2 = imbalance_position(d, q, azimuth)
            sums[0] += mass * (y * y + z * z)
            sums[1] += 2.0 * mass * (y * y1 + z * z1)
            sums[2] += mass * (y * z1 - z * y1)
            sums[3] += mass * (y * z2 - z * y2)
            sums[4] += mass * (x1 * x1 + y1 * y1 + z1 * z1)
            sums[5] += 2.0 * mass * (x1 * x2 + y1 * y2 + z1 * z2)
        scale = d.mass * d.axial**2 + d.mass * d.radial**2
        assert reduced_inertia(d, q) == pytest.approx(sums, rel=1e-12, abs=1e-13 * scale)


@pytest.mark.parametrize("satellites", [1, 2, 3])
def test_reduced_inertia_with_gears_agrees_with_virtual_work(mechanism, satellites):
    values = {**mechanism, **GEARS, "satellites": satellites}
    d, p = started("plain", values).derived, parameters(**values)
    for q in ANGLES:
        i, *others = reduced_inertia(d, q)
        assert [d.J1 + i, *others] == pytest.approx(direct_sums(p, q), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("satellites", [1, 2, 3])
def test_derivatives_of_the_reduced_inertia(mechanism, satellites):
    d = started("plain", mechanism, GEARS, satellites=satellites).derived
    for q in ANGLES:
        assert_rates(reduced_inertia(d, q)[1::2], lambda more, q=q: reduced_inertia(d, q + more)[::2])


@pytest.mark.parametrize("satellites", [1, 2, 3, 5])
def test_highest_harmonic_of_the_reduced_inertia(mechanism, satellites):
    """The ratio z17 / z6 = 1.5 of the satellites repeats after two revolutions of the pinion shaft."""
    d = started("plain", mechanism, z17=30, z6=20, satellites=satellites).derived
    angles = np.linspace(0.0, 2.0 * math.tau, 128, endpoint=False)
    inertias = np.array([reduced_inertia(d, q)[::2] for q in angles])
    content = np.abs(np.fft.rfft(inertias, axis=0)).max(axis=1)
    harmonics = np.flatnonzero(content > 1e-9 * content.max()) / 2.0
    assert harmonics.max() == d.harmonic


def test_position_and_its_derivatives(mechanism):
    d, p = started("plain", mechanism).derived, parameters(**mechanism)
    for q in ANGLES:
        values = imbalance_position(d, q, 0.0)
        assert values[:3] == pytest.approx(list(position(p, q)), rel=1e-12, abs=1e-14)
        assert_rates(values[3:], lambda more, q=q: imbalance_position(d, q + more, 0.0)[:6])


@given(q=st.floats(-50.0, 50.0))
def test_planar_inertia_by_the_cosine_rule(q):
    """|r|^2 = R^2 + l^2 - 2 R l cos q and |r'| = l, with the distance R of the satellite axis."""
    mass, distance, arm = 0.8, 0.05 + 0.03, 0.02
    radii = {"sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": arm}
    d = started("plain", radii, layout=1, imbalance_mass=mass, satellites=1).derived
    i, i1, b, b1, g, g1 = reduced_inertia(d, q)
    product = mass * distance * arm
    assert i == pytest.approx(mass * (distance**2 + arm**2) - 2.0 * product * math.cos(q), rel=1e-12)
    assert i1 == pytest.approx(2.0 * product * math.sin(q), abs=1e-15)
    assert b == pytest.approx(mass * arm**2 - product * math.cos(q), abs=1e-15)
    assert b1 == pytest.approx(product * math.sin(q), abs=1e-15)
    assert g == pytest.approx(mass * arm**2, rel=1e-12)
    assert g1 == 0.0


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (0.7, 0.7), (0.8, 1.3), (1.4, 0.6)])
def test_bevel_speed_of_the_imbalance_next_to_the_rolling_point(a, b):
    """|r'| = |b - a| L sin(Sigma) cos(phi) where the angle B is 0 (mechanics.md, "Reduced inertia")."""
    p = parameters(a=a, b=b)
    d = started("plain", a=a, b=b).derived
    cone_angle = math.atan2(math.sin(p["shaft_angle"]), p["z17"] / p["z6"] + math.cos(p["shaft_angle"]))
    length = p["wheel_radius"] / math.sin(p["shaft_angle"] - cone_angle)
    speed = (b - a) * length * math.sin(p["shaft_angle"]) * math.cos(cone_angle)
    assert reduced_inertia(d, -d.phase_b / d.s)[4] == pytest.approx(d.mass * speed**2, rel=1e-12, abs=1e-30)
