"""Test the averaged map with the rigid module at constant output speed, and the interpolation of the map."""

import ctypes
import math
import random
from functools import lru_cache

import numpy as np
import pytest
from scenes import MECHANISMS, PLANAR, advanced, started
from scipy.interpolate import PchipInterpolator

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
    assert len(torque_map.RATIOS) == fields.RATIOS
    assert len(torque_map.SLOWNESS) == fields.SLOWNESSES
    assert len(torque_map.LOSSES) == fields.LOSSES
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
    assert ctypes.sizeof(module.derived.forward) < 14000
    assert len(module.save()) < 36000


@pytest.fixture
def side():
    """Return a map of random numbers up to ratio 0.8."""
    chance = random.Random(1)
    side = started("plain").derived.forward
    side.end = 0.8
    for column in side.columns:
        column.numbers[:] = [chance.uniform(-1.0, 1.0) for _ in column.numbers]
    return side


def test_curves_agree_with_scipy(side):
    ratios = side.end * np.array(torque_map.RATIOS)
    values = [column.inertia for column in side.columns]
    expected = PchipInterpolator(ratios, values)
    for s in np.linspace(0.0, side.end, 200, endpoint=False):
        n = torque_map.interval(side, s)
        value, slope = torque_map.curve(side, n, s, torque_map.ENERGY)
        assert value == pytest.approx(float(expected(s)), abs=1e-12)
        assert slope == pytest.approx(float(expected.derivative()(s)), abs=1e-9)


def test_error_of_a_curve_falls_with_the_cube_of_the_spacing(side):
    errors = []
    for end in (0.8, 0.4):
        side.end = end
        for column, ratio in zip(side.columns, torque_map.RATIOS, strict=True):
            column.inertia = math.exp(3.0 * end * ratio)
        errors.append(
            max(
                abs(
                    torque_map.curve(side, torque_map.interval(side, s), s, torque_map.ENERGY)[0]
                    - math.exp(3.0 * s)
                )
                for s in np.linspace(0.1 * end, 0.9 * end, 200)
            )
        )
    assert errors[1] < errors[0] / 6.0


def test_between_slownesses_cubics_are_exact():
    for z in np.linspace(0.0, 1.0, 50):
        first, weights = torque_map.cubic_weights(float(z))
        nodes = np.array(torque_map.SLOWNESS[first : first + torque_map.CUBIC])
        for power in range(torque_map.CUBIC):
            assert float(np.dot(weights, nodes**power)) == pytest.approx(z**power, abs=1e-12)


def test_surface_of_two_parabolas_is_exact_between_slownesses(side):
    side.slow = 1.0
    for column in side.columns:
        for m, z in enumerate(torque_map.SLOWNESS):
            column.torque[m] = 2.0 - z - 0.5 * z * z
    for z in (0.05, 0.3, 0.6, 0.95):
        first, weights = torque_map.cubic_weights(z)
        value = torque_map.surface(side, 3, 0.8 * 0.08, first, weights, torque_map.TORQUE)
        assert value == pytest.approx(2.0 - z - 0.5 * z * z, rel=1e-12)
