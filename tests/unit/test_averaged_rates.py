"""Rates of the mean motion of fidelity averaged against differences of what they are the rates of."""

import random
from itertools import product

import pytest
from differences import assert_rates
from scenes import ENGINE, started
from scipy.interpolate import PchipInterpolator

from inertia_module.kernel.averaged.balance import mean_input_torque
from inertia_module.kernel.averaged.jump import input_inertia
from inertia_module.kernel.averaged.rates import energy_at, flow, look_up, look_up_input
from inertia_module.kernel.averaged.table import finish_table, inner_slope


@pytest.fixture(params=product([0, 1], [1.0, -1.0], range(4)), ids=str)
def averaged(request):
    """(d, a side of a map of random cubics, x, |v|, omega3): its speed or its torque given."""
    drive, direction, seed = request.param
    chance = random.Random(seed)
    module = started("plain", ENGINE, drive=drive)
    d, x, side = module.derived, module.state, module.derived.forward
    side.direction, side.count, side.end = direction, 2.0, 0.9
    side.knots[0].ratio, side.knots[1].ratio = 0.1, 0.9
    for cubic in (side.knots[0].torque, side.knots[0].input, side.knots[0].omega2):
        cubic[:] = [chance.uniform(0.1, 1.0) for _ in range(4)]
    d.map_inertia = chance.uniform(0.1, 1.0)
    x.drive_torque, x.load_torque = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0)
    speed = chance.uniform(0.5, 2.0)
    x.omega3 = chance.uniform(0.3, 0.7) * speed
    return d, side, x, speed, x.omega3


def test_mean_flow(averaged):
    d, side, x, speed, omega3 = averaged

    def after(change, change3):
        found = flow(d, side, x, speed + change, 0.7, omega3 + change3)
        return [pair[0] for pair in (*found[:2], *found[3:])]

    found = flow(d, side, x, speed, 0.7, omega3)
    rate, rate3, torque, _, omega1 = after(0.0, 0.0)
    if d.by_torque:
        power = side.direction * x.drive_torque * omega1 - torque * omega3
        assert d.map_inertia * speed * rate == pytest.approx(power)
    assert_rates([pair[1] for pair in (*found[:2], *found[3:])], lambda t: after(rate * t, rate3 * t))
    assert_rates(found[2][::2], lambda t: after(t, 0.0)[:2])
    assert_rates(found[2][1::2], lambda t: after(0.0, t)[:2])


def test_mean_energy_and_input_torque(averaged):
    d, side, x, speed, omega3 = averaged
    v, alpha1, alpha3 = side.direction * speed, 0.7, -0.4

    def energy(change, change3):
        x.omega3 = omega3 + change3
        found = energy_at(d, side, x, v + change)
        x.omega3 = omega3
        return found

    assert_rates(energy(0.0, 0.0)[2] / speed, lambda t: energy(0.0, t)[1])
    assert_rates(v * input_inertia(d, side, x, v), lambda t: energy(t, 0.0)[0])
    if not d.by_torque:
        torque = flow(d, side, x, speed, 0.0, omega3)[3][0]
        given = mean_input_torque(d, side, x, v, alpha1, alpha3, torque) * v
        assert_rates(given - torque * omega3, lambda t: energy(alpha1 * t, alpha3 * t)[0])


def test_slopes_of_the_table_are_those_of_scipy():
    x, y = [0.0, 0.3, 1.0], [2.0, 1.5, 0.1]
    found = inner_slope(x[1] - x[0], x[2] - x[1], *y)
    assert found == pytest.approx(PchipInterpolator(x, y).derivative()(x[1]), rel=1e-13)


def test_table_of_two_knots_is_a_straight_line():
    module = started("plain", ENGINE, drive=1)
    side = module.derived.forward
    side.count, side.end = 2.0, 0.9
    for knot, values in zip(side.knots, [(0.1, 3.0, 1.0, 0.0), (0.9, 1.0, 2.0, 0.4)], strict=False):
        knot.ratio, knot.torque[0], knot.input[0], knot.omega2[0] = values
    finish_table(side)
    torque, torque_slope, omega2, omega2_slope = look_up(side, module.state, 1.0, 0.3)[:4]
    assert (torque, torque_slope) == pytest.approx((2.5, -2.5))
    assert (omega2, omega2_slope) == pytest.approx((0.1, 0.5))
    assert look_up_input(side, module.state, 1.0, 0.3) == pytest.approx((1.25, 1.25))
