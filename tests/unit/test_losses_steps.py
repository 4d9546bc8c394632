"""Losses of a prescribed motion and in fixed steps, against closed forms and the method event."""

import pytest
from energy_runs import COMBINATIONS, ROUNDING, largest_gain
from scenes import DRIVEN, SCENES, advanced, started
from test_losses import ACCOUNTS, ALL, CAUSE, LOSSES, MEANS, WIND_UP, every_scene, passed

from inertia_module.memory import Refused

RATIOS = [0.5, 1.0, -0.3, 1.4]
# gravity acts with one module only, and shows with one heavy imbalance
HEAVY = {"modules": 1, "satellites": 1, "imbalance_mass": 3.0}
SPEEDS = ("input_speed", "omega2", "omega_hub", "omega_out")


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("losses", [*LOSSES, "all"])
def test_prescribed_motion_pays_for_each_loss_and_nothing_else(compiled, layout, ratio, losses):
    values = ALL if losses == "all" else LOSSES[losses]
    module = started(compiled, SCENES[layout], HEAVY, values, fidelity=0, kinematic_ratio=ratio)
    lost = dict.fromkeys(ACCOUNTS, 0.0)
    for speed, rate in ((100.0, 0.0), (60.0, 800.0), (-40.0, -300.0)):
        module.set(omega1=speed)
        module.set_rates(omega1=rate)
        link2 = module["omega2"]
        module.advance(0.03)
        # the ratio jumps with omega1 at the beginning: part of the means
        gained = 0.0 if rate else module.derived.J2 * (module["omega2"] - link2) / 0.03
        assert abs(module["energy_residual"]) < 1e-11 * passed(module)
        balance = module["mesh_torque_mean"] + module["housing_torque_mean"] - module["output_torque_mean"]
        if losses not in {"all", "viscous"} and rate == 0.0:
            assert balance == pytest.approx(gained, abs=1e-9 * abs(module["mesh_torque_mean"]) + 1e-12)
        for name in ACCOUNTS:
            assert module[name] >= lost[name], name
            lost[name] = module[name]
    cause = f"energy_lost_{CAUSE.get(losses, losses)}"
    assert losses == "all" or {name for name in ACCOUNTS if lost[name] != 0.0} <= {cause}
    if losses in ("mesh", "journal", "viscous") and ratio != 1.0:
        assert lost[cause] > 0.0


@pytest.mark.parametrize("ratio", [0.5, 1.4])
@pytest.mark.parametrize("slope", [1.0, -1.0])
def test_prescribed_motion_has_the_efficiency_of_planetary_gears(kernel, ratio, slope):
    """Drives alone that are sped up or slowed down: M2 = f k^2 J16 (alpha1 - alpha2), of one sign."""
    efficiency, inertia = 0.9, 0.01
    module = started(
        kernel,
        fidelity=0,
        kinematic_ratio=ratio,
        imbalance_mass=0.0,
        drive_inertia=inertia,
        mesh_efficiency=efficiency,
        omega1=100.0,
    )
    rate = 500.0 * slope
    module.set_rates(omega1=rate)
    module.advance(0.1)
    slip = (1.0 - ratio) * 100.0
    ideal = inertia * (1.0 - ratio) * rate
    factor = 1.0 / efficiency if ideal * slip > 0.0 else 1.0 / (2.0 - efficiency)
    assert module["mesh_torque"] == pytest.approx(factor * ideal, rel=1e-12)
    mean_slip = (1.0 - ratio) * (100.0 + 0.5 * rate * 0.1)
    lost = (1.0 - efficiency) * abs(factor * ideal * mean_slip) * 0.1
    assert module["energy_lost_mesh"] == pytest.approx(lost, rel=1e-10)
    assert module["energy_lost"] == module["energy_lost_mesh"]


@every_scene
@pytest.mark.parametrize("losses", [*LOSSES, "all"])
def test_fixed_steps_come_to_what_events_say(compiled, scene, losses):
    values = ALL if losses == "all" else LOSSES[losses] | (HEAVY if losses == "gravity" else {})
    exact = advanced(started(compiled, scene, values, tolerance=1e-9), 0.03)
    energy = passed(exact)
    errors = []
    for step in (4e-4, 5e-5):
        module = advanced(started(compiled, scene, values, method=1, max_step=step), 0.03)
        errors.append(max(abs(module[name] - exact[name]) for name in SPEEDS) / exact["input_speed"])
        assert module["energy_residual"] > -1e-12 * energy
        for name in ACCOUNTS:
            assert abs(module[name] - exact[name]) < 1e-3 * energy, name
            assert (module[name] == 0.0) == (exact[name] == 0.0), name
    for name in MEANS[:4]:
        assert module[name] == pytest.approx(exact[name], rel=1e-4, abs=1e-2), name
    assert errors[1] < max(0.25 * errors[0], 1e-6)
    assert errors[1] < 2e-5


@pytest.mark.parametrize("scenes", [SCENES, DRIVEN], ids=["by speed", "by torque"])
@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("losses", [*LOSSES, "all"])
def test_error_of_fixed_steps_falls_with_the_square_where_nothing_switches(compiled, scenes, layout, losses):
    values = ALL if losses == "all" else LOSSES[losses]
    # link 2 alone, far from both freewheels
    apart = {"omega2_start": 60.0, "omega_out_start": 1000.0}
    exact = advanced(started(compiled, scenes[layout], HEAVY, values, apart, tolerance=1e-12), 0.01)
    errors = []
    for step in (2e-4, 5e-5):
        module = advanced(
            started(compiled, scenes[layout], HEAVY, values, apart, method=1, max_step=step), 0.01
        )
        errors.append(abs(module["omega2"] - exact["omega2"]))
    assert errors[1] == pytest.approx(errors[0] / 16.0, rel=0.3)


@pytest.mark.parametrize("combination", COMBINATIONS, ids=", ".join)
@pytest.mark.parametrize("seed", range(6))
def test_no_random_run_with_losses_makes_energy(compiled, combination, seed):
    assert largest_gain(seed, combination, compiled, lossy=True) < ROUNDING


@pytest.mark.parametrize("drive", [0, 1], ids=["by speed", "by torque"])
@pytest.mark.parametrize("step", [1e-4, 0.01, 1.0])
def test_locked_up_machine_stays_so_in_steps_of_any_length(compiled, drive, step):
    together = {"omega1": 100.0, "omega2_start": 100.0, "omega_out_start": 100.0, "drive_angle_start": 1.5}
    torques = {"drive": drive, "input_inertia": 0.2, "drive_torque": 1.0, "load_torque": 1.0}
    module = started(compiled, together, torques, method=1, journal_friction=1.0)
    angle = module["drive_angle"]
    for _ in range(5):
        module.advance(step)
        assert module["omega2"] == module["omega_out"] == module["input_speed"]
        assert module["input_speed"] == pytest.approx(100.0, rel=1e-12)
        assert module["drive_angle"] == angle
        assert module["energy_lost"] == 0.0


@pytest.mark.parametrize("step", [1e-3, 0.1, 1.0])
def test_drag_of_the_output_freewheel_slows_the_shaft_alone(compiled, step):
    # what drags the shaft drags link 2 along, too heavy to follow
    values = {"omega1": 0.0, "load_torque": 0.0, "omega_out_start": 10.0, "output_inertia": 0.5}
    values |= {"link2_inertia": 1e9}
    module = advanced(started(compiled, values, method=1, max_step=step, output_drag=2.0), 1.0)
    assert module["omega_out"] == pytest.approx(6.0, rel=1e-8)
    assert module["energy_lost_freewheel"] == pytest.approx(16.0, rel=1e-8)
    assert module["output_torque_mean"] == pytest.approx(-2.0, rel=1e-12)


def test_drag_of_the_housing_freewheel_stops_link_2_and_holds_it(compiled):
    """Without imbalance link 2 coasts down under constant drag; a push below the drag does not start it."""
    values = {"imbalance_mass": 0.0, "omega1": 0.0, "load_torque": 0.0, "omega_out_start": 10.0}
    values |= {"link2_inertia": 0.5, "housing_drag": 2.0, "omega2_start": 1.0, "output_drag": 1.0}
    module = advanced(started(compiled, values, method=1, max_step=1e-3), 0.2)
    assert module["omega2"] == pytest.approx(1.0 - 0.2 * (2.0 - 1.0) / 0.5, rel=1e-9)
    advanced(module, 0.5)
    assert module["omega2"] == 0.0
    assert module["housing_torque_mean"] < 0.0


def test_wind_up_is_refused_in_fixed_steps(kernel):
    sentence = "with method = 1 .timestepping. housing_stiffness and freewheel_stiffness must be 0"
    for name in ("housing_stiffness", "freewheel_stiffness"):
        with pytest.raises(Refused, match=sentence):
            started(kernel, fidelity=3, method=1, **{name: WIND_UP[name]})


def test_pendulum_falls_from_rest_as_by_events(compiled):
    values = {**DRIVEN["bevel"], **HEAVY, "gravity": 9.81, "drive_angle_start": 2.5, "input_inertia": 0.02}
    values |= {"omega1": 0.0, "load_torque": 0.0, "drive_torque": 0.0}
    exact = advanced(started(compiled, values, tolerance=1e-9), 1.0)
    assert abs(exact["input_speed"]) > 0.1
    errors = []
    for step in (2e-3, 2.5e-4):
        module = advanced(started(compiled, values, method=1, max_step=step), 1.0)
        errors.append(abs(module["input_speed"] - exact["input_speed"]))
        assert module["energy_residual"] > -1e-12 * passed(module)
    assert errors[1] < min(0.25 * errors[0], 1e-4)
