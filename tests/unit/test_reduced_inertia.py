import numpy as np
import pytest
from geometry import direct_sums
from hypothesis import given
from hypothesis import strategies as st
from scenes import parameters, started

from inertia_module.kernel.inertia import reduced_inertia

PHASES = st.floats(-7.0, 7.0)
FACTORS = st.floats(0.0, 3.0)
LENGTHS = st.floats(0.01, 0.3)
MECHANISM = {
    "satellites": st.integers(1, 5),
    "modules": st.integers(1, 3),
    "imbalance_mass": st.floats(0.01, 10.0),
    "drive_inertia": st.sampled_from([0.0, 0.02]),
    "satellite_inertia": st.sampled_from([0.0, 0.03]),
    "satellite_transverse_inertia": st.sampled_from([0.0, 0.02]),
    "link2_inertia": st.just(0.1),
}
MECHANISMS = {
    "bevel": st.fixed_dictionaries(
        {
            "layout": st.just(0),
            "z17": st.integers(10, 60),
            "z6": st.integers(15, 30),
            "shaft_angle": st.floats(0.3, 2.8),
            "a": FACTORS,
            "b": FACTORS,
            "c": FACTORS,
            "epsilon": PHASES,
            "gamma": PHASES,
        }
        | MECHANISM
    ),
    "planar": st.fixed_dictionaries(
        {"layout": st.just(1), "sun_radius": LENGTHS, "satellite_radius": LENGTHS, "eccentricity": LENGTHS}
        | MECHANISM
    ),
}


def derived(p):
    return started("plain", p).derived


@pytest.mark.parametrize("layout", MECHANISMS)
@given(data=st.data())
def test_reduced_inertia_and_its_derivatives_are_sums_over_imbalances_and_gears(layout, data):
    p = parameters(**data.draw(MECHANISMS[layout]))
    q = data.draw(PHASES)
    expected = direct_sums(p, q)
    expected[0] += p["input_inertia"]
    d = derived(p)
    inertia, *others = reduced_inertia(d, q)
    assert (d.J1 + inertia, *others) == pytest.approx(expected, rel=1e-11, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("satellites", [1, 2, 3])
@pytest.mark.parametrize(("z17", "z6"), [(34, 20), (20, 20), (13, 20)])
@pytest.mark.parametrize("layout", [0, 1])
def test_highest_harmonic_is_the_highest_there_is(layout, z17, z6, satellites):
    d = derived({"layout": layout, "z17": z17, "z6": z6, "a": 0.7, "b": 1.3, "satellites": satellites})
    turns = np.arange(256) / 256
    spectrum = np.abs(np.fft.rfft([reduced_inertia(d, d.period * turn) for turn in turns], axis=0)).max(
        axis=1
    )
    highest = np.flatnonzero(spectrum > 1e-9 * spectrum.max())[-1]
    assert d.harmonic == pytest.approx(highest / d.period_turns)


@given(distance=st.floats(1e-12, 1e-4))
def test_inertia_near_the_rolling_point_keeps_its_digits(distance):
    p = parameters()
    d = derived(p)
    curvature = 2.0 * d.mass * d.s**2 * d.spin
    g = reduced_inertia(d, distance)[4]
    assert g == pytest.approx(0.5 * curvature * distance**2, rel=1e-13 + 10.0 * distance**2)
