"""Geometry, motion and times at their limits: finite values or a refusal that says why."""

import itertools
import math
import warnings

import numpy as np
import pytest
from karetin_cases import geometry, reach
from rigid_chain import Chain, length, relative_error

from inertia_module.contract.variables import BY_NAME
from studies.papers.karetin import Geometry, Motion, dynamic_mode, exact, stop_mode
from studies.papers.karetin.exact import EXACT
from studies.papers.karetin.motion import transmission_ratios
from studies.papers.karetin.projections import angles, angular_velocities, feet, lengths

SMALLEST_ANGLE, LARGEST_ANGLE = 1e-6, 3.141591
ANGLES = (SMALLEST_ANGLE, 1e-3, math.pi / 2, 2.0, math.pi - 1e-3, LARGEST_ANGLE)
# equal wheels, needle of a satellite, needle of a wheel, internal satellite
TEETH = ((20, 20), (1_000_000, 1), (1, 1_000_000), (20, 21), (10, 40))
FACTORS = (
    (1.0, 1.0, 1.0),
    (0.0, 1.0, 1.0),
    (1.0, 0.0, 1.0),
    (1.0, 1.0, 0.0),
    (0.0, 0.0, 0.0),
    (1e-300, 1e-9, 1e-160),
)
MOTIONS = {
    "stop": stop_mode(100.0),
    "dynamic": dynamic_mode(100.0, 2.0),
    "link 2 held": dynamic_mode(100.0, math.inf),
    "locked": dynamic_mode(100.0, 1.0),
    "turning back": dynamic_mode(-100.0, -0.5),
    "at rest": stop_mode(0.0),
    "hardly moving": dynamic_mode(1e-300, 2.0),
}
# the coefficients of the page, infinite at QA = 0, OQ = 0, x = 0 and V_y = 0, are not needed
NAMES = EXACT.keys() - {"mu", "lambda_", "v", "k1"}
TIMES = np.array([0.0, 1e-300, 1e-9, math.pi / 200.0, math.pi / 100.0, 0.1, 1.0, 1e6, -1e6])


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("shaft_angle", ANGLES)
def test_everything_is_finite_at_the_limits(shaft_angle, motion):
    for (z17, z6), (a, b, c) in itertools.product(TEETH, FACTORS):
        g = Geometry(z17=z17, z6=z6, shaft_angle=shaft_angle, a=a, b=b, c=c)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            k = exact(g, motion, TIMES)
        for name in NAMES:
            assert np.isfinite(getattr(k, name)).all(), (name, g)


@pytest.mark.parametrize("shaft_angle", ANGLES)
@pytest.mark.parametrize("teeth", TEETH)
def test_lengths_are_right_however_flat_or_sharp_the_cones(teeth, shaft_angle):
    p = {
        "z2": 20,
        "z16": 20,
        "z17": teeth[0],
        "z6": teeth[1],
        "shaft_angle": shaft_angle,
        "wheel_radius": 0.1,
    }
    p |= {"a": 1.0, "b": 1.0, "c": 1.0, "epsilon": 0.0, "gamma": 0.0}
    g, chain = Geometry(**p), Chain(p, 1.0, 0.0, 0.0)
    assert relative_error([-g.AD, 0.0, -g.QA, g.OQ], [*chain.place, chain.height]) < 1e-15
    t = np.array([0.0, 0.1, 1.0])
    k = exact(g, stop_mode(1.0), t)
    for n, time in enumerate(t):
        r, _, _ = chain.motion(time)
        assert relative_error(k.position[:, n], r) * float(length(r)) < 1e-15 * reach(g)


def test_bad_geometry_is_refused_by_name_with_value_and_range():
    for name, value in (
        ("shaft_angle", 0.0),
        ("shaft_angle", math.pi),
        ("shaft_angle", math.nan),
        ("wheel_radius", 0.0),
        ("z17", 0),
        ("z6", 20.5),
        ("z2", -3),
        ("a", -0.1),
        ("b", math.inf),
        ("epsilon", math.nan),
    ):
        with pytest.raises(ValueError, match="must be") as refusal:
            Geometry(**{name: value})
        assert str(refusal.value) == f"{name} must be {BY_NAME[name].allowed}, is {value:.16g}"


@pytest.mark.parametrize(("omega1", "omega2"), [(math.nan, 0.0), (0.0, math.inf), (1e7, 0.0)])
def test_bad_speeds_are_refused(omega1, omega2):
    with pytest.raises(ValueError, match=r"^omega[12] must be between -1000000 and 1000000 rad/s, is "):
        Motion(omega1, omega2, 0.0)


@pytest.mark.parametrize("transmission", [0.0, math.nan])
def test_bad_transmission_is_refused(transmission):
    with pytest.raises(ValueError, match=r"^transmission must be any number but 0, infinity included, is "):
        dynamic_mode(100.0, transmission)


@pytest.mark.parametrize("t", [[math.nan], [0.0, math.inf], [1e15]])
def test_bad_times_are_refused_with_the_allowed_range(t):
    with pytest.raises(ValueError, match=r"^t must be from -\S+ to \S+ s, is "):
        exact(geometry(), stop_mode(100.0), t)


def test_times_of_another_shape_are_refused():
    with pytest.raises(ValueError, match=r"t must be of shape \(n,\), is of shape \(2, 1\)"):
        exact(geometry(), stop_mode(100.0), [[0.0], [1.0]])


def test_on_an_axis_the_angle_about_it_and_its_rate_are_0():
    """At the pole of the cones D is on Ox: OP = 0."""
    k = exact(Geometry(), dynamic_mode(100.0, 2.0), [0.0])
    assert k.projections[1, 0] < 1e-16
    assert k.angles[1, 0] == 0.0
    assert k.angular_velocities[1, 0] == 0.0


def test_on_each_axis_its_own_angle_and_rate_are_0():
    on_x, on_y, on_z = range(3)
    H, P, F = range(3)
    rates = angular_velocities(np.eye(3), np.ones((3, 3)))
    for axis, index in ((on_x, P), (on_y, F), (on_z, H)):
        assert angles(np.eye(3))[index, axis] == rates[index, axis] == 0.0
    # the other rates are those of a point 1 m from the axis
    np.testing.assert_array_equal(np.abs(rates).sum(axis=0), [2.0, 2.0, 2.0])
    np.testing.assert_array_equal(angular_velocities(np.zeros((3, 1)), np.ones((3, 1))), np.zeros((3, 1)))


def test_close_to_an_axis_the_rate_is_large_but_finite_and_right():
    r = np.array([[1.0, 1e-12, 0.0]]).T
    assert angular_velocities(r, np.array([[0.0, 0.0, 1.0]]).T)[1, 0] == pytest.approx(-1e12)


def test_velocity_along_an_axis_has_feet_and_arms():
    """V parallel to Ox at D = (1, 2, 3): in yOz it vanishes, and the foot is the projection of D."""
    foot = feet(np.array([[1.0, 2.0, 3.0]]).T, np.array([[5.0, 0.0, 0.0]]).T)
    np.testing.assert_allclose(foot.T, [[0.0, 2.0, 2.0, 3.0, 0.0, 3.0]])
    np.testing.assert_allclose(lengths(foot).T, [[2.0, math.sqrt(13.0), 3.0]])


def test_velocity_across_an_axis_has_feet_where_the_printed_slope_is_infinite():
    """V_y = 0, where (27) and (30) divide by 0."""
    foot = feet(np.array([[1.0, 2.0, 3.0]]).T, np.array([[3.0, 0.0, 4.0]]).T)
    # in xOz: n = (4, -3)/5, n r = -1
    np.testing.assert_allclose(foot.T, [[0.0, 2.0, 2.0, 0.0, -0.8, 0.6]])


def test_imbalance_on_the_axis_of_the_satellite_only_turns_with_the_drive():
    k = exact(geometry(a=0.0), stop_mode(100.0), TIMES)
    assert (k.about_satellite == 0.0).all()
    np.testing.assert_allclose(k.angular_velocities[0], 100.0, rtol=1e-13)


def test_locked_links_turn_as_one_body():
    g = geometry(epsilon=0.4, gamma=0.3)
    k = exact(g, dynamic_mode(100.0, 1.0), np.linspace(0.0, 1.0, 50))
    assert transmission_ratios(g, dynamic_mode(100.0, 1.0))[1:] == (0.0, 0.0)
    np.testing.assert_allclose(k.angular_velocities[1], -100.0, rtol=1e-12)
    np.testing.assert_allclose(k.acceleration_modulus, 1e4 * k.projections[1], rtol=1e-13)


def test_internal_satellites_have_negative_cone_heights():
    g = geometry(z17=10, z6=40, shaft_angle=2.5)
    assert g.phi > math.pi / 2
    assert g.QA < 0.0 < g.OQ
    assert geometry(z17=40, z6=10, shaft_angle=2.5).OQ < 0.0
