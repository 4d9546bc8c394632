"""The engine: exact steps, limits, governor, energy."""

import math
import re

import pytest
from scipy.integrate import solve_ivp

from examples.coupling.engine import Engine
from inertia_module.driveline import EngineMap, Governor, InterfaceInertia, governed_engine

MAP = EngineMap((0.0, 100.0, 300.0), (80.0, 150.0, 120.0), (5.0, 10.0, 30.0))
STILL = Governor(0.0, 0.0, 1e6)


def engine(governor=STILL, **values):
    arguments = {"inertia": 0.2, "reference": 150.0, "speed": 100.0, "torque": 20.0} | values
    return Engine(limits=MAP, governor=governor, **arguments)


def test_speed_and_energy_with_a_load_inertia_agree_with_a_fine_integration():
    tested = engine()
    tested.state = tested.after(0.3, 5.0, inertia=0.07)

    def rates(t, y):
        acceleration = (20.0 - 5.0) / 0.27
        on_load = 20.0 - 0.2 * acceleration
        return [acceleration, y[0], 20.0 * y[0], on_load * y[0], on_load]

    end = solve_ivp(rates, (0.0, 0.3), [100.0, 0.0, 0.0, 0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    state = tested.state
    assert (state.speed, state.angle, state.work_in, state.work_out, state.impulse_out) == pytest.approx(
        tuple(end), rel=1e-10
    )
    assert tested.energy_stored == pytest.approx(0.5 * 0.2 * end[0] ** 2, rel=1e-10)


@pytest.mark.parametrize("step", [0.0007, 0.003, 0.005, 0.0125, 0.15])
def test_division_of_a_time_into_steps_has_no_influence(step):
    governor = Governor(3.0, 20.0, 0.005)
    whole, cut = engine(governor), engine(governor)
    whole.state = whole.after(0.3, 30.0)
    count = round(0.3 / step)
    for _ in range(count):
        cut.state = cut.after(0.3 / count, 30.0)
    assert cut.state[:4] == pytest.approx(whole.state[:4], rel=1e-9)
    assert cut.state[5:] == pytest.approx(whole.state[5:], rel=1e-9)


def test_governor_holds_the_speed_against_a_load_without_error():
    tested = engine(Governor(4.0, 20.0))
    for _ in range(400):
        tested.state = tested.after(0.01, 60.0)
    assert tested.speed == pytest.approx(150.0, abs=1e-6)
    assert tested.state.torque == pytest.approx(60.0, abs=1e-4)


def test_torque_keeps_within_the_map_and_the_integral_does_not_wind_up():
    assert MAP.limits(100.0) == (-10.0, 150.0)
    assert MAP.limits(0.0) == (0.0, 80.0)  # At rest there is no drag.
    tested = engine(Governor(4.0, 20.0), reference=290.0)
    for _ in range(300):
        tested.state = tested.after(0.01, 200.0 if tested.speed > 100.0 else 0.0)
        low, _ = MAP.limits(tested.speed)
        assert low - 30.0 <= tested.state.torque <= 150.0
    assert abs(tested.state.integral) < 4.0 * 290.0 + 150.0
    tested.reference = 50.0
    tested.state = tested.after(0.01, 0.0)
    assert tested.state.torque < 0.0  # The drag acts at once.


@pytest.mark.parametrize("throttle, torque", [(0.0, -10.0), (0.5, 70.0), (1.0, 150.0)])
def test_throttle_interpolates_between_drag_and_full_load(throttle, torque):
    system = governed_engine(0.01, MAP, idle=50.0, top_speed=290.0, proportional_gain=4.0)
    assert system.output(0.0, [0.0, 0.0], [throttle, 100.0])[0] == pytest.approx(torque)


def test_middle_of_the_interface_inertia_is_the_mean_of_its_extremes():
    assert InterfaceInertia(minimum=1.0, mean=1.5, maximum=3.0).middle == 2.0


def test_engine_continues_from_a_restored_state():
    tested = engine(Governor(4.0, 20.0))
    saved = tested.state = tested.after(0.013, 10.0)
    first = tested.after(0.02, 10.0)
    tested.state = tested.after(0.5, -3.0)
    tested.state = saved
    assert tested.after(0.02, 10.0) == first


@pytest.mark.parametrize(
    "make, sentence",
    [
        (lambda: Governor(-1.0, 0.0), "proportional_gain must be finite and at least 0 (got -1)"),
        (lambda: Governor(1.0, 0.0, 0.0), "sample_time must be a positive number of seconds (got 0)"),
        (
            lambda: EngineMap((0.0, 0.0), (1.0, 1.0), (0.0, 0.0)),
            "strictly increasing (got 0 after 0)",
        ),
        (
            lambda: EngineMap((0.0,), (1.0, 1.0), (0.0,)),
            "speed and full_load: a table must have one value ",
        ),
        (lambda: EngineMap((0.0,), (1.0,), (math.nan,)), "drag: numbers of a table must be finite (got nan)"),
        (
            lambda: EngineMap((0.0,), (1.0,), (-1.0,)),
            "drag must be at least 0 N.m (got -1). Drag is the magnitude",
        ),
    ],
)
def test_invalid_values_are_rejected_by_name(make, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        make()
