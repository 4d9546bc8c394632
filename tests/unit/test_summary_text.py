"""Test the summary of a run as text: shape, units, digits and warnings."""

import re

import numpy as np
import pytest

from inertia_module.common.examples import example
from inertia_module.fmi.results import Result
from inertia_module.interface.variables import LOSSES
from inertia_module.scene import load_scene
from inertia_module.scene.quantity import Quantity
from inertia_module.scene.reading import display_units
from inertia_module.scene.result import SceneResult
from inertia_module.scene.summary_text import DISPLAY_UNITS, summary, three_digits, two_digits

TIME = np.linspace(0.0, 1.0, 11)


def quantities(**values):
    """Return the metrics of a module with the given values; the others are those of a short run."""
    units = {"J": ("energy",), "N.m": ("torque",), "rad/s": ("omega", "slip"), "Hz": ("frequency",)}
    units |= {"N": ("force",), "s": ("time",), "km/h": ("vehicle_speed", "tracking"), "m": ("distance",)}

    def unit_of(name):
        if name in ("efficiency", "energy_residual_relative", "real_time_factor"):
            return ""
        if name == "share_out_of_tolerance":
            return "%"
        return next((unit for unit, words in units.items() if any(word in name for word in words)), "")

    numbers = {
        "simulated_time": 1.0,
        "omega1_maximum": 100.0,
        "omega_out_maximum": 17.968,
        "omega_out_final": 17.968,
        "input_torque_mean": 2.34685,
        "output_torque_mean": 18.984,
        "output_torque_mean_maximum": 102.013,
        "energy_in": 234.685,
        "energy_out": 111.311,
        "energy_stored_gain": 123.375,
        "energy_lost": 0.0,
        "efficiency": 1.0,
        "energy_residual": 3.2e-8,
        "energy_residual_relative": 1.36e-10,
        "wall_time": 0.0241,
        "real_time_factor": 41.5,
    }
    return {name: Quantity(value, unit_of(name)) for name, value in (numbers | values).items()}


DUTY_NOTE = {
    f"{name}_{metric}": value
    for name, values in {"housing": (28.0, 31.9, 117.08, 17.97), "output": (33.0, 37.8, 102.1, 17.8)}.items()
    for metric, value in zip(
        ("engagement_frequency_mean", "engagement_frequency_maximum", "torque_peak", "slip_peak"),
        values,
        strict=True,
    )
}


def run_result(speed=100.0, omega_out=None, remarks=None, limits=None, warnings=(), scene=None, **values):
    """Return the result of a run without running it; speeds in rad/s, constant or over TIME."""
    columns = {
        "time": TIME,
        "omega1": speed + 0.0 * TIME,
        "omega_out": 17.968 * TIME if omega_out is None else omega_out + 0.0 * TIME,
        "energy_stored": 123.375 * TIME,
    }
    table = Result.from_columns(columns)
    return SceneResult(
        columns=table.columns,
        units=table.units,
        scene=scene or load_scene(example("reference")),
        quantities=quantities(**values),
        remarks=remarks or {},
        limits=limits or {},
        warnings=tuple(warnings),
    )


def lines_of(result, units=DISPLAY_UNITS, width=80):
    return [line for lines in summary(result, units, width) for line in lines]


def group(lines, label):
    """Return the text of a group: its first line without the label, and its continuation lines."""
    start = next(number for number, line in enumerate(lines) if line.startswith(f"  {label}"))
    end = next((n for n, line in enumerate(lines[start + 1 :], start + 1) if line[2] != " "), len(lines))
    return "\n".join(line[14:] for line in lines[start:end])


def test_summary_of_the_reference_case():
    assert lines_of(run_result(**DUTY_NOTE)) == [
        "R1: a bevel inertia module starts a flywheel                          1 s, rigid",
        "  Speed       input 955 rpm   output at the end 172 rpm   ratio 0.180",
        "  Torque      output mean 19.0 N·m (peak 102)   input mean 2.35 N·m",
        "  Energy      input 235 J = output 111 + stored 123   efficiency 100 %",
        "  Freewheels      engagements/s   peak torque   overrunning speed",
        "    housing    31.9 (mean 28.0)       117 N·m             172 rpm",
        "    output     37.8 (mean 33.0)       102 N·m             170 rpm",
        "  Solved      in 24 ms, 42 times real time   energy error 1e-10",
    ]


def test_warnings_are_first_marked_wrapped_and_in_the_units_of_the_user():
    result = run_result(
        remarks={"load_torque": "exceeds the stall torque of 27.33 N.m at 100 rad/s (200 N.m)"},
        warnings=["a warning " * 20, "a stiffness of 10000 N.m/rad"],
    )
    text = summary(result)
    assert text.warnings[0] == "  ! load torque exceeds the stall torque of 27.33 N·m at 954.9 rpm (200 N·m)"
    assert [line[:4] for line in text.warnings] == ["  ! ", "  ! ", "    ", "    ", "  ! "]
    assert text.warnings[-1].endswith("10000 N·m/rad")
    assert lines_of(result)[1] == text.warnings[0]


@pytest.mark.parametrize("width", [40, 60, 80])
def test_no_line_is_wider_than_the_width(width):
    losses = dict.fromkeys(LOSSES, 12.3456)
    forces = {
        f"{name}_{kind}": 5706.6 for name in ("satellite_force", "shaking_force") for kind in ("peak", "rms")
    }
    result = run_result(
        warnings=["word " * 50],
        remarks={"time_to_100_kmh": "not reached (maximum 50.1 km/h)"},
        distance=1024.7,
        vehicle_speed_maximum=50.06,
        time_to_50_kmh=25.97,
        energy_rolling=90450.0,
        energy_drag=40340.0,
        **losses,
        **forces,
    )
    assert max(map(len, lines_of(result, width=width))) <= width


def test_zeros_are_omitted():
    result = run_result(
        omega_out=0.0,
        output_torque_mean=0.0,
        output_torque_mean_maximum=0.0,
        energy_out=0.0,
        energy_in=0.0,
        energy_stored_gain=0.0,
        input_torque_mean=0.0,
        energy_residual_relative=0.0,
        energy_lost_mesh=0.0,
        distance=0.0,
        vehicle_speed_maximum=0.0,
        energy_brake=0.0,
        **dict.fromkeys(DUTY_NOTE, 0.0),
    )
    lines = lines_of(result)
    assert not [line for line in lines if re.search(r"(?<![\d.])0(\.0*)? (J|N|N·m|rpm|%|m|km/h)", line)]
    labels = [line.split()[0] for line in lines[1:]]
    assert labels == ["Speed", "Freewheels", "housing", "output", "Solved"]
    assert "output at rest" in lines[1]


@pytest.mark.parametrize(
    "speed, omega_out, text",
    [
        (100.0, np.minimum(20.0, 40.0 * TIME), "input 955 rpm   output at the end 191 rpm   ratio 0.200"),
        (100.0, 20.0 - 10.0 * TIME, "input 955 rpm   output at the end 95.5 rpm (max 191)   ratio 0.100"),
        (50.0 * TIME, 0.0, "input 0 to 477 rpm   output at rest"),
        (50.0, np.sin(np.pi * TIME), "input 477 rpm   output max 9.55 rpm, at rest at the end"),
        (-50.0, 10.0 * TIME, "input -477 rpm   output at the end 95.5 rpm   ratio -0.200"),
        (50.0, 1 - 3 * TIME, "input 477 rpm   output at the end -19.1 rpm (-19.1 to 9.55)\nratio -0.0400"),
        (0.0, 10.0 - TIME, "input at rest   output at the end 85.9 rpm (max 95.5)"),
    ],
)
def test_speeds(speed, omega_out, text):
    assert group(lines_of(run_result(speed, omega_out)), "Speed") == text


def test_energies_are_a_balance_of_supply_and_use_in_one_unit():
    def energy(**values):
        values = {f"energy_{name}": value for name, value in values.items()}
        return group(lines_of(run_result(**values)), "Energy").replace("\n", " ").split("   ")[0]

    assert energy(**{"in": 14610.0, "out": 4890.0, "stored_gain": 8360.0, "lost": 1360.0}) == (
        "input 14.6 kJ = output 4.89 + stored 8.36 + losses 1.36 efficiency 100 %"
    )
    assert (
        energy(**{"in": 341.8, "out": -107.6, "stored_gain": 449.4})
        == "input 342 J + output 108 = stored 449"
    )
    assert energy(**{"in": 0.0, "out": 225.0, "stored_gain": -225.0}) == "stored 225 J = output 225"
    assert energy(**{"in": 2.3e8, "out": 2.3e8, "stored_gain": 0.0}) == "input 230 MJ = output 230"


def test_losses_are_sorted_and_have_fractions():
    losses = {"energy_lost_viscous": 24.7, "energy_lost_mesh": 180.2, "energy_lost_journal": 1e-9}
    text = group(lines_of(run_result(energy_lost=204.9, **losses)), "Losses")
    assert text == "mesh 180 J (88 %)   viscous friction 24.7 J (12 %)"
    alone = run_result(energy_lost=4.07, energy_lost_shaft=4.07)
    assert group(lines_of(alone), "Losses") == "shaft damping 4.07 J"


def test_limits_of_freewheels_are_in_their_table():
    limits = {"housing_torque_peak": 100.0, "output_torque_peak": 200.0}
    lines = lines_of(run_result(limits=limits, **DUTY_NOTE))
    assert [line.split()[-1] for line in lines if "mean " in line and "N·m  " in line][-2:] == [
        "exceeded",
        "ok",
    ]
    missing = run_result(remarks={"freewheel_duty": "is not available: fidelity averaged has no pulses"})
    assert group(lines_of(missing), "Freewheels") == "not available: fidelity averaged has no pulses"


def test_vehicle_and_control():
    values = {
        "time_to_50_kmh": 25.97,
        "distance": 1024.7,
        "vehicle_speed_maximum": 50.06,
        "energy_rolling": 90450.0,
        "energy_slope": 0.0,
        "tracking_error_rms": 0.3884,
        "tracking_error_maximum": 0.9847,
        "share_out_of_tolerance": 0.0,
        "time_out_of_tolerance": 0.0,
    }
    remarks = {"time_to_100_kmh": "not reached (maximum 50.06 km/h)"}
    lines = lines_of(run_result(remarks=remarks, **values))
    assert group(lines, "Vehicle") == "50 km/h in 26.0 s   100 km/h not reached   max 50.1 km/h   1.02 km"
    assert group(lines, "Road load") == "rolling 90.5 kJ"
    assert group(lines, "Control") == "speed error max 0.985 km/h (RMS 0.388)   always within tolerance"
    outside = values | {"share_out_of_tolerance": 1.64, "time_out_of_tolerance": 3.2}
    assert "out of tolerance for 3.20 s (1.6 %)" in group(lines_of(run_result(**outside)), "Control")
    miles = lines_of(run_result(**values), {**DISPLAY_UNITS, "km/h": "mph"})
    assert group(miles, "Vehicle").startswith("31.0686 mph in 26.0 s   max 31.1 mph")


def test_units_are_those_of_the_operation_in_the_scene(tmp_path):
    reference = example("reference")
    assert display_units(reference) == {"rad/s": "rad/s", "N.m": "N.m"}
    assert display_units(reference, {"drive.omega1": "955 rpm"})["rad/s"] == "rpm"
    assert display_units(reference, {"load.torque": "8 lbf.ft"})["N.m"] == "lbf.ft"
    assert display_units(example("urban"))["km/h"] == "km/h"
    assert display_units(example("engine_launch"))["rad/s"] == "rpm"
    assert display_units(example("orders"))["rad/s"] == "rad/s"
    result = run_result(**DUTY_NOTE)
    lines = lines_of(result, {"rad/s": "rad/s", "N.m": "lbf.ft"})
    assert group(lines, "Speed") == "input 100 rad/s   output at the end 18.0 rad/s   ratio 0.180"
    assert group(lines, "Torque") == "output mean 14.0 lbf·ft (peak 75.3)   input mean 1.73 lbf·ft"


def test_units_of_a_scene_with_a_byte_order_mark(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(example("reference").read_text(encoding="utf-8"), encoding="utf-8-sig")
    assert display_units(file) == display_units(example("reference"))


@pytest.mark.parametrize(
    "value, text",
    [
        (0.18, "0.180"),
        (17.968, "18.0"),
        (99.96, "100"),
        (-2.346, "-2.35"),
        (3126.0, "3130"),
        (0.0, "0"),
        (123456.0, "123000"),
        (1.36e-10, "1.36e-10"),
        (4.5e7, "4.50e+07"),
        (0.00123, "0.00123"),
    ],
)
def test_three_digits(value, text):
    assert three_digits(value) == text


@pytest.mark.parametrize("value, text", [(24.1, "24"), (220.0, "220"), (3.26, "3.3"), (9.96, "10")])
def test_two_digits(value, text):
    assert two_digits(value) == text
