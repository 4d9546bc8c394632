"""Fidelity "auto": chosen for a scene from trial runs of that scene."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from inertia_module.contract.variables import BY_NAME, COMPUTED
from inertia_module.fidelity import trials
from inertia_module.fidelity.choice import NoneMeets
from inertia_module.fidelity.levels import NOT_MODELLED, event
from inertia_module.fidelity.tradeoff import scene_study
from inertia_module.fidelity.trials import run_in_process, window_errors, window_means
from inertia_module.harness.simulate import Result
from inertia_module.scene import SceneError, read_scene

SCENE = """
[mechanism]
fidelity = "auto"
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "shaft"
inertia = "0.2 kg.m2"
viscous_friction = "0.1 N.m.s/rad"
[accuracy]
error = "2 %"
window = "0.1 s"
[run]
stop_time = "0.2 s"
communication_step = "5 ms"
outputs = ["omega_out", "output_torque_mean"]
"""


def scene(text=SCENE):
    return read_scene(text, Path())


def changed(old, new):
    assert old in SCENE
    return SCENE.replace(old, new)


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    """Measurements of these tests are kept in a folder of their own."""
    name = trials.measurement_file
    monkeypatch.setattr(trials, "measurement_file", lambda scene: tmp_path / name(scene).name)
    return tmp_path


# --- the scene ---


def test_auto_needs_the_error():
    with pytest.raises(SceneError, match=r"accuracy.error must be given, such as '1 %', is missing"):
        scene(changed('error = "2 %"', ""))


@pytest.mark.parametrize(
    "old, new, key",
    [
        ("[accuracy]", "[accuracy]\ntolerance = 1e-7", "accuracy.tolerance must not be given, is 1e-07"),
        ("[mechanism]", '[mechanism]\nmethod = "event"', "mechanism.method must not be given, is 0"),
        ("[mechanism]", "[mechanism]\nmax_step = 1e-3", "mechanism.max_step must not be given, is 0.001"),
    ],
)
def test_what_auto_chooses_is_not_given_too(old, new, key):
    with pytest.raises(SceneError, match=f"^with mechanism.fidelity = 'auto' {key}: "):
        scene(changed(old, new))


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('"2 %"', '"0 %"', "accuracy.error must be a number above 0 and of at most 1, is '0 %'"),
        ('"2 %"', '"2 m"', "accuracy.error must be a number .*, is '2 m'"),
        ('"0.1 s"', '"0 s"', "accuracy.window must be a number above 0 in s, .*, is '0 s'"),
        ('"auto"', '"automatic"', r"mechanism.fidelity must be .*, or auto, is 'automatic'"),
        ('"omega_out",', '"omega_oat",', "run.outputs .*, has 'omega_oat' .did you mean omega_out"),
    ],
)
def test_bad_keys_are_refused(old, new, words):
    with pytest.raises(SceneError, match=words):
        scene(changed(old, new))


def test_another_fidelity_can_be_asked_for():
    rigid = scene(changed('fidelity = "auto"', 'fidelity = "kinematic"')).with_fidelity("rigid")
    assert rigid.parameters()["fidelity"] == 2.0
    auto = rigid.with_fidelity("auto", 0.05)
    assert auto.chooses_fidelity
    assert auto.accuracy.error == 0.05
    with pytest.raises(SceneError, match=r"mechanism\.fidelity must be .*, is 'ideal'"):
        rigid.with_fidelity("ideal")


def test_a_scene_is_not_run_before_its_fidelity_is_chosen(tmp_path):
    from inertia_module.scene import run_scene

    with pytest.raises(SceneError, match="must be chosen first"):
        run_scene(scene(), tmp_path / "none.fmu")


def test_a_scene_with_columns_from_a_file_can_be_replaced(tmp_path):
    (tmp_path / "drive.csv").write_text("time,omega1\n0,0\n1,100\n")
    text = changed('kind = "constant"\nomega1 = "100 rad/s"', 'kind = "table"\nfile = "drive.csv"')
    found = read_scene(text, tmp_path).replaced(run={"stop_time": 0.1})
    assert found.run.stop_time == 0.1
    assert found.drive.signal()(0.5) == 50.0


# --- the levels of fidelity ---


def test_every_name_that_a_level_lacks_is_one_of_the_module():
    for lacking in NOT_MODELLED.values():
        assert set(lacking) <= set(COMPUTED) <= set(BY_NAME)


def test_averaged_lacks_what_pulses_and_what_has_a_phase():
    lacking = NOT_MODELLED[1]
    assert "no pulses" in lacking["output_torque"]
    assert "no drive angle" in lacking["imbalance_acceleration"]
    assert not {"output_torque_mean", "omega_out"} & lacking.keys()


def test_a_driven_mass_is_rigid_with_the_hub_where_there_is_no_shaft():
    shaft = scene(changed("[mechanism]", "[mechanism]\ndriven_inertia = 0.3\noutput_inertia = 0.1"))
    rigid = trials.at_level(shaft, event(2, 1e-6))
    assert rigid.parameters()["output_inertia"] == pytest.approx(0.1 + 0.3 + 0.2)
    elastic = trials.at_level(shaft, event(3, 1e-6))
    assert elastic.parameters()["output_inertia"] == 0.1
    assert elastic.parameters()["driven_inertia"] == pytest.approx(0.3 + 0.2)
    assert trials.reference_level(shaft).fidelity == 3
    assert trials.reference_level(scene()).fidelity == 2


# --- errors over windows ---


def test_windows_take_in_what_is_left_over():
    assert window_means(np.arange(7.0), 3) == pytest.approx([1.0, 4.5])
    assert window_means(np.arange(2.0), 5) == pytest.approx([0.5])


def record(**columns):
    size = len(next(iter(columns.values())))
    return Result.from_columns({"time": np.arange(size) * 0.1, "energy_in": np.full(size, 50.0), **columns})


def after_start(*steps):
    """A column: the start, then what is repeated in each step."""
    return np.concatenate([[0.0], np.tile(steps, 5)])


def test_means_are_compared_over_windows_and_not_by_the_instant():
    exact, late = after_start(0.0, 0.0, 2.0, 2.0), after_start(2.0, 2.0, 0.0, 0.0)
    assert window_errors(record(omega_out=late), record(omega_out=exact), 0.4, 2)["omega_out"] == 0.0
    assert window_errors(record(omega_out=late), record(omega_out=exact), 0.2, 2)["omega_out"] == 1.0


def test_what_pulses_is_compared_by_its_rms_too():
    exact, flat = after_start(3.0, -1.0), after_start(1.0, 1.0)
    pulsing = window_errors(record(output_torque=flat), record(output_torque=exact), 0.2, 2)
    assert pulsing["output_torque"] == pytest.approx((np.sqrt(5.0) - 1.0) / 3.0)
    mean = window_errors(record(output_torque_mean=flat), record(output_torque_mean=exact), 0.2, 2)
    assert mean["output_torque_mean"] == 0.0


def test_what_a_level_lacks_has_no_error():
    both = record(omega2=np.ones(5), rhs_evaluations=np.ones(5))
    found = window_errors(both, both, 0.2, 1)
    assert np.isnan(found["omega2"])
    assert found["rhs_evaluations"] == 0.0


def test_energies_are_measured_by_the_energy_in():
    exact, other = record(energy_residual=np.zeros(5)), record(energy_residual=np.full(5, 0.5))
    assert window_errors(other, exact, 0.2, 2)["energy_residual"] == pytest.approx(0.01)


# --- the choice ---


def test_the_module_in_process_is_the_plant_of_the_same_loop(built):
    from inertia_module.scene import run_scene

    rigid = trials.at_level(scene(), event(2, 1e-8))
    ours = run_in_process(rigid).record
    fmu = run_scene(rigid, built / "InertiaModule.fmu").record
    for name in ("omega_out", "output_torque_mean", "load_torque"):
        assert ours[name] == pytest.approx(fmu[name], rel=1e-12, abs=1e-12)


def test_the_chosen_level_meets_the_error_in_all_outputs():
    chosen, choice = trials.choose(scene())
    assert not chosen.chooses_fidelity
    exact = run_in_process(trials.at_level(scene(), event(2, 1e-12))).record
    found = run_in_process(chosen).record
    errors = window_errors(found, exact, 0.1, int(chosen.parameters()["fidelity"]))
    assert all(errors[name] <= 0.02 for name in choice.wanted)
    assert choice.row.wall_time > 0.0


def test_asked_for_the_acceleration_it_picks_a_level_that_has_it():
    asked = scene(changed('outputs = ["omega_out",', 'outputs = ["imbalance_acceleration",'))
    chosen, choice = trials.choose(asked)
    assert chosen.parameters()["fidelity"] == 2.0
    assert choice.row.errors["imbalance_acceleration"] <= 0.02


def test_measurements_are_kept_whatever_error_and_outputs_are_asked_for(monkeypatch, kept):
    first = trials.trial_rows(scene())
    assert len(list(kept.glob("trials-*.csv"))) == 1

    def fail(*_):
        raise AssertionError("measured again")

    monkeypatch.setattr(trials, "run_in_process", fail)
    again = trials.trial_rows(scene(changed('"2 %"', '"3 %"').replace('"omega_out", ', "")))
    assert [row.label for row in again] == [row.label for row in first]
    assert [row.wall_time for row in again] == pytest.approx([row.wall_time for row in first], nan_ok=True)


def test_another_mechanism_is_measured_anew():
    one, other = scene(), scene(changed("[mechanism]", "[mechanism]\nimbalance_mass = 2"))
    assert trials.measurement_file(one) != trials.measurement_file(other)


def test_broken_measurements_are_measured_anew():
    path = trials.measurement_file(scene())
    path.write_text("{")
    assert trials.trial_rows(scene())


def test_an_error_that_no_level_meets_is_refused():
    with pytest.raises(NoneMeets, match="is met by no level of fidelity"):
        trials.choose(scene(changed('"2 %"', "1e-15")))


def test_a_scene_is_measured_in_longer_steps_too():
    short = scene().replaced(run={"stop_time": 0.05})
    study = scene_study(short)
    assert {row.communication_step for row in study.rows} == {0.005, 0.05}
    done = [row for row in study.rows if not row.failure]
    assert all(row.errors["worst"] == row.worst(short.run.outputs) for row in done)
    assert dataclasses.replace(done[0], failure="no").worst(["omega_out"]) == float("inf")


# --- losses ---


WOUND = {"[drive]": "freewheel_stiffness = 2e3\n[drive]"}
BY_TORQUE = {
    '[drive]\nkind = "constant"': 'mesh_efficiency = 0.95\ninput_inertia = 0.2\n[drive]\nkind = "torque"',
    'omega1 = "100 rad/s"': 'drive_torque = "20 N.m"\nomega1 = "100 rad/s"',
}


@pytest.mark.parametrize(("changes", "refusing"), [(WOUND, "elastic, timestepping"), (BY_TORQUE, "averaged")])
def test_level_that_refuses_the_losses_of_a_scene_is_not_chosen(changes, refusing):
    text = changed('"2 %"', '"100 %"')
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    lossy = scene(text)
    rows = trials.trial_rows(lossy)
    assert {row.level for row in rows if "must be" in row.failure} == {refusing}
    chosen, choice = trials.choose(lossy)
    assert choice.row.level != refusing
    assert run_in_process(chosen).record.last()["time"] == pytest.approx(0.2)
    # what refuses and might be cheaper is told with the sentence
    assert any(label.startswith(refusing) for label in choice.passed)


def test_weights_that_averaged_leaves_out_are_in_its_error():
    def averaged(text):
        (row,) = (row for row in trials.trial_rows(scene(text)) if row.level == "averaged")
        return row.errors["output_torque_mean"]

    assert averaged(changed("[drive]", "gravity = 1000.0\n[drive]")) > 3.0 * averaged(SCENE)


def test_measurements_are_made_anew_where_the_equations_of_losses_change(monkeypatch):
    named = []
    monkeypatch.setattr(trials, "sources", lambda *patterns: named.extend(patterns) or {})
    trials.measurement_file(scene())
    assert any(Path("kernel/general/motion.py").match(pattern) for pattern in named)
