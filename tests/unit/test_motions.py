"""Test invariants of motion in all scenes of a table (scenes.motions)."""

import math

import pytest
import scenes
from rejected import assert_rejected
from scenes import ACCOUNTS, LEVELS, MEANS, MOTION, advanced, motions, passed, started

from inertia_module.kernel import codes
from inertia_module.model import DrivenShaft, Module

EVENTS = ("rigid", "elastic")
STEPS = [0.01] * 5 + [1e-3] * 20 + [0.05] * 5
COUNTERS = ("contact_switches", "rhs_evaluations")


def led(module, steps):
    """Apply jumps, ramps and load changes to a module; yield after each step."""
    speed, torque = module["omega1"], module["drive_torque"]
    for n, step in enumerate(steps):
        module.set(
            omega1=speed * (1.0 + 0.3 * math.sin(0.4 * n)), drive_torque=(1.0, 2.5, -2.0)[n % 3] * torque
        )
        module.set(load_torque=10.0 if n % 10 < 5 else -3.0)
        module.set_rates(omega1=0.0 if module["drive"] or n % 2 else 3.0 * speed)
        module.advance(step)
        yield


def audit_bound(module):
    """Return the maximum residual relative to the transmitted energies."""
    return {0: 1e-11, 1: 1e-6}.get(module["fidelity"], 10.0 * module["tolerance"])


def assert_freewheels_hold(module, tiny):
    """Check that no freewheel pulls and no closed freewheel slips, in a module without drag and wind-up.

    A freewheel may slip back within its backlash.
    """
    house, clutch = module["housing_torque"], module["output_torque"]
    slip = module["omega_hub"] - module["omega2"]
    if module["housing_freewheel"]:
        assert module["omega2"] >= 0.0 or module["housing_engagement_angle"] > 0.0
        assert house >= -tiny
        assert module["omega2"] * house == 0.0
    else:
        assert house == 0.0
    if module["output_freewheel"]:
        assert slip >= 0.0 or module["output_engagement_angle"] > 0.0
        assert clutch >= -tiny
        assert slip * clutch == 0.0
    else:
        assert slip == 0.0


@motions()
def test_energies_balance_and_freewheels_only_push(compiled, scene):
    module = started(compiled, scene, tolerance=1e-8)
    ideal = not any(name in scene for name in ("housing_drag", "housing_stiffness"))
    impacts = "housing_engagement_angle" in scene
    last = dict.fromkeys((*COUNTERS, *ACCOUNTS, "energy_residual"), 0.0)
    energy = passed(module)
    for _ in led(module, STEPS):
        assert all(math.isfinite(value) for value in module.snapshot().values())
        energy = max(energy, passed(module))
        assert abs(module["energy_residual"]) < audit_bound(module) * energy
        assert sum(module[name] for name in ACCOUNTS) == pytest.approx(module["energy_lost"], rel=1e-12)
        for name in (*COUNTERS, *ACCOUNTS):
            assert module[name] >= last[name] - 1e-9 * energy * (name in ACCOUNTS), name
        last = {name: module[name] for name in last}
        if ideal and module["fidelity"] >= codes.RIGID:
            torques = ("input_torque", "mesh_torque", "output_torque", "load_torque")
            assert_freewheels_hold(module, 1e-9 * max(abs(module[name]) for name in torques) + 1e-11 * energy)
    elastic = module["fidelity"] == codes.ELASTIC
    assert (module["energy_lost_shaft"] > 0.0) == elastic
    assert (module["energy_lost_viscous"] > 0.0) == ("drive_friction" in scene)
    others = [module[f"energy_lost_{cause}"] > 0.0 for cause in ("mesh", "journal", "freewheel")]
    assert others == [not ideal, not ideal, impacts or not ideal]


@motions()
def test_many_steps_equal_a_single_step(compiled, scene):
    """Compare angles, speeds, energies, switches, and means by their sums over the steps of a ramp."""
    ramp = {"omega1": 0.0 if scene.get("drive") else 300.0}
    single, many = (started(compiled, scene, tolerance=1e-10) for _ in range(2))
    single.set_rates(**ramp)
    single.advance(0.05)
    sums = dict.fromkeys(MEANS[:4], 0.0)
    for _ in range(50):
        many.set_rates(**ramp)
        many.advance(1e-3)
        many.set(omega1=many["omega1"] + 1e-3 * ramp["omega1"])
        sums = {name: value + many[name] / 50 for name, value in sums.items()}
    within = 3e-7 if single["fidelity"] >= codes.RIGID else 1e-3
    for name in (*MOTION, "omega_hub", "shaft_twist", *ACCOUNTS):
        assert many[name] == pytest.approx(single[name], rel=within, abs=within * passed(single)), name
    assert many["contact_switches"] == single["contact_switches"]
    largest = max(abs(single[name]) for name in sums)
    for name, mean in sums.items():
        assert mean == pytest.approx(single[name], abs=100.0 * within * largest), name


@motions()
def test_run_from_a_saved_state_has_the_same_bits(compiled, scene):
    module = advanced(started(compiled, scene), 0.01, 0.003)
    other = Module(compiled)
    other.set(**scene)
    unstarted = other.save()
    other.restore(module.save())
    assert other.snapshot() == module.snapshot()
    for each in (module, other):
        for _ in led(each, [0.02, 0.013]):
            pass
    assert other.save() == module.save()
    other.restore(unstarted)
    assert not other.started
    assert other.start().save() == started(compiled, scene).save()


def test_invalid_state_is_rejected_without_effect(compiled):
    module = advanced(started(compiled), 0.01)
    saved = module.save()
    damaged = {
        "empty": b"",
        "short": saved[:-1],
        "long": saved + b"\0",
        "another kind": b"X" + saved[1:],
        "another build": saved[:16] + bytes([saved[16] ^ 1]) + saved[17:],
        "zeros": bytes(len(saved)),
    }
    for name, state in damaged.items():
        assert_rejected("the state must be saved by this build", module.restore, state)
        assert module.save() == saved, name


@motions(added=("ideal", "losses"))
def test_outputs_evaluated_after_a_step_equal_a_complete_step(compiled, scene):
    whole, parts = (started(compiled, scene) for _ in range(2))
    advanced(whole, 0.01, 0.01)
    late = [variable.name for variable in parts.model.variables if variable.late]
    before = [parts[name] for name in late]
    for _ in range(2):
        assert parts.call(codes.STEP_ONLY, 0.01) == 0
    assert [parts[name] for name in late] == before
    for name in set(parts.model.by_name) - set(late):
        assert parts[name] == whole[name], name
    assert parts.call(codes.OUTPUTS, 0.0) == 0
    assert parts.save() == whole.save()


@motions(levels=EVENTS)
def test_error_follows_the_tolerance(compiled, scene):
    general = "mesh_efficiency" in scene
    # A prescribed speed would keep the errors small.
    duration, most = 0.3 if scene.get("drive") or general else 1.0, 30.0 if general else 10.0
    if general and "output_engagement_angle" in scene:
        most = 1e3  # Springs bounce in the backlash.

    def end(tolerance):
        return advanced(started(compiled, scene, tolerance=tolerance), duration)

    exact, errors = end(1e-12), []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        module = end(tolerance)
        names = ("input_speed", "omega2", "omega_out")
        errors.append(max(abs(module[name] - exact[name]) for name in names) / exact["input_speed"])
        assert errors[-1] < most * tolerance
        assert abs(module["energy_residual"]) < 15.0 * tolerance * passed(module)
    assert errors[-1] < max(1e-3 * errors[0], 1e-9)


# --- a torque drives link 1 ---


@motions(levels=("averaged", "rigid", "elastic"), added=("ideal",))
def test_only_the_selected_drive_input_does_work(compiled, scene):
    """The other drive input, speed or torque, has no effect."""
    first, second = (advanced(started(compiled, scene), 0.01) for _ in range(2))
    if scene.get("drive"):
        second.set(omega1=-3.0)
        second.set_rates(omega1=1e4)
    else:
        second.set(drive_torque=-1e6)
        second.set_rates(drive_torque=1e5)
    for module in (first, second):
        advanced(module, 0.02)
    assert bytes(first.outputs) == bytes(second.outputs)
    if scene.get("drive"):
        assert bytes(first.state) == bytes(second.state)
        for step in (1e-3, 0.01, 0.03):
            first.advance(step)
            assert first["input_torque_mean"] == pytest.approx(first["drive_torque"], rel=1e-14)
        assert first["energy_in"] == pytest.approx(
            first["drive_torque"] * scenes.input_angle(first), rel=1e-12
        )
    else:
        assert first["input_speed"] == first["omega1"]


@pytest.mark.parametrize("layout", scenes.DRIVEN)
def test_torque_with_a_rate_acts_by_its_mean_over_the_step(compiled, layout):
    ramp, mean = (started(compiled, scenes.DRIVEN[layout], drive_torque=10.0) for _ in range(2))
    ramp.set_rates(drive_torque=400.0, load_torque=-100.0)
    advanced(ramp, 0.05)
    advanced(mean, 0.05, drive_torque=20.0, load_torque=mean["load_torque"] - 2.5)
    assert bytes(ramp.state) == bytes(mean.state)
    assert bytes(ramp.outputs) == bytes(mean.outputs)


# --- accuracy of very long runs and of many tiny steps ---


# Residual over the largest energy: tolerance at once, and per turn of link 1 and of the drives.
AT_ONCE = 100.0
PER_TURN = 0.1
KINDS = {
    "bevel": {},
    "planar": scenes.PLANAR,
    "no housing freewheel": {"housing_freewheel": 0},
    "heavy output": {"output_inertia": 500.0},
    "elastic": scenes.ELASTIC,
}
RUNS = [(0, -100.0, 0.0), (0, 100.0, 0.0), (0, 30.0, 3.0), (1, -100.0, 0.0), (1, 100.0, 0.0)]
# Without the housing freewheel a load accelerates both links without limit.
CASES = [(kind, *run) for kind in KINDS for run in RUNS if kind != "no housing freewheel" or run[2] == 0.0]


@pytest.mark.parametrize("kind, drive, omega1, load", CASES)
def test_residual_of_long_runs_grows_with_the_turns_and_no_faster(compiled, kind, drive, omega1, load):
    inputs = {"omega1": omega1, "load_torque": load}
    module = started(compiled, KINDS[kind], inputs, drive=drive, input_inertia=0.2)
    largest = 0.0
    for _ in range(5):
        module.advance(20.0 if kind == "elastic" else 50.0)
        moved = (module["energy_in"], module["energy_out"], module["energy_lost"], module["energy_stored"])
        largest = max(largest, *map(abs, moved))
        turns = abs(module["drive_turns"]) + abs(module["input_turns"])
        bound = (AT_ONCE + PER_TURN * turns) * module["tolerance"]
        assert abs(module["energy_residual"]) <= bound * largest
    assert turns > 300.0


@motions(levels=[level for level in LEVELS if level != "averaged"], added=("ideal", "losses"), missing=())
def test_means_of_a_tiny_last_step_are_instantaneous_torques(compiled, scene):
    for before in (0.05, 0.0037):
        module = advanced(started(compiled, scene), before)
        for step, missing in ((1e-13, 1e-9), (1e-16, 1e-9), (1e-30, 1e-9)):
            module.advance(step)
            for name in MEANS[:4]:
                torque = module[name.removesuffix("_mean")]
                assert module[name] == pytest.approx(torque, abs=missing), (name, step)
            assert module["torque_ripple"] < 1e-3


# --- the plain and the compiled kernel are one source: they give the same results ---


ALIKE = {"contact_mode", "contact_switches", "rhs_evaluations", "drive_turns", "input_turns"}
# Maps of fidelity averaged take minutes in plain Python, except speed-driven planar ones.
QUICK = [level for level in LEVELS if level != "averaged"]


def assert_same(plain, fast):
    """Check that values are equal to rounding, energies to rounding of the largest, and counters exactly."""
    assert {name: fast[name] for name in ALIKE & plain.keys()} == {
        name: plain[name] for name in ALIKE & plain.keys()
    }
    largest = max(abs(value) for name, value in plain.items() if name.startswith("energy"))
    for name, value in plain.items():
        scale = largest if name.startswith("energy") else abs(value)
        assert fast[name] == pytest.approx(value, abs=1e-12 * max(scale, 1.0)), name


def assert_led_alike(compiled, *scenes):
    modules = [started(kernel, *scenes, tolerance=1e-8) for kernel in ("plain", compiled)]
    for module in modules:
        for _ in led(module, [0.002, 0.003, 0.004] * 4):
            pass
    assert_same(*(module.snapshot() for module in modules))


@motions(levels=QUICK, added=("gears", "losses", "wind-up"))
def test_both_kernels_give_the_same_results(compiled, scene):
    assert_led_alike(compiled, scene, {"satellites": 2, "epsilon": 0.4, "balancer": 0.3})


def test_both_kernels_give_the_same_mean_motion(compiled):
    assert_led_alike(compiled, scenes.PLANAR, LEVELS["averaged"], {"input_hold": 1})


def test_both_kernels_give_the_same_motion_of_a_driven_shaft(compiled):
    models = [DrivenShaft(kernel).start(balancer=0.7, input_hold=1) for kernel in ("plain", compiled)]
    for model in models:
        for n in range(40):
            model.set(hub_speed=20.0 * (n % 7 - 3), load_torque=n - 20.0)
            model.advance((1e-4, 0.01, 0.3, 20.0)[n % 4])
    assert_same(*(model.snapshot() for model in models))
