"""Method `timestepping`: fixed steps, complementarity of impulses, no search for events."""

import math
from contextlib import suppress

import pytest
import scenes
from refused import assert_refused
from scenes import LEVELS, advanced, motions, passed, started

from inertia_module.kernel.codes import TIMESTEPPING
from inertia_module.memory import Module, Refused
from studies.stability.random_motions import draw_motion

SPEEDS = ("input_speed", "omega2", "omega_hub", "omega_out")
# gravity acts with one module only, and shows with one heavy imbalance
HEAVY = {"modules": 1, "satellites": 1, "imbalance_mass": 3.0}
FIXED_STEPS = ("timestepping", "elastic-timestepping")
ideal = motions(FIXED_STEPS, added=("ideal",), missing=(), drives=("speed",))


# what rounding may make in a run, of the largest energy there was: at the least of this share of what the
# inertias would have at the speed of link 1 (speeds are differences of it), and of next to nothing at rest;
# and of the impulses, of the momentum
ROUNDING = 1e-11
OF_INPUT = 1e-3
AT_REST = 1e-20  # J
OF_MOMENTUM = 1e-13
ENERGIES = ("energy_stored", "energy_in", "energy_out", "energy_lost")


def largest_gain(kernel, motion, step):
    """Largest energy that a step, or all of the run, made out of nothing, of the largest energy there was.

    In each of its segments it takes 20 steps of this size.
    """
    module = motion.started(Module(kernel))
    inertia = sum(module[name] for name in ("link2_inertia", "output_inertia", "driven_inertia"))
    energy, last, gain = max(module["energy_stored"], AT_REST), 0.0, 0.0
    for part in motion.segments:
        energy = max(energy, OF_INPUT * inertia * part.omega1**2)
        module.set(omega1=part.omega1, load_torque=part.load, drive_torque=part.drive)
        for _ in range(20):
            module.advance(step)
            energy = max(energy, *(abs(module[name]) for name in ENERGIES))
            residual = module["energy_residual"]
            gain = max(gain, last - residual, -residual)
            last = residual
            # within its play a freewheel slips back
            plays = [module[f"{name}_engagement_angle"] > 0.0 for name in ("housing", "output")]
            assert module["omega2"] >= 0.0 or not module["housing_freewheel"] or plays[0]
            assert module["omega_hub"] >= module["omega2"] or plays[1]
            dragged = module["output_drag"] + module["output_drag_viscous"] > 0.0
            impulse, momentum = step * module["output_torque_mean"], inertia * abs(module["omega2"])
            assert impulse >= -OF_MOMENTUM * momentum or not module["output_freewheel"] or dragged
    assert all(math.isfinite(value) for value in module.snapshot().values())
    return gain / energy


@motions(levels=FIXED_STEPS, added=("ideal", "gears", "friction", "losses", "wind-up"))
def test_fixed_steps_come_to_what_events_say(compiled, scene):
    exact = advanced(started(compiled, scene, method=0, max_step=0.0, tolerance=1e-9), 0.05)
    energy, errors = passed(exact), []
    for step in (8e-4, 5e-5):
        module = advanced(started(compiled, scene, max_step=step), 0.05)
        errors.append(max(abs(module[name] - exact[name]) for name in SPEEDS) / exact["input_speed"])
        assert module["energy_residual"] > -1e-12 * energy
        for name in scenes.ACCOUNTS:
            assert abs(module[name] - exact[name]) < 1e-3 * energy, name
            assert (module[name] == 0.0) == (exact[name] == 0.0), name
        assert module["energy_lost_viscous"] == pytest.approx(exact["energy_lost_viscous"], rel=1e-3)
    for name in (*scenes.MEANS[:4], "energy_in"):
        assert module[name] == pytest.approx(exact[name], rel=1e-4, abs=1e-2), name
    # of second order, down to what the position of a switch within its step leaves
    assert errors[1] < max(errors[0] / 50.0, 3e-6)
    assert errors[1] < 2e-5


@pytest.mark.parametrize("losses", [False, True], ids=["ideal", "losses"])
def test_no_random_run_makes_energy(compiled, losses):
    for number in range(600):
        motion = draw_motion(1, number, losses)
        with suppress(Refused):  # the meshes jam
            if motion.level.method == TIMESTEPPING:
                # 0.03 to 30 rad of the highest harmonic
                step, motion = 10.0 * motion["max_step"], motion.changed(max_step=0.0, input_hold=number % 2)
                assert largest_gain(compiled, motion, step) < ROUNDING, number


@pytest.mark.parametrize("drive", scenes.DRIVES)
@pytest.mark.parametrize("layout", scenes.SCENES)
@pytest.mark.parametrize("losses", [*scenes.LOSSES, "all"])
def test_error_of_fixed_steps_falls_with_the_square_where_nothing_switches(compiled, drive, layout, losses):
    values = scenes.ALL_LOSSES if losses == "all" else scenes.LOSSES[losses]
    # link 2 alone, far from both freewheels
    apart = scenes.DRIVES[drive][layout] | HEAVY | values | {"omega2_start": 60.0, "omega_out_start": 1000.0}
    exact = advanced(started(compiled, apart, tolerance=1e-12), 0.01)["omega2"]
    coarse, fine = (
        abs(advanced(started(compiled, apart, method=1, max_step=step), 0.01)["omega2"] - exact)
        for step in (2e-4, 5e-5)
    )
    assert fine == pytest.approx(coarse / 16.0, rel=0.3)


@pytest.mark.parametrize("step", [0.1, 0.01, 0.001])
@pytest.mark.parametrize("level", FIXED_STEPS)
@pytest.mark.parametrize("housing_drag", [0.0, 1.0])
def test_shaft_that_a_load_has_stopped_is_held_where_it_is(compiled, housing_drag, level, step):
    # stiff where it is elastic; a light link 2, that its drag would turn back faster than the load the shaft
    built = LEVELS[level] | {"imbalance_mass": 0.0, "link2_inertia": 1e-5, "shaft_stiffness": 1e8}
    given = {"output_inertia": 0.5, "driven_inertia": 0.5, "max_step": step, "housing_drag": housing_drag}
    module = started(compiled, built, given, load_torque=10.0, omega_out_start=0.3)
    stored = module["energy_stored"]
    advanced(module, 0.2)
    assert module["omega_out"] == module["omega2"] == 0.0
    assert module["energy_out"] == pytest.approx(stored, rel=1e-3)
    before = module["energy_out"]
    assert advanced(module, 1.0)["energy_out"] == pytest.approx(before, rel=1e-6)


@pytest.mark.parametrize("drive", scenes.DRIVES)
@pytest.mark.parametrize("layout", scenes.SCENES)
def test_link_2_that_comes_to_rest_with_the_shaft_takes_no_energy_along(compiled, drive, layout):
    scene = scenes.DRIVES[drive][layout] | LEVELS["timestepping"] | {"output_freewheel": 0}
    module = advanced(started(compiled, scene, max_step=8e-4), 0.05)
    assert module["contact_switches"] > 0
    assert module["energy_residual"] < 1e-6 * passed(module)


@pytest.mark.parametrize("step", [0.01, 0.001])
def test_hub_that_a_load_presses_on_link_2_at_rest_stays_where_it_is(compiled, step):
    # which its drag would turn back faster than the load the hub
    drag = {"link2_inertia": 1e-5, "housing_drag": 1.0, "output_engagement_angle": 0.02}
    module = started(compiled, LEVELS["elastic-timestepping"], drag, max_step=step, load_torque=0.1)
    advanced(module, 0.2)
    assert module["shaft_twist"] != 0.0
    assert module["output_flange_angle"] == pytest.approx(-module["shaft_twist"], rel=1e-9)


@ideal
def test_a_step_takes_at_most_two_evaluations(compiled, scene):
    # without max_step a communication step is one step
    assert advanced(started(compiled, scene, max_step=0.0), 0.1)["rhs_evaluations"] <= 2
    for omega1 in (1e-3, 1.0, 100.0, 1e5):
        for count in (1, 7, 1000):
            module = started(compiled, scene, max_step=1e-3, omega1=omega1)
            advanced(module, count * 1e-3)
            assert count <= module["rhs_evaluations"] <= 2 * count


@motions(("timestepping",), added=("ideal",), missing=())
def test_contact_switches_are_those_of_the_event_method_at_any_communication_step(compiled, scene):
    events = advanced(started(compiled, scene, method=0, max_step=0.0), 0.3)
    for steps in (1, 100, 3000):
        fixed = advanced(started(compiled, scene), *[0.3 / steps] * steps)
        assert fixed["contact_switches"] == events["contact_switches"] > 20


def test_a_step_of_too_many_fixed_steps_is_refused(compiled):
    module = started(compiled, scenes.SCENES["bevel"], method=1, max_step=1e-7)
    assert_refused("communication step = 100 s is rejected", module.advance, 100.0)
