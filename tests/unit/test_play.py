"""Engagement angles: what a freewheel that turns back through its play meets, loses, and comes to."""

import pytest
from scenes import LOSSES, PLAY, SCENES, advanced, motions, started

from inertia_module.kernel import codes

# link 2 and the shaft turn apart at the start, and drag brings them together
COASTING = {"omega2_start": 10.0, "omega_out_start": 12.0} | LOSSES["housing_drag"] | LOSSES["output_drag"]


@pytest.mark.parametrize("start", [{}, COASTING], ids=["resting", "coasting"])
@motions(("timestepping", "elastic-timestepping"), added=("play", "worn"), missing=())
def test_fixed_steps_come_to_what_events_say_at_first_order(compiled, scene, start):
    scene = scene | start
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


def test_an_engagement_is_an_event_and_a_turn_within_the_play_is_none(compiled):
    """Steps that end at a switch, as FMI 3.0 asks for: each is followed by another contact mode."""
    module = started(compiled, SCENES["bevel"], PLAY)
    for number in range(60):
        assert module.call(codes.STEP_UNTIL_EVENT, 0.2) == codes.OK
        assert module["contact_switches"] == number
        assert module.call(codes.HANDLE_EVENT, 0.0) == codes.OK
        assert module["contact_switches"] == number + 1
    assert module["housing_engagements"] > 10


def test_each_impact_is_an_engagement(compiled):
    """In steps shorter than what lies between impacts each of them is a loss."""
    module = started(compiled, SCENES["bevel"], PLAY)
    impacts = lost = 0.0
    for _ in range(5000):
        module.advance(1e-4)
        impacts += module["energy_lost_freewheel"] > lost
        lost = module["energy_lost_freewheel"]
    assert impacts > 20
    assert module["housing_engagements"] + module["output_engagements"] == impacts


def test_a_freewheel_that_its_drag_alone_holds_has_not_engaged(compiled):
    module = advanced(started(compiled, SCENES["bevel"], PLAY, housing_drag=1e3, load_torque=0.0), 0.1)
    assert module["contact_mode"] in (codes.HELD, codes.HELD_DRIVING)
    assert module["housing_engagements"] == 0.0
    assert module["housing_torque_peak"] < 1e3


PEAKS = (
    "torque_peak",
    "housing_torque_peak",
    "housing_slip_peak",
    "output_slip_peak",
    "satellite_force_peak",
)


@pytest.mark.parametrize("added", [{}, PLAY, PLAY | LOSSES["output_drag"] | LOSSES["mesh"]])
@pytest.mark.parametrize("layout", SCENES)
def test_peaks_of_long_steps_are_those_of_short_ones(compiled, layout, added):
    """Up to the moment before an impact, and between the stages of the solver."""
    long, short = (started(compiled, SCENES[layout], added, tolerance=1e-9) for _ in range(2))
    for _ in range(10):
        long.advance(0.02)
        largest = dict.fromkeys(PEAKS, 0.0)
        for _ in range(200):
            short.advance(1e-4)
            largest = {name: max(peak, short[name]) for name, peak in largest.items()}
        for name, peak in largest.items():
            assert long[name] == pytest.approx(peak, rel=5e-3, abs=1e-3), name
