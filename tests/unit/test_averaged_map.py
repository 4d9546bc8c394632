"""Test the averaged map with the rigid module at constant output speed, and the interpolation of the map."""

import ctypes
import itertools
import math
import random
from functools import lru_cache

import numpy as np
import pytest
from scenes import MECHANISMS, PLANAR, advanced, started
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from inertia_module import model
from inertia_module.analysis.steady_state import SteadyMachine
from inertia_module.interface.variables import MAP_KEY
from inertia_module.kernel import fields
from inertia_module.kernel.averaged import torque_map
from inertia_module.model import Module

SHAPES = {
    **MECHANISMS,
    "bevel, offset imbalance": {"a": 0.7, "b": 1.3, "epsilon": 0.4, "gamma": -0.9, "drive_inertia": 1e-3},
    "bevel, three satellites": {"satellites": 3},
}
HELD = {"output_inertia": 1e5, "load_torque": 0.0, "tolerance": 1e-9}


def at_ratio(kernel, mechanism, omega1, sigma, **values):
    """Return a started averaged module with its output at this ratio to omega1."""
    speed = abs(omega1) * sigma
    return started(kernel, mechanism, fidelity=1, omega1=omega1, omega_out_start=speed, **values)


def rigid_after(kernel, mechanism, omega1, sigma, time):
    """Return the rigid module with its output at this ratio, after a step in the steady motion."""
    module = started(kernel, mechanism, HELD, omega1=omega1, omega_out_start=abs(omega1) * sigma)
    return advanced(module, 2.0, time)


@pytest.mark.parametrize("mechanism", SHAPES)
@pytest.mark.parametrize("omega1", [100.0, -100.0])
@pytest.mark.parametrize("sigma", [0.0, 0.07, 0.31, 0.6, 0.93])
def test_means_ripple_and_peak_agree_with_pulses_at_constant_output_speed(compiled, mechanism, omega1, sigma):
    settings = SHAPES[mechanism]
    stall = at_ratio(compiled, settings, omega1, 0.0)["output_torque"]
    module = at_ratio(compiled, settings, omega1, sigma, output_inertia=1e5)
    pulses = SteadyMachine(settings).at(omega1, sigma)
    assert sigma == 0.0 or pulses.efficiency == pytest.approx(1.0, abs=1e-5)
    assert module["omega2"] == pytest.approx(100.0 * pulses.link2_ratio, abs=0.5)
    assert module["output_torque"] == pytest.approx(pulses.output_torque, abs=5e-3 * stall)
    assert module["torque_ripple"] == pytest.approx(pulses.ripple, rel=0.02, abs=0.01 * module["torque_peak"])
    assert module["torque_peak"] == pytest.approx(pulses.peak, rel=0.06, abs=0.05)
    # The mean input torque is the mesh torque: M1 = M2 if no energy is stored.
    measured = math.copysign(1.0, omega1) * pulses.input_torque
    assert module["mesh_torque"] == pytest.approx(measured, abs=5e-3 * stall)
    assert module["input_torque"] == pytest.approx(measured, abs=5e-3 * stall)
    shared = module["housing_torque"] + module["mesh_torque"]
    assert shared == pytest.approx(module["output_torque"], rel=1e-12)


@pytest.mark.parametrize("mechanism", SHAPES)
def test_torque_is_quadratic_in_speed_and_symmetric(compiled, mechanism):
    settings = SHAPES[mechanism]
    for sigma in (0.0, 0.2, 0.9):
        unit_torque = at_ratio(compiled, settings, 1.0, sigma)["output_torque"]
        for omega1 in (1e-9, 1e4):
            torque = at_ratio(compiled, settings, omega1, sigma)["output_torque"]
            assert torque == pytest.approx(unit_torque * omega1**2, rel=1e-9)
    forward, backward = (at_ratio(compiled, settings, omega1, 0.0) for omega1 in (100.0, -100.0))
    assert forward["output_torque"] > 0.0
    assert backward["output_torque"] == pytest.approx(forward["output_torque"], rel=2e-4)
    # A shaft that link 2 never reaches receives no energy.
    for omega1, end in ((100.0, 2.0), (-100.0, 10.0)):
        assert at_ratio(compiled, settings, omega1, end)["output_torque"] == pytest.approx(0.0, abs=1e-9)
        assert rigid_after(compiled, settings, omega1, end, 5.0)["output_torque_mean"] == 0.0


def test_long_periods_of_coprime_teeth_are_averaged_too(compiled):
    long = at_ratio(compiled, {"z17": 199, "z6": 200}, 100.0, 0.3, output_inertia=1e5)
    rigid = rigid_after(compiled, {"z17": 199, "z6": 200}, 100.0, 0.3, 200.0)
    assert long["output_torque"] == pytest.approx(rigid["output_torque_mean"], rel=5e-3)
    longer = at_ratio(compiled, {"z17": 499, "z6": 501}, 100.0, 0.3)["output_torque"]
    assert longer == pytest.approx(long["output_torque"], rel=0.05)


@pytest.mark.parametrize(
    "settings",
    [
        {"drive_inertia": 1e5},
        {"layout": "planar", "satellites": 3, "link2_inertia": 0.0, "eccentricity": 1e-7},
    ],
    ids=["heavy drive", "hardly an imbalance"],
)
def test_map_terminates_if_rounding_switches_freewheels(compiled, settings):
    """Link 2 moves only by rounding: its freewheels switch at once at each speed."""
    module = started(compiled, settings, fidelity=1)
    assert module.derived.map_evaluations < 1e6
    assert 0.0 <= module["output_torque"] <= 10.0


def test_equal_instances_share_a_map(compiled, monkeypatch):
    cached = lru_cache(3)(model._map_of.__wrapped__)
    monkeypatch.setattr(model, "_map_of", cached)
    first = Module(compiled).start(fidelity=1, omega1=100.0)
    assert first.derived.map_evaluations > 0.0
    (cached_map,) = cached(tuple(first[name] for name in MAP_KEY))
    cached_map.map_evaluations = -1.0  # A rebuilt map counts from zero.
    second = Module(compiled).start(fidelity=1, omega1=50.0, output_inertia=3.0)
    assert second.derived.map_evaluations == -1.0
    for side in ("forward", "backward"):
        assert bytes(getattr(second.derived, side)) == bytes(getattr(first.derived, side))
    for number, mechanism in enumerate(({"imbalance_mass": 2.0}, {"satellite_inertia": 0.02}), 2):
        other = Module(compiled).start(fidelity=1, omega1=50.0, **mechanism)
        assert other.derived.map_evaluations > 0.0
        assert cached.cache_info().currsize == number
    for mass in (1.0, 2.0, 3.0, 4.0, 5.0):
        started(compiled, PLANAR, fidelity=1, imbalance_mass=mass)
    assert cached.cache_info().currsize == 3


def test_sizes_of_the_map_agree_with_the_grid():
    assert len(torque_map.RATIOS) == fields.N_RATIOS
    assert torque_map.SLOWNESSES == fields.N_SLOWNESSES
    assert len(torque_map.LOSSES) == fields.N_LOSSES
    column = started("plain").derived.forward.columns[0]
    for n in range(len(column.numbers)):
        column.numbers[n] = n
    for name, place in (
        ("torque", torque_map.TORQUE),
        ("link2", torque_map.LINK2),
        ("lost", torque_map.LOST),
    ):
        assert getattr(column, name)[0] == place
    assert (column.inertia, column.ripple, column.peak) == (
        torque_map.ENERGY,
        torque_map.RIPPLE,
        torque_map.PEAK,
    )


def test_a_saved_state_is_small():
    module = Module("plain").start()
    assert ctypes.sizeof(module.derived.forward) < 16000
    assert len(module.save()) < 40000


@pytest.fixture
def side():
    """Return a map of random numbers up to ratio 0.8."""
    chance = random.Random(1)
    side = started("plain").derived.forward
    side.end = 0.8
    for column in side.columns:
        column.numbers[:] = [chance.uniform(-1.0, 1.0) for _ in column.numbers]
    return side


def read_curve(side, s, place=torque_map.ENERGY):
    """Return value and slope of a number of the map at ratio s."""
    n = torque_map.ratio_interval(side, s)
    return torque_map.curve(side, n, torque_map.ratio_cell(side, n, s), place)


def limited_slopes(x, y):
    """Return the slopes of parabolas, limited to three times a secant (Hyman, 1983)."""
    secants = np.diff(y) / np.diff(x)
    slopes = np.gradient(y, x, edge_order=2)
    limits = 3.0 * np.minimum(abs(secants[1:]), abs(secants[:-1]))
    slopes[1:-1] = np.clip(slopes[1:-1], -limits, limits)
    for end, secant in ((0, secants[0]), (-1, secants[-1])):
        slopes[end] = np.clip(slopes[end] / secant, 0.0, 3.0) * secant
    return slopes


def test_curves_over_the_slowness_agree_with_scipy(side):
    slownesses = np.linspace(0.0, 1.0, torque_map.SLOWNESSES) ** 0.5
    side.slowness[:] = slownesses
    column = side.columns[3]
    values = np.array(column.torque)
    expected = CubicHermiteSpline(slownesses, values, limited_slopes(slownesses, values))
    for z in np.linspace(0.0, 1.0, 200):
        m = torque_map.slowness_interval(side, z)
        value = torque_map.at_slowness(column, m, torque_map.slowness_cell(side, m, z), torque_map.TORQUE)
        assert value == pytest.approx(float(expected(z)), abs=1e-12)


def test_curves_over_the_ratio_agree_with_scipy(side):
    ratios = side.end * np.array(torque_map.RATIOS)
    expected = PchipInterpolator(ratios, [column.inertia for column in side.columns])
    for s in np.linspace(0.0, side.end, 200, endpoint=False):
        value, slope = read_curve(side, s)
        assert value == pytest.approx(float(expected(s)), abs=1e-12)
        assert slope == pytest.approx(float(expected.derivative()(s)), abs=1e-9)


def test_curve_through_rising_points_rises(side):
    rising = sorted(column.inertia for column in side.columns)
    for column, value in zip(side.columns, rising, strict=True):
        column.inertia = value
    values = [read_curve(side, s)[0] for s in np.linspace(0.0, side.end, 500)]
    assert values == sorted(values)


def test_error_of_a_curve_falls_with_the_cube_of_the_spacing(side):
    errors = []
    for end in (0.8, 0.4):
        side.end = end
        for column, ratio in zip(side.columns, torque_map.RATIOS, strict=True):
            column.inertia = math.exp(3.0 * end * ratio)
        inside = np.linspace(0.1 * end, 0.9 * end, 200)
        errors.append(max(abs(read_curve(side, s)[0] - math.exp(3.0 * s)) for s in inside))
    assert errors[1] < errors[0] / 6.0


def read_surface(side, s, z, place=torque_map.TORQUE):
    """Return a number of the map at ratio s and slowness z."""
    n, m = torque_map.ratio_interval(side, s), torque_map.slowness_interval(side, z)
    cells = torque_map.ratio_cell(side, n, s), torque_map.slowness_cell(side, m, z)
    return torque_map.surface(side, n, cells[0], m, cells[1], place)


def test_surface_with_parabolas_of_the_slowness_is_exact(side):
    side.v0 = 1.0
    side.slowness[:] = [(m / (torque_map.SLOWNESSES - 1)) ** 0.5 for m in range(torque_map.SLOWNESSES)]
    for column, ratio in zip(side.columns, torque_map.RATIOS, strict=True):
        for m, z in enumerate(side.slowness):
            s = side.end * ratio
            column.torque[m] = 2.0 - z - 0.5 * z * z + (1.0 - 0.2 * z) * s
    for s, z in itertools.product((0.07, 0.3, 0.61, 0.79), (0.05, 0.3, 0.6, 0.95)):
        expected = 2.0 - z - 0.5 * z * z + (1.0 - 0.2 * z) * s
        assert read_surface(side, s, z) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("kink", [0.13, 0.4, 0.62, 0.91])
def test_slownesses_are_added_around_a_kink(side, kink):
    count = len(torque_map.FIRST_SLOWNESSES)
    side.slowness[:count] = torque_map.FIRST_SLOWNESSES

    def write_torques():
        for column in side.columns:
            for m, z in enumerate(side.slowness[:count]):
                column.torque[m] = max(kink - z, 0.0) + 0.2 * z * z

    write_torques()
    while count < torque_map.SLOWNESSES:
        worst = max(
            range(count - torque_map.N_FRICTION_ONLY),
            key=lambda m: torque_map.interpolation_error(side, m, count),
        )
        torque_map.insert_slowness(side, worst, count)
        count += 1
        write_torques()
    assert list(side.slowness) == sorted(side.slowness)
    before, after = max(z for z in side.slowness if z <= kink), min(z for z in side.slowness if z > kink)
    assert after - before < 0.01


def test_an_added_slowness_keeps_the_values_of_all_others(side):
    count = len(torque_map.FIRST_SLOWNESSES)
    side.slowness[:count] = torque_map.FIRST_SLOWNESSES
    values = [list(column.link2[:count]) for column in side.columns]
    inertias = [column.inertia for column in side.columns]
    torque_map.insert_slowness(side, 2, count)
    assert [[*column.link2[:3], *column.link2[4 : count + 1]] for column in side.columns] == values
    assert [column.inertia for column in side.columns] == inertias
