"""Torque converter charts: made, saved, read, compared."""

import json

import numpy as np
import pytest
from scenes import PLANAR, started
from typer.testing import CliRunner

from inertia_module.chart import TorqueConverterChart, torque_converter_chart
from inertia_module.cli import app
from inertia_module.module import Refused
from inertia_module.results import TableError

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
    assert np.isinf(chart.torque_ratio[0])
    power_out = chart.output_torque * chart.speed_ratio
    assert np.allclose(power_out[moving], chart.efficiency[moving] * chart.input_torque[moving], rtol=1e-14)
    assert np.allclose(chart.torque_ratio[moving] * chart.speed_ratio[moving], chart.efficiency[moving])
    assert chart.end_ratio == 1.0
    assert chart.lock_up_torque[0] > chart.output_torque[-1] > 0.0


def test_chart_saved_is_the_chart_read(compiled, tmp_path):
    chart = torque_converter_chart({}, kernel=compiled)
    read = TorqueConverterChart.load(chart.save(tmp_path / "chart.csv"))
    for name, values in vars(chart).items():
        assert np.array_equal(getattr(read, name), values), name


def test_a_file_that_is_no_chart_is_refused(tmp_path):
    with pytest.raises(TableError, match="allowed is a saved chart"):
        TorqueConverterChart.load(tmp_path / "none.csv")
    other = tmp_path / "other.csv"
    other.write_text("time,x\n0,1\n")
    with pytest.raises(TableError, match="allowed is a chart with the columns speed_ratio"):
        TorqueConverterChart.load(other)


def test_a_mechanism_may_be_given_by_names_and_units(compiled):
    named = torque_converter_chart({"layout": "planar", "sun_radius": "60 mm", "imbalance_mass": "800 g"})
    numbers = torque_converter_chart(
        {"layout": 1, "sun_radius": 0.06, "imbalance_mass": 0.8}, kernel=compiled
    )
    assert np.array_equal(named.output_torque, numbers.output_torque)
    for bad in ({"layout": "flat"}, {"sun_radius": "60 kg"}, {"sun_radius": None}, {"satellites": [3]}):
        with pytest.raises(Refused, match=f"^{next(iter(bad))} = .* is refused: allowed is"):
            torque_converter_chart(bad)


def test_without_a_freewheel_there_is_no_chart(compiled):
    with pytest.raises(Refused, match="output_freewheel = 0"):
        torque_converter_chart({"output_freewheel": 0}, kernel=compiled)


def test_command_compares_scenes(compiled, tmp_path):
    assert compiled
    arguments = ["chart", "examples/urban.toml", "examples/planar.toml", "-o", str(tmp_path), "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    told = json.loads(done.output)
    assert set(told["charts"]) == {"urban", "planar"}
    for name, numbers in told["charts"].items():
        read = TorqueConverterChart.load(tmp_path / f"{name}.csv")
        assert read.stall_torque == numbers["stall_torque"] > 0.0
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")
