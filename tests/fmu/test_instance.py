"""Test an FMU by names of variables: each error is one sentence, and the instance continues."""

import numpy as np
import pytest
from rejected import REJECTED, assert_rejected, rejection

from inertia_module.common.errors import FmuError
from inertia_module.fmi.simulate import Fmu, simulate_fmu

from .conftest import R1


@pytest.fixture
def fmu(fmu_path):
    with Fmu(fmu_path, inputs=R1) as fmu:
        fmu.advance(0.01)
        yield fmu


# --- states ---


def test_invalid_state_is_rejected_and_the_run_continues(fmu):
    before = fmu.save()
    for junk in (b"junk", b"", bytes(19232), "junk", None, 7):
        assert "state" in rejection(fmu.restore, junk, 5.0)
        assert fmu.time == pytest.approx(0.01)
        assert fmu.save() == before
    fmu.advance(0.01)
    assert fmu["omega_out"] > 0.0


def test_state_of_another_instance_is_rejected_and_an_unused_state_is_freed(fmu, fmu_path):
    saved, unused = fmu.get_state(), fmu.get_state()
    pointer = unused.state
    assert pointer.value
    del unused
    assert not pointer.value
    with Fmu(fmu_path, inputs=R1) as other:
        foreign = other.get_state()  # The state is freed with the instance.
        for invalid in (foreign, None):
            assert "a state must be from get_state of this instance" in rejection(fmu.set_state, invalid)
    fmu.advance(0.01)
    fmu.set_state(saved)
    assert fmu.time == pytest.approx(0.01)
    fmu.advance(0.01)


USES = (
    lambda fmu: fmu.read(("omega_out",)),
    lambda fmu: fmu["contact_mode"],
    lambda fmu: fmu.set(omega1=1.0),
    lambda fmu: fmu.advance(0.01),
    lambda fmu: fmu.get_state(),
    lambda fmu: fmu.save(),
    lambda fmu: fmu.restore(b"junk"),
    lambda fmu: fmu.rates(("omega_out",)),
    lambda fmu: fmu.set_rates(omega1=1.0),
    lambda fmu: fmu.jacobian(("omega_out",), ("omega1",)),
    lambda fmu: fmu.set_logging(True),
)


def test_closed_instance_raises_an_error(fmu_path):
    fmu = Fmu(fmu_path)
    fmu.close()
    fmu.close()
    for use in USES:
        assert f"{fmu_path.name} is closed" in rejection(use, fmu)


# --- values ---

VALUES = {
    "imbalance_mass": ("1200 g", 1.2),
    "shaft_angle": ("60 deg", np.pi / 3.0),
    "shaft_stiffness": ("0.4 kNm/rad", 400.0),
    "satellites": ("3", 3.0),
    "layout": ("planar", 1.0),
    "housing_freewheel": ("false", 0.0),
    "output_freewheel": (np.True_, 1.0),
    "modules": (np.int64(2), 2.0),
    "output_inertia": (np.float32(0.25), 0.25),
}


def test_values_may_have_units_and_names(fmu_path):
    with Fmu(fmu_path, {name: value for name, (value, _) in VALUES.items()}) as fmu:
        for name, (_, expected) in VALUES.items():
            assert fmu[name] == pytest.approx(expected, rel=1e-15)
        fmu.set(omega1="3000 rpm")
        assert fmu["omega1"] == pytest.approx(100.0 * np.pi)


@pytest.mark.parametrize(
    "name, value, words",
    [*REJECTED["values"], ("imbalance_mass", None, "must be a number in kg.* .got None.")],
)
def test_invalid_value_is_rejected_by_name(fmu_path, name, value, words):
    assert_rejected(f"^{name} {words}", Fmu, fmu_path, {name: value})


@pytest.mark.parametrize("bad", [{"omega2_": 1.0}, {"load_torque": "10 rpm"}])
def test_no_value_is_set_if_any_value_is_invalid(fmu, bad):
    rejection(fmu.set, omega1=7.0, **bad)
    assert fmu["omega1"] == 100.0


def test_single_name_is_accepted_as_names(fmu, fmu_path):
    assert fmu.read("omega_out") == fmu.read(("omega_out",))
    table = simulate_fmu(fmu_path, R1, 0.02, 0.01, outputs="omega_out")
    assert table.names == ["time", "omega1", "load_torque", "omega_out"]


@pytest.mark.parametrize(
    "changes, words", [({"type": "String"}, "a String"), ({"dimensions": [3]}, "an array of Real")]
)
def test_a_text_or_an_array_is_no_number_and_is_named(fmu, changes, words):
    for name, value in changes.items():
        setattr(fmu.variables["omega1"], name, value)
    for use in (lambda: fmu["omega1"], lambda: fmu.set(omega1="x"), lambda: fmu.jacobian("omega2", "omega1")):
        assert rejection(use) == f"{fmu.path.name}: omega1 must be a number (got {words})"


# --- a whole run from a table ---


@pytest.mark.parametrize("stop_time", [1e-3, 1e-29])
def test_stop_time_far_below_the_step_is_a_single_step(fmu_path, stop_time):
    assert simulate_fmu(fmu_path, R1, stop_time, 1e7).time.tolist() == [0.0, stop_time]


def test_run_with_too_many_steps_is_rejected_before_memory_is_allocated(fmu_path):
    words = r"step must be at least 1 s, for at most 100,000,000 steps \(got 1e-12\)$"
    assert_rejected(words, simulate_fmu, fmu_path, R1, 1e8, 1e-12)


def run(fmu_path, inputs, **more):
    return simulate_fmu(fmu_path, inputs, 0.05, 0.01, parameters={"output_inertia": 0.1}, **more)


def test_columns_in_other_units_run_as_in_si(fmu_path, tmp_path):
    expected = run(fmu_path, {"time": [0.0, 0.05], "omega1": [50.0, 100.0], "load_torque": 4.0})
    speeds = [value * 30.0 / np.pi for value in (50.0, 100.0)]
    (tmp_path / "rig.csv").write_text(
        f"time [ms];load_torque [kNm];omega1 [rpm]\n0;0,004;{speeds[0]}\n50;0,004;{speeds[1]}\n".replace(
            ".", ","
        )
    )
    result = run(fmu_path, tmp_path / "rig.csv")
    assert result.units["omega1"] == "rad/s"
    for name in expected:
        assert result[name] == pytest.approx(expected[name], rel=1e-9, abs=1e-9)
    again = run(fmu_path, {"omega1": "955 rpm", "load_torque": 4.0})
    assert again["omega1"][0] == pytest.approx(955.0 * np.pi / 30.0)


@pytest.mark.parametrize("heading, words", REJECTED["headings"])
def test_ambiguous_column_is_rejected(fmu_path, tmp_path, heading, words):
    (tmp_path / "rig.csv").write_text(f"time,{heading}\n0,1\n1,2\n")
    assert_rejected(words, run, fmu_path, tmp_path / "rig.csv")


def test_measured_columns_are_part_of_the_result(fmu_path, tmp_path):
    (tmp_path / "rig.csv").write_text(
        "time,omega1,load_torque,omega_out [rpm],energy_in [kJ],contact_mode\n"
        "0,100,4,0,0,0\n0.05,100,4,60,1,2\n"
    )
    table = run(fmu_path, tmp_path / "rig.csv")
    plain = run(fmu_path, {"omega1": 100.0, "load_torque": 4.0})
    assert np.array_equal(table["omega_out"], plain["omega_out"])
    assert table["omega_out_measured"][-1] == pytest.approx(2.0 * np.pi)
    assert table.units["omega_out_measured"] == "rad/s"
    assert table["energy_in_measured"][-1] == pytest.approx(1000.0)
    assert table["contact_mode_measured"][-1] == 2.0


WIDE = (
    "Rig 3\nsep=;\ntime;omega1;load_torque;note;valve;oil [°C];omega_out;energy_in [blink];\n"
    "ms;1/min;Ncm;;;;;;\n0;955;400;start;true;n/a;;1;\n50;1.910;400;;false;;1,5;2;\n"
)


def test_unknown_columns_are_ignored_with_a_warning(fmu_path, tmp_path):
    (tmp_path / "rig.csv").write_text(WIDE)
    with pytest.warns(UserWarning, match="not inputs or readable outputs of .* are ignored: ") as caught:
        table = run(fmu_path, tmp_path / "rig.csv")
    names = str(caught[0].message).rpartition(": ")[2].split(", ")
    assert sorted(names) == ["energy_in", "note", "oil", "omega_out", "valve"]
    expected = run(fmu_path, {"time": [0.0, 0.05], "omega1": [100.0, 200.0], "load_torque": 4.0})
    assert table["omega1"] == pytest.approx(expected["omega1"], rel=1e-3)
    assert table["load_torque"] == pytest.approx(4.0)
    (tmp_path / "rig.csv").write_text("# rig\ntime,omega1,load_torque\n0,100,4\n0.05,,4\n")
    assert_rejected(
        r"rig\.csv line 4: omega1 must be a finite number \(got ''\)$", run, fmu_path, tmp_path / "rig.csv"
    )
    # Tables in memory reject unknown names, unlike files.
    assert_rejected("unknown input or output 'note'", run, fmu_path, {"omega1": 100.0, "note": 1.0})


def test_times_outside_the_run_are_rejected_or_cause_a_warning(fmu_path, tmp_path):
    (tmp_path / "rig.csv").write_text("time,omega1\n1700000000,100\n1700000001,101\n")
    words = (
        r"times of .*rig\.csv must be within the run, 0 to 0\.05 s \(got 1700000000 to .* seconds since 1970"
    )
    assert_rejected(words, run, fmu_path, tmp_path / "rig.csv")
    assert_rejected("times of inputs must be", run, fmu_path, {"time": [7.0, 8.0], "omega1": [100.0, 101.0]})
    with pytest.warns(UserWarning, match="uses less than 1 % of this range: name their unit, such as ms"):
        run(fmu_path, {"time": [0.0, 50.0], "omega1": [100.0, 101.0]})


def test_two_rows_of_the_same_time_are_a_step(fmu_path, tmp_path):
    (tmp_path / "rig.csv").write_text(
        "time,omega1,load_torque\n0,100,4\n0.02,100,4\n0.02,100,8\n0.05,100,8\n"
    )
    assert run(fmu_path, tmp_path / "rig.csv")["load_torque"].tolist() == [4.0, 4.0, 8.0, 8.0, 8.0, 8.0]


@pytest.mark.parametrize("name, value", [("stop_time", 0.0), ("step", -0.1), ("step", float("nan"))])
def test_run_without_duration_is_rejected(fmu_path, name, value):
    times = {"stop_time": 1.0, "step": 0.1, name: value}
    assert_rejected(
        rf"{name} must be a positive number of seconds \(got {value}\)", simulate_fmu, fmu_path, R1, **times
    )


def test_rates_of_inputs_are_rejected_in_fmi_3(fmu_path):
    if not fmu_path.stem.endswith("3"):
        pytest.skip("FMI 2.0 has them")
    with Fmu(fmu_path, inputs=R1) as fmu, pytest.raises(FmuError, match="does not support input derivatives"):
        fmu.set_rates(omega1=1.0)


def test_column_of_a_table_tunes_parameters(fmu_path):
    table = {"time": [0.0, 0.049, 0.05, 0.1], **R1}
    tuned = simulate_fmu(fmu_path, {**table, "output_friction": [0.0, 0.0, 0.5, 0.5]}, 0.1, 0.01)["omega_out"]
    plain = simulate_fmu(fmu_path, table, 0.1, 0.01)["omega_out"]
    assert tuned[:6].tolist() == plain[:6].tolist()
    assert all(tuned[6:] < plain[6:])
