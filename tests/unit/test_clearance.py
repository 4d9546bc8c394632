"""Test warnings of mechanisms that cannot be built: overlapping satellites, imbalances outside."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from rejected import REJECTED

from inertia_module.model import DrivenShaft, Module
from papers.karetin import Geometry

PLANAR = {"layout": 1, "sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": 0.02}
INTERNAL = {"z17": 20, "z6": 60, "shaft_angle": 2.5, "a": 1.2}
OVERLAP, OUTSIDE = "satellites of a module overlap", "the unbalanced mass is outside"


def warned(words, **values):
    return any(words in warning for warning in Module("plain").start(**values).warnings())


def axis(shaft_angle, turn):
    """Return the unit vector along the axis of a satellite on a drive about z."""
    sine, cosine = math.sin(shaft_angle), math.cos(shaft_angle)
    return np.array([sine * math.cos(turn), sine * math.sin(turn), -cosine])


@given(st.floats(0.01, 1.0), st.floats(0.01, 1.0), st.integers(2, 24))
def test_planar_satellites_overlap_with_their_circles(sun, satellite, count):
    centre = sun + satellite
    apart = abs(centre - centre * np.exp(2j * math.pi / count))
    assume(abs(apart - 2.0 * satellite) > 1e-9)
    overlap = apart < 2.0 * satellite
    assert warned(OVERLAP, layout=1, sun_radius=sun, satellite_radius=satellite, satellites=count) == overlap


@given(st.integers(8, 80), st.integers(8, 80), st.floats(0.1, 3.0), st.integers(2, 24))
def test_bevel_satellites_overlap_with_their_pitch_cones(z17, z6, shaft_angle, count):
    phi = Geometry(z17=z17, z6=z6, shaft_angle=shaft_angle).phi
    first, second = axis(shaft_angle, 0.0), axis(shaft_angle, 2.0 * math.pi / count)
    apart = math.atan2(float(np.linalg.norm(np.cross(first, second))), float(first @ second))
    assume(abs(apart - 2.0 * phi) > 1e-6)
    values = {"z17": z17, "z6": z6, "shaft_angle": shaft_angle, "satellites": count}
    assert warned(OVERLAP, **values) == (apart < 2.0 * phi)


@given(st.floats(0.0, 2.0), st.floats(0.0, 2.0), st.floats(0.3, 2.5), st.integers(10, 60))
def test_bevel_imbalance_outside_the_pitch_cone_is_reported(a, b, shaft_angle, z17):
    g = Geometry(z17=z17, z6=20, shaft_angle=shaft_angle, a=a, b=b)
    assume(g.phi < 0.49 * math.pi)
    room = min(g.QA * math.tan(g.phi), g.L * math.sin(g.phi))
    assume(abs(g.AD - room) > 1e-9)
    values = {"z17": z17, "shaft_angle": shaft_angle, "a": a, "b": b, "link2_inertia": 1.0}
    assert warned(OUTSIDE, **values) == (room < g.AD)


@given(own=st.floats(0.0, 1e-2), across=st.floats(0.0, 1e-2), layout=st.sampled_from([0, 1]))
def test_bevel_satellite_with_impossible_inertias_is_reported(own, across, layout):
    # own: twice the sum of m x^2 of an equal body about z; across: the same and the sum of m z^2.
    along = across - 0.5 * own
    assume(abs(along) > 1e-9)
    values = {"satellite_inertia": own, "satellite_transverse_inertia": across}
    assert warned("physically impossible inertia", layout=layout, **values) == (layout == 0 and along < 0.0)


@pytest.mark.parametrize("values", REJECTED["buildable"])
def test_buildable_mechanism_has_no_warning(values):
    assert Module("plain").start(**values).warnings() == []
    assert DrivenShaft("plain").start().warnings() == []


@pytest.mark.parametrize("values, sentence", REJECTED["clearance"])
def test_warning_contains_the_values_and_their_limits(compiled, values, sentence):
    module = Module(compiled).start(**values)
    assert module.warnings() == [sentence]
    # The module runs in spite of the warning.
    module.set(omega1=100.0, load_torque=10.0)
    module.advance(0.01)


def test_all_warnings_are_reported_and_internal_satellites_do_not_overlap():
    assert len(Module("plain").start(**PLANAR | {"satellites": 12, "eccentricity": 0.04}).warnings()) == 2
    assert warned(OVERLAP, **INTERNAL, satellites=2)
