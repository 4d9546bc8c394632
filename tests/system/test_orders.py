"""Test orders: synthetic signals, modules whose lines follow from their geometry, errors."""

import functools
import json
import math
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from rejected import REJECTED, assert_rejected, rejection
from scipy.io import loadmat

from inertia_module import example, studies
from inertia_module.common.errors import InertiaModuleError
from inertia_module.fmi.results import Result, read_columns
from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.model import Module
from inertia_module.plots.studies import order_figure
from inertia_module.scene import load_scene
from inertia_module.studies.order_analysis import HARMONICS
from inertia_module.studies.order_lines import MIN_SHARE, leakage
from inertia_module.studies.order_spectra import spectra
from tests.system.programs import stdout_of

order_run = sys.modules["inertia_module.studies.order_analysis"]
OMEGA1 = 100.0
# The output is too heavy to move: link 2 is nearly at rest.
HELD = {"mechanism.output_inertia": 1e5, "load.torque": 0.0, "accuracy.tolerance": 1e-8, "run.outputs": None}
PLANAR = {"layout": "planar", "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
PLANAR |= {"satellites": 3, "link2_inertia": 0.01}


def held(stop=4.0, omega1=OMEGA1, **mechanism):
    keys = {f"mechanism.{name}": value for name, value in mechanism.items()}
    keys |= {"run.stop_time": stop, "drive.omega1": omega1}
    return load_scene(example("reference")).with_keys(HELD | keys)


def imbalance_lines(scene, turns):
    """Return amplitudes of k I'(q) omega1^2 / 2 over cycles per turn of q: the imbalance torque on link 2."""
    module = Module("plain")
    module.check(**scene.parameters())
    d = module.derived
    q = np.linspace(0.0, math.tau * turns, 1000 * turns, endpoint=False)
    torque = [0.5 * d.k * reduced_inertia(d, float(angle))[1] * OMEGA1**2 for angle in q]
    result = 2.0 * np.abs(np.fft.rfft(torque)) / q.size
    return d.k, {place / turns: height for place, height in enumerate(result) if height > 1e-6}


def by_order(lines):
    return {round(line.order, 6): line.amplitude for line in lines}


# --- synthetic signals ---


@functools.cache
def run_up(highest=None, turns=None, names=("x",)):
    """Return a run-up from 20 to 200 rad/s with two lines, a mean and a trend."""
    time = np.arange(0.0, 10.0, 2e-4)
    speed = 20.0 + 18.0 * time
    turned = (20.0 * time + 9.0 * time**2) / math.tau
    swing = 3.0 * np.cos(math.tau * 2.5 * turned) + 0.5 * np.sin(math.tau * 7.0 * turned)
    columns = {"time": time, "input_speed": speed, "x": 10.0 + 0.1 * time + swing}
    return spectra(Result.from_columns(columns, {"x": "N.m"}), turned, names, "link1", highest, turns)


@pytest.mark.parametrize("turns", [None, 8.0])
def test_lines_of_a_synthetic_run_up_have_their_orders_and_amplitudes(turns):
    result = run_up(turns=turns)
    first, second = result.largest(2)["x"]
    assert (first.order, second.order) == pytest.approx((2.5, 7.0), rel=1e-12)
    assert (first.amplitude, second.amplitude) == pytest.approx((3.0, 0.5), rel=2e-3)
    # The side lobes of a large line are not listed.
    assert all(abs(line.order - 2.5) > 4.0 / result.turns for line in result.largest()["x"][1:])
    edges = 0.5 * result.turns * np.arange(result.time.size + 2)
    speed = np.sqrt(20.0**2 + 36.0 * math.tau * edges)
    assert result.speed == pytest.approx(0.5 * (speed[:-2] + speed[2:]), rel=1e-3)
    # At every speed the lines are a cosine and a sine of the angle.
    for line, expected in ((first, 3.0), (second, -0.5j)):
        at = int(np.argmin(np.abs(result.order - line.order)))
        assert np.abs(result.spectrum["x"][:, at] - expected).max() < 0.015
        assert result.waterfall["x"][:, at] == pytest.approx(abs(expected), rel=5e-3)
        assert line.phase == pytest.approx(np.angle(expected), abs=5e-3)
        assert line.frequency == pytest.approx(line.order * line.speed / math.tau, rel=1e-3)


def test_waterfall_has_the_speed_of_each_window(tmp_path):
    result = run_up(highest=8.0, names=("x", "input_speed"))
    rows, units = read_columns(result.write(tmp_path)["waterfall"])
    assert sorted(set(rows["speed"])) == result.speed.tolist()
    assert max(rows["input_speed"]) < 20.0  # The column contains an amplitude.
    expected = {"speed": "rad/s", "x": "N.m", "time": "s", "rpm": "rpm", "frequency": "Hz", "x_phase": "rad"}
    assert units == expected | {"input_speed_phase": "rad"}
    speed, order, x = (np.array(rows[name]) for name in ("speed", "order", "x"))
    assert rows["rpm"] == pytest.approx(speed * 30.0 / math.pi, rel=1e-12)
    assert rows["frequency"] == pytest.approx(order * speed / math.tau, rel=1e-3)
    complex_rows = x * np.exp(1j * np.array(rows["x_phase"]))
    assert complex_rows.reshape(speed.size // len(set(order)), -1) == pytest.approx(
        result.spectrum["x"][:, ::4]
    )


def test_complex_amplitudes_are_written_for_matlab(tmp_path):
    result = run_up(highest=8.0, names=("x", "input_speed"))
    read = loadmat(result.write_mat(tmp_path / "x.mat"), simplify_cells=True)["orders"]
    assert read["x"].tolist() == result.spectrum["x"].tolist()
    assert read["frequency"].tolist() == result.frequency.tolist()
    assert read["rpm"].tolist() == result.rpm.tolist()
    assert [read["units"][name] for name in ("order", "rpm", "frequency", "x")] == ["1", "rpm", "Hz", "N.m"]


def test_spectrum_contains_the_total_oscillation():
    result = run_up()
    assert result.rms("x") == pytest.approx(math.sqrt(0.5 * (3.0**2 + 0.5**2)), rel=2e-3)
    low = run_up(highest=5.0)
    assert low.rms("x") == pytest.approx(3.0 / math.sqrt(2.0), rel=2e-3)


def test_orders_above_the_maximum_do_not_alias():
    turned = np.arange(0.0, 100.0, 1.0 / 200.0)
    columns = {"time": turned, "input_speed": 0.0 * turned + math.tau, "x": np.cos(math.tau * 30.5 * turned)}
    result = spectra(Result.from_columns(columns), turned, ["x"], highest=8.0)
    assert result.amplitude["x"].max() < 2e-3


@pytest.mark.parametrize("offset", [0.0, 1.0])
def test_line_of_varying_order_is_a_single_line_with_its_amplitude(offset):
    turned = np.arange(0.0, 200.0, 0.01)
    drive = 1.7 * turned - 0.5 * turned**2 / 400.0  # 1.7 turns per turn at the start, 1.2 at the end
    swing = 3.0 * np.cos(math.tau * (drive + offset * turned)) + 0.5 * np.cos(math.tau * 5.5 * turned)
    table = Result.from_columns({"time": turned, "input_speed": 0.0 * turned + math.tau, "x": swing})
    first, second = spectra(table, turned, ["x"], drive=drive).largest(2)["x"]
    assert first.amplitude == pytest.approx(3.0, rel=0.05)
    assert (first.low, first.high) == pytest.approx((1.24 + offset, 1.66 + offset), abs=0.03)
    assert (second.order, second.low, second.high) == pytest.approx((5.5, 5.5, 5.5))
    assert second.amplitude == pytest.approx(0.5, rel=0.02)
    # The order of the line over the turns of link 1 does not show this amplitude.
    assert spectra(table, turned, ["x"]).largest()["x"][0].amplitude < 2.0


@pytest.mark.parametrize("growth", [0.0, 1.0])
def test_side_lobes_are_no_orders_but_small_lines_outside_them_are(growth):
    """The second side lobes of a Hann window reach 0.4 % of the line, at a distance of 4.5 / turns."""
    turned = np.arange(0.0, 320.0, 0.01)
    large = (1.0 + growth * turned / 320.0) * np.cos(math.tau * turned)
    speed = 0.0 * turned + math.tau
    columns = {"time": turned, "input_speed": speed, "x": large}
    alone = spectra(Result.from_columns(columns), turned, ["x"], highest=3.0, turns=32.0)
    assert [line.order for line in alone.largest()["x"]] == [1.0]
    columns["x"] = large + 0.05 * np.cos(math.tau * 1.2 * turned)
    both = spectra(Result.from_columns(columns), turned, ["x"], highest=3.0, turns=32.0)
    assert [line.order for line in both.largest()["x"]] == pytest.approx([1.0, 1.2], abs=0.01)


@pytest.mark.parametrize("distance", [2.5, 3.5, 10.5])
def test_leakage_is_the_envelope_of_the_spectrum_of_the_hann_window(distance):
    spectrum = abs(np.sinc(distance) / (1.0 - distance**2))
    assert leakage(distance) == pytest.approx(spectrum, rel=1e-12)


def test_a_trend_is_no_order():
    turned = np.arange(0.0, 320.0, 0.01)
    columns = {"time": turned, "input_speed": 0.0 * turned + math.tau, "x": (turned / 320.0) ** 2}
    result = spectra(Result.from_columns(columns), turned, ["x"], highest=3.0, turns=32.0)
    assert result.largest()["x"] == []


def test_the_maximum_order_itself_is_listed_and_a_line_above_it_is_not():
    turned = np.arange(0.0, 320.0, 0.01)
    swing = np.cos(math.tau * 4.0 * turned) + np.cos(math.tau * 5.0 * turned)
    columns = {"time": turned, "input_speed": 0.0 * turned + math.tau, "x": swing}
    for highest, orders in ((4.0, [4.0]), (4.95, [4.0]), (5.0, [4.0, 5.0])):
        result = spectra(Result.from_columns(columns), turned, ["x"], highest=highest, turns=32.0)
        assert sorted(line.order for line in result.largest()["x"]) == orders
        if highest == 4.95:
            assert result.rms("x") == pytest.approx(math.sqrt(0.5), rel=1e-3)
        figure = order_figure(result, "title")
        assert figure.axes[0].get_xlim() == (0.0, highest)


def test_signals_with_the_same_amplitudes_share_a_row_of_the_figure():
    result = run_up(highest=8.0)
    more = {"x": result.spectrum["x"], "y": -result.spectrum["x"], "z": 2.0 * result.spectrum["x"]}
    several = replace(result, spectrum=more, units=dict.fromkeys(more, "N"))
    figure = order_figure(several, "title", speed_unit="rpm")
    labels = [axes.get_title(loc="left") or axes.get_ylabel() for axes in figure.axes]
    assert [label for label in labels if "[N]" in label and "amplitude" not in label] == [
        "x,\ny [N]",
        "z [N]",
    ]
    assert any("[rpm]" in axes.get_ylabel() for axes in figure.axes)


# --- modules whose lines follow from their geometry ---


def test_orders_of_r1_with_held_link_2_follow_from_its_teeth(fmu):
    """The reduced inertia consists of functions of 2 q and of s q, with s = z17 / z6."""
    result = studies.orders(held(stop=4.0), fmu, signals=["mesh_torque"], turns=20.0, highest=9.0)
    s = 1.7
    lines = by_order(result.largest(5)["mesh_torque"])
    assert set(lines) == {s, 2.0, round(2.0 + s, 6), 2.0 * s, round(2.0 + 2.0 * s, 6)}
    _, expected = imbalance_lines(held(), 10)
    # The other orders also contain a part of the coupling of both links.
    for order in (2.0, 3.7, 5.4):
        assert lines[order] == pytest.approx(expected[order], rel=1e-3)


def test_output_torque_of_a_held_planar_module_is_a_rectified_sine(fmu):
    scene = held(**PLANAR)
    k, expected = imbalance_lines(scene, 1)
    (sine,) = expected.values()
    result = studies.orders(scene, fmu, signals=["output_torque"], turns=30.0, highest=9.0)
    first, second, fourth = result.largest(3)["output_torque"]
    for line, times, share in (
        (first, 1, 1.0 / 2.0),
        (second, 2, 2.0 / (3.0 * math.pi)),
        (fourth, 4, 2.0 / (15.0 * math.pi)),
    ):
        assert line.order == pytest.approx(times * k, abs=0.5 / 30.0)
        assert line.amplitude == pytest.approx(share * sine, rel=5e-3)
    assert result.rms("output_torque") == pytest.approx(sine * math.sqrt(0.25 - 1.0 / math.pi**2), rel=0.01)


@pytest.mark.parametrize("omega1", [OMEGA1, -OMEGA1])
def test_pulse_of_a_planar_module_is_order_1_of_the_pinion_shaft(fmu, omega1):
    scene = held(1.0, omega1, **PLANAR, output_inertia=3.0)
    result = studies.orders(scene, fmu, of="drive_angle", signals=["mesh_torque"], turns=8.0, end=0.9)
    assert result.largest(1)["mesh_torque"][0].order == pytest.approx(1.0, abs=0.04)
    over_turns = studies.orders(scene, fmu, signals=["mesh_torque"], turns=6.0, end=0.9)
    order = over_turns.largest(1)["mesh_torque"][0].order
    # The shaft speeds up. Over turns of link 1 the order therefore moves away from 5/3.
    assert abs(order - 5.0 / 3.0) > 0.07


def test_example_shows_the_orders_and_the_speed_of_the_resonance(fmu):
    result = studies.orders(example("orders"), fmu, signals=["shaft_twist", "shaking_force_y"], highest=8.0)
    twist = result.largest(1)["shaft_twist"][0]
    assert twist.order == pytest.approx(5.0 / 3.0, rel=0.05)
    # The twist is largest during the run-up, the force at the top speed.
    assert 130.0 < twist.speed < 165.0
    lines = result.largest(2)["shaking_force_y"]
    assert {round(line.order, 1) for line in lines} == {1.0, 2.6}
    assert all(line.speed > 220.0 for line in lines)


def test_fast_pulses_are_recorded_in_shorter_steps(fmu):
    """Steps of 10 ms alias the pulses of 27 to 53 Hz. Car and controller keep these steps."""
    scene = load_scene(example("engine_launch")).replaced(run={"stop_time": 4.0})
    coarse = studies.orders(scene, fmu, signals=["output_torque"], turns=16.0)
    fine = studies.orders(
        scene.replaced(run={"communication_step": 5e-4}), fmu, signals=["output_torque"], turns=16.0
    )
    assert coarse.step < 7e-4
    assert coarse.highest == pytest.approx(HARMONICS * 5.0 / 3.0, rel=1e-2)
    line, reference = (result.largest(1)["output_torque"][0] for result in (coarse, fine))
    assert (line.low, line.high) == pytest.approx((reference.low, reference.high), abs=0.05)
    assert line.high == pytest.approx(5.0 / 3.0, abs=0.1)
    assert line.amplitude == pytest.approx(reference.amplitude, rel=0.05)


def test_shorter_steps_do_not_change_the_motion(fmu):
    scene = load_scene(example("engine_launch")).replaced(run={"stop_time": 2.0})
    recorder = order_run._Recorder(scene, fmu, 0.0, 2.0, None)
    once, often = recorder.record(), recorder.record(20)
    assert len(often) == 20 * (len(once) - 1) + 1
    for name in ("omega_out", "input_speed", "vehicle_speed", "drive_torque"):
        assert often[name][::20] == pytest.approx(once[name], rel=1e-4, abs=1e-4), name


def test_aliases_are_below_the_smallest_listed_line(fmu):
    """With half the step no line changes by more than the smallest listed fraction."""
    scene = held(2.0, **PLANAR)
    first = studies.orders(scene, fmu, signals=["output_torque"], highest=8.0)
    shorter = scene.replaced(run={"communication_step": 0.5 * first.step})
    second = studies.orders(shorter, fmu, signals=["output_torque"], highest=8.0)
    size = min(first.order.size, second.order.size)
    a, b = first.amplitude["output_torque"][:size], second.amplitude["output_torque"][:size]
    assert np.abs(a - b).max() < MIN_SHARE * b.max()


def test_too_long_step_of_a_signal_is_rejected_with_a_sufficient_step(fmu):
    scene = load_scene(example("engine_launch")).replaced(run={"stop_time": 4.0})
    words = r"= ([\d.]+) ms or less .got 0.01 s.: the scene computes drive_torque once per communication step"
    step = float(re.search(words, rejection(studies.orders, scene, fmu, signals=["drive_torque"]))[1])
    shorter = scene.replaced(run={"communication_step": 4.0 / math.ceil(4e3 / step)})
    assert studies.orders(shorter, fmu, signals=["drive_torque"]).step <= 1.001e-3 * step


def test_orders_have_speeds_in_rpm():
    result = run_up(highest=8.0)
    line = result.largest(1)["x"][0]
    text = result.lines(1, speed_unit="rpm")["x"]["order 2.5"]
    assert text.endswith(f"at {line.speed * 30.0 / math.pi:.4g} rpm")


# --- omitted signals and errors ---


def test_constant_signals_are_omitted_unless_requested(fmu, tmp_path):
    scene = held(1.0, **PLANAR)
    swing = {"input_torque", "output_torque", "satellite_force_y", "satellite_force_z"}
    # The heavy output moves a little.
    assert set(studies.orders(scene, fmu).amplitude) == swing | {"omega_out"}
    for in_hz, names in ((True, ["input_torque", "shaking_force_x", "omega1"]), (False, ["omega1"])):
        result = studies.orders(scene, fmu, signals=names)
        assert list(result.amplitude) == names
        assert result.largest()["omega1"] == []
        figure = order_figure(result, "title", in_hz)
        figure.savefig(tmp_path / "orders.png")
        drawn = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
        # The figure omits the constant signals.
        assert len(drawn) == 2 * in_hz
        if in_hz:
            assert drawn[-1].get_xlabel() == "frequency [Hz]"
        else:
            assert figure.texts[-1].get_text() == "all signals are constant"
        assert read_columns(result.write(tmp_path)["orders"])[0]["omega1"] == [0.0] * result.order.size


def test_run_up_from_rest_starts_with_the_rotation(fmu):
    ramp = {"kind": "ramp", "omega1": None, "initial": 0.0, "final": 100.0, "start": 0.5, "duration": 2.0}
    scene = held(2.5, **PLANAR).replaced(drive=ramp)
    result = studies.orders(scene, fmu, signals=["mesh_torque"], turns=4.0, highest=6.0)
    # The middle of the first window is at 2 turns.
    middle = 0.5 + np.sqrt(2.0 * math.tau * 2.0 * np.arange(1, result.time.size + 1) / 50.0)
    assert result.time == pytest.approx(middle, abs=0.01)
    assert result.largest(1)["mesh_torque"][0].order == pytest.approx(5.0 / 3.0, abs=0.1)
    torque = held(1.0, input_inertia=0.1, **PLANAR).replaced(
        drive={
            "kind": "torque_table",
            "omega1": None,
            "time": [0.0, 0.1, 0.11, 1.0],
            "drive_torque": [0.0, 0.0, 20.0, 20.0],
        }
    )
    assert studies.orders(torque, fmu, signals=["mesh_torque"], turns=4.0).time[0] > 0.1


@pytest.mark.parametrize("omega1", [OMEGA1, -OMEGA1])
def test_components_of_the_bearing_force_are_two_circles(fmu, omega1):
    """Planar, link 2 at rest: the satellite orbits at omega1 and rotates at (1 + R0 / r) omega1."""
    scene = held(2.0, omega1, **PLANAR)
    result = studies.orders(
        scene, fmu, signals=["satellite_force_x", "satellite_force_y", "satellite_force_z"], turns=15.0
    )
    k, mass = PLANAR["sun_radius"] / PLANAR["satellite_radius"], scene.parameters().get("imbalance_mass", 1.0)
    expected = {1.0: mass * OMEGA1**2 * 0.16, 1.0 + k: mass * ((1.0 + k) * OMEGA1) ** 2 * 0.04}
    assert result.largest()["satellite_force_x"] == []
    phases = []
    for axis in "yz":
        lines = result.largest(2)[f"satellite_force_{axis}"]
        for line in lines:
            order = min(expected, key=lambda expected_order: abs(expected_order - line.order))
            assert line.order == pytest.approx(order, abs=0.02)
            assert line.amplitude == pytest.approx(expected[order], rel=5e-3)
        phases.append(next(line.phase for line in lines if line.order < 1.5))
        assert result.units[f"satellite_force_{axis}"] == "N"
    # The force rotates: its components differ by a quarter of a turn.
    assert abs(math.sin(phases[0] - phases[1])) == pytest.approx(1.0, abs=1e-3)


RAMP = {"kind": "ramp", "omega1": None, "initial": 0.0, "final": 50.0, "duration": 1.0}


@pytest.mark.parametrize(
    "drive, options, words", [*REJECTED["orders"], (RAMP, {"begin": 0.0}, "decreasing at 0 s")]
)
def test_invalid_orders_are_rejected_in_a_sentence(fmu, drive, options, words):
    scene = held(1.0, input_inertia=0.1).replaced(drive=drive)
    assert_rejected(words, studies.orders, scene, fmu, **options)


def test_run_without_oscillation_or_pulses_is_rejected(fmu, monkeypatch):
    monkeypatch.setattr(order_run, "SIGNALS", ("omega1", "input_speed"))
    assert_rejected("all signals are constant: omega1, input_speed", studies.orders, held(stop=1.0), fmu)
    with pytest.raises(
        InertiaModuleError, match=r"must be kinematic, rigid or elastic for orders \(got averaged\)"
    ):
        studies.orders(held(fidelity="averaged"), fmu)
    locked = load_scene(example("planar")).replaced(run={"stop_time": 3.0})
    words = r"must be increasing .got constant or decreasing at .* s.; choose another time range"
    assert_rejected(words, studies.orders, locked, fmu, of="drive_angle", signals=["omega2"])


def test_command_writes_spectrum_waterfall_summary_and_plot(fmu, tmp_path):
    scene = example("planar")
    words = ["--signal", "input_torque", "--turns", "4", "--highest", "20", "--from"]
    options = [*words, "0 s", "--fmu", fmu, "-o", tmp_path]
    printed = stdout_of("orders", scene, *options, "--to", "600 ms")
    result = studies.orders(scene, fmu, signals=["input_torque"], end=0.6, turns=4.0, highest=20.0)
    first = result.largest()["input_torque"][0]
    assert f"order {first.order:.4g}" in printed
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary == json.loads(json.dumps(result.as_dict()))
    assert summary["signals"]["input_torque"]["largest"][0]["amplitude"] == first.amplitude
    columns, units = read_columns(tmp_path / "orders.csv")
    assert columns["input_torque"] == result.amplitude["input_torque"].tolist()
    assert units["input_torque"] == "N.m"
    rows, _ = read_columns(tmp_path / "waterfall.csv")
    assert sorted(set(rows["time"])) == result.time.tolist()
    assert (tmp_path / "orders.png").read_bytes().startswith(b"\x89PNG")
    printed = json.loads(stdout_of("orders", scene, *options, "--to", "600 ms", "--json"))
    assert printed["signals"] == summary["signals"]
    more = stdout_of(
        "orders", scene, *options, "--to", "600 ms", "--mat", "--hz", "--signal", "shaking_force_x"
    )
    assert "0 N, constant" in more
    assert "orders.mat" in more
    assert (tmp_path / "orders.mat").exists()
