"""Test fits: estimates and intervals, identifiability, causes of residuals, files and errors."""

import importlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
from rejected import assert_rejected

from inertia_module import studies
from inertia_module.common.errors import InertiaModuleError
from inertia_module.fmi.results import Result, read_columns, write_columns
from inertia_module.scene import load_scene, run_scene
from inertia_module.studies.candidates import TIE
from inertia_module.studies.measurement import Rig, measurement
from tests.system.programs import assert_one_line_error, command, stdout_of

pytest.importorskip("tomli_w")
EXAMPLES = Path(__file__).parents[2] / "examples"
MEASURED, SCENE = EXAMPLES / "fit_rig.csv", EXAMPLES / "fit_rig.toml"
FREE = dict.fromkeys(("imbalance_mass", "link2_inertia"))
MASS = {"imbalance_mass": None}
RANGES = {"imbalance_mass": (0.5, 2.0), "link2_inertia": (0.001, 0.02)}
SETS = 16


@pytest.fixture(scope="module")
def rig():
    """Return the script that makes the data of the example."""
    from benchmarks import fit_rig_data

    return fit_rig_data


@pytest.fixture(scope="module")
def true_scene(rig):
    """Return the scene with the true values; the fit of a single key needs few runs."""
    return load_scene(SCENE).with_keys({f"mechanism.{name}": rig.TRUE[name] for name in FREE})


@pytest.fixture(scope="module")
def example_fit(fmu, tmp_path_factory):
    free = {**RANGES, "shaft_stiffness": None}
    return studies.fit(MEASURED, SCENE, free, starts=2, output=tmp_path_factory.mktemp("fit"), fmu=fmu)


# --- estimates ---


def test_example_estimates_the_true_values_and_the_noise(example_fit, rig):
    for name in FREE:
        low, high = example_fit[name].interval_if_exact
        assert low <= rig.TRUE[name] <= high
        assert not example_fit[name].doubt
    assert example_fit["imbalance_mass"].error < 0.002
    assert example_fit.estimated == list(rig.NOISE)
    for name, value in example_fit.noise.items():
        assert value == pytest.approx(rig.NOISE[name], rel=0.1)
    assert example_fit.searches == (3, 3)


def test_interval_ends_at_the_squared_quantile_of_the_profile(fmu, example_fit, tmp_path):
    def squares(fit):
        """Return the sum of squared residuals, scaled by the estimated noise."""
        table, noise = fit.table(), example_fit.noise
        return sum(np.sum((table[f"{name}_residual"] / noise[name]) ** 2) for name in noise)

    for name, other in ([*FREE], [*FREE][::-1]):
        for end in example_fit[name].interval_if_exact:
            free = {name: f"{end!r} +- 0", other: None}
            fit = studies.fit(MEASURED, example_fit.scene, free, output=tmp_path, fmu=fmu)
            # The squared quantile of Student's t is 3.86.
            assert 3.0 < squares(fit) - squares(example_fit) < 4.7


def test_key_without_influence_is_named_and_unchanged(example_fit):
    stiffness = example_fit["shaft_stiffness"]
    assert stiffness.value == 400.0
    assert "has no influence" in stiffness.text
    assert [line for line in example_fit.warnings if "shaft_stiffness: has no influence" in line]
    assert list(example_fit.correlations) == [tuple(f"mechanism.{name}" for name in FREE)]


def test_fitted_scene_and_residuals_can_be_read_again(example_fit):
    scene = load_scene(example_fit.files["scene"])
    for name in FREE:
        assert scene.parameters()[name] == example_fit[name].value
    assert scene.run == load_scene(SCENE).run
    columns, units = read_columns(example_fit.files["residuals"])
    assert units["omega2_residual"] == "rad/s"
    residual = np.array(columns["omega2_computed"]) - np.array(columns["omega2_measured"])
    assert columns["omega2_residual"] == pytest.approx(residual)
    assert np.std(residual) == pytest.approx(example_fit.noise["omega2"], rel=0.02)


def test_intervals_are_as_wide_as_the_values_scatter(fmu, rig, tmp_path, monkeypatch):
    monkeypatch.setattr(rig, "TIMES", rig.TIMES[:100])
    true, scene, off = rig.true_speeds(), load_scene(SCENE), []
    inside, named = np.zeros(2), 0
    for seed in range(SETS):
        file = write_columns(tmp_path / "measured.csv", rig.measured(true, seed))
        fit = studies.fit(file, scene, FREE, output=tmp_path, fmu=fmu)
        off.append([(fit[name].value - rig.TRUE[name]) / fit[name].error for name in FREE])
        named += bool(fit.causes)
        inside += [
            fit[name].interval_if_exact[0] <= rig.TRUE[name] <= fit[name].interval_if_exact[1]
            for name in FREE
        ]
    # One false alarm in a hundred fits is expected.
    assert named <= 1
    # The intervals have 95 % coverage. Chi-squared of 16 values is between 3.9 and 39 in 99.8 % of cases.
    assert inside.min() >= 12
    squares = np.sum(np.square(off), axis=0)
    assert 3.9 < squares.min() <= squares.max() < 39.3


def test_two_keys_of_which_the_data_determine_a_combination_are_not_identifiable(fmu, tmp_path):
    free = {"imbalance_mass": (0.5, 2.0), "wheel_radius": (0.07, 0.1)}
    fit = studies.fit(MEASURED, SCENE, free, starts=0, output=tmp_path, fmu=fmu)
    assert fit.correlations["mechanism.imbalance_mass", "mechanism.wheel_radius"] < -0.99
    assert [
        line for line in fit.warnings if line.startswith("only a combination of mechanism.imbalance_mass")
    ]
    for name in free:
        assert "not identifiable" in fit[name].doubt


def test_masses_without_a_fixed_scale_are_not_identifiable(fmu, rig, tmp_path):
    """A search that ends near an end of a range must not give a narrow interval there."""
    free = {
        "imbalance_mass": (0.5, 20.0),
        "output_inertia": (0.2, 10.0),
        "load.torque": (2.0, 300.0),
        "link2_inertia": (0.001, 0.2),
    }
    fit = studies.fit(MEASURED, SCENE, free, output=tmp_path, fmu=fmu)
    assert [line for line in fit.warnings if line.startswith("only ratios of mechanism.imbalance_mass")]
    for name, true in {**rig.TRUE, "load.torque": 10.0}.items():
        assert "not identifiable" in fit[name].doubt
        assert fit[name].interval[0] <= true <= fit[name].interval[1]


def test_parameter_of_the_scale_is_named(fmu, tmp_path):
    free = {"imbalance_mass": (0.5, 2.0), "output_inertia": (0.2, 1.0), "load.torque": (2.0, 30.0)}
    fit = studies.fit(MEASURED, SCENE, free, output=tmp_path, fmu=fmu)
    assert fit.scale == ["mechanism.link2_inertia"]
    assert "mechanism.link2_inertia" in fit.inseparable
    words = "are identifiable: the result scales with mechanism.link2_inertia, which is taken as exact"
    assert [line for line in fit.warnings if line.endswith(words)]


@pytest.mark.parametrize(
    "name, limits, doubt",
    [
        ("link2_inertia", (0.0062, 0.0063), "not identifiable from the data: the profile likelihood has no"),
        ("imbalance_mass", (0.9, 1.0), "is at the end of its range"),
        ("imbalance_mass", (1.14, 1.3), "is at the end of its range"),
    ],
)
def test_too_narrow_or_wrong_range_causes_a_warning(fmu, true_scene, tmp_path, name, limits, doubt):
    fit = studies.fit(MEASURED, true_scene, {name: limits}, starts=0, output=tmp_path, fmu=fmu)
    assert fit[name].doubt.startswith(doubt)
    assert [line for line in fit.warnings if line.startswith(f"mechanism.{name}: {doubt}")]
    outside = not limits[0] <= true_scene.parameters()[name] <= limits[1]
    words = "does not contain the value in the scene"
    assert bool([line for line in fit.warnings if words in line]) == outside


def test_residuals_reveal_an_incomplete_scene(fmu, tmp_path):
    wrong = load_scene(SCENE).with_keys({"load.torque": "15 N.m"})
    fit = studies.fit(MEASURED, wrong, MASS, output=tmp_path, fmu=fmu)
    assert any("residuals of omega_out are autocorrelated" in line for line in fit.warnings)


def test_specified_noise_sets_weights_and_tests(fmu, true_scene, tmp_path):
    columns, units = read_columns(MEASURED)
    rows = len(columns["time"])
    noisy = {**columns, "omega2_noise": [0.5] * rows, "omega_out_noise": [0.05] * rows}
    units = {**units, "omega2_noise": "rad/s", "omega_out_noise": "rad/s"}
    fit = studies.fit(Result.from_columns(noisy, units), true_scene, MASS, output=tmp_path, fmu=fmu)
    assert fit.estimated == []
    # The specified noise of one of the two columns is half the true noise: (1 + 4) / 2.
    assert fit.chi_squared == pytest.approx(2.5, rel=0.1)
    assert any("the residuals are larger than the specified noise" in line for line in fit.warnings)


def test_several_starts_reach_a_minimum_that_a_single_start_misses(fmu, true_scene, tmp_path):
    scene = true_scene.with_keys({"drive.omega1": "75 rad/s"})
    free = {"drive.omega1": (50.0, 150.0)}
    alone = studies.fit(MEASURED, scene, free, columns=["omega2"], starts=0, output=tmp_path / "a", fmu=fmu)
    assert alone["omega1"].value < 90.0
    assert any("residuals of omega2 are autocorrelated" in line for line in alone.warnings)
    several = studies.fit(MEASURED, scene, free, columns=["omega2"], output=tmp_path / "b", fmu=fmu)
    low, high = several["omega1"].interval_if_exact
    assert low <= 100.0 <= high < low + 0.1
    assert several["omega1"].value == pytest.approx(100.0, abs=0.03)
    assert several["omega1"].unit == "rad/s"
    assert several.warnings == []


def test_interrupted_search_is_reported(fmu, true_scene, tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.import_module("inertia_module.studies.least_squares"), "MAX_EVALUATIONS", 2)
    scene = true_scene.with_keys({"mechanism.imbalance_mass": 0.5})
    fit = studies.fit(MEASURED, scene, FREE, output=tmp_path, fmu=fmu)
    assert "the search did not converge within the maximum number of iterations" in fit.warnings


def test_same_seed_same_result(fmu, true_scene, tmp_path):
    settings = {"free": {"imbalance_mass": (0.5, 2.0)}, "starts": 2, "seed": 5, "fmu": fmu}
    fit, again = (studies.fit(MEASURED, true_scene, **settings, output=tmp_path / name) for name in "ab")
    assert fit.as_dict() == again.as_dict()


# --- fixed parameters ---


def with_column(table, **columns):
    return Result(table.columns | columns, table.units)


@pytest.fixture(scope="module")
def measured():
    return Result.from_csv(MEASURED).converted({"omega2": "rad/s", "omega_out": "rad/s"})


@pytest.fixture(scope="module")
def offset(fmu, measured, tmp_path_factory):
    shifted = with_column(measured, omega_out=measured["omega_out"] + np.pi / 3.0)
    folder = tmp_path_factory.mktemp("offset")
    fit = studies.fit(shifted, SCENE, FREE, output=folder, fmu=fmu)
    return fit, studies.fit(shifted, SCENE, {**FREE, "offset.omega_out": None}, output=folder, fmu=fmu)


def test_correct_data_have_no_cause_and_intervals_name_the_released_parameters(example_fit):
    assert example_fit.causes == []
    assert [line for line in example_fit.warnings if "would explain" in line] == []
    mass = example_fit["imbalance_mass"]
    assert not mass.is_excluded
    assert "mechanism.output_inertia" in mass.released
    assert set(mass.released) < set(example_fit.candidate_lines())
    low, high = mass.interval_if_exact
    assert mass.interval[0] < low < high < mass.interval[1]
    # The inertia rotates with link 2, because the speed of link 1 is prescribed.
    assert "mechanism.drive_inertia" in example_fit.candidate_lines()["not separately identifiable"]
    assert set(example_fit.scale) == {"mechanism.output_inertia", "load.torque"}
    lines = example_fit.lines()
    assert lines["mechanism.imbalance_mass"].endswith(" released")
    assert lines["mechanism.imbalance_mass, if everything else is exact"].startswith("from 1.06")
    assert "chi-squared" in lines


def test_sensor_offset_is_named_and_estimated_if_free(offset, rig):
    fit, free_fit = offset
    assert [cause.name for cause in fit.causes] == ["offset.omega_out"]
    (sentence,) = (line for line in fit.warnings if "would explain" in line)
    assert sentence.startswith("an offset of 1.0")
    assert "chi-squared " in sentence
    assert sentence.endswith("correct the cause or fit again with --free offset.omega_out")
    assert free_fit.warnings == []
    low, high = free_fit["offset.omega_out"].interval
    assert low <= np.pi / 3.0 <= high < low + 0.1
    for name in FREE:
        low, high = free_fit[name].interval
        assert low <= rig.TRUE[name] <= high
    # The candidate was fitted in full.
    (cause,) = fit.causes
    assert cause.value == pytest.approx(free_fit["offset.omega_out"].value, abs=0.005)
    assert cause.values["mechanism.link2_inertia"] == pytest.approx(free_fit["link2_inertia"].value, rel=0.02)
    assert cause.p_value < 1e-6
    assert free_fit.noise["omega_out"] == pytest.approx(rig.NOISE["omega_out"], rel=0.1)
    assert "offset" not in free_fit.files["scene"].read_text()


def test_shift_of_the_clock_is_estimated(fmu, true_scene, measured, tmp_path):
    late = with_column(measured, time=measured.time + 3e-3)
    scene = true_scene.with_keys({"run.stop_time": 0.6})
    fit = studies.fit(late, scene, MASS, output=tmp_path, fmu=fmu)
    assert fit.causes[0].name == "shift.time"
    assert any(
        line.startswith("a time shift of 3") and " ms (late) in the clock of the file would explain" in line
        for line in fit.warnings
    )
    free_fit = studies.fit(late, scene, {**MASS, "shift.time": "-5 ms:5 ms"}, output=tmp_path, fmu=fmu)
    assert free_fit["shift.time"].value == pytest.approx(3e-3, abs=1e-4)
    assert free_fit.warnings == []


def test_wrong_unit_is_named_for_a_column_and_for_all(fmu, measured, tmp_path):
    wrong = {name: measured[name] * 30.0 / np.pi for name in ("omega2", "omega_out")}
    single = studies.fit(with_column(measured, omega2=wrong["omega2"]), SCENE, FREE, output=tmp_path, fmu=fmu)
    assert single.causes[0].name == "gain.omega2"
    assert any("its numbers are in rpm, not in rad/s" in line for line in single.warnings)
    all_wrong = studies.fit(with_column(measured, **wrong), SCENE, FREE, output=tmp_path, fmu=fmu)
    for name in wrong:
        words = "the unfitted scene computes; possible cause: its numbers are in rpm, not in rad/s"
        assert any(line.startswith(f"{name} is ") and line.endswith(words) for line in all_wrong.warnings)


@pytest.fixture(scope="module")
def lossy_data(rig):
    """Return measurements of a machine with losses."""
    losses = {"link2_friction": 0.02, "output_friction": 0.05, "mesh_efficiency": 0.97}
    columns = rig.measured(rig.true_speeds(imbalance_mass=1.13, **losses), 1)
    names, units = ["time", "omega2", "omega_out"], {"time": "ms", "omega2": "rpm", "omega_out": "rpm"}
    return Result.from_columns(dict(zip(names, columns.values(), strict=True)), units)


def test_unmodelled_loss_is_named_and_other_intervals_widen(fmu, rig, lossy_data, tmp_path):
    fit = studies.fit(lossy_data, SCENE, FREE, output=tmp_path, fmu=fmu)
    mass = fit["imbalance_mass"]
    assert mass.interval_if_exact[0] > 1.15
    assert mass.interval[0] < 1.13 < mass.interval[1]
    assert "mechanism.output_friction" in [cause.name for cause in fit.causes]
    priors = {"mesh_efficiency": "0.97 +- 0.01", "link2_friction": "0.02 +- 0.02"}
    free = {**FREE, "output_friction": (0.0, 0.2), **priors}
    free_fit = studies.fit(lossy_data, SCENE, free, output=tmp_path, fmu=fmu)
    for name, true in {"imbalance_mass": 1.13, "link2_inertia": 0.0062, "output_friction": 0.05}.items():
        low, high = free_fit[name].interval
        assert low <= true <= high
    # The data determine the mesh efficiency less accurately than its prior.
    low, high = free_fit["mesh_efficiency"].interval_if_exact
    assert 0.02 < high - low < 0.045
    assert free_fit.causes == []


def test_prior_of_an_unidentifiable_key_is_unchanged(fmu, true_scene, tmp_path):
    free = {"imbalance_mass": None, "output_inertia": "0.5 +- 0.001"}
    fit = studies.fit(MEASURED, true_scene, free, output=tmp_path, fmu=fmu)
    inertia = fit["output_inertia"]
    assert inertia.value == pytest.approx(0.5, abs=1e-3)
    assert inertia.error == pytest.approx(0.001, rel=0.1)


def test_prior_is_not_reported_as_a_cause_or_bound(fmu, true_scene, tmp_path):
    fixed = {"output_inertia": "0.5 +- 0", "load.torque": "10 N.m +- 0", "offset.omega2": "0.5 rad/s +- 0"}
    fit = studies.fit(MEASURED, true_scene, {"imbalance_mass": None, **fixed}, output=tmp_path, fmu=fmu)
    assert [cause.name for cause in fit.parameters] == ["mechanism.imbalance_mass"]
    names = {candidate.name for candidate in fit.candidates}
    assert not names & {"mechanism.output_inertia", "load.torque", "offset.omega2"}
    assert "mechanism.mesh_efficiency" in names
    # The known offset of the sensor is subtracted.
    measured = fit.measurement.table["omega2"]
    assert np.mean(fit.computed["omega2"] - measured) == pytest.approx(0.5, abs=0.1)
    with pytest.raises(
        InertiaModuleError, match="at least one key must be free; a deviation of 0 fixes a key"
    ):
        studies.fit(MEASURED, true_scene, fixed, output=tmp_path, fmu=fmu)


def test_wrong_radius_is_named_or_tied(fmu, rig, tmp_path):
    from benchmarks import fit as benchmark

    case = benchmark.wrong_radius(rig.true_speeds(), 0, np.random.default_rng(0))
    scene = load_scene(SCENE).with_keys(dict(case.changes))
    file = write_columns(tmp_path / "measured.csv", case.columns)
    fit = studies.fit(file, scene, FREE, output=tmp_path, fmu=fmu)
    assert "mechanism.sun_radius" in [cause.name for cause in fit.causes]
    likelihoods = [cause.likelihood_ratio for cause in fit.causes]
    assert max(likelihoods) - min(likelihoods) < TIE


@pytest.mark.slow
@pytest.mark.parametrize("number", range(10))
def test_fits_are_correct_or_report_a_caveat(fmu, tmp_path, number):
    from benchmarks import fit as benchmark

    verdicts = benchmark.run(benchmark.KINDS[number], 8, tmp_path, fmu)  # `make bench` fits 100 of each kind
    assert sum(verdict.is_correct for verdict in verdicts) >= 7


def delayed_columns(fmu, scene, names, times, late=()):
    """Return columns of a scene at times, shape (times, names); `late` is the delay of each sensor, s."""
    table = Result.from_columns({"time": times} | dict.fromkeys(names, 0.0 * times))
    with Rig(scene, measurement(table, scene), fmu) as rig:
        return rig.computed({f"shift.{name}": delay for name, delay in zip(names, late, strict=False)})


def test_shifted_column_of_any_kind_is_read_earlier(fmu):
    names = ["omega2", "output_torque_mean", "satellite_force_peak"]
    scene, times, late = load_scene(SCENE), 0.02 * np.arange(1.0, 12.0), [0.0, 3e-3, 7e-3]
    together = delayed_columns(fmu, scene, names, times, late)
    for n, name in enumerate(names):
        (alone,) = delayed_columns(fmu, scene, [name], times - late[n]).T
        # Peaks depend on the steps.
        assert together[:, n] == pytest.approx(alone, rel=1e-2 if name.endswith("_peak") else 1e-6)


# --- measurements between communication points ---


def test_times_within_steps_agree_with_short_steps(fmu):
    names = ["omega2", "omega_out", "output_torque", "output_torque_mean", "satellite_force_peak"]
    scene = load_scene(SCENE).replaced(run={"outputs": names}, accuracy={"tolerance": 1e-10})
    fine = run_scene(scene.replaced(run={"communication_step": 1e-4, "stop_time": 0.1}), fmu).record
    rows = np.array([7, 50, 61, 100, 333, 340, 987])
    values = dict(zip(names, delayed_columns(fmu, scene, names, fine.time[rows]).T, strict=True))
    for name in names[:3]:
        assert values[name] == pytest.approx(fine[name][rows], rel=1e-6, abs=1e-6)
    between = list(zip([0, *rows[:-1]], rows, strict=True))
    means = [fine["output_torque_mean"][a + 1 : b + 1].mean() for a, b in between]
    assert values["output_torque_mean"] == pytest.approx(means, rel=1e-6, abs=1e-6)
    peaks = [fine["satellite_force_peak"][a + 1 : b + 1].max() for a, b in between]
    assert values["satellite_force_peak"] == pytest.approx(peaks, rel=1e-2)


def test_signals_of_the_loop_are_linear_between_its_steps(fmu):
    scene = load_scene(EXAMPLES / "engine_launch.toml")
    step = scene.run.communication_step
    (points,) = delayed_columns(fmu, scene, ["vehicle_speed"], step * np.array([60.0, 61.0])).T
    (between,) = delayed_columns(fmu, scene, ["vehicle_speed"], step * np.array([60.25])).T
    assert between == pytest.approx(0.75 * points[0] + 0.25 * points[1], rel=1e-9)


def test_extrapolated_speed_continues_within_steps(fmu):
    scene = load_scene(SCENE).with_keys({"mechanism.input_hold": "linear"})
    table = Result.from_columns({"time": [0.005, 0.007], "omega2": [0.0, 0.0]})
    with Rig(scene, measurement(table, scene), fmu) as rig:
        assert np.isnan(rig.computed({})).all()
    assert re.match(r".* each time must be a multiple of .* = 0.005 s .got 0.007 s", rig.rejection)


# --- errors and the command ---


def test_invalid_fit_is_an_error_in_a_sentence(fmu, tmp_path):
    few = Result.from_columns({"time": [0.1, 0.2, 0.3], "omega2": [1.0, 2.0, 1.0]})
    idle = ["shaft_damping", "shaft_stiffness"]
    for measured, free, options, words in (
        (few, FREE, {}, r"must be at least 4 \(2 free parameters, 2 for the noise\) \(got 3\)"),
        (MEASURED, idle, {}, r"no free parameter .*shaft_damping.* has an influence on omega2, omega_out"),
        (MEASURED, FREE, {"starts": -1}, "starts must be at least 0 .got -1"),
    ):
        assert_rejected(words, studies.fit, measured, SCENE, free, **options, output=tmp_path, fmu=fmu)
    assert list(tmp_path.iterdir()) == []


def test_command_writes_scene_residuals_summary_and_plot(fmu, tmp_path):
    words = ["fit", MEASURED, SCENE, "--fmu", fmu, "-o", tmp_path]
    free = ["--free", "imbalance_mass=0.5:2", "--starts", "1", "--column", "omega_out"]
    summary = json.loads(stdout_of(*words, *free, "--json"))
    assert list(summary["noise"]) == ["omega_out"]
    assert json.loads((tmp_path / "fit.json").read_text())["parameters"] == summary["parameters"]
    assert (tmp_path / "fit.png").read_bytes().startswith(b"\x89PNG")
    mass = summary["parameters"]["mechanism.imbalance_mass"]
    assert mass["value"] == load_scene(tmp_path / "fitted.toml").parameters()["imbalance_mass"]
    assert_one_line_error(command(*words), "error: at least one key must be free")
