"""Test published driving cycles against their regulations, the tolerance, and cycles from files."""

import itertools

import numpy as np
import pytest
from test_scene_runs import car

from inertia_module.common.examples import example
from inertia_module.driveline.cycles import (
    CYCLES,
    ELEMENTARY_URBAN_CYCLE,
    FTP_75,
    KILOMETRE_PER_HOUR,
    MILE_PER_HOUR,
    NEDC,
    WLTC_3B,
    Cycle,
)
from inertia_module.scene import load_scene
from inertia_module.scene.summary_metrics import summarise
from inertia_module.scene.vehicle_metrics import cycle_remarks

MILE = 1609.344  # m


def length(cycle, begin=0.0, end=np.inf):
    """Return the distance between two breakpoints, m."""
    inside = (cycle.time >= begin) & (cycle.time <= end)
    return np.trapezoid(cycle.speed[inside], cycle.time[inside])


@pytest.mark.parametrize(
    "cycle, duration, distance, tolerance, maximum, unit",
    [
        (ELEMENTARY_URBAN_CYCLE, 195.0, 1013.0, 6.0, 50.0, KILOMETRE_PER_HOUR),
        (NEDC, 1180.0, 11007.0, 25.0, 120.0, KILOMETRE_PER_HOUR),
        (WLTC_3B, 1800.0, 23266.0, 0.5, 131.3, KILOMETRE_PER_HOUR),
        (FTP_75, 1874.0, 11.04 * MILE, 0.005 * MILE, 56.7, MILE_PER_HOUR),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_published_cycle_has_the_totals_of_its_regulation(
    cycle, duration, distance, tolerance, maximum, unit
):
    assert CYCLES[cycle.name] is cycle
    assert cycle.source
    assert (cycle.time[0], cycle.duration) == (0.0, duration)
    assert (np.diff(cycle.time) > 0.0).all()
    assert cycle.speed[[0, -1]].tolist() == [0.0, 0.0]
    assert cycle.speed.min() == 0.0
    assert cycle.speed.max() / unit == pytest.approx(maximum)
    assert cycle.speed_tolerance == 2.0 * unit
    assert length(cycle) == pytest.approx(distance, abs=tolerance)
    # A car can follow the cycle.
    assert np.abs(np.diff(cycle.speed) / np.diff(cycle.time)).max() < 1.7


def test_phases_of_the_wltc_have_the_lengths_and_the_checksums_of_the_regulation():
    """UN GTR No. 15 gives the length of each phase, m, and the sum of its speeds per second, km/h."""
    ends = [0.0, 589.0, 1022.0, 1477.0, 1800.0]
    lengths = [length(WLTC_3B, *phase) for phase in itertools.pairwise(ends)]
    assert lengths == pytest.approx([3095.0, 4756.0, 7162.0, 8254.0], abs=0.5)
    assert WLTC_3B.time.tolist() == list(range(1801))
    starts = [0, 590, 1023, 1478, 1801]
    sums = [np.sum(WLTC_3B.speed[slice(*phase)]) * 3.6 for phase in itertools.pairwise(starts)]
    assert sums == pytest.approx([11140.3, 17121.2, 25782.2, 29714.9], abs=1e-6)


def test_the_ftp_75_is_the_udds_and_its_first_505_seconds():
    assert FTP_75.time.tolist() == list(range(1875))
    assert length(FTP_75, 0.0, 1369.0) == pytest.approx(7.45 * MILE, abs=0.005 * MILE)
    assert length(FTP_75, 0.0, 505.0) == pytest.approx(3.59 * MILE, abs=0.005 * MILE)
    assert FTP_75.speed[1369:].tolist() == FTP_75.speed[:506].tolist()


def test_the_nedc_is_four_urban_cycles_and_the_extra_urban_cycle():
    seconds = np.arange(196.0)
    for begin in 195.0 * np.arange(4):
        np.testing.assert_array_equal(
            NEDC.speed_at(begin + seconds), ELEMENTARY_URBAN_CYCLE.speed_at(seconds)
        )
    assert length(NEDC, 780.0) == pytest.approx(6955.0, abs=0.5)


@pytest.mark.parametrize(
    "cycle, unit, speeds",
    [
        (NEDC, KILOMETRE_PER_HOUR, {57: 18.4, 150: 50, 841: 70, 1121: 120, 1150: 50, 1155: 25}),
        (WLTC_3B, KILOMETRE_PER_HOUR, {230: 56.5, 788: 65.3, 915: 57.0, 1154: 17.7, 1210: 90.6, 1724: 131.3}),
        (FTP_75, MILE_PER_HOUR, {21: 3.0, 164: 3.3, 185: 19.4, 240: 56.7, 505: 0.0, 1609: 56.7}),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_speeds_of_a_cycle_are_as_published(cycle, unit, speeds):
    published = cycle.speed_at(list(speeds)) / unit
    assert published == pytest.approx(list(speeds.values()), abs=1e-9)


# --- the tolerance ---


@pytest.mark.parametrize("cycle", [*CYCLES.values(), pytest.param(None, id="steps")])
def test_tolerance_band_agrees_with_brute_force(cycle):
    cycle = cycle or Cycle("steps", np.array([2.0, 5.0, 5.0, 8.0, 8.0]), np.array([3.0, 3.0, 9.0, 9.0, 0.0]))
    times = np.linspace(-3.0, cycle.duration + 3.0, 997)
    lower, upper = cycle.tolerance_band(times)
    for n, time in enumerate(times):
        inside = np.abs(cycle.time - time) <= 1.0
        near = np.concatenate([cycle.speed[inside], cycle.speed_at([time - 1.0, time + 1.0])])
        assert upper[n] == pytest.approx(near.max() + cycle.speed_tolerance, abs=1e-12)
        assert lower[n] == pytest.approx(max(near.min() - cycle.speed_tolerance, 0.0), abs=1e-12)


# --- tracking error of a car ---

RAMP = Cycle("ramp.csv", np.array([0.0, 10.0, 20.0]), np.array([0.0, 20.0, 20.0]))


def driven(speed, cycle=RAMP):
    """Return a table of a car with these speeds every 0.1 s."""
    time = 0.1 * np.arange(len(speed))
    return car(speed, time, reference=cycle.speed_at(time))


def test_a_car_within_the_tolerance_gets_no_remark():
    time = 0.1 * np.arange(201)
    assert cycle_remarks(driven(RAMP.speed_at(time)), RAMP) == {}
    assert cycle_remarks(driven(RAMP.speed_at(time - 1.0)), RAMP) == {}


def test_a_deviation_of_at_most_a_second_is_counted_without_a_remark():
    speed = RAMP.speed_at(0.1 * np.arange(201))
    speed[150:160] -= 1.0
    table = driven(speed)
    assert summarise(table, RAMP, 1.0, {})["time_out_of_tolerance"].value == pytest.approx(1.0)
    assert cycle_remarks(table, RAMP) == {}
    speed[160] -= 1.0
    assert cycle_remarks(driven(speed), RAMP)["vehicle_speed"] == (
        "does not follow ramp.csv: out of tolerance for more than 1 s at a time (once, at 15 s); largest"
        " deviation 3.6 km/h too slow at 15 s"
    )


def test_the_remark_names_the_first_and_the_farthest_time():
    speed = RAMP.speed_at(0.1 * np.arange(201))
    speed[110:130] -= 1.0
    speed[150:] += 2.0
    speed[170] += 1.0
    speed[140] += 9.0  # This error is shorter than a second.
    assert cycle_remarks(driven(speed), RAMP)["vehicle_speed"] == (
        "does not follow ramp.csv: out of tolerance for more than 1 s at a time (2 times, first at 11 s);"
        " largest deviation 10.8 km/h too fast at 17 s"
    )


def test_run_shorter_than_its_cycle_has_a_remark():
    assert cycle_remarks(driven(RAMP.speed_at(0.1 * np.arange(101))), RAMP) == {
        "stop_time": "is 10 s, but ramp.csv lasts 20 s"
    }
    assert cycle_remarks(driven(RAMP.speed_at(0.1 * np.arange(301))), RAMP) == {}


# --- cycles in scenes ---


@pytest.mark.parametrize("name", CYCLES)
def test_a_scene_names_a_published_cycle(name):
    scene = load_scene(example("urban"), {"controller.reference.cycle": name})
    assert scene.cycle is CYCLES[name]
    times = np.arange(0.0, scene.cycle.duration, 7.3)
    np.testing.assert_allclose(scene.controller.reference.signal()(times), scene.cycle.speed_at(times))


def test_a_table_is_a_cycle_of_a_vehicle_and_of_no_other_load(tmp_path):
    (tmp_path / "own.csv").write_text("time [min],speed [km/h]\n0,0\n1,36\n")
    reference = {"kind": "table", "file": str(tmp_path / "own.csv")}
    cycle = load_scene(example("urban"), {"controller.reference": reference}).cycle
    assert (cycle.name, cycle.duration) == ("own.csv", 60.0)
    assert cycle.speed_at(30.0) == pytest.approx(5.0)
    assert cycle.speed_tolerance == pytest.approx(2.0 / 3.6)
    inline = {"kind": "table", "time": [0, 60], "speed": [0, "10 m/s"]}
    assert load_scene(example("urban"), {"controller.reference": inline}).cycle.name == "the reference"
    constant = {"kind": "constant", "speed": "36 km/h"}
    assert load_scene(example("urban"), {"controller.reference": constant}).cycle is None
    keys = {"load": {"kind": "shaft", "inertia": 1.0}, "controller.brake": None}
    reference = {"kind": "table", "time": [0, 60], "speed": [0, 10]}
    gains = {f"controller.{name}": 1.0 for name in ("proportional_gain", "integral_gain", "feedforward")}
    assert load_scene(example("urban"), {**keys, **gains, "controller.reference": reference}).cycle is None
