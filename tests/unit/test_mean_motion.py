"""The mean motion: its balances, its accelerations, the Rosenbrock method ROS2 and the end of a regime."""

import itertools
import math

import numpy as np
import pytest
from differences import assert_rates
from scenes import ENGINE, PLANAR, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.averaged import integrate, mean_motion


@pytest.fixture(params=itertools.product([0, 1], [1.0, -1.0]), ids=str)
def motion(request):
    """Return (d, map, state) of a slipping planar module with losses, for both drives and directions."""
    drive, direction = request.param
    losses = {"link2_friction": 0.01, "output_drag": 0.2, "input_friction": 0.01, "output_friction": 0.01}
    module = started("plain", PLANAR, ENGINE, losses, drive=drive, fidelity=1, load_torque=3.0)
    d, x = module.derived, module.state
    x.omega1, x.omega3, x.alpha1 = direction * 60.0, 20.0, 0.0 if drive else 0.7
    x.drive_torque = direction * 15.0
    return d, mean_motion.side_now(d, x), x


def rates(motion, change1=0.0, change3=0.0, regime=mean_motion.SLIPPING):
    d, side, x = motion
    mean_motion.write_mean_rates(d, side, x, regime, x.omega1 + change1, x.omega3 + change3, d.mean)
    return d.mean


def test_mean_power_is_output_power_plus_stored_and_lost_power(motion):
    d, side, x = motion
    m = rates(motion)
    rate1, rate3, drive, output, lost = m.omega1, m.omega3, m.drive, m.output, sum(m.lost)
    assert lost > 0.0
    assert d.J3 * rate3 == pytest.approx(output - x.load_torque - d.b3 * x.omega3)

    def energy(t):
        omega3 = x.omega3 + rate3 * t
        links = mean_motion.energy_of_mechanism(d, side, x, x.omega1 + rate1 * t, omega3)
        return links + 0.5 * d.J3 * omega3 * omega3

    assert_rates(drive * x.omega1 - x.load_torque * x.omega3 - lost, energy)
    # Friction of link 1 and the output is outside the mesh.
    outside = d.b1 * x.omega1**2 + d.b3 * x.omega3**2
    assert m.mesh * x.omega1 == pytest.approx(output * x.omega3 + lost - outside)


def changes(motion, h, parts):
    """Return the changes of both speeds over h, in several steps."""
    d, side, x = motion
    w = record_type(fields.WORKSPACE)()
    start = x.omega1, x.omega3
    for _ in range(parts):
        mean_motion.write_mean_rates(d, side, x, mean_motion.SLIPPING, x.omega1, x.omega3, w.means[0])
        integrate.differentiate(d, side, x, w, mean_motion.SLIPPING, h)
        integrate.make_step(d, side, x, w, mean_motion.SLIPPING, h / parts)
        x.omega1 += w.mean_change.omega1
        x.omega3 += w.mean_change.omega3
    change = np.array([x.omega1 - start[0], x.omega3 - start[1]])
    x.omega1, x.omega3 = start
    return change


def test_method_is_of_order_2(motion):
    motion[0].J3 = 0.02
    exact = changes(motion, 0.02, 400)
    coarse, fine = (np.abs(changes(motion, 0.02, parts) - exact).max() for parts in (4, 8))
    assert fine < coarse / 3.3


@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9])
def test_stiff_linear_rate_is_damped(stiffness):
    w = record_type(fields.WORKSPACE)()
    w.mean_slopes[1].omega3 = -stiffness
    h, first = 1.0, record_type(fields.MEAN)()
    first.omega3 = -stiffness
    integrate.solve_stage(w, h, first.numbers)
    second = record_type(fields.MEAN)()
    second.omega3 = -stiffness * (1.0 + h * first.omega3) - 2.0 * first.omega3
    integrate.solve_stage(w, h, second.numbers)
    factor = 1.0 + 0.5 * h * (3.0 * first.omega3 + second.omega3)
    # R(z) -> 0 for z -> - infinity
    assert abs(factor) < 10.0 / stiffness + 1e-6


def test_regime_ends_at_the_zero_of_its_indicator(compiled):
    module = started(compiled, PLANAR, fidelity=1, omega1=100.0, omega_out_start=120.0, load_torque=2.0)
    # Link 1 coasts without torque until the speeds are equal.
    time = 20.0 * PLANAR["output_inertia"] / 2.0
    module.advance(time * (1.0 - 1e-9))
    assert module["contact_mode"] == 1.0
    assert module["omega_out"] == pytest.approx(100.0, abs=1e-6)
    module.advance(1.0)
    assert module["omega_out"] == 100.0


def test_mean_acceleration_of_link_2_is_the_rate_of_its_speed(motion):
    d, _, x = motion
    m = rates(motion)
    rate1, rate3 = m.omega1, m.omega3
    x.mode = 2.0
    y = started("plain").outputs
    accelerations = mean_motion.write_averaged(d, x, y)
    assert_rates(accelerations, lambda t: rates(motion, rate1 * t, rate3 * t).theta2, rel=1e-4, share=1e-4)
    assert math.isfinite(y.housing_torque)
