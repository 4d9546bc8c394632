"""Steady pulses at a speed ratio: the map of averaged without losses, closed forms with friction."""

import json
import math

import numpy as np
import pytest
from scenes import PLANAR
from typer.testing import CliRunner

from inertia_module.cli import app
from inertia_module.figures.chart import chart_figure
from inertia_module.harness.chart import RATIOS, efficiency_map, torque_converter_chart
from inertia_module.harness.steady import SteadyMachine

PLANAR_MECHANISM = {name: value for name, value in PLANAR.items() if name not in ("omega1", "load_torque")}
MECHANISMS = {"bevel": {}, "planar": PLANAR_MECHANISM}
FRICTION = """
[mechanism]
layout = "planar"
satellites = 3
input_friction = 0.005
[drive]
kind = "constant"
omega1 = 100
[load]
kind = "torque"
torque = 1
[run]
stop_time = 1
communication_step = 0.1
"""


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize("omega1", [100.0, -30.0])
def test_without_losses_they_are_those_of_the_map_and_lock_up_too(compiled, mechanism, omega1):
    parameters = MECHANISMS[mechanism]
    machine = SteadyMachine(parameters, compiled)
    chart = torque_converter_chart(parameters, omega1 < 0.0, compiled)
    assert machine.ideal
    stall = chart.stall_torque * omega1**2
    for ratio in (0.0, 0.1, 0.4, 0.9):
        found = machine.at(omega1, ratio)
        torque, taken, link2, ripple = (
            float(np.interp(ratio, chart.speed_ratio, values))
            for values in (chart.output_torque, chart.input_torque, chart.link2_ratio, chart.ripple)
        )
        assert found.output_torque == pytest.approx(torque * omega1**2, abs=5e-3 * stall)
        assert found.input_torque == pytest.approx(taken * omega1**2, abs=5e-3 * stall)
        assert found.link2_ratio == pytest.approx(link2, abs=2e-3)
        assert found.ripple == pytest.approx(ripple * omega1**2, abs=5e-3 * stall)
        assert found.efficiency == 1.0
    if omega1 > 0.0:
        assert machine.lock_up_torque(70.0) == pytest.approx(4900.0 * chart.lock_up_torque[0], rel=1e-3)


@pytest.mark.parametrize("omega1, ratio", [(60.0, 0.0), (60.0, 0.7), (-60.0, 0.2)])
def test_friction_of_input_and_output_take_what_they_must(compiled, omega1, ratio):
    """Neither touches the pulses: b1 omega1^2 and b3 omega3^2 come on top of the ideal machine's powers."""
    b1, b3 = 0.01, 0.02
    ideal = SteadyMachine(PLANAR_MECHANISM, compiled).at(omega1, ratio)
    rubbed = {**PLANAR_MECHANISM, "input_friction": b1, "output_friction": b3}
    found = SteadyMachine(rubbed, compiled).at(omega1, ratio)
    shaft = ratio * abs(omega1)
    assert found.output_torque == pytest.approx(ideal.output_torque - b3 * shaft, rel=1e-5)
    assert found.input_torque == pytest.approx(ideal.input_torque + b1 * abs(omega1), rel=1e-5)
    power = ideal.output_torque * shaft
    expected = (power - b3 * shaft**2) / (power + b1 * omega1**2)
    assert found.efficiency == pytest.approx(max(expected, 0.0), abs=1e-5)


def test_friction_of_the_drives_takes_the_mean_square_of_their_speed(compiled):
    """At stall link 2 pulses against the housing; what goes in is lost, and it is b_q q'^2 at least."""
    found = SteadyMachine({**PLANAR_MECHANISM, "drive_friction": 0.003}, compiled).at(100.0, 0.0)
    k = PLANAR["sun_radius"] / PLANAR["satellite_radius"]
    mean = (k * 100.0 * (1.0 - found.link2_ratio)) ** 2
    assert found.efficiency == pytest.approx(0.0, abs=1e-5)
    assert found.input_torque * 100.0 == pytest.approx(0.003 * mean, rel=1e-4)


def test_where_nothing_comes_out_the_efficiency_is_zero_and_the_chart_ends(compiled):
    # the bevel one passes little torque at higher ratios
    parameters = {"satellites": 3, "imbalance_mass": 0.3, "output_friction": 0.02}
    chart = torque_converter_chart(parameters, kernel=compiled, omega1=50.0)
    assert not chart.lossless
    assert chart.end_ratio < 0.9
    assert chart.output_torque[-1] > 0.0
    assert chart.lock_up_torque[0] == 0.0
    assert all(np.isfinite(values).all() for values in vars(chart).values())
    assert SteadyMachine(parameters, compiled).at(50.0, 0.9).efficiency == 0.0


def test_map_has_more_efficiency_at_speed_where_friction_is_viscous_and_agrees_with_the_chart(compiled):
    told = []
    parameters = {**PLANAR_MECHANISM, "input_friction": 0.01}
    found = efficiency_map(parameters, 200.0, compiled, told.append)
    assert found.efficiency.shape == (found.omega1.size, RATIOS.size)
    assert found.omega1[[0, -1]] == pytest.approx([20.0, 200.0])
    assert told[-1] == 1.0
    middle = found.efficiency[:, 14]
    assert (np.diff(middle) > 0.0).all()
    # torques go with the square of the speed, so the loss is b1 over a torque times the speed
    assert 1.0 / middle - 1.0 == pytest.approx(
        (1.0 / middle[0] - 1.0) * found.omega1[0] / found.omega1, rel=1e-4
    )
    chart = torque_converter_chart(parameters, kernel=compiled, omega1=200.0)
    assert chart.speed_ratio == pytest.approx(found.speed_ratio)
    assert chart.efficiency == pytest.approx(found.efficiency[-1], abs=1e-6)
    assert chart.efficiency.max() < 1.0
    assert len(chart_figure({"rubbed": chart}).axes) == 4
    titles = [axes.get_title(loc="left") for axes in chart_figure({"rubbed": chart}, {"map": found}).axes]
    assert "efficiency of map" in titles


def test_a_long_period_is_cut_off(compiled):
    long, short = ({"z17": z17, "z6": 200, "input_friction": 0.01} for z17 in (341, 340))
    torques = [SteadyMachine(one, compiled).at(100.0, 0.3).output_torque for one in (long, short)]
    assert torques[0] == pytest.approx(torques[1], rel=0.05)


def test_command_draws_a_map_of_a_machine_with_losses_only(compiled, tmp_path):
    assert compiled
    scene = tmp_path / "rubbed.toml"
    scene.write_text(FRICTION)
    arguments = ["chart", str(scene), "examples/planar.toml", "-o", str(tmp_path / "out"), "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    told = json.loads(done.output)
    assert told["charts"]["planar"]["efficiency_maximum"] == 1.0
    assert 0.5 < told["charts"]["rubbed"]["efficiency_maximum"] < 1.0
    rows = (tmp_path / "out" / "rubbed_efficiency.csv").read_text().splitlines()
    assert rows[0] == "omega1 [rad/s],speed_ratio,efficiency"
    cells = [float(cell) for row in rows[1:] for cell in row.split(",")]
    assert all(map(math.isfinite, cells))
    assert not (tmp_path / "out" / "planar_efficiency.csv").exists()
    assert (tmp_path / "out" / "chart.png").read_bytes().startswith(b"\x89PNG")


def test_losses_by_load_take_the_same_share_at_every_speed(compiled):
    """Forces go with the square of the speed, and so do the torques that mesh and journals take."""
    parameters = {**PLANAR_MECHANISM, "mesh_efficiency": 0.98, "journal_friction": 3e-5}
    machine = SteadyMachine(parameters, compiled)
    slow, fast = (machine.at(omega1, 0.4) for omega1 in (20.0, 200.0))
    assert 0.5 < fast.efficiency < 0.99
    assert slow.efficiency == pytest.approx(fast.efficiency, abs=1e-5)
    assert slow.output_torque * 100.0 == pytest.approx(fast.output_torque, rel=1e-4)


def test_drag_of_the_freewheels_takes_less_of_more_power(compiled):
    machine = SteadyMachine({**PLANAR_MECHANISM, "housing_drag": 0.5, "output_drag": 0.5}, compiled)
    slow, fast = (machine.at(omega1, 0.4).efficiency for omega1 in (30.0, 120.0))
    # both losses are torques times speeds that go with omega1, the power goes with its cube
    assert 1.0 - fast == pytest.approx((1.0 - slow) / 16.0, rel=0.2)
    assert slow < fast < 1.0


@pytest.mark.parametrize("satellites", [1.0, 3.0])
def test_force_on_bearing_and_mount_with_link_2_held(satellites, compiled):
    lengths = {"sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04, "imbalance_mass": 0.3}
    machine = SteadyMachine({"layout": "planar", **lengths, "satellites": satellites}, compiled)
    # the satellite goes round at omega1 and turns at (1 + R0/r) omega1: both accelerations add up once a turn
    greatest = 0.3 * 100.0**2 * (0.16 + (1.0 + 0.1 / 0.06) ** 2 * 0.04)
    assert machine.at(100.0, 0.0).bearing_force == pytest.approx(greatest, rel=1e-9)
    mount = machine.mount(100.0, 0.0)
    # three of them balance each other
    assert mount.force == pytest.approx(greatest if satellites == 1.0 else 0.0, rel=2e-3, abs=1e-6)
    assert mount.moment > 100.0
