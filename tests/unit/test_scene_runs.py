"""Test runs of scenes: output columns, summary, figures, engines and controllers."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from inertia_module.analysis.converter_chart import compute_chart
from inertia_module.analysis.steady_state import SteadyMachine
from inertia_module.common.errors import InertiaModuleError, UnknownNameError
from inertia_module.driveline import EngineMap, Governor
from inertia_module.driveline.cycles import ELEMENTARY_URBAN_CYCLE as CYCLE
from inertia_module.fidelity.measure import kernel_time_of, run_in_process
from inertia_module.fmi.results import Result
from inertia_module.interface.variables import BY_NAME, LOSSES
from inertia_module.plots.scenes import FLOWS, end_of_run, losses, plot, scene_figure
from inertia_module.plots.studies import chart_figure
from inertia_module.scene import freewheel_loads, load_scene, run, run_scene, summary_metrics, vehicle_metrics
from inertia_module.scene.summary_metrics import SUMMARY_VARIABLES, summarise

EXAMPLES = Path(__file__).parents[2] / "examples"
R1 = load_scene(EXAMPLES / "reference.toml").replaced(run={"outputs": None}, accuracy={"tolerance": None})
CAR = {"kind": "vehicle", "torque": None, "mass": 900, "wheel_radius": 0.3, "final_drive": 3}
FOLLOWED = {
    "kind": "pi",
    "proportional_gain": 500,
    "reference": {"kind": "table", "time": [0, 5], "speed": [0, 2]},
}
DRIVEN_CAR = {
    "drive": {"kind": "controlled", "omega1": None},
    "load": CAR,
    "controller": FOLLOWED,
    "step": 0.01,
}
RISING = {
    "mechanism": {"input_inertia": 0.2},
    "drive": {"kind": "torque_table", "time": [0, 0.5], "drive_torque": [0, "20 N.m"], "omega1": 50},
    "load": {"torque": 5},
    "step": 0.01,
}
FORCES = ("satellite_force", "satellite_force_peak", "shaking_force_x", "shaking_force_y", "shaking_force_z")
REAL = ("real_machine", "real_bevel")
TOP_SPEED = 250.0


def scene(stop=0.5, step=0.001, outputs=None, **tables):
    """Return R1 under 10 N.m with other keys; None deletes a key."""
    run = {"stop_time": stop, "communication_step": step, "outputs": outputs}
    return R1.replaced(run=run, **tables)


def table(**last):
    """Return a table of two rows; all values are zero, except the arguments in the second row."""
    columns = {
        name: np.array([0.0, last.get(name, 0.0)]) for name in (*SUMMARY_VARIABLES, "load_torque", *last)
    }
    return Result.from_columns({"time": np.array([0.0, 1.0]), **columns})


def labels(figure):
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None]
    return {text.get_text() for legend in legends for text in legend.get_texts()}


# --- numbers of the summary ---


def test_load_above_stall_is_reported():
    stall = SteadyMachine({}).at(100.0, 0.0).output_torque

    def warnings_of(load, parameters=None, **columns):
        given = {"omega1": [100.0] * 3, "load_torque": [load] * 3, "omega_out": [3.0, 0.0, 0.0], **columns}
        return run.above_stall(Result.from_columns({"time": [0.0, 1.0, 2.0], **given}), parameters or {})

    sentence = f"exceeds the stall torque of {stall:.4g} N.m at 100 rad/s ({stall + 1:.4g} N.m)"
    assert warnings_of(stall + 1.0) == {"load_torque": sentence}
    assert not warnings_of(stall - 1.0)
    assert not warnings_of(stall + 1.0, omega_out=[3.0, 2.0, 1.0])
    assert not warnings_of(stall + 1.0, brake_torque=[0.0, 0.0, 5.0])
    assert not warnings_of(stall + 1.0, omega1=[0.0] * 3)
    assert not warnings_of(stall + 1.0, {"output_freewheel": 0.0})


@pytest.mark.parametrize(
    "given, out, stored, lost, efficiency",
    [
        (100.0, 60.0, 20.0, 20.0, 0.8),
        # A driving load, released kinetic energy, a driven input: the work put in is the sum of inflows.
        (-30.0, -50.0, 10.0, 10.0, 0.8),
        (0.0, 15.0, -20.0, 5.0, 0.75),
        (7.0, 0.0, 0.0, 7.0, 0.0),
        (7.0, 7.0, 0.0, 0.0, 1.0),
        # A balancer releases more than the losses; nothing moves.
        (7.0, 9.0, 0.0, -2.0, None),
        (0.0, 0.0, 0.0, 0.0, None),
    ],
)
def test_efficiency_is_the_fraction_of_work_without_losses(given, out, stored, lost, efficiency):
    energies = table(energy_in=given, energy_out=out, energy_stored=stored, energy_lost=lost)
    summary = summarise(energies, None, 1.0, {})
    assert ("efficiency" in summary) == (efficiency is not None)
    if efficiency is not None:
        assert summary["efficiency"].value == pytest.approx(efficiency, rel=1e-15)


def test_stored_energy_counts_from_the_start_of_the_run():
    energies = table(energy_in=10.0, energy_out=8.0, energy_stored=51.0, energy_lost=1.0)
    energies["energy_stored"][0] = 50.0
    summary = summarise(energies, None, 1.0, {})
    assert summary["energy_stored_gain"].value == 1.0
    assert summary["efficiency"].value == pytest.approx(0.9)


def test_each_loss_is_reported():
    assert len(LOSSES) == 6
    for name in LOSSES:
        summary = summarise(table(energy_in=10.0, energy_lost=2.0, **{name: 2.0}), None, 1.0, {})
        assert {key: summary[key] for key in summary if key in LOSSES} == {name: (2.0, "J")}
        assert losses(table(**{name: 2.0})) == [name]
        assert BY_NAME[name].unit == "J"


def test_forces_are_magnitudes_of_recorded_components():
    one = table(satellite_force=5.0, shaking_force_x=2.0, shaking_force_y=-3.0, shaking_force_z=6.0)
    assert {name: values[-1] for name, values in summary_metrics.forces(one).items()} == {
        "satellite_force": 5.0,
        "shaking_force": 7.0,
    }
    summary = summarise(one, None, 1.0, {})
    assert summary["shaking_force_peak"] == (7.0, "N")
    assert summary["shaking_force_rms"].value == pytest.approx(7.0 / math.sqrt(2.0))
    assert "shaking_moment_peak" not in summary
    # Two of three components are no magnitude. A signal that is 0 throughout is not modelled.
    assert not summary_metrics.forces(table(shaking_force_x=2.0, shaking_force_y=1.0))
    assert not summary_metrics.forces(table(satellite_force=0.0))
    # The forces of three satellites of 3 kN cancel to rounding.
    balanced = table(satellite_force=3e3, shaking_force_x=0.0, shaking_force_y=3e-12, shaking_force_z=-4e-12)
    assert list(summary_metrics.forces(balanced)) == ["satellite_force"]
    between = summarise(table(satellite_force=5.0, satellite_force_peak=8.0), None, 1.0, {})
    assert between["satellite_force_peak"] == (8.0, "N")


# --- the duty of the freewheels ---


def test_maximum_frequency_is_the_mean_of_ten_engagements():
    # 20 Hz, then 50 Hz for 15 engagements, then rest.
    events = np.cumsum([*[0.05] * 30, *[0.02] * 15, 3.0])
    for step, allowed in ((1e-3, 0.01), (0.015, 0.1)):
        time = np.arange(0.0, 6.0, step)
        count = np.searchsorted(events, time + 1e-9).astype(float)
        assert freewheel_loads.maximum_frequency(time, count) == pytest.approx(50.0, rel=allowed)
    few = np.array([0.0, 1.0, 2.0, 5.0]), np.array([0.0, 1.0, 1.0, 3.0])
    assert freewheel_loads.maximum_frequency(*few) == pytest.approx(0.5)
    assert freewheel_loads.maximum_frequency(few[0], np.array([0.0, 0.0, 1.0, 1.0])) == pytest.approx(0.2)
    assert freewheel_loads.maximum_frequency(few[0], np.zeros(4)) == 0.0


def test_overruns_with_engaged_sprags_do_not_count():
    degrees = np.array([0.0, 1.0, 0.05, 0.05, 0.05, 0.0, 0.02, 0.4])
    columns = {
        "housing_engagements": np.array([0.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 6.0]),
        "housing_slip_peak": np.radians(degrees) / 1e-3,
    }
    record = Result.from_columns({"time": 1e-3 * np.arange(8.0), **columns})
    assert freewheel_loads.engagements(record, "housing").tolist() == [0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 4.0]


def test_duty_excludes_jumps_of_a_zero_order_speed(fmu):
    # Up to 1500 rpm, with 5/3 engagements per turn at stall.
    result = run_scene(load_scene(EXAMPLES / "real_machine.toml").replaced(run={"stop_time": 1.5}), fmu)
    for name in ("housing", "output"):
        assert result[f"{name}_engagements"][-1] > 200.0
        assert 30.0 < result.summary[f"{name}_engagement_frequency_maximum"] < 25.0 * 5.0 / 3.0


def test_duty_agrees_with_the_module_and_exceeded_limits_cause_warnings(fmu):
    limits = {"indexing_frequency": "60 Hz", "output": {"torque": 80.0, "indexing_frequency": "20 Hz"}}
    result = run_scene(scene(1.0, freewheels=limits), fmu)
    table, numbers = result.record, result.summary
    for name in ("housing", "output"):
        counted = table[f"{name}_engagements"][-1]
        assert counted - 1.0 <= numbers[f"{name}_engagement_frequency_mean"] <= counted
        assert 30.0 <= numbers[f"{name}_engagement_frequency_maximum"] < 45.0
    assert numbers["housing_torque_peak"] >= table["housing_torque_peak"].max() > 100.0
    assert numbers["output_torque_peak"] == table["torque_peak"].max() > 80.0
    assert numbers["housing_slip_peak"] == pytest.approx(table["omega2"].max(), rel=1e-3)
    assert result.metric_units["output_slip_peak"] == "rad/s"
    of_limits = {"housing": 60.0, "output": 20.0}
    expected = {f"{name}_engagement_frequency_maximum": limit for name, limit in of_limits.items()}
    assert result.as_dict()["limits"] == result.limits == {**expected, "output_torque_peak": 80.0}
    assert result.as_dict()["warnings"] == [
        f"{name} exceeds its limit of {limit}: {numbers[name.replace(' ', '_')]:.6g} {limit.split()[1]}"
        for name, limit in (
            ("output engagement frequency maximum", "20 Hz"),
            ("output torque peak", "80 N.m"),
        )
    ]
    assert result.lines()["output torque peak"].endswith(" N·m, limit 80")


@pytest.mark.parametrize(
    "mechanism, reason",
    [
        ({"fidelity": "averaged"}, "fidelity averaged has no pulses"),
        ({"fidelity": "kinematic", "kinematic_ratio": 0.2}, "fidelity kinematic prescribes the motion"),
    ],
)
def test_level_without_pulses_has_no_duty(fmu, mechanism, reason):
    result = run_scene(scene(mechanism=mechanism, freewheels={"torque": 1.0, "slip": 1.0}), fmu)
    assert reason in result.remarks["freewheel_duty"]
    assert not result.limits
    assert not result.warnings
    assert not {name for name in result.summary if name.startswith(("housing_", "output_slip"))}
    with pytest.raises(UnknownNameError, match="unknown metric of the summary 'housing_torque_peak'; "):
        result.summary["housing_torque_peak"]


def test_missing_freewheel_has_no_duty(fmu):
    result = run_scene(scene(mechanism={"output_freewheel": False}, freewheels={"torque": 1.0}), fmu)
    assert list(result.limits) == ["housing_torque_peak"]
    assert "output_torque_peak" not in result.summary


def car(speed, time, **columns):
    """Return a table with a vehicle of these speeds at these times."""
    zeros = ("distance", "load_speed", *(f"{name}_torque" for name in ("rolling", "drag", "slope", "brake")))
    given = {name: np.zeros(len(time)) for name in (*SUMMARY_VARIABLES, "load_torque", *zeros)}
    units = {"reference": "m/s"}
    return Result.from_columns({"time": time, **given, "vehicle_speed": np.array(speed), **columns}, units)


def test_times_to_a_speed_count_from_the_last_standstill():
    time = np.linspace(0.0, 2.0, 201)
    record = car(np.interp(time, [0.0, 0.5, 1.0, 1.5, 2.0], [3.0, 0.0, 0.0, 10.0, 20.0]), time)
    summary = summarise(record, None, 1.0, vehicle_metrics.times_to(record, [2.0, 10.0, 15.0, 30.0])[0])
    times = {name: summary[name].value for name in summary if name.startswith("time_to_")}
    assert times == {"time_to_36_kmh": pytest.approx(0.5), "time_to_54_kmh": pytest.approx(0.75)}


PLAY = {"output_engagement_angle": 0.03, "housing_engagement_angle": 0.0}


def played(mechanism=None, **freewheels):
    return scene(mechanism=PLAY | (mechanism or {}), freewheels=freewheels)


def test_torque_limit_is_compared_with_the_peak_without_impacts(fmu):
    result = run_scene(played(torque=1e4), fmu)
    assert result.summary["output_torque_peak"] < 1e4
    (warning,) = [one for one in result.warnings if "impacts" in one]
    assert "Set freewheels.output.stiffness to compare impacts with the limit of 10000 N.m" in warning
    assert not any("housing" in one for one in result.warnings)
    assert not [one for one in run_scene(played(), fmu).warnings if "impacts" in one]


def test_impact_torque_is_the_torque_of_a_spring_with_its_energy(fmu):
    stiffness = 2e4
    result = run_scene(played(torque=1e4, stiffness=stiffness), fmu)
    energy, torque = (result.summary[f"output_impact_{name}"] for name in ("energy", "torque"))
    assert torque == pytest.approx(math.sqrt(2.0 * stiffness * energy))
    assert not [one for one in result.warnings if "impact" in one]
    lost = np.diff(result.record["energy_lost_freewheel"])
    assert energy == lost.max() > 0.0
    # The torque exceeds this limit.
    low = run_scene(played(torque=0.9 * torque, stiffness=stiffness), fmu)
    assert [one for one in low.warnings if one.startswith("output impact torque is above the limit")]


def test_impact_estimate_agrees_with_a_compliant_freewheel(fmu):
    """Add half a sine with amplitude slip sqrt(c J) to the torque that the freewheel transmits then."""
    stiffness = 2e4
    rigid = run_scene(played(stiffness=stiffness), fmu)
    shaft = {
        "fidelity": "elastic",
        "driven_inertia": 1e-3,
        "shaft_stiffness": 1e6,
        "freewheel_stiffness": stiffness,
    }
    spring = run_scene(played(shaft), fmu)
    assert "output_impact_torque" not in spring.summary
    peak, base = spring.summary["output_torque_peak"], rigid.summary["output_torque_peak"]
    estimate = rigid.summary["output_impact_torque"]
    assert max(estimate, base) < 1.2 * peak
    assert peak < 1.2 * (estimate + 2.0 * base)


def test_the_tractive_force_accelerates_the_vehicle_and_overcomes_its_resistances():
    vehicle = load_scene(EXAMPLES / "engine_launch.toml").load
    time = np.linspace(0.0, 2.0, 201)
    ratio = vehicle.wheel_radius / vehicle.final_drive
    torques = {"rolling_torque": np.full(201, 100.0 * ratio), "slope_torque": np.full(201, 300.0 * ratio)}
    record = car(np.maximum(time - 1.0, 0.0) * 2.0, time, **torques)
    force = vehicle_metrics.tractive_force(record, vehicle)
    assert force[:99].max() == 0.0
    assert force[101:] == pytest.approx(vehicle.mass * 2.0 + 400.0)


@pytest.mark.parametrize("friction, slips", [(2.0, False), (0.15, True)])
def test_a_launch_beyond_the_grip_has_a_note_and_a_warning(fmu, friction, slips):
    keys = {"friction_coefficient": friction, "driven_axle_load": "4 kN"}
    launch = load_scene(EXAMPLES / "engine_launch.toml").replaced(load=keys, run={"stop_time": 2.0})
    result = run_scene(launch, fmu)
    largest = result.summary["tractive_force_maximum"]
    assert result.limits == {"tractive_force_maximum": pytest.approx(4000.0 * friction)}
    assert (largest > 4000.0 * friction) == slips
    assert ("grip" in result.remarks) == slips
    assert any("tractive force maximum exceeds its limit" in one for one in result.warnings) == slips
    # The mean torque of the module accelerates the car and its own output inertia.
    torque = result.record["output_torque_mean"].max() * launch.load.final_drive / launch.load.wheel_radius
    assert largest == pytest.approx(torque, rel=0.15)


def test_grip_without_an_axle_load_is_that_of_the_weight():
    launch = load_scene(EXAMPLES / "engine_launch.toml").replaced(load={"friction_coefficient": 0.3})
    assert launch.load.grip == pytest.approx(0.3 * launch.load.mass * 9.80665)


def test_without_a_friction_coefficient_there_is_no_tractive_force(fmu):
    result = run_scene(load_scene(EXAMPLES / "engine_launch.toml").replaced(run={"stop_time": 0.1}), fmu)
    assert not {name for name in result.summary if name.startswith("tractive")}


@pytest.mark.parametrize(
    "keys, words",
    [
        ({"driven_axle_load": "4 kN"}, "driven_axle_load requires friction_coefficient"),
        (
            {"friction_coefficient": 1.0, "driven_axle_load": "9 kN"},
            "at most the weight of the vehicle, 8825.98 N",
        ),
        ({"friction_coefficient": 0.0}, "friction_coefficient must be .*above 0"),
    ],
)
def test_invalid_grip_is_rejected(keys, words):
    launch = load_scene(EXAMPLES / "engine_launch.toml")
    with pytest.raises(InertiaModuleError, match=words):
        launch.replaced(load=keys)


def test_launch_on_a_hill_starts_after_rolling_back():
    """Pulses move the car, with rest in between. Before, the car rolls forward and back."""
    time = np.linspace(0.0, 4.0, 401)
    pulses = np.where(time % 0.2 < 0.1, 1.0, 0.0)
    speed = np.where(time < 1.0, np.sin(math.tau * time), np.where(time < 3.0, pulses, 10.0 * (time - 3.0)))
    (quantity,) = vehicle_metrics.times_to(car(speed, time), [5.0])[0].values()
    assert quantity.value == pytest.approx(2.5, abs=0.011)
    rolls_back = np.where(time < 3.0, -0.1 * pulses, 10.0 * (time - 3.0))
    (quantity,) = vehicle_metrics.times_to(car(rolls_back, time), [5.0])[0].values()
    assert quantity.value == pytest.approx(0.5, abs=0.011)


def test_time_outside_the_band_counts_steps_that_start_outside():
    time = np.array([0.0, 20.0, 21.0, 24.0, 195.0])
    lower, _ = CYCLE.tolerance_band(time)
    record = car(lower + np.array([0.1, -0.1, 0.1, 0.1, -0.1]), time, reference=CYCLE.speed_at(time))
    summary = summarise(record, CYCLE, 1.0, {})
    assert summary["time_out_of_tolerance"] == (1.0, "s")
    assert summary["share_out_of_tolerance"] == (pytest.approx(100.0 / 195.0), "%")


# --- drives that give a speed ---


def test_controlled_run_reports_tracking_error_and_energies(fmu, tmp_path):
    result = run_scene(scene(5, mechanism={"satellites": 3, "input_friction": 0.05}, **DRIVEN_CAR), fmu)
    assert result.metric_units["tracking_error_rms"] == "km/h"
    assert 0.1 < result.summary["tracking_error_rms"] < result.summary["tracking_error_maximum"] < 3.0
    assert result.summary["distance"] == pytest.approx(5.0, rel=0.2)
    figure = scene_figure(result)
    assert len(figure.axes) == 5
    assert {"losses", "viscous"} <= labels(figure)
    figure.savefig(tmp_path / "closed.png")
    assert (tmp_path / "closed.png").stat().st_size > 10_000


def test_car_that_cannot_follow_its_cycle_is_reported(fmu):
    """Link 1 may turn at 10 rad/s, which is 3.6 km/h. The car starts at 18 km/h."""
    reference = {"kind": "table", "time": [0, 2, 3], "speed": [5, 5, 10]}
    start = {"satellites": 3, "omega_out_start": 50}
    weak = {**DRIVEN_CAR, "controller": {**FOLLOWED, "maximum": 10, "reference": reference}}
    result = run_scene(scene(6, mechanism=start, **weak), fmu)
    assert result.summary["time_out_of_tolerance"] == pytest.approx(2.9, abs=0.1)
    first, slow, at = re.fullmatch(
        r"does not follow the reference: out of tolerance for more than 1 s at a time \(once, at (\S+) s\);"
        r" largest deviation (\S+) km/h too slow at (\S+) s",
        result.remarks["vehicle_speed"],
    ).groups()
    assert [float(first), float(at)] == pytest.approx([3.1, 6.0], abs=0.1)
    assert float(slow) == pytest.approx(result.summary["tracking_error_maximum"], rel=0.01)
    assert "does not follow" in result.lines()["vehicle speed"]
    assert "stop_time" not in result.remarks
    assert result["distance"][0] == 0.0
    way = np.trapezoid(result["vehicle_speed"], result.record.time)
    assert result.summary["distance"] == pytest.approx(way, rel=1e-12)


def test_energy_of_a_car_behind_an_elastic_shaft(fmu):
    """Only resistances of the motion of the car count: input = rolling resistance + kinetic energy."""
    coupled = {**DRIVEN_CAR, "load": {**CAR, "coupling": {"stiffness": 2000, "damping": 20}}}
    reference = {"kind": "constant", "speed": 10}
    coupled["controller"] = {**FOLLOWED, "proportional_gain": 100, "reference": reference}
    result = run_scene(scene(2, mechanism={"satellites": 3, "output_inertia": 0.5}, **coupled), fmu)
    summary = result.summary
    moving = 0.5 * 900.0 * result.table["vehicle_speed"][-1] ** 2
    assert moving > 100.0
    assert summary["energy_out"] > moving + summary["energy_rolling"]
    assert summary["energy_rolling"] == pytest.approx(0.01 * 900 * 9.80665 * summary["distance"], rel=0.02)


def test_losses_of_a_run_add_up_and_are_drawn(fmu):
    friction = {"input_friction": 0.005, "output_friction": 0.02}
    result = run_scene(scene(mechanism=friction, outputs=["omega2", *FORCES]), fmu)
    numbers = result.summary
    assert numbers["energy_lost_viscous"] == numbers["energy_lost"] > 0.0
    kept = numbers["energy_out"] + numbers["energy_stored_gain"]
    assert numbers["efficiency"] == pytest.approx(kept / numbers["energy_in"], rel=1e-5)
    assert numbers["satellite_force_peak"] >= result.table["satellite_force"].max()
    assert numbers["satellite_force_rms"] < numbers["satellite_force_peak"]
    assert not set(LOSSES) & set(result.table.names)
    figure = scene_figure(result)
    assert {"satellite bearing", "mounting", "viscous", "losses"} <= labels(figure)
    assert len(figure.axes) == 12
    # The power loss over the end of the run equals the table.
    lost = next(
        axes for axes in figure.axes if axes.get_ylabel() == "losses [W]" and axes.get_xlim()[0] > 0.3
    )
    power = np.diff(result.record["energy_lost"]) / 1e-3
    assert lost.lines[0].get_ydata() == pytest.approx(power[-lost.lines[0].get_ydata().size :])


@pytest.mark.parametrize(("step", "coarse"), [(0.01, True), (0.001, False)])
def test_rows_too_far_apart_for_the_pulses_are_dots_and_mean_torques_no_curves(fmu, step, coarse):
    figure = scene_figure(run_scene(scene(step=step), fmu))
    lines = {line.get_label(): line for axes in figure.axes for line in axes.lines}
    assert ("link 2 ω2, instantaneous" in lines) is coarse
    assert ("output freewheel" in lines) is not coarse
    if coarse:
        assert lines["link 2 ω2, instantaneous"].get_linestyle() == "None"


@pytest.mark.parametrize("stop, step", [(0.5, 0.001), (0.01, 0.01)], ids=["many steps", "one step"])
def test_ideal_run_has_the_requested_columns_and_no_loss_panels(fmu, tmp_path, stop, step):
    seen, wanted = [], ["omega2", "imbalance_acceleration"]
    result = run_scene(scene(stop, step, wanted), fmu, seen.append)
    assert result.table.names == ["time", *wanted, "load_torque", "omega1"]
    assert len(result.table) == round(stop / step) + 1
    assert seen[-1] == 1.0
    assert set(result.summary) == set(result.metric_units)
    assert result.summary["energy_residual_relative"] < 1e-5
    assert result.summary["efficiency"] == 1.0
    figure = scene_figure(result)
    assert len(figure.axes) == 8
    assert figure.get_figheight() == 9.0
    assert not {"losses", "viscous", "mounting"} & labels(figure)
    figure.savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 10_000


@pytest.mark.parametrize("example", REAL)
def test_examples_lose_to_every_cause_but_the_shaft_and_balance(fmu, example):
    result = run_scene(load_scene(EXAMPLES / f"{example}.toml").replaced(run={"stop_time": 0.5}), fmu)
    numbers = result.summary
    assert {name for name in LOSSES if name in numbers} == set(LOSSES) - {
        "energy_lost_shaft",
        "energy_lost_windage",
    }
    assert all(numbers[name] > 0.0 for name in LOSSES if name in numbers)
    total = sum(numbers[name] for name in LOSSES if name in numbers)
    assert total == pytest.approx(numbers["energy_lost"], rel=1e-12)
    assert numbers["energy_residual_relative"] < 1e-6
    assert 0.3 < numbers["efficiency"] < 1.0
    assert {"mesh", "journal", "freewheel", "viscous"} <= labels(scene_figure(result))


# --- drives that give a torque ---


def test_torque_driven_run_reports_and_draws_speed_and_torque(fmu):
    result = run_scene(scene(**RISING), fmu)
    table, summary = result.table, result.summary
    assert table["drive_torque"][-1] == 20.0
    assert table["input_speed"][0] == 50.0
    assert "omega1" not in table
    assert summary["omega1_maximum"] == table["input_speed"].max()
    assert summary["energy_residual_relative"] < 1e-6
    # The torque is constant in each step.
    mean = np.average(table["drive_torque"][:-1])
    assert summary["input_torque_mean"] == pytest.approx(mean, rel=1e-9)
    assert {"input ω1", "drive"} <= labels(scene_figure(result))
    # A run in this process agrees.
    in_process = run_in_process(scene(**RISING))
    assert in_process["omega_out"][-1] == pytest.approx(table["omega_out"][-1], rel=1e-9)
    assert kernel_time_of(scene(**RISING), in_process) > 0.0


def test_example_speeds_up_a_flywheel_while_the_motor_sags(fmu):
    short = {"stop_time": 2.2, "communication_step": 2e-3}
    table = run_scene(load_scene(EXAMPLES / "engine.toml").replaced(run=short), fmu).table
    assert table["input_speed"][0] == pytest.approx(200.0)
    assert table["omega_out"][-1] > 100.0
    assert table["input_speed"].min() < 120.0


def test_a_controller_commands_the_torque_within_its_limits(fmu):
    gains = {"kind": "pi_torque", "proportional_gain": "20 N.m.s/m", "integral_gain": 2}
    reference = {"kind": "constant", "speed": "36 km/h"}
    light = scene(
        25,
        step=0.01,
        mechanism={"input_inertia": 0.2, "satellites": 3},
        drive={"kind": "controlled_torque", "omega1": 80},
        load={**CAR, "mass": 100},
        controller={**gains, "minimum": "-10 N.m", "maximum": "20 N.m", "reference": reference},
    )
    assert light.parameters()["drive"] == 1.0
    assert run.initial_values(light)[1]["omega1"] == 80.0
    result = run_scene(light, fmu)
    torque = result.table["drive_torque"]
    assert torque.max() == 20.0
    assert torque.min() >= -10.0
    assert np.abs(result.table["vehicle_speed"][-500:] - 10.0).max() < 0.15
    assert result.summary["energy_residual_relative"] < 1e-5
    scene_figure(result)


# --- an engine ---


def full_throttle(stop_time=6.0, step=0.01, integral_gain=12.0):
    """Return the example with full throttle from the start, and the engine at idle."""
    governor = {
        "top_speed": TOP_SPEED,
        "idle": 80.0,
        "proportional_gain": 3.0,
        "integral_gain": integral_gain,
    }
    return load_scene(EXAMPLES / "engine_launch.toml").replaced(
        drive={"throttle": 1.0, "throttle_over_time": None, "governor": governor},
        run={"stop_time": stop_time, "communication_step": step},
    )


@pytest.mark.parametrize("integral_gain", [0.0, 12.0])
def test_full_throttle_torque_follows_the_map_and_the_speed_limiter(fmu, integral_gain):
    table = run_scene(full_throttle(integral_gain=integral_gain), fmu).record
    limits = EngineMap(
        tuple(np.array([0.0, 1000.0, 2000.0, 3000.0]) * np.pi / 30.0),
        (20.0, 30.0, 36.0, 32.0),
        (6.0, 8.0, 10.0, 14.0),
    )
    governor, integral, expected = Governor(3.0, integral_gain, 0.01), 0.0, []
    for n, speed in enumerate(table["input_speed"]):
        sample = TOP_SPEED, speed, limits.limits(speed)
        if n > 0:  # The integral includes the present sample.
            integral = governor.sample(integral, *sample)[1]
        expected.append(governor.sample(integral, *sample)[0])
    assert table["input_speed"].max() > TOP_SPEED  # The governor is active.
    assert table["drive_torque"] == pytest.approx(expected, rel=1e-9)


def test_with_the_throttle_closed_the_engine_idles(fmu):
    """The governor of the idle speed supplies the torque that turns link 2 and the car."""
    closed = full_throttle(8.0).replaced(drive={"throttle": 0.0, "omega1": 150.0})
    table = run_scene(closed, fmu).record
    assert table["drive_torque"][0] == pytest.approx(closed.drive.torque_map().limits(150.0)[0])
    assert table["input_speed"][table.time > 6.0].mean() == pytest.approx(80.0, rel=0.03)


def test_example_reports_the_acceleration_time(fmu):
    launch = load_scene(EXAMPLES / "engine_launch.toml")
    launch = launch.replaced(load={"times_to": ["25 km/h", "50 km/h", "100 km/h"]})
    result = run_scene(launch, fmu)
    table, numbers = result.record, result.summary
    for speed in (25.0, 50.0):
        time = numbers[f"time_to_{speed:g}_kmh"]
        assert np.interp(time, table.time, table["vehicle_speed"]) * 3.6 == pytest.approx(speed, rel=2e-3)
    assert numbers["time_to_25_kmh"] < numbers["time_to_50_kmh"]
    assert "time_to_100_kmh" not in numbers
    fastest = table["vehicle_speed"].max() * 3.6
    assert result.remarks == {"time_to_100_kmh": f"not reached (maximum {fastest:.4g} km/h)"}
    assert numbers["energy_residual_relative"] < 1e-7
    heading = scene_figure(result).axes[0].get_title(loc="left")
    assert f"25 km/h in {numbers['time_to_25_kmh']:.3g} s" in heading


# --- figures contain the numbers that they name ---


PULSES = np.tile([0.0, 0.0, 5.0, 9.0, 5.0], 6)
LOCKED, COASTING = np.full(200, 3.0), np.zeros(200)


@pytest.mark.parametrize(
    "torque, title",
    [
        (PULSES, "last 4 pulses"),
        (np.concatenate([PULSES, LOCKED[:8]]), "last 4 pulses"),
        (np.concatenate([PULSES, LOCKED]), "lock-up from 0.026 s"),
        (np.concatenate([PULSES, COASTING]), "no pulses from 0.029 s"),
        (PULSES[:15], "end of the run"),
        (LOCKED, "end of the run"),
        (COASTING, "end of the run"),
    ],
)
def test_close_up_has_its_title(torque, title):
    table = Result.from_columns({"time": 1e-3 * np.arange(torque.size), "output_torque_mean": torque})
    first, heading = end_of_run(table)
    assert heading == title
    if "pulses" in heading or "lock-up" in heading:
        assert first == 11
    assert 0 <= first < torque.size


@pytest.mark.parametrize(
    ("largest", "unit", "label", "factor"),
    [(1999.0, "W", "W", 1.0), (5000.0, "W", "kW", 1e3), (5000.0, "rad/s", "rad/s", 1.0)],
)
def test_large_powers_are_drawn_in_kilowatts(largest, unit, label, factor):
    axes, power = Figure().subplots(), np.array([1.0, -largest, 2.0])
    columns = {"time": np.arange(3.0), "energy_in": power, "energy_lost": 0.1 * power}
    plot(axes, Result(columns), FLOWS, "power", unit)
    assert axes.get_ylabel() == f"power [{label}]"
    assert [line.get_label() for line in axes.lines] == ["input", "losses"]
    assert axes.lines[0].get_ydata() == pytest.approx(power / factor)


@pytest.mark.usefixtures("compiled")
def test_chart_without_losses_conserves_power():
    ratio, output, taken, _ = chart_figure({"ideal": compute_chart({})}).axes
    speeds, ratios = ratio.lines[0].get_data()
    assert ratios == pytest.approx(1.0 / speeds, rel=1e-9)
    assert ratios.max() > 5.0
    assert ratio.get_title(loc="left") == "torque ratio, no losses"
    torques = [axes.lines[0].get_ydata() for axes in (output, taken)]
    assert torques[0] * output.lines[0].get_xdata() == pytest.approx(torques[1])


def test_a_table_in_another_unit_is_a_warning_of_the_run(fmu):
    drive = {"kind": "table", "omega1": [50.0, 100.0], "time": [0.0, 500.0]}
    result = run_scene(scene(0.5, 0.01, drive=drive), fmu)
    assert [line for line in result.warnings if line.startswith("drive changes from 0 to 500 s")]
    assert result.as_dict()["warnings"] == [*result.warnings]
