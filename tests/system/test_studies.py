"""The study scripts: each says something about the mechanism, and that is so."""

import sys
from pathlib import Path

import numpy as np
import pytest

STUDIES = Path(__file__).parents[2] / "examples" / "studies"


@pytest.fixture(scope="module", autouse=True)
def scripts():
    """The scripts import each other as a reader runs them: from their own folder."""
    sys.path.insert(0, str(STUDIES))
    yield
    sys.path.remove(str(STUDIES))


def test_launch_stall_torque_grows_with_the_square_and_averaged_times_are_those_of_rigid(fmu):
    import launch

    rows, _ = launch.study(fmu)
    over_square = [torque / omega1**2 for omega1, torque, *_ in rows]
    assert np.ptp(over_square) < 0.03 * over_square[0]
    _, _, rigid_half, rigid_most, half, most = rows[-1]
    assert half == pytest.approx(rigid_half, rel=0.01)
    assert most == pytest.approx(rigid_most, rel=0.02)


def test_load_step_above_stall_torque_is_held_locked_up_and_beyond_that_the_shaft_rests_and_comes_back(fmu):
    import load_step

    rows, _ = load_step.study(fmu)
    speeds = np.array([row[1] for row in rows]) / load_step.OMEGA1
    stall = rows[0][0] / load_step.STALL_SHARES[0]
    assert rows[2][0] > 1.2 * stall
    assert speeds[:3] == pytest.approx(1.0, abs=2e-3)
    assert speeds[3] == pytest.approx(0.0, abs=1e-3)
    assert 0.1 < speeds[4] < 0.9
    assert speeds[5] == pytest.approx(1.0, abs=2e-3)


def test_overrunning_shaft_coasts_on_its_load_alone_and_is_caught_again(fmu):
    import overrun

    tables = overrun.study(fmu)
    slowed, free, again = overrun.phases(tables[True])
    assert slowed == pytest.approx(free, rel=1e-6)
    assert 0.0 < again < 1.0
    during = (tables[True].time > overrun.TIMES[2]) & (tables[True].time < overrun.TIMES[3])
    assert np.abs(tables[True]["output_torque_mean"][during]).max() == 0.0
    # one with link 2 the shaft is dragged down
    assert tables[False]["omega_out"][during].min() < 0.5 * tables[True]["omega_out"][during].min()


def test_hoist_holds_its_load_without_a_brake_and_cannot_without_the_freewheel_of_link_2(fmu):
    import hoist

    rows, _ = hoist.study(fmu)
    for _, _, lifted, sunk, _ in rows:
        assert lifted > 0.0
        assert sunk == pytest.approx(0.0, abs=1e-9)
    speeds = [row[4] for row in rows]
    assert speeds == sorted(speeds, reverse=True)
    assert hoist.run(rows[1][0], False, fmu, stop=1.0)["height"][-1] < -0.1


def test_noise_on_sensor_and_load_leaves_the_car_within_the_tolerances_of_the_cycle(fmu):
    import noisy_cycle

    table = noisy_cycle.run(*noisy_cycle.CASES["both"], fmu)
    error, outside, _, residual = noisy_cycle.judge(table)
    assert 0.3 < error < 0.6
    assert outside < 0.001
    assert residual < 1e-6
    assert np.std(np.diff(table["measured_speed"])) > 0.01
