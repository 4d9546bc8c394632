"""Engagement angles: what a freewheel that turns back through its play meets, loses, and comes to."""

import math
from itertools import pairwise, product

import pytest
from scenes import DRIVEN, ELASTIC, LOSSES, PLANAR, PLAY, SCENES, advanced, motions, started

from inertia_module.kernel import codes

FREE, DRIVING = 1, 2
COASTING = {"imbalance_mass": 1e-9, "omega2_start": 10.0, "omega_out_start": 12.0}
LINK2, SHAFT, LOAD, ANGLE, WIDE = 0.005, 0.5, 5.0, 0.02, 0.3
# a stiff shaft, damped, so that hub and driven mass are one shaft soon after the impact of the hub
STIFF = {
    **ELASTIC,
    "output_inertia": 0.5 * SHAFT,
    "driven_inertia": 0.5 * SHAFT,
    "shaft_stiffness": 1e7,
    "shaft_damping": 1e3,
}
LEVELS = {
    "rigid": ({}, 1e-9),
    "by torque": ({"drive": 1, "input_inertia": 1.0}, 1e-9),
    "stiff shaft": (STIFF, 1e-3),
    "fixed steps": ({"method": 1, "max_step": 1e-5}, 1e-3),
}


@pytest.mark.parametrize(
    ("level", "drag", "angle"),
    [*product(LEVELS, (0.0, 0.02), [ANGLE]), ("rigid", 0.0, WIDE), ("fixed steps", 0.0, WIDE)],
)
def test_a_shaft_that_is_slowed_meets_a_coasting_link_2_and_shares_its_momentum(compiled, level, drag, angle):
    """The shaft at 12, link 2 at 10 rad/s: they meet, and the play is used up a while later.

    It is there from the start on, though they turn apart by less than a wide one.
    """
    added, within = LEVELS[level]
    scene = COASTING | added | {"load_torque": LOAD, "output_engagement_angle": angle, "output_drag": drag}
    # drag of the overrunning freewheel speeds link 2 up and slows the shaft, and does no more once they meet
    meet = 2.0 / (LOAD / SHAFT + drag * (1.0 / LINK2 + 1.0 / SHAFT))
    link2 = 10.0 + drag / LINK2 * meet
    engage = math.sqrt(2.0 * angle * SHAFT / LOAD)
    slip = LOAD / SHAFT * engage
    module = started(compiled, scene)
    module.advance(meet + engage - 1e-3)
    assert module["contact_mode"] == FREE
    assert module["omega2"] == pytest.approx(link2, rel=max(within, 1e-6))
    assert module["omega_hub"] == pytest.approx(link2 - slip + LOAD / SHAFT * 1e-3, rel=max(within, 1e-6))
    lost = module["energy_lost_freewheel"]
    assert lost == pytest.approx(drag * meet, rel=0.01, abs=1e-12)
    module.advance(2e-3)
    assert module["contact_mode"] == DRIVING
    # (the twist of a shaft parts them once more)
    assert 1 <= module["output_engagements"] <= (2 if module["fidelity"] == 3 else 1)
    since = LOAD / (LINK2 + SHAFT) * 1e-3
    together = (LINK2 * link2 + SHAFT * (link2 - slip)) / (LINK2 + SHAFT)
    assert module["omega_out"] == pytest.approx(together - since, rel=max(within, 1e-8))
    impact = 0.5 * LINK2 * SHAFT / (LINK2 + SHAFT) * slip**2
    assert module["energy_lost_freewheel"] - lost == pytest.approx(impact, rel=max(20.0 * within, 1e-6))


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("drive", ["speed", "torque"])
def test_a_small_angle_comes_to_the_ideal_machine_at_first_order(compiled, layout, drive):
    scene = (SCENES if drive == "speed" else DRIVEN)[layout] | {"tolerance": 1e-10}
    names = ("omega2", "omega_out", "input_speed", "energy_in", "output_torque_mean")
    ideal = advanced(started(compiled, scene), 0.1)
    errors, lost = [], []
    for angle in (1e-5, 1e-6, 1e-7):
        angles = dict.fromkeys(PLAY, angle)
        module = advanced(started(compiled, scene | angles), 0.1)
        errors.append(max(abs(module[name] - ideal[name]) / abs(ideal["energy_in"]) for name in names))
        lost.append(module["energy_lost_freewheel"])
    for coarse, fine in pairwise(errors):
        assert fine < 0.2 * coarse
    for coarse, fine in pairwise(lost):
        assert fine == pytest.approx(0.1 * coarse, rel=0.05)


@motions(("timestepping", "elastic-timestepping"), added=("play", "worn"), missing=())
def test_fixed_steps_come_to_what_events_say_at_first_order(compiled, scene):
    exact = advanced(started(compiled, scene, method=0, max_step=0.0, tolerance=1e-9), 0.05)
    errors = []
    for step in (1e-4, 1e-5):
        module = advanced(started(compiled, scene, max_step=step), 0.05)
        lost = module["energy_lost_freewheel"] - exact["energy_lost_freewheel"]
        speeds = [abs(module[name] - exact[name]) for name in ("omega2", "omega_out", "input_speed")]
        errors.append(max(*speeds, abs(lost)))
        assert abs(module["energy_residual"]) < 1e-2 * abs(exact["energy_in"])
    assert errors[1] < max(0.3 * errors[0], 1e-3)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("more", [{}, LOSSES["mesh"] | LOSSES["housing_drag"] | LOSSES["output_drag"]])
def test_averaged_torque_and_loss_are_those_of_the_pulses(compiled, layout, more):
    """Behind a shaft too heavy to change its speed, up to where link 2 is thrown past link 1."""
    for angle in (0.002, 0.05):
        for ratio in (0.05, 0.4, 0.8):
            scene = SCENES[layout] | more | dict.fromkeys(PLAY, angle) | {"output_inertia": 1e6}
            scene |= {"omega_out_start": ratio * SCENES[layout]["omega1"], "load_torque": 0.0}
            averaged = advanced(started(compiled, scene, fidelity=1), 0.1)
            pulses = advanced(started(compiled, scene), 0.5)
            before = pulses["energy_out"], pulses["energy_lost"], pulses["omega_out"]
            pulses.advance(10.0)
            torque = 1e6 * (pulses["omega_out"] - before[2]) / 10.0
            largest = 0.01 * SCENES[layout]["omega1"] ** 2 * 0.2
            assert averaged["output_torque_mean"] == pytest.approx(torque, rel=0.03, abs=0.01 * largest)
            lost = (pulses["energy_lost"] - before[1]) / 10.0
            assert averaged["loss_power_mean"] == pytest.approx(lost, rel=0.04, abs=0.02 * lost + 1.0)


def test_a_freewheel_carries_again_only_when_it_has_turned_back_by_its_angle(compiled):
    """Of a record in short steps: the angle of each slip backwards, between carrying and carrying."""
    module = started(compiled, PLANAR, PLAY)
    back, largest, engaged = 0.0, 0.0, 0
    for _ in range(40000):
        module.advance(1e-5)
        slip = module["omega2"]
        back = back - 1e-5 * slip if slip < 0.0 else 0.0
        if module["housing_engagements"] > engaged:
            engaged += 1
            # it has overrun by far more since
            assert largest == pytest.approx(PLAY["housing_engagement_angle"], abs=5e-4)
            largest = 0.0
        largest = max(largest, back)
    assert engaged > 5


def test_an_engagement_is_an_event_and_a_turn_within_the_play_is_none(compiled):
    """Steps that end at a switch, as FMI 3.0 asks for: each is followed by another contact mode."""
    module = started(compiled, SCENES["bevel"], PLAY)
    for number in range(60):
        assert module.call(codes.STEP_TO_SWITCH, 0.2) == codes.OK
        assert module["contact_switches"] == number
        assert module.call(codes.SWITCH, 0.0) == codes.OK
        assert module["contact_switches"] == number + 1
    assert module["housing_engagements"] > 10
