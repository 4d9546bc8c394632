"""Test engagement angles: impacts, losses and contact modes of a freewheel that turns back."""

import pytest
from scenes import LOSSES, PLAY, SCENES, advanced, mechanism, reference, started

from inertia_module.kernel import codes
from verification.reference.cases import OMEGA3

# Drags of both freewheels, one of which turns back within its engagement angle.
DRAGGED = mechanism("""z16=47 output_inertia=.04 housing_drag_viscous=.2 output_drag=2
  omega_out_start=1 output_engagement_angle=.01 omega1=10""")


def test_drag_of_one_freewheel_acts_while_the_other_turns_back(compiled):
    module = advanced(started(compiled, DRAGGED, tolerance=1e-9), 0.0327)
    assert module["omega_out"] == pytest.approx(0.7796, abs=1e-4)
    expected = reference(DRAGGED, 0.0327).state[OMEGA3]
    assert module["omega_out"] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("more", [{}, LOSSES["mesh"] | LOSSES["housing_drag"] | LOSSES["output_drag"]])
def test_averaged_torque_and_loss_agree_with_the_pulses(compiled, layout, more):
    """The shaft is too heavy to change its speed. The ratios end before link 2 overtakes link 1."""
    for angle in (0.002, 0.05):
        for ratio in (0.05, 0.4, 0.8):
            scene = SCENES[layout] | more | dict.fromkeys(PLAY, angle) | {"output_inertia": 1e5}
            scene |= {"omega_out_start": ratio * SCENES[layout]["omega1"], "load_torque": 0.0}
            averaged = advanced(started(compiled, scene, fidelity=1), 0.1)
            pulses = advanced(started(compiled, scene), 0.5)
            before = pulses["energy_out"], pulses["energy_lost"], pulses["omega_out"]
            pulses.advance(10.0)
            torque = 1e5 * (pulses["omega_out"] - before[2]) / 10.0
            largest = 0.01 * SCENES[layout]["omega1"] ** 2 * 0.2
            assert averaged["output_torque_mean"] == pytest.approx(torque, rel=0.03, abs=0.01 * largest)
            lost = (pulses["energy_lost"] - before[1]) / 10.0
            assert averaged["loss_power_mean"] == pytest.approx(lost, rel=0.04, abs=0.02 * lost + 1.0)


def test_engagement_is_an_event_but_a_reversal_within_the_engagement_angle_is_not(compiled):
    """Steps end at a switch as in FMI 3.0; the contact mode changes after each."""
    module = started(compiled, SCENES["bevel"], PLAY)
    for number in range(60):
        assert module.call(codes.STEP_UNTIL_EVENT, 0.2) == codes.OK
        assert module["contact_switches"] == number
        assert module.call(codes.HANDLE_EVENT, 0.0) == codes.OK
        assert module["contact_switches"] == number + 1
    assert module["housing_engagements"] > 10


def test_each_impact_is_an_engagement(compiled):
    """The steps are shorter than the time between impacts. Each impact is a loss."""
    module = started(compiled, SCENES["bevel"], PLAY)
    impacts = lost = 0.0
    for _ in range(5000):
        module.advance(1e-4)
        impacts += module["energy_lost_freewheel"] > lost
        lost = module["energy_lost_freewheel"]
    assert impacts > 20
    assert module["housing_engagements"] + module["output_engagements"] == impacts


def test_freewheel_stopped_by_drag_has_not_engaged(compiled):
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
def test_peaks_of_long_steps_agree_with_short_steps(compiled, layout, added):
    """Compare up to the moment before an impact, and between the stages of the solver."""
    long, short = (started(compiled, SCENES[layout], added, tolerance=1e-9) for _ in range(2))
    for _ in range(10):
        long.advance(0.02)
        largest = dict.fromkeys(PEAKS, 0.0)
        for _ in range(200):
            short.advance(1e-4)
            largest = {name: max(peak, short[name]) for name, peak in largest.items()}
        for name, peak in largest.items():
            assert long[name] == pytest.approx(peak, rel=5e-3, abs=1e-3), name
