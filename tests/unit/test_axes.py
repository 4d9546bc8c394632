"""Test ranges and lists of keys, free keys, measured columns of studies, and their errors."""

from collections import Counter

import numpy as np
import pytest
from rejected import REJECTED, assert_rejected

from inertia_module.common.errors import InertiaModuleError, ParameterError
from inertia_module.common.examples import example
from inertia_module.fmi.results import Result
from inertia_module.plots.studies import sweep_figure
from inertia_module.scene import load_scene
from inertia_module.studies.axes import (
    Free,
    axes_of,
    free_keys,
    grid,
    points_at,
    ranges_from_options,
    sample_shares,
)
from inertia_module.studies.evaluation import Row
from inertia_module.studies.measurement import measurement
from inertia_module.studies.parameter_sweep import SweepResult, indices


@pytest.fixture(scope="module")
def scene():
    car = {"kind": "vehicle", "torque": None, "mass": 900, "wheel_radius": 0.3, "final_drive": 3}
    return load_scene(example("reference")).replaced(mechanism={"output_friction": 0}, load=car)


def table(**columns):
    return Result.from_columns({"time": [0.1, 0.2, 0.3], **columns})


# --- points of ranges and lists ---


def test_a_grid_has_all_combinations_in_si_units_the_last_key_fastest(scene):
    points = grid(
        axes_of(ranges_from_options(["imbalance_mass=500 g:2:3", "drive.omega1=600rpm,100"]), scene)
    )
    assert [list(point.values()) for point in points] == [
        [mass, speed] for mass in (0.5, 1.25, 2.0) for speed in (pytest.approx(20 * np.pi), 100.0)
    ]
    assert list(points[0]) == ["mechanism.imbalance_mass", "drive.omega1"]


def test_points_even_in_the_logarithm_names_and_whole_numbers(scene):
    (log,) = axes_of({"load.mass": "log:0.1:10:3"}, scene)
    assert grid([log]) == [{"load.mass": pytest.approx(value)} for value in (0.1, 1.0, 10.0)]
    (layout,) = axes_of({"layout": ["bevel", "planar"]}, scene)
    assert [point["mechanism.layout"] for point in grid([layout])] == ["bevel", "planar"]
    (teeth,) = axes_of(ranges_from_options(["z17=30:34:9"]), scene)
    assert [point["mechanism.z17"] for point in grid([teeth])] == [30.0, 31.0, 32.0, 33.0, 34.0]


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_samples_fill_the_ranges_and_are_the_same_for_the_same_seed(kind, scene):
    axes = axes_of(
        ranges_from_options(["imbalance_mass=0.5:2", "satellites=1:4", "layout=bevel,planar"]), scene
    )
    points, same, other = (points_at(axes, sample_shares(3, f"{kind}:64", seed)) for seed in (3, 3, 4))
    assert points == same != other
    masses = np.array([point["mechanism.imbalance_mass"] for point in points])
    counts = np.histogram(masses, bins=8, range=(0.5, 2.0))[0]
    assert counts.min() >= 7
    assert counts.max() <= 9
    satellites = Counter(point["mechanism.satellites"] for point in points)
    assert satellites == dict.fromkeys((1.0, 2.0, 3.0, 4.0), 16)
    assert sum(point["mechanism.layout"] == "planar" for point in points) == 32


@pytest.mark.parametrize("weights, expected", [([3.0], [1.0]), ([1.0, 2.0], [0.2, 0.8])])
def test_indices_of_a_weighted_sum_are_the_shares_of_its_squares(scene, weights, expected):
    names = ["mechanism.imbalance_mass", "mechanism.eccentricity"][: len(weights)]
    axes = axes_of(ranges_from_options([f"{name}=0.5:1.5" for name in names]), scene)

    def rows(points):
        return [
            Row(point, {"sum": float(np.dot(weights, list(point.values()))), "one": 1.0}, 0.0)
            for point in points
        ]

    found, every = indices(axes, 256, 0, rows)
    assert (len(every), [one[:2] for one in found]) == (256 * (len(axes) + 2), [("sum", n) for n in names])
    for one, share in zip(found, expected, strict=True):
        assert one[2:] == pytest.approx((share, share), abs=0.02)


def test_a_grid_needs_numbers_of_points_and_a_sample_a_kind(scene):
    axes = axes_of(ranges_from_options(["imbalance_mass=1:2"]), scene)
    assert_rejected("imbalance_mass must be FROM:TO:COUNT for a grid .got 1:2 kg.$", grid, axes)
    assert_rejected("must be latin:COUNT or sobol:COUNT", sample_shares, 1, "random:10", 0)
    with pytest.raises(InertiaModuleError, match=r"points of a grid must be at most 10000000 \(got "):
        grid(axes_of(ranges_from_options(["imbalance_mass=1:2:9999", "drive.omega1=1:2:9999"]), scene))


@pytest.mark.parametrize("number, panels", [(1, 2), (2, 4), (3, 6)])
def test_a_sweep_is_drawn_over_each_key_or_as_a_map_of_two(scene, number, panels):
    axes = axes_of(
        ranges_from_options(["layout=bevel,planar", "load.mass=log:1:100:3", "z17=30:32:3"][:number]), scene
    )
    rows = [Row(point, {"one": float(n), "two": -1.0 * n}, 0.0) for n, point in enumerate(grid(axes))]
    rows[1] = Row(rows[1].point, {}, 0.0, "rejected")
    found = SweepResult(axes, rows, {"one": "N", "load.mass": "kg"}, 0, {}, [], {})
    figure = sweep_figure(found, ["one", "two"])
    figure.canvas.draw()
    assert len(figure.axes) == panels  # The count includes the axes of the colour bar.
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == ["bevel", "planar"]
    labels = [text for one in figure.axes for text in (one.get_xlabel(), one.get_ylabel()) if text]
    assert set(labels) == {"one [N]", "two", *["layout", "load.mass [kg]", "z17"][:number]}


# --- free keys ---


def test_free_keys_begin_at_the_values_of_the_scene_and_change_by_a_range_or_as_much(scene):
    mass, load, start = free_keys(
        ranges_from_options(["imbalance_mass=500 g:2", "load.mass", "omega_out_start=-1:3"]), scene
    )
    assert [one.name for one in (mass, load)] == ["mechanism.imbalance_mass", "load.mass"]
    # The mass has its default of 1 kg.
    assert (mass.start, mass.size, mass.has_range) == (1.0, 1.5, True)
    assert (mass.at(0.5), mass.low, mass.high) == (1.25, 0.5, 2.0)
    assert (load.start, load.size, load.has_range, load.at(0.2)) == (900.0, 900.0, False, 900.0)
    assert start.start == 0.0
    (back,) = free_keys(ranges_from_options(["drive.omega1"]), scene.with_keys({"drive.omega1": -100.0}))
    assert (back.low < back.start < back.high, back.size) == (True, 100.0)


def test_prior_is_a_value_with_its_deviation(scene):
    mass, efficiency = free_keys(
        ranges_from_options(["imbalance_mass=900 g +- 10 g", "mesh_efficiency=0.97±0.01"]), scene
    )
    assert (mass.start, mass.deviation, mass.has_range) == (0.9, 0.01, False)
    assert (efficiency.start, efficiency.deviation) == (0.97, 0.01)
    assert (efficiency.high, efficiency.size) == (1.0, pytest.approx(0.1))


def test_keys_outside_the_scene_have_value_unit_and_limits(scene):
    beside = {
        "offset.omega2": Free("offset.omega2", "rad/s", -np.inf, np.inf, start=0.0, nominal=0.0, size=2.0),
        "shift.time": Free("shift.time", "s", -0.1, 0.1, start=0.0, nominal=0.0, size=1e-3),
    }
    offset, shift = free_keys(ranges_from_options(["offset.omega2", "shift.time=-2 ms:5 ms"]), scene, beside)
    assert (offset.start, offset.size, offset.low, offset.high) == (0.0, 2.0, -np.inf, np.inf)
    assert (shift.low, shift.high, shift.start) == (pytest.approx(-2e-3), pytest.approx(5e-3), 0.0)
    (shift,) = free_keys(ranges_from_options(["shift.time"]), scene, beside)
    assert (shift.low, shift.high) == (-0.1, 0.1)
    with pytest.raises(
        ParameterError, match=r"unknown sensor parameter 'offset.omega3'; did you mean 'offset.omega2'"
    ):
        free_keys(ranges_from_options(["offset.omega3"]), scene, beside)


def test_limits_of_the_table_hold_without_a_range_and_a_value_outside_begins_in_the_middle(scene):
    (mass,) = free_keys(ranges_from_options(["imbalance_mass"]), scene)
    assert mass.low == 0.0
    (outside,) = free_keys({"imbalance_mass": (2.0, 4.0)}, scene)
    assert outside.start == 3.0
    (even,) = free_keys(ranges_from_options(["imbalance_mass=log:0.01:100"]), scene)
    assert even.at(0.5) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "read, keys, words",
    [(axes_of, *one) for one in REJECTED["varied"]] + [(free_keys, *one) for one in REJECTED["free"]],
)
def test_keys_that_cannot_vary_are_an_error_in_a_sentence(scene, read, keys, words):
    assert_rejected(words, lambda: read(ranges_from_options(keys.split(", ") if keys else []), scene))


# --- columns ---


def test_columns_are_in_si_units_separate_from_inputs_and_noise(scene, tmp_path):
    file = tmp_path / "measured.csv"
    file.write_text(
        "time [ms];omega_out [rpm];vehicle_speed [km/h];omega1 [rpm];omega_out_noise [rpm]\n"
        "100;300;36;955;3\n200;600;72;955;6\n"
    )
    data = measurement(file, scene)
    assert data.columns == ["omega_out", "vehicle_speed"]
    assert data.table.time.tolist() == [0.1, 0.2]
    assert data.values == pytest.approx(np.array([[10 * np.pi, 10.0], [20 * np.pi, 20.0]]))
    assert data.noise["omega_out"] == pytest.approx([0.1 * np.pi, 0.2 * np.pi])
    assert list(data.noise) == ["omega_out"]
    assert data.table.units == {"time": "s", "omega_out": "rad/s", "vehicle_speed": "m/s"}


def test_unused_columns_can_have_any_content(scene, tmp_path):
    file = tmp_path / "measured.csv"
    file.write_text(
        "# rig 3\ntime,omega_out,note,sound_noise [dB],temperature [°C],omega1,valve\n"
        "0.1,1,warm,60,n/a,100,true\n0.2,2,,60,20,,false\n"
    )
    data = measurement(file, scene)
    assert data.columns == ["omega_out"]
    assert {*data.unused} == {"note", "temperature", "valve"}
    file.write_text("# rig 3\ntime,omega_out,omega2\n0.1,1,1\n\n0.2,,2\n")
    assert_rejected(
        r"measured\.csv line 5: omega_out must be a finite number \(got ''\)$", measurement, file, scene
    )
    assert measurement(file, scene, ["omega2"]).columns == ["omega2"]
    assert_rejected(
        "unknown output of the scene 'omega3'; did you mean", measurement, file, scene, ["omega3"]
    )
    file.write_text("# rig 3\ntime,omega_out,omega_out_noise\n0.1,1,1\n0.2,1,0\n")
    assert_rejected(r"csv line 4: omega_out_noise must be above 0 .got 0.$", measurement, file, scene)
    file.write_text("time,omega_out\n1700000000,1\n1700000001,1\n")
    words = r"time must be within the run .*got 1700000000 to 1700000001 s\): they look like seconds"
    assert_rejected(words, measurement, file, scene)


def test_a_mean_counts_from_the_second_row_and_columns_are_chosen(scene):
    given = table(output_torque_mean=[1, 2, 3], omega2=[1, 2, 3], other=[0, 0, 0])
    data = measurement(given, scene, ["output_torque_mean"])
    assert data.columns == ["output_torque_mean"]
    assert data.counted.tolist() == [[False], [True], [True]]


@pytest.mark.parametrize("columns, words", REJECTED["columns"])
def test_invalid_columns_are_an_error_in_a_sentence(scene, columns, words):
    assert_rejected(words, measurement, table(**columns), scene)
