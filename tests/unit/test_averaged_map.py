"""The map of fidelity averaged against the rigid module with its output speed held; rates of its flow."""

import math
import random
from functools import lru_cache
from itertools import product

import numpy as np
import pytest
from differences import assert_rates
from scenes import DRIVEN, ENGINE, MECHANISMS, PLANAR, advanced, started
from scipy.interpolate import PchipInterpolator

from inertia_module import memory
from inertia_module.contract.records import record_type
from inertia_module.contract.variables import MAP_KEY
from inertia_module.harness.chart import SteadyMachine
from inertia_module.kernel import fields
from inertia_module.kernel.averaged import rates, run, steady, step, table
from inertia_module.kernel.links import inertia_at_input
from inertia_module.memory import Module
from studies.stability.motion import solve_at

SHAPES = {
    **MECHANISMS,
    "bevel, offset imbalance": {"a": 0.7, "b": 1.3, "epsilon": 0.4, "gamma": -0.9, "drive_inertia": 1e-3},
    "bevel, three satellites": {"satellites": 3},
}
HELD = {"output_inertia": 1e12, "load_torque": 0.0, "tolerance": 1e-9}


def at_ratio(kernel, mechanism, omega1, sigma, **values):
    """Averaged module just started with its output at this ratio to omega1."""
    speed = abs(omega1) * sigma
    return started(kernel, mechanism, fidelity=1, omega1=omega1, omega_out_start=speed, **values)


def rigid_after(kernel, mechanism, omega1, sigma, time):
    """Rigid module with its output held at this ratio, after a step of this length in its steady motion."""
    module = started(kernel, mechanism, HELD, omega1=omega1, omega_out_start=abs(omega1) * sigma)
    return advanced(module, 2.0, time)


@pytest.mark.parametrize("mechanism", SHAPES)
@pytest.mark.parametrize("omega1", [100.0, -100.0])
@pytest.mark.parametrize("sigma", [0.0, 0.07, 0.31, 0.6, 0.93])
def test_means_ripple_and_peak_are_those_of_the_pulses_at_held_output_speed(
    compiled, mechanism, omega1, sigma
):
    settings = SHAPES[mechanism]
    stall = at_ratio(compiled, settings, omega1, 0.0)["output_torque"]
    module = at_ratio(compiled, settings, omega1, sigma, output_inertia=1e12)
    pulses = SteadyMachine(settings).at(omega1, sigma)
    assert pulses.efficiency == 1.0
    assert module["omega2"] == pytest.approx(100.0 * pulses.link2_ratio, abs=0.05)
    assert module["output_torque"] == pytest.approx(pulses.output_torque, abs=3e-4 * stall)
    assert module["torque_ripple"] == pytest.approx(pulses.ripple, rel=0.02, abs=0.01 * module["torque_peak"])
    assert module["torque_peak"] == pytest.approx(pulses.peak, rel=0.06, abs=0.05)
    # the mean input torque is what the mesh takes: M1 = M2 where no energy is stored
    measured = math.copysign(1.0, omega1) * pulses.input_torque
    assert module["mesh_torque"] == pytest.approx(measured, abs=1e-3 * stall)
    assert module["input_torque"] == pytest.approx(measured, abs=1e-3 * stall)
    shared = module["housing_torque"] + module["mesh_torque"]
    assert shared == pytest.approx(module["output_torque"], rel=1e-12)


@pytest.mark.parametrize("mechanism", SHAPES)
def test_torque_goes_with_the_square_of_the_speed_and_stalls_alike_both_ways(compiled, mechanism):
    settings = SHAPES[mechanism]
    for sigma in (0.0, 0.2, 0.9):
        one = at_ratio(compiled, settings, 1.0, sigma)["output_torque"]
        for omega1 in (1e-9, 1e5):
            torque = at_ratio(compiled, settings, omega1, sigma)["output_torque"]
            assert torque == pytest.approx(one * omega1**2, rel=1e-9)
    forward, backward = (at_ratio(compiled, settings, omega1, 0.0) for omega1 in (100.0, -100.0))
    assert forward["output_torque"] > 0.0
    assert backward["output_torque"] == pytest.approx(forward["output_torque"], rel=1e-6)
    # and none is passed to a shaft that link 2 never reaches
    for omega1, end in ((100.0, 2.0), (-100.0, 10.0)):
        assert at_ratio(compiled, settings, omega1, end)["output_torque"] == 0.0
        assert rigid_after(compiled, settings, omega1, end, 5.0)["output_torque_mean"] == 0.0


@pytest.mark.parametrize("mechanism", SHAPES)
@pytest.mark.parametrize("drive", [{}, ENGINE], ids=["by speed", "by torque"])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_momentum_while_link_2_is_held_changes_by_what_holds_it(mechanism, drive, direction):
    module = started("plain", SHAPES[mechanism], drive)
    d, q = module.derived, 0.3
    # by its torque link 1 has the energy 1/2; by its speed, the drive takes as much again as the housing
    omega1 = direction / inertia_at_input(d, q) ** 0.5 if drive else direction
    housing = -solve_at(module, True, False, q=q, omega1=omega1, omega2=0.0).mesh
    rate = (1.0 if drive else 2.0) * housing / (d.k * omega1)
    assert_rates(rate, lambda angle: steady.momentum(d, direction, q + angle))
    # and where link 2 is thrown it still rests, the slip being that of link 1
    side = d.forward
    d.map_inertia, side.direction, side.thrown = 1.0, direction, steady.momentum(d, direction, q)
    assert steady.thrown(d, side, q) == pytest.approx((0.0, omega1**2), abs=1e-12)


@pytest.mark.parametrize("ratio", [0.1, 0.3])
# evaluations that it and the map take: a search that goes the wrong way comes there too, at twice the cost
@pytest.mark.parametrize(("inertia", "most"), [(0.01, 2.8e4), (0.2, 1.4e4)])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_steady_motion_under_a_torque_ends_a_period_as_it_began(compiled, direction, inertia, most, ratio):
    # the plain one has the map of the first
    _, module = (
        started(kernel, DRIVEN["planar"], fidelity=1, input_inertia=inertia) for kernel in (compiled, "plain")
    )
    p, d, w = module.parameters, module.derived, module._records[5]
    side = d.forward if direction > 0.0 else d.backward
    steady.hold_output(d, w, 1e-4)
    w.drive, w.begin_energy, w.begin_omega2 = 0.0, 1.0, 0.0
    assert steady.find_steady(p, w, side, ratio, 0.0)
    assert direction * w.drive > 0.0
    assert w.held.map_evaluations < most
    x = w.part
    assert x.omega3 == pytest.approx(ratio, abs=1e-12)
    assert abs(x.omega2 - w.begin_omega2) < 1e-3
    # the energy comes back, and that of the mean speed is that of v = 1
    assert abs(w.sum_gain) < 1e-4 * d.map_inertia
    assert steady.speed_of_sums(d, w) == pytest.approx(1.0, abs=1e-4)


def test_long_periods_of_coprime_teeth_are_averaged_too(compiled):
    long = at_ratio(compiled, {"z17": 199, "z6": 200}, 100.0, 0.3, output_inertia=1e12)
    rigid = rigid_after(compiled, {"z17": 199, "z6": 200}, 100.0, 0.3, 200.0)
    assert long["output_torque"] == pytest.approx(rigid["output_torque_mean"], rel=5e-3)
    longer = at_ratio(compiled, {"z17": 1999, "z6": 2003}, 100.0, 0.3)["output_torque"]
    assert longer == pytest.approx(long["output_torque"], rel=0.05)


@pytest.mark.parametrize(
    "settings",
    [
        {"drive_inertia": 1e12},
        {"layout": "planar", "satellites": 3, "link2_inertia": 0.0, "eccentricity": 1e-7},
    ],
    ids=["heavy drive", "hardly an imbalance"],
)
def test_freewheels_that_rounding_makes_switch_hold_up_no_map(compiled, settings):
    """Link 2 moves by rounding alone: its freewheels switch at once wherever they are."""
    module = started(compiled, settings, fidelity=1)
    assert module.derived.map_evaluations < 1e6
    assert 0.0 <= module["output_torque"] <= 10.0


def test_map_is_kept_between_instances_that_are_alike(compiled, monkeypatch):
    kept = lru_cache(3)(memory._map_of.__wrapped__)
    monkeypatch.setattr(memory, "_map_of", kept)
    first = Module(compiled).start(fidelity=1, omega1=100.0)
    assert first.derived.map_evaluations > 0.0
    (known,) = kept(tuple(first[name] for name in MAP_KEY))
    known.map_evaluations = -1.0  # a map built anew counts from zero
    second = Module(compiled).start(fidelity=1, omega1=50.0, output_inertia=3.0)
    assert second.derived.map_evaluations == -1.0
    for side in ("forward", "backward"):
        assert bytes(getattr(second.derived, side)) == bytes(getattr(first.derived, side))
    for number, mechanism in enumerate(({"imbalance_mass": 2.0}, {"satellite_inertia": 0.02}), 2):
        other = Module(compiled).start(fidelity=1, omega1=50.0, **mechanism)
        assert other.derived.map_evaluations > 0.0
        assert kept.cache_info().currsize == number
    for mass in (1.0, 2.0, 3.0, 4.0, 5.0):
        started(compiled, PLANAR, fidelity=1, imbalance_mass=mass)
    assert kept.cache_info().currsize == 3


@pytest.fixture(params=product([0, 1], [1.0, -1.0], range(4)), ids=str)
def averaged(request):
    """(d, a side of a map of random cubics and losses, x, |v|, omega3): its speed or its torque given."""
    drive, direction, seed = request.param
    chance = random.Random(seed)
    module = started("plain", ENGINE, drive=drive)
    d, x, side = module.derived, module.state, module.derived.forward
    side.direction, side.count, side.end = direction, 2.0, 0.9
    side.knots[0].ratio, side.knots[1].ratio = 0.1, 0.9
    for knot in side.knots[:2]:
        for curve in (table.TORQUE, table.OMEGA2, table.INPUT):
            knot.value[curve], knot.slope[curve] = chance.uniform(0.1, 1.0), chance.uniform(-1.0, 1.0)
        knot.lost[0] = chance.uniform(0.0, 0.1)
    d.lossy = 1.0
    d.map_inertia = chance.uniform(0.1, 1.0)
    x.drive_torque, x.load_torque = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0)
    speed = chance.uniform(0.5, 2.0)
    x.omega3 = chance.uniform(0.3, 0.7) * speed
    return d, side, x, speed, x.omega3


def rates_of(averaged, change=0.0, change3=0.0):
    d, side, x, speed, omega3 = averaged
    rates.write_mean_rates(
        d, side, x, rates.SLIPPING, side.direction * (speed + change), omega3 + change3, d.mean
    )
    return d.mean


def test_mean_power_of_link_1_goes_to_the_output_or_into_its_energy_or_is_lost(averaged):
    d, side, x, speed, omega3 = averaged
    x.alpha1 = 0.7
    m = rates_of(averaged)
    rate, rate3, used = side.direction * m.omega1, m.omega3, m.output * omega3 + sum(m.lost)
    assert sum(m.lost) > 0.0
    assert d.J3 * rate3 == pytest.approx(m.output - x.load_torque)

    def energy(change, change3):
        x.omega3 = omega3 + change3
        return rates.energy_at(d, side, x, side.direction * (speed + change))

    if not d.by_torque:
        assert_rates(m.drive * m.theta1 - used, lambda t: energy(rate * t, rate3 * t))
        x.omega3 = omega3
        inertia = run.input_inertia(d, side, x, side.direction * speed)
        assert_rates(speed * inertia, lambda t: energy(t, 0.0))
    else:
        assert m.drive == x.drive_torque
        assert d.map_inertia * speed * rate == pytest.approx(m.drive * m.theta1 - used)
    assert m.housing * m.theta1 == pytest.approx(used)


def test_accelerations_of_the_mean_motion_are_the_rates_of_its_speeds(averaged):
    d, side, x, speed, _ = averaged
    x.alpha1 = 0.7
    m = rates_of(averaged)
    rate, rate3 = side.direction * m.omega1, m.omega3
    found = run.mean_accelerations(d, side, x, rates.SLIPPING, side.direction * speed)

    def speeds(t):
        now = rates_of(averaged, rate * t, rate3 * t)
        return [now.theta1, now.omega2]

    assert_rates(found, speeds, rel=1e-5, share=1e-5)


def test_what_goes_with_the_speed_of_links_that_crawl_is_as_exact_as_it(averaged):
    _, side, *_ = averaged
    side.slow = 1e4
    for speed in (1e-9, 1e-3, 1.0, 1e4, 1e9):
        first, *now = rates.shares(side, speed)
        left = sum(share * (1.0 - z) for share, z in zip(now, table.SLOWNESS[first:], strict=False))
        assert left == pytest.approx(speed / (speed + side.slow), rel=1e-13, abs=0.0)


def mean_changes(averaged, make_step, h, parts=1):
    """Changes of v and omega3 over h, in so many steps."""
    d, side, x, speed, omega3 = averaged
    w = record_type(fields.WORKSPACE)()
    x.omega1, x.omega3 = side.direction * speed, omega3
    for _ in range(parts):
        rates.write_mean_rates(d, side, x, rates.SLIPPING, x.omega1, x.omega3, w.rates[0])
        step.differentiate(d, side, x, w, rates.SLIPPING)
        make_step(d, side, x, w, rates.SLIPPING, h / parts)
        x.omega1 += w.change.omega1
        x.omega3 += w.change.omega3
    return np.array([x.omega1 - side.direction * speed, x.omega3 - omega3])


def test_a_stiff_step_of_the_mean_motion_is_of_its_order(averaged):
    averaged[2].alpha1 = 0.7
    stiff, gentle = step.make_stiff_step, step.make_gentle_step
    whole, half = (
        abs(mean_changes(averaged, stiff, h) - mean_changes(averaged, gentle, h, 100)).max()
        for h in (0.02, 0.01)
    )
    assert whole < 1e-6
    # of order 5: halved it leaves 2^-5, or nearly
    assert half < 2.0**-4.4 * whole


def test_slopes_of_the_table_are_those_of_scipy():
    x, y = [0.0, 0.3, 1.0], [2.0, 1.5, 0.1]
    found = table.inner_slope(x[1] - x[0], x[2] - x[1], *y)
    assert found == pytest.approx(PchipInterpolator(x, y).derivative()(x[1]), rel=1e-13)


def test_table_of_two_knots_is_a_straight_line():
    module = started("plain", ENGINE, drive=1)
    side = module.derived.forward
    side.count, side.end = 2.0, 0.9
    for knot, values in zip(side.knots, [(0.1, 3.0, 1.0, 0.0), (0.9, 1.0, 2.0, 0.4)], strict=False):
        knot.ratio, knot.value[table.TORQUE], knot.value[table.INPUT], knot.value[table.OMEGA2] = values
    for n in range(2):
        table.set_slopes(side, n)
    assert rates.look_up(side, module.state, 1.0, 0.3) == pytest.approx((2.5, 0.1))
    assert rates.look_up(side, module.state, 1.0, 0.7) == pytest.approx((1.5, 0.3))
    assert rates.look_up_input(side, module.state, 0.3) == pytest.approx((1.25, 1.25))
