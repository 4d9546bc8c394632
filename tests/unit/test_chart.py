"""Torque converter charts: made, saved, read, compared."""

import csv
import json
import math

import numpy as np
import pytest
from scenes import PLANAR, started
from scipy.io import loadmat
from typer.testing import CliRunner

from inertia_module.cli import app
from inertia_module.harness.chart import torque_converter_chart
from inertia_module.harness.results import read_columns
from inertia_module.memory import Refused

PLANAR_MECHANISM = {name: value for name, value in PLANAR.items() if name not in ("omega1", "load_torque")}
MECHANISMS = {"bevel": {}, "planar": PLANAR_MECHANISM}


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("backward", [False, True])
def test_chart_tells_the_torque_of_the_averaged_module(compiled, mechanism, backward):
    settings = MECHANISMS[mechanism]
    chart = torque_converter_chart(settings, backward, compiled)
    omega1 = -50.0 if backward else 50.0
    for n in (0, 30, 77, 150):
        speed = 50.0 * chart.speed_ratio[n]
        module = started(compiled, settings, fidelity=1, omega1=omega1, omega_out_start=speed)
        assert chart.output_torque[n] * 2500.0 == pytest.approx(module["output_torque"], rel=1e-12)
        assert chart.peak[n] * 2500.0 == pytest.approx(module["torque_peak"], rel=1e-12)
        assert chart.link2_ratio[n] * 50.0 == pytest.approx(module["omega2"], rel=1e-12)


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_an_ideal_module_loses_no_power_at_any_ratio(compiled, mechanism):
    chart = torque_converter_chart(MECHANISMS[mechanism], kernel=compiled)
    moving = slice(1, None)
    power_out = chart.output_torque * chart.speed_ratio
    assert np.allclose(power_out[moving], chart.efficiency[moving] * chart.input_torque[moving], rtol=1e-14)
    assert chart.end_ratio == 1.0
    assert chart.lock_up_torque[0] > chart.output_torque[-1] > 0.0


def test_chart_saved_is_the_chart_read(compiled, tmp_path):
    chart = torque_converter_chart({}, kernel=compiled)
    columns, units = read_columns(chart.save(tmp_path / "chart.csv"))
    assert columns == {name: values.tolist() for name, values in vars(chart).items()}
    assert units["output_torque"] == "N.m.s2"
    assert "efficiency" not in units


def test_numbers_of_a_chart_have_units(compiled):
    chart = torque_converter_chart({}, kernel=compiled)
    assert chart.units()["stall_torque"] == "N.m.s2"
    assert chart.units(50.0)["stall_torque"] == "N.m"
    assert chart.units()["end_ratio"] == ""
    assert chart.summary(50.0)["stall_torque"] == pytest.approx(2500.0 * chart.stall_torque)
    assert chart.summary(50.0)["end_ratio"] == chart.end_ratio


def test_a_mechanism_may_be_given_by_names_and_units(compiled):
    named = torque_converter_chart({"layout": "planar", "sun_radius": "60 mm", "imbalance_mass": "800 g"})
    numbers = torque_converter_chart(
        {"layout": 1, "sun_radius": 0.06, "imbalance_mass": 0.8}, kernel=compiled
    )
    assert np.array_equal(named.output_torque, numbers.output_torque)
    for bad in ({"layout": "flat"}, {"sun_radius": "60 kg"}, {"sun_radius": None}, {"satellites": [3]}):
        with pytest.raises(Refused, match=f"^{next(iter(bad))} must be .*, is "):
            torque_converter_chart(bad)


def test_without_a_freewheel_there_is_no_chart(compiled):
    with pytest.raises(Refused, match="output_freewheel must both be 1, are 1 and 0"):
        torque_converter_chart({"output_freewheel": 0}, kernel=compiled)


def test_command_compares_scenes(compiled, tmp_path):
    assert compiled
    arguments = ["chart", "examples/urban.toml", "examples/planar.toml", "-o", str(tmp_path), "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    told = json.loads(done.output)
    assert set(told["charts"]) == {"urban", "planar"}
    for name, numbers in told["charts"].items():
        columns, _ = read_columns(tmp_path / f"{name}.csv")
        assert columns["output_torque"][0] == numbers["stall_torque"] > 0.0
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")


def test_command_gives_torques_and_a_converter_table_at_a_speed(compiled, tmp_path):
    assert compiled
    arguments = ["chart", "examples/planar.toml", "--speed", "3000 rpm", "-o", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    columns, _ = read_columns(tmp_path / "planar.csv")
    stall = columns["output_torque"][0] * (100.0 * math.pi) ** 2
    assert f"{stall:.6g} N.m " in done.output
    rows = list(csv.DictReader((tmp_path / "planar_converter.csv").open()))
    assert float(rows[0]["output_torque [N.m]"]) == pytest.approx(stall, rel=1e-12)
    read = loadmat(tmp_path / "planar_converter.mat", simplify_cells=True)["converter"]
    assert read["omega1"] == pytest.approx(100.0 * math.pi)
    assert read["units"]["capacity_factor"] == "rad/s/(N.m)^0.5"
    for name in ("speed_ratio", "torque_ratio"):
        assert read[name].tolist() == [float(row[name]) for row in rows]


@pytest.mark.parametrize("speed, told", [("3000", "3000 rad/s (28648 rpm)"), ("3000 rpm", "(3000 rpm)")])
def test_command_tells_the_speed_it_has_understood(speed, told, compiled, tmp_path):
    assert compiled
    done = CliRunner().invoke(app, ["chart", "examples/planar.toml", "--speed", speed, "-o", str(tmp_path)])
    assert told in done.stdout
    assert ("warning: --speed 3000 has no unit, is taken as 3000 rad/s" in done.stderr) == (speed == "3000")


def test_no_file_of_a_chart_holds_what_is_not_finite(compiled, tmp_path):
    assert compiled
    CliRunner().invoke(app, ["chart", "examples/urban.toml", "--speed", "100", "-o", str(tmp_path)])
    files = sorted(tmp_path.glob("*.csv"))
    assert [file.stem for file in files] == ["urban", "urban_converter"]
    for file in files:
        cells = [cell for row in list(csv.reader(file.open()))[1:] for cell in row]
        assert all(math.isfinite(float(cell)) for cell in cells), file.name


@pytest.mark.parametrize("speed", ["0", "fast", "10 N.m", "1e9 rad/s", "nan"])
def test_command_refuses_a_speed_that_is_none(speed, tmp_path):
    done = CliRunner().invoke(
        app, ["chart", "examples/planar.toml", "--speed", speed, "-o", str(tmp_path / "x")]
    )
    assert done.exit_code == 1
    assert "--speed must be a speed up to 1e+06 rad/s" in done.output
    assert repr(speed) in done.output
    assert not (tmp_path / "x").exists()
