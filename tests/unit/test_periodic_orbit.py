"""Test the periodic orbit at constant output speed: closed forms, balances, fixed point of the return map."""

import math

import pytest
from differences import assert_rates
from scenes import ENGINE, FOUND, MECHANISMS, mechanism, started

from inertia_module.common.errors import InertiaModuleError
from inertia_module.interface.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.averaged import periodic_orbit
from inertia_module.kernel.links import inertia_at_input
from inertia_module.model import Module
from verification.stability.motion import solve_at

PLANAR = MECHANISMS["planar"]
SHAPES = {
    **MECHANISMS,
    "bevel, offset imbalance": {"a": 0.7, "b": 1.3, "epsilon": 0.4, "gamma": -0.9, "drive_inertia": 1e-3},
    "bevel, three satellites": {"satellites": 3},
}


def orbit(values, omega1, ratio, turns=1.0, **more):
    """Return the module in the periodic orbit over this number of turns of the pinion shaft."""
    speed = abs(omega1) * ratio
    module = Module("plain")
    return module.start_steady(
        turns * math.tau, **{**values, **more, "omega1": omega1, "omega_out_start": speed}
    )


@pytest.mark.parametrize("omega1", [100.0, -3.0])
def test_at_stall_the_planar_module_has_the_half_waves_of_its_centrifugal_torque(omega1):
    module = orbit(PLANAR, omega1, 0.0)
    # While link 2 rests, M2 = - k I' omega1^2 / 2 with I = ... - 2 m l (R0 + r) cos q.
    reach = PLANAR["sun_radius"] + PLANAR["satellite_radius"]
    mass = PLANAR["satellites"] * PLANAR["imbalance_mass"]
    peak = (
        PLANAR["sun_radius"] / PLANAR["satellite_radius"] * mass * PLANAR["eccentricity"] * reach * omega1**2
    )
    assert module["output_torque_mean"] == pytest.approx(peak / math.pi, rel=1e-9)
    assert module["torque_peak"] == pytest.approx(peak, rel=1e-4)
    assert module["torque_ripple"] == pytest.approx(peak * math.sqrt(0.25 - 1.0 / math.pi**2), rel=1e-6)
    assert module["input_torque_mean"] == pytest.approx(0.0, abs=1e-9 * peak)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.9])
def test_mean_energy_and_power_balance(shape, ratio):
    module = started("plain", SHAPES[shape], drive_angle_start=0.0)
    d, w, x = module.derived, module._records[5], module.state
    periodic_orbit.hold_output(d)
    length = periodic_orbit.period_length(d)
    w.tolerance, w.orbit_torque, w.orbit_start = 1e-8, 0.0, periodic_orbit.release_angle(d, 1.0)
    time = periodic_orbit.find_orbit(d, x, w, 10.0, ratio, length)
    assert abs(periodic_orbit.angle_travelled(x)) == pytest.approx(length, rel=1e-8)
    # The output receives all power, and the stored energy is periodic.
    assert x.energy_in == pytest.approx(x.output_impulse * 10.0 * ratio, abs=1e-5 * 100.0 * w.orbit_energy)
    if ratio == 0.0:
        number = 4000
        mean_inertia = sum(inertia_at_input(d, length * n / number) for n in range(number)) / number
        assert w.orbit_energy == pytest.approx(50.0 * mean_inertia, rel=1e-3)
        assert time == pytest.approx(length / (10.0 * d.k), rel=1e-8)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_held_momentum_changes_by_the_torque_of_the_housing_and_free_flight_begins_at_rest(shape, direction):
    module = started("plain", SHAPES[shape])
    d, q = module.derived, 0.3

    def momentum(angle):
        return periodic_orbit.quantity(d, periodic_orbit.MOMENTUM, direction, 0.0, angle)

    # The drive torque equals the housing torque.
    housing = -solve_at(module, True, False, q=q, omega1=direction, omega2=0.0).mesh
    assert_rates(2.0 * housing / (d.k * direction), lambda angle: momentum(q + angle))
    for kind, value in ((periodic_orbit.FLIGHT_SPEED, 0.0), (periodic_orbit.FLIGHT_SLIP, -1.0)):
        computed = periodic_orbit.quantity(d, kind, direction, momentum(q), q)
        assert computed == pytest.approx(value, abs=1e-12)


def test_maximum_is_the_closed_form_of_the_planar_module():
    d = started("plain", PLANAR).derived
    q, largest = periodic_orbit.maximum(d, periodic_orbit.INERTIA, 1.0, 0.0)
    arm, reach = PLANAR["eccentricity"], PLANAR["sun_radius"] + PLANAR["satellite_radius"]
    assert q == pytest.approx(math.pi, abs=1e-3)
    assert largest == pytest.approx(d.mass * (arm + reach) ** 2 + d.J16, rel=1e-6)
    lock = periodic_orbit.maximum(d, periodic_orbit.LOCK_TORQUE, 1.0, 0.0)[1]
    assert lock == pytest.approx(d.k * d.mass * arm * reach, rel=1e-5)


@pytest.mark.parametrize("omega1", [10.0, -10.0])
def test_torque_driven_orbit_has_a_periodic_energy_and_the_mean_input_speed(omega1):
    module = started("plain", PLANAR, ENGINE, drive=1, input_inertia=0.13)
    d, w = module.derived, module._records[5]
    x = record_type(fields.STATE)()
    periodic_orbit.hold_output(d)
    w.tolerance, w.orbit_torque = 1e-6, 0.0
    w.orbit_start = periodic_orbit.release_angle(d, math.copysign(1.0, omega1))
    time = periodic_orbit.find_orbit(d, x, w, omega1, 0.3, math.tau)
    assert periodic_orbit.input_angle(x) / time == pytest.approx(omega1, rel=2e-4)
    power = x.output_impulse * 3.0 / time
    assert w.orbit_torque * omega1 == pytest.approx(power, abs=2e-4 * w.orbit_energy / time)


@pytest.mark.parametrize("ratio", [0.2, 0.5])
def test_period_without_rest_of_link_2_is_closed(ratio):
    values = mechanism(FOUND["heavy_link_2"]) | {"mesh_efficiency": 0.938}
    module = started("plain", values)
    d, w, x = module.derived, module._records[5], module.state
    periodic_orbit.hold_output(d)
    w.tolerance, w.orbit_torque, w.orbit_start = 1e-6, 0.0, periodic_orbit.release_angle(d, 1.0)
    assert periodic_orbit.find_orbit(d, x, w, 20.0, ratio, periodic_orbit.period_length(d)) > 0.0
    assert abs(x.omega2 - x.begin_omega2) <= 2.0 * periodic_orbit.OMEGA2_ATOL * 20.0
    assert 0.0 < x.begin_omega2 < 20.0 * ratio


def test_invalid_start_speed_is_rejected():
    with pytest.raises(InertiaModuleError, match="omega_out_start"):
        orbit(PLANAR, 10.0, 0.5, output_freewheel=0)
