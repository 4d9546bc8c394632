"""Test converter charts and tables, and the steady pulses of machines with losses."""

import csv
import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rejected import assert_rejected
from scenes import MECHANISMS, started
from scipy.io import loadmat

from inertia_module.analysis.chart_files import (
    MAP_COLUMNS,
    MAP_SPEEDS,
    MAX_TORQUE_RATIO,
    UNITS,
    converter_table,
    save_converter,
    save_map,
    steady_map,
)
from inertia_module.analysis.converter_chart import NOMINAL_SPEED, RATIOS, TorqueConverterChart, compute_chart
from inertia_module.analysis.steady_state import SteadyMachine
from inertia_module.common.errors import InertiaModuleError
from inertia_module.fmi.results import read_columns
from inertia_module.plots.studies import chart_figure
from tests.system.programs import stdout_of, succeeded

PLANAR = MECHANISMS["planar"]
LOSSES = {"input_friction": 0.002, "output_friction": 0.001, "output_drag": 0.2, "output_drag_viscous": 1e-3}
LOSSY = {**PLANAR, **LOSSES}

pytestmark = pytest.mark.usefixtures("compiled")


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("backward", [False, True])
def test_chart_agrees_with_the_averaged_module_and_conserves_power(compiled, mechanism, backward):
    settings = MECHANISMS[mechanism]
    omega1 = -50.0 if backward else 50.0
    chart = compute_chart(settings, omega1)
    for n in (0, 30, 77, 150):
        speed = 50.0 * chart.speed_ratio[n]
        module = started(compiled, settings, fidelity=1, omega1=omega1, omega_out_start=speed)
        assert chart.output_torque[n] * 2500.0 == pytest.approx(module["output_torque"], rel=1e-12)
        assert chart.peak[n] * 2500.0 == pytest.approx(module["torque_peak"], rel=1e-12)
        assert chart.link2_ratio[n] * 50.0 == pytest.approx(module["omega2"], rel=1e-12)
    moving = slice(1, None)
    power_out = chart.output_torque * chart.speed_ratio
    assert np.allclose(power_out[moving], chart.efficiency[moving] * chart.input_torque[moving], rtol=1e-14)
    if not backward:
        assert chart.end_ratio == 1.0
        assert chart.lock_up_torque[0] > chart.output_torque[-1] > 0.0
        machine = SteadyMachine(settings)
        assert machine.ideal
        assert machine.lock_up_torque(70.0) == pytest.approx(4900.0 * chart.lock_up_torque[0], rel=1e-3)


def test_chart_saved_is_the_chart_read_and_its_numbers_have_units(tmp_path):
    chart = compute_chart({})
    columns, units = read_columns(chart.save(tmp_path / "chart.csv"))
    assert columns == {name: values.tolist() for name, values in vars(chart).items() if values is not None}
    assert not [name for name in columns if "engagements" in name]
    assert units["output_torque"] == "N.m.s2"
    assert "efficiency" not in units
    assert chart.units()["stall_torque"] == "N.m.s2"
    assert chart.units(50.0)["stall_torque"] == "N.m"
    assert chart.units()["end_ratio"] == ""
    assert chart.summary(50.0)["stall_torque"] == pytest.approx(2500.0 * chart.stall_torque)
    assert chart.summary(50.0)["end_ratio"] == chart.end_ratio


@pytest.mark.parametrize("losses", [{}, {"input_friction": 0.01}], ids=["ideal", "losses"])
def test_each_freewheel_of_a_planar_module_engages_once_a_turn_of_the_drive(losses):
    chart = compute_chart({**PLANAR, **losses}, 80.0, engagements=True)
    expected = (1.0 - chart.link2_ratio) * PLANAR["sun_radius"] / PLANAR["satellite_radius"]
    measured = np.flatnonzero(np.isin(chart.speed_ratio, RATIOS))
    assert measured.size > 1
    for engagements in (chart.housing_engagements, chart.output_engagements):
        # Near lock-up the map of the mean speed of link 2 is coarse.
        assert engagements[measured] == pytest.approx(expected[measured], abs=4e-3)
    assert chart.summary()["output_engagements_maximum"] == pytest.approx(5.0 / 3.0, rel=1e-6)
    at_speed = chart.summary(80.0, {"housing": 10.0, "output": 60.0})
    assert at_speed["output_engagements_maximum"] == pytest.approx(80.0 / math.tau * 5.0 / 3.0, rel=1e-6)
    # At this speed the housing freewheel engages ten times a second at stall.
    assert at_speed["indexing_speed"] == pytest.approx(10.0 * math.tau * 0.6, rel=1e-6)
    assert {name: chart.units(80.0)[name] for name in list(at_speed)[-3:]} == {
        "housing_engagements_maximum": "Hz",
        "output_engagements_maximum": "Hz",
        "indexing_speed": "rad/s",
    }


def test_freewheels_of_a_chart_engage_as_often_as_in_a_run_with_a_heavy_shaft(compiled):
    chart = compute_chart({}, 100.0, engagements=True)
    for ratio in RATIOS[[3, 10, 20]]:
        module = started(compiled, {}, omega1=100.0, omega_out_start=100.0 * ratio, output_inertia=1e5)
        module.advance(1.0)
        counts = [f"{name}_engagements" for name in ("housing", "output")]
        before = np.array(module.read(counts))
        module.advance(20.0)
        row = int(np.argmin(np.abs(chart.speed_ratio - ratio)))
        expected = np.array([getattr(chart, name)[row] for name in counts])
        assert np.subtract(module.read(counts), before) / (2000.0 / math.tau) == pytest.approx(
            expected, rel=0.03
        )


def test_mechanism_accepts_names_and_units():
    named = compute_chart({"layout": "planar", "sun_radius": "60 mm", "imbalance_mass": "800 g"})
    numbers = compute_chart({"layout": 1, "sun_radius": 0.06, "imbalance_mass": 0.8})
    assert np.array_equal(named.output_torque, numbers.output_torque)
    for bad in ({"layout": "flat"}, {"sun_radius": "60 kg"}, {"sun_radius": None}, {"satellites": [3]}):
        assert_rejected(f"^{next(iter(bad))} must be .* \\(got ", compute_chart, bad)


@pytest.mark.parametrize("name, values", [("housing_freewheel", "0 and 1"), ("output_freewheel", "1 and 0")])
def test_without_a_freewheel_there_is_no_chart(name, values):
    for losses in ({}, {"input_friction": 0.1}):
        with pytest.raises(
            InertiaModuleError, match=f"must be 1 .got {values}.: without both freewheels there is no"
        ):
            compute_chart({name: 0, **losses})


# --- converter tables ---


def table_of(parameters, omega1):
    chart = compute_chart(parameters, omega1)
    return SimpleNamespace(**converter_table(SteadyMachine(parameters), chart, omega1))


def block(table, omega1, speed_ratio):
    """Return input and output torque of a lookup block with this table."""
    k = np.interp(speed_ratio, table.speed_ratio, table.capacity_factor)
    input_torque = (omega1 / k) ** 2
    return input_torque, np.interp(speed_ratio, table.speed_ratio, table.torque_ratio) * input_torque


@pytest.mark.parametrize(
    "parameters, omega1",
    [({}, 30.0), ({}, -50.0), (PLANAR, 314.0), (LOSSY, 314.0), (LOSSY, -50.0)],
    ids=["bevel", "bevel, backward", "planar", "losses", "losses, backward"],
)
def test_table_is_finite_and_gives_the_torques_of_the_chart(parameters, omega1):
    table = table_of(parameters, omega1)
    assert all(np.isfinite(values).all() for values in vars(table).values())
    assert (np.diff(table.speed_ratio) > 0.0).all()
    assert table.speed_ratio[0] == 0.0
    assert table.torque_ratio.max() <= MAX_TORQUE_RATIO * (1.0 + 1e-12)
    input_torque, output_torque = block(table, omega1, table.speed_ratio)
    assert output_torque == pytest.approx(table.output_torque, rel=1e-12, abs=1e-12)
    limited = table.torque_ratio > MAX_TORQUE_RATIO * (1.0 - 1e-9)
    # The capacity factor has no sign. The column of the input torque shows that the shaft drives link 1.
    expected, floor = np.maximum(table.input_torque, 0.0), 1e-4 * table.input_torque.max()
    assert input_torque[~limited] == pytest.approx(expected[~limited], rel=1e-9, abs=1.01 * floor)
    assert (input_torque[limited] >= table.input_torque[limited] * (1.0 - 1e-9)).all()


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_between_its_rows_a_block_has_the_torque_of_the_module(compiled, mechanism):
    settings = MECHANISMS[mechanism]
    table = table_of(settings, 100.0)
    for ratio in (0.0, 0.0525, 0.3333, 0.721):
        module = started(compiled, settings, fidelity=1, omega1=100.0, omega_out_start=100.0 * ratio)
        input_torque, output_torque = block(table, 100.0, ratio)
        assert output_torque == pytest.approx(module["output_torque"], rel=5e-3)
        if ratio > 0.04:
            assert input_torque == pytest.approx(ratio * module["output_torque"], rel=5e-3)


def test_coasting_torque_is_zero_without_losses():
    ideal, lossy = (table_of(parameters, 100.0) for parameters in (PLANAR, LOSSY))
    coast = ideal.speed_ratio > 1.0
    assert coast.sum() == 5
    assert not ideal.output_torque[coast].any()
    assert not ideal.input_torque[coast].any()
    # The rigid module also transmits no mean torque if its shaft is driven from outside.
    braked, taken = SteadyMachine(PLANAR).coasting(100.0, 1.5)
    assert abs(braked) + abs(taken) < 1e-2 * ideal.output_torque.max()
    coast = lossy.speed_ratio > 1.0
    ahead = 100.0 * (lossy.speed_ratio[coast] - 1.0)
    # Link 2 rotates at the speed of link 1.
    drag = LOSSES["output_drag"] + LOSSES["output_drag_viscous"] * ahead
    shaft = LOSSES["output_friction"] * 100.0 * lossy.speed_ratio[coast]
    assert lossy.output_torque[coast] == pytest.approx(-(drag + shaft), rel=1e-3)
    assert lossy.input_torque[coast] == pytest.approx(LOSSES["input_friction"] * 100.0 - drag, abs=0.02)


@pytest.mark.parametrize(
    "parameters, omega1", [(PLANAR, 100.0), (LOSSY, 100.0), ({**PLANAR, "output_drag": 1.0}, 60.0)]
)
def test_vecto_table_has_the_torques_of_the_chart(tmp_path, parameters, omega1):
    table = vars(table_of(parameters, omega1))
    rows = list(csv.reader(save_converter(table, omega1, tmp_path / "x")[2].open()))
    assert rows.pop(0) == ["Speed Ratio", "Torque Ratio", "Input Torque at reference rpm"]
    ratio, torque_ratio, reference = np.array(rows, dtype=float).T
    assert ratio.tolist() == table["speed_ratio"].tolist()
    assert torque_ratio * reference == pytest.approx(table["output_torque"], rel=1e-12, abs=1e-12)
    assert np.abs(torque_ratio).max() <= MAX_TORQUE_RATIO * (1.0 + 1e-12)
    limited = np.abs(torque_ratio) > MAX_TORQUE_RATIO * (1.0 - 1e-9)
    floor = 1.01e-4 * table["input_torque"].max()
    assert reference[~limited] == pytest.approx(table["input_torque"][~limited], rel=1e-9, abs=floor)
    assert (reference[-1] < 0.0) == ("output_drag" in parameters)


def test_mechanism_without_torque_is_rejected():
    chart = compute_chart({})
    none = {name: 0.0 * values for name, values in vars(chart).items() if values is not None}
    words = "a converter table requires torque; the mechanism transmits none at 100 rad/s"
    assert_rejected(words, converter_table, SteadyMachine({}), TorqueConverterChart(**none), 100.0)


# --- steady pulses: closed forms with friction (test_averaged_map.py tests them without losses) ---


@pytest.mark.parametrize("omega1, ratio", [(60.0, 0.0), (60.0, 0.7), (-60.0, 0.2)])
def test_friction_of_input_and_output_reduces_the_torques(omega1, ratio):
    """Friction does not change the pulses: b1 omega1^2 and b3 omega3^2 add to the ideal powers."""
    b1, b3 = 0.01, 0.02
    ideal = SteadyMachine(PLANAR).at(omega1, ratio)
    with_friction = {**PLANAR, "input_friction": b1, "output_friction": b3}
    means = SteadyMachine(with_friction).at(omega1, ratio)
    shaft = ratio * abs(omega1)
    assert means.output_torque == pytest.approx(ideal.output_torque - b3 * shaft, rel=1e-5)
    assert means.input_torque == pytest.approx(ideal.input_torque + b1 * abs(omega1), rel=1e-5)
    power = ideal.output_torque * shaft
    expected = (power - b3 * shaft**2) / (power + b1 * omega1**2)
    assert means.efficiency == pytest.approx(max(expected, 0.0), abs=1e-5)


def test_friction_of_link_2_and_the_output_reduces_the_lock_up_torque():
    ideal = SteadyMachine(PLANAR).lock_up_torque(60.0)
    rubbed = SteadyMachine({**PLANAR, "link2_friction": 0.01, "output_friction": 0.02})
    assert rubbed.lock_up_torque(60.0) == pytest.approx(ideal - 0.03 * 60.0, rel=1e-9)


def test_chart_ends_at_zero_output_torque_and_efficiency():
    # The bevel layout transmits little torque at higher ratios.
    parameters = {"satellites": 3, "imbalance_mass": 0.3, "output_friction": 0.02}
    chart = compute_chart(parameters, omega1=50.0)
    assert not chart.lossless
    assert chart.end_ratio < 0.9
    assert chart.output_torque[-1] > 0.0
    assert chart.lock_up_torque[0] == 0.0
    assert all(np.isfinite(values).all() for values in vars(chart).values())
    assert SteadyMachine(parameters).at(50.0, 0.9).efficiency == 0.0


SPEEDS, FEW = MAP_SPEEDS[[0, 3, 7]], RATIOS[::2]


@pytest.fixture
def small_maps(monkeypatch):
    """Reduce the maps to three speeds and every second ratio."""
    monkeypatch.setattr("inertia_module.analysis.chart_files.MAP_SPEEDS", SPEEDS)
    for name in ("chart_files", "converter_chart"):
        monkeypatch.setattr(f"inertia_module.analysis.{name}.RATIOS", FEW)


@pytest.mark.usefixtures("small_maps")
def test_map_depends_on_speed_with_viscous_friction_and_agrees_with_the_chart():
    fractions = []
    parameters = {**PLANAR, "input_friction": 0.01}
    speed_map = steady_map(SteadyMachine(parameters), 200.0, fractions.append)
    efficiency = speed_map["efficiency"]
    assert efficiency.shape == (speed_map["omega1"].size, FEW.size)
    assert speed_map["omega1"][[0, -1]] == pytest.approx([20.0, 200.0])
    assert fractions[-1] == 1.0
    middle = efficiency[:, 7]
    assert (np.diff(middle) > 0.0).all()
    # Torques scale with the square of the speed, so the loss is b1 over a torque times the speed.
    assert 1.0 / middle - 1.0 == pytest.approx(
        (1.0 / middle[0] - 1.0) * speed_map["omega1"][0] / speed_map["omega1"], rel=1e-4
    )
    chart = compute_chart(parameters, omega1=200.0)
    assert chart.speed_ratio == pytest.approx(speed_map["speed_ratio"])
    assert chart.efficiency == pytest.approx(efficiency[-1], abs=1e-6)
    assert chart.efficiency.max() < 1.0
    lossy = chart_figure({"rubbed": chart}).axes
    assert len(lossy) == 7
    assert [axes.get_ylim() for axes in lossy if axes.get_ylabel() == "efficiency [%]"] == [(0.0, 100.0)]
    axes = chart_figure({"rubbed": chart}, {"map": speed_map}, "rpm").axes
    panel = next(axis for axis in axes if axis.get_title(loc="left") == "efficiency of map")
    assert panel.get_ylabel() == "input speed [rpm]"
    assert panel.get_ylim()[1] == pytest.approx(200.0 * 30.0 / math.pi)


@pytest.mark.usefixtures("small_maps")
def test_row_of_the_map_agrees_with_a_rigid_run(compiled, tmp_path):
    """The flywheel gives the torque, the energies give input torque and loss, and samples give the ripple."""
    speed_map = steady_map(SteadyMachine(LOSSY), 200.0, lambda _: None)
    rows = read_columns(save_map(speed_map, tmp_path / "map", "rpm")[0])[0]
    omega1, inertia, step = 200.0, 1e5, 1e-4
    names = ("output_torque", "drive_angle", "drive_turns", "omega_out", "energy_in", "energy_lost")
    for ratio in FEW[[4, 7, 10]]:
        point = {"omega1": omega1, "omega_out_start": ratio * omega1, "output_inertia": inertia}
        module = started(compiled, LOSSY, **point)
        module.advance(0.5)
        samples = []
        for _ in range(10_000):
            module.advance(step)
            samples.append(module.read(names))
        torque, angle, turns, *sums = np.array(samples).T
        # Use whole turns of the drive, after which the imbalances have the same speed again.
        turns_done = angle / math.tau + turns - turns[0] - angle[0] / math.tau
        end = int(np.argmin(np.abs(turns_done - np.floor(turns_done[-1]))))
        acceleration, input_power, lost_power = ((values[end] - values[0]) / (end * step) for values in sums)
        row = int(np.flatnonzero(np.isclose(rows["speed_ratio"], ratio))[-1])
        map_row = {name: values[row] for name, values in rows.items()}
        assert map_row["omega1"] == pytest.approx(omega1 * 30.0 / math.pi)
        assert map_row["output_torque"] == pytest.approx(inertia * acceleration, rel=5e-3)
        assert map_row["input_torque"] == pytest.approx(input_power / omega1, rel=5e-3)
        assert map_row["loss"] == pytest.approx(lost_power, rel=5e-3)
        assert map_row["ripple"] == pytest.approx(np.std(torque[:end]), rel=5e-3)
        power_out = ratio * omega1 * map_row["output_torque"]
        assert map_row["loss"] == pytest.approx(map_row["input_torque"] * omega1 - power_out, rel=1e-3)
        assert map_row["efficiency"] == pytest.approx(
            power_out / (omega1 * map_row["input_torque"]), abs=1e-5
        )


def test_a_long_period_is_cut_off():
    long, short = ({"z17": z17, "z6": 200, "input_friction": 0.01} for z17 in (341, 340))
    torques = [SteadyMachine(one).at(100.0, 0.3).output_torque for one in (long, short)]
    assert torques[0] == pytest.approx(torques[1], rel=0.05)


@pytest.mark.parametrize("satellites", [1.0, 3.0])
def test_force_on_bearing_and_mount_with_link_2_held(satellites):
    lengths = {"sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04, "imbalance_mass": 0.3}
    machine = SteadyMachine({"layout": "planar", **lengths, "satellites": satellites})
    # The satellite orbits at omega1 and rotates at (1 + R0/r) omega1: its accelerations align once per turn.
    expected = 0.3 * 100.0**2 * (0.16 + (1.0 + 0.1 / 0.06) ** 2 * 0.04)
    assert machine.at(100.0, 0.0).bearing_force == pytest.approx(expected, rel=1e-9)
    # Three satellites balance each other.
    force, moment = (
        np.linalg.norm(machine.samples([f"shaking_{load}_{axis}" for axis in "xyz"], 100.0, 0.0), axis=1)
        for load in ("force", "moment")
    )
    assert force.max() == pytest.approx(expected if satellites == 1.0 else 0.0, rel=2e-3, abs=1e-6)
    assert moment.max() > 100.0


# --- the command ---


@pytest.mark.parametrize(
    "speed, speed_text", [("3000", "3000 rad/s (28648 rpm)"), ("3000 rpm", "(3000 rpm)")]
)
def test_command_prints_the_speed_and_writes_finite_torques_and_a_converter_table(
    speed, speed_text, tmp_path
):
    done = succeeded("chart", "examples/planar.toml", "--speed", speed, "-o", tmp_path)
    assert speed_text in done.output
    warned = "warning: --speed 3000 has no unit; rad/s is used: 3000 rad/s" in done.stderr
    assert warned == (speed == "3000")
    omega1 = 3000.0 if warned else 100.0 * math.pi
    columns, _ = read_columns(tmp_path / "planar.csv")
    stall = columns["output_torque"][0] * omega1**2
    assert f"{stall:.6g} N·m " in done.output
    rows = list(csv.DictReader((tmp_path / "planar_converter.csv").open()))
    assert float(rows[0]["output_torque [N.m]"]) == pytest.approx(stall, rel=1e-12)
    read = loadmat(tmp_path / "planar_converter.mat", simplify_cells=True)["converter"]
    assert read["omega1"] == pytest.approx(omega1)
    assert read["units"]["capacity_factor"] == "rad/s/(N.m)^0.5"
    for name in ("speed_ratio", "torque_ratio"):
        assert read[name].tolist() == [float(row[name]) for row in rows]
    files = sorted(tmp_path.glob("*.csv"))
    assert [file.stem for file in files] == ["planar", "planar_converter"]
    for file in files:
        cells = [cell for row in list(csv.reader(file.open()))[1:] for cell in row]
        assert all(math.isfinite(float(cell)) for cell in cells), file.name


def test_command_draws_engagements_and_prints_the_speed_limit_of_freewheels(tmp_path):
    limits = ("freewheels.indexing_frequency=60 Hz", "freewheels.output.indexing_frequency=10 Hz")
    options = [word for limit in limits for word in ("--set", limit)]
    printed = json.loads(stdout_of("chart", "examples/planar.toml", *options, "-o", tmp_path, "--json"))
    assert printed["charts"]["planar"]["indexing_speed"] == pytest.approx(10.0 * math.tau * 0.6, rel=1e-6)
    assert printed["units"]["planar"]["output_engagements_maximum"] == "1/rev"
    columns, units = read_columns(tmp_path / "planar.csv")
    assert columns["output_engagements"][0] == pytest.approx(5.0 / 3.0, rel=1e-6)
    assert units["housing_engagements"] == "1/rev"
    chart = compute_chart(PLANAR, engagements=True)
    engaged = chart_figure({"planar": chart}, allowed={"planar": 0.6}).axes[4]
    assert [line.get_linestyle() for line in engaged.lines] == ["-", "--", ":"]
    assert engaged.lines[2].get_ydata()[0] == pytest.approx(0.6 * NOMINAL_SPEED / math.tau)


def test_at_a_speed_the_figure_has_torques_and_frequencies():
    chart = compute_chart(PLANAR, engagements=True)
    any_speed = chart_figure({"planar": chart}, allowed={"planar": 0.6}).axes
    one_speed = chart_figure({"planar": chart}, {}, "rpm", {"planar": 0.6}, 50.0 * math.pi)
    assert one_speed.get_suptitle() == "Torque converter chart at 1500 rpm"
    labels = [axes.get_ylabel() for axes in one_speed.axes]
    torque = "torque [N·m]"
    assert labels == ["output torque / input torque", torque, torque, "ripple", "frequency [Hz]", torque]
    factor = 50.0 * math.pi / NOMINAL_SPEED
    factors = (1.0, factor**2, factor**2, 1.0, factor, factor**2)
    for before, after, factor in zip(any_speed, one_speed.axes, factors, strict=True):
        for line, other in zip(before.lines, after.lines, strict=True):
            assert other.get_ydata() == pytest.approx(factor * np.asarray(line.get_ydata()))


def test_chart_with_losses_and_lock_up_ends_at_ratio_1():
    chart = compute_chart({**PLANAR, "output_friction": 1e-4}, 100.0)
    assert chart.lock_up_torque[0] > 0.0
    assert chart.summary()["end_ratio"] == 1.0


@pytest.mark.usefixtures("small_maps")
def test_command_compares_scenes_and_draws_a_map_of_a_machine_with_losses_only(tmp_path):
    planar, scene = Path("examples/planar.toml"), tmp_path / "rubbed.toml"
    scene.write_text(planar.read_text().replace("[mechanism]", "[mechanism]\ninput_friction = 0.005"))
    printed = json.loads(stdout_of("chart", scene, planar, "-o", tmp_path / "out", "--json"))["charts"]
    assert printed["planar"]["efficiency_maximum"] == 1.0
    assert 0.5 < printed["rubbed"]["efficiency_maximum"] < 1.0
    for name, numbers in printed.items():
        columns, _ = read_columns(tmp_path / "out" / f"{name}.csv")
        assert columns["output_torque"][0] == numbers["stall_torque"] > 0.0
    columns, units = read_columns(tmp_path / "out" / "rubbed_map.csv")
    assert list(columns) == ["omega1", "speed_ratio", *MAP_COLUMNS]
    assert units == {"omega1": "rad/s", **{name: UNITS[name] for name in MAP_COLUMNS if name != "efficiency"}}
    assert not list((tmp_path / "out").glob("*map_*"))
    assert not (tmp_path / "out" / "planar_map.csv").exists()
    assert (tmp_path / "out" / "chart.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("small_maps")
def test_command_writes_the_map_long_wide_and_for_matlab(tmp_path):
    printed = stdout_of("chart", "examples/planar.toml", "--map", "--speed", "1500 rpm", "-o", tmp_path)
    assert "1500 rpm), the reference speed of the converter tables" in printed
    long, units = read_columns(tmp_path / "planar_map.csv")
    read = loadmat(tmp_path / "planar_map.mat", simplify_cells=True)["map"]
    assert units["omega1"] == read["units"]["omega1"] == "rpm"
    assert read["omega1"] == pytest.approx(1500.0 * SPEEDS, rel=1e-12)
    assert set(long["efficiency"]) == {1.0}
    assert not any(long["loss"])
    for name in MAP_COLUMNS:
        unit = UNITS.get(name)
        wide, units = read_columns(tmp_path / f"planar_map_{name}.csv")
        assert set(units.values()) == ({unit} if unit else set())
        assert list(wide)[1:] == [f"{name} at {speed:.6g} rpm" for speed in read["omega1"]]
        assert wide.pop("speed_ratio") == read["speed_ratio"].tolist() == long["speed_ratio"][: FEW.size]
        assert list(wide.values()) == read[name].tolist()
        assert read[name].ravel().tolist() == long[name]
        assert read["units"][name] == (unit or "1")
    assert (tmp_path / "planar_converter.vtcc").exists()
