"""Test contact modes and impacts: complementarity problems with a known solution."""

import random
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import DRIVEN, SCENES, started

from inertia_module.kernel.codes import DRIVING, FREE, HELD, HELD_DRIVING
from inertia_module.kernel.equations import states
from inertia_module.kernel.equations.choice import N_MODES, complementarity_violation, select_mode, set_mode
from inertia_module.kernel.equations.losses import FREEWHEEL
from inertia_module.kernel.impulse import apply_plastic_impact, jump_input, solve_impact
from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.kernel.links import kinetic_energy, momentum_of_links

OUTPUT_FREEWHEEL = SimpleNamespace(output_freewheel=1.0)
NO_OUTPUT_FREEWHEEL = SimpleNamespace(output_freewheel=0.0)
J2, J3 = 0.3, 0.4  # kg m^2
# Two inertias without imbalance: torques and accelerations have closed forms.
TWO_INERTIAS = {"imbalance_mass": 0.0, "link2_inertia": J2, "output_inertia": J3}
SPEEDS = st.floats(-10.0, 10.0)
INERTIAS = st.floats(1e-3, 10.0)


@pytest.mark.parametrize(
    ("free2", "free3", "end2", "end3", "mode"),
    [
        (5.0, 8.0, 5.0, 8.0, FREE),
        (8.0, 1.0, 4.0, 4.0, DRIVING),  # J2 8 + J3 1 = (J2 + J3) 4
        (-2.0, 8.0, 0.0, 8.0, HELD),
        (-2.0, -3.0, 0.0, 0.0, HELD_DRIVING),
        (2.0, -3.0, 0.0, 0.0, HELD_DRIVING),  # Locked together they would move backward.
        (0.0, 0.0, 0.0, 0.0, HELD_DRIVING),
        (0.0, 1.0, 0.0, 1.0, HELD),
        (5.0, 5.0, 5.0, 5.0, FREE),
    ],
)
def test_plastic_impact_of_two_inertias(free2, free3, end2, end3, mode):
    omega2, omega3, impulse, result = solve_impact(OUTPUT_FREEWHEEL, J2, free2, J3, free3, True, True)
    assert (omega2, omega3) == pytest.approx((end2, end3), rel=1e-14)
    assert impulse == pytest.approx(J3 * (end3 - free3), abs=1e-14)
    assert result == mode


@given(free2=SPEEDS, free3=SPEEDS, inertia2=INERTIAS, inertia3=INERTIAS)
def test_impact_satisfies_the_complementarity_conditions(free2, free3, inertia2, inertia3):
    omega2, omega3, impulse, _ = solve_impact(OUTPUT_FREEWHEEL, inertia2, free2, inertia3, free3, True, True)
    housing_impulse = inertia2 * (omega2 - free2) + impulse
    tolerance = 1e-13 * (inertia2 + inertia3) * (abs(free2) + abs(free3))
    assert omega2 >= 0.0
    assert omega3 >= omega2
    assert impulse >= -tolerance
    assert housing_impulse >= -tolerance
    assert abs(housing_impulse * omega2) <= 10.0 * tolerance
    assert abs(impulse * (omega3 - omega2)) <= 10.0 * tolerance
    assert impulse == pytest.approx(inertia3 * (omega3 - free3), abs=tolerance)


@given(free2=SPEEDS, free3=SPEEDS)
def test_impact_without_output_freewheel_keeps_link_2_and_output_together(free2, free3):
    omega2, omega3, _, _ = solve_impact(NO_OUTPUT_FREEWHEEL, J2, free2, J3, free3, False, True)
    assert omega2 == omega3
    assert (J2 + J3) * omega2 == pytest.approx(J2 * free2 + J3 * free3, abs=1e-14)


def energy(d, x):
    return kinetic_energy(d, x.q, x.omega1, x.omega2, x.omega3)


def test_plastic_impact_loses_the_energy_of_the_relative_motion():
    module = started("plain", TWO_INERTIAS, omega1=20.0)
    d, x = module.derived, module.state
    x.omega2, x.omega3 = 8.0, 1.0
    apply_plastic_impact(d, x)
    assert (x.omega2, x.omega3) == pytest.approx((4.0, 4.0), rel=1e-14)
    assert x.lost[FREEWHEEL] == pytest.approx(0.5 * J2 * J3 / (J2 + J3) * 7.0**2, rel=1e-14)
    assert x.output_impulse == pytest.approx(J3 * 3.0, rel=1e-14)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("omega2", [5.0, -5.0], ids=["output", "housing"])
def test_plastic_impact_changes_the_speed_of_a_driven_link_1(layout, omega2):
    """The impulse of the input torque is 0. Momentum is conserved; the energy of the slip is lost."""
    module = started("plain", DRIVEN[layout])
    d, x = module.derived, module.state

    def momentum():
        i, _, b, _, _, _ = reduced_inertia(d, x.q)
        return momentum_of_links(d, i, b, x.omega1, x.omega2) + d.J3 * x.omega3

    for q in (0.3, 1.2, 4.0):
        x.q, x.omega1, x.omega2, x.omega3 = q, 50.0, omega2, 1.0
        x.lost[FREEWHEEL] = x.input_impulse = x.housing_impulse = 0.0
        energy_before, momentum_before = energy(d, x), momentum()
        apply_plastic_impact(d, x)
        assert x.omega2 == (0.0 if omega2 < 0.0 else x.omega3)
        assert x.omega1 != 50.0
        assert x.input_impulse == pytest.approx(0.0, abs=1e-13 * abs(momentum_before))
        assert momentum() - momentum_before == pytest.approx(x.housing_impulse, abs=1e-12)
        assert energy_before - energy(d, x) == pytest.approx(x.lost[FREEWHEEL], rel=1e-9)
        assert x.lost[FREEWHEEL] > 0.0


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("ratio", [None, 0.4], ids=["freewheels", "prescribed ratio"])
def test_jump_of_the_input_loses_no_energy(layout, ratio):
    prescribed = {} if ratio is None else {"fidelity": 0, "kinematic_ratio": ratio}
    module = started("plain", SCENES[layout], prescribed)
    d, x = module.derived, module.state
    chance = random.Random(layout)
    for _ in range(40):
        x.q, x.omega1 = chance.uniform(0.0, 60.0), chance.uniform(-100.0, 100.0)
        if ratio is None:
            x.omega2 = chance.choice([0.0, chance.uniform(0.0, 30.0)])
            x.omega3 = x.omega2 + chance.choice([0.0, chance.uniform(0.0, 30.0)])
        else:
            x.omega2 = x.omega3 = 0.3 * x.omega1
        stored = energy(d, x) - (0.5 * d.J3 * x.omega3**2 if ratio else 0.0)
        x.energy_in = x.energy_out = 0.0
        jump = chance.uniform(-50.0, 50.0)
        omega1 = x.omega1 + jump
        jump_input(d, x, jump)
        gain = energy(d, x) - (0.5 * d.J3 * x.omega3**2 if ratio else 0.0) - stored
        scale = abs(stored) + abs(x.energy_in)
        assert x.omega1 == omega1
        assert x.energy_in - x.energy_out == pytest.approx(gain, abs=1e-12 * scale)


@pytest.mark.parametrize("freewheel", ["housing", "output"])
def test_freewheel_inside_its_engagement_angle_has_no_impact(freewheel):
    module = started("plain", TWO_INERTIAS, {f"{freewheel}_engagement_angle": 0.05}, omega1=20.0)
    d, x = module.derived, module.state
    setattr(x, f"play_{freewheel}", 0.05)
    x.omega2, x.omega3 = (-2.0, 3.0) if freewheel == "housing" else (8.0, 1.0)
    speeds = x.omega2, x.omega3
    apply_plastic_impact(d, x)
    assert (x.omega2, x.omega3) == speeds


def select(load, omega2, omega3, **values):
    """Return the state after the selection of the mode for two inertias at these speeds."""
    module = started("plain", TWO_INERTIAS, omega1=20.0, **values)
    x = module.state
    x.omega2, x.omega3, x.load_torque = omega2, omega3, load
    select_mode(module.derived, x, 0.0)
    return x


@pytest.mark.parametrize(
    ("load", "speed", "mode", "alpha2", "alpha3", "output", "housing"),
    [
        (7.0, 0.0, HELD_DRIVING, 0.0, 0.0, 7.0, 7.0),
        (-7.0, 0.0, HELD, 0.0, 7.0 / J3, 0.0, 0.0),
        (7.0, 10.0, DRIVING, -7.0 / (J2 + J3), -7.0 / (J2 + J3), 7.0 * J2 / (J2 + J3), 0.0),
        (-7.0, 10.0, FREE, 0.0, 7.0 / J3, 0.0, 0.0),
    ],
)
def test_mode_of_two_inertias_at_equal_speeds(load, speed, mode, alpha2, alpha3, output, housing):
    x = select(load, speed, speed)
    assert x.mode == mode
    assert (x.now.alpha2, x.now.alpha3) == pytest.approx((alpha2, alpha3), abs=1e-12)
    assert (x.now.output, x.now.housing) == pytest.approx((output, housing), abs=1e-12)


@pytest.mark.parametrize(("fraction", "mode"), [(0.999, DRIVING), (1.001, FREE)])
def test_output_freewheel_unlocks_when_it_pulls_with_more_than_its_drag(fraction, mode):
    """Locked together the output freewheel transmits -T J2 / (J2 + J3) under the driving load T."""
    drag = 0.5
    load = -fraction * drag * (J2 + J3) / J2
    assert select(load, 10.0, 10.0, output_drag=drag).mode == mode


@pytest.mark.parametrize("freewheel", ["housing", "output"])
def test_freewheel_inside_its_engagement_angle_transmits_no_torque(freewheel):
    module = started("plain", TWO_INERTIAS, {f"{freewheel}_engagement_angle": 0.05}, omega1=20.0)
    x = module.state
    x.load_torque, x.omega2, x.omega3 = 7.0, 0.0, 0.0
    setattr(x, f"play_{freewheel}", 0.05)
    select_mode(module.derived, x, 0.0)
    assert getattr(x, f"{freewheel}_state") <= states.OVERRUNNING
    assert getattr(x.now, freewheel) == 0.0


@pytest.mark.parametrize("layout", SCENES)
def test_selected_mode_satisfies_the_conditions_of_ideal_freewheels(layout):
    """0 <= omega2 _|_ Th >= 0 and 0 <= omega3 - omega2 _|_ Tc >= 0, also for the accelerations at contact."""
    module = started("plain", SCENES[layout])
    d, x = module.derived, module.state
    chance = random.Random(layout)
    for _ in range(50):
        x.q, x.omega1 = chance.uniform(0.0, 60.0), chance.uniform(-100.0, 100.0)
        x.omega2 = chance.choice([0.0, chance.uniform(0.0, 50.0)])
        x.omega3 = x.omega2 + chance.choice([0.0, chance.uniform(0.0, 50.0)])
        x.load_torque = chance.uniform(-50.0, 50.0)
        select_mode(d, x, 0.0)
        torque = 1e-9 * (abs(x.now.mesh) + abs(x.load_torque))
        acceleration = torque / (d.J2 + d.J3)
        contacts = (
            (x.omega2, x.now.alpha2, x.now.housing),
            (x.omega3 - x.omega2, x.now.alpha3 - x.now.alpha2, x.now.output),
        )
        for speed, rate, reaction in contacts:
            assert reaction >= -torque
            assert speed > 0.0 or rate >= -acceleration
            assert reaction == 0.0 or (speed == 0.0 and abs(rate) <= acceleration)


def test_modes_are_all_different():
    module = started("plain", SCENES["bevel"], omega1=0.0, journal_friction=0.1)
    x = module.state
    x.omega1 = x.omega2 = x.omega3 = 0.0
    module.derived.freewheel_angles = 1.0  # Springs and engagement angles are active.
    modes = set()
    for number in range(N_MODES):
        set_mode(module.derived, x, number)
        modes.add((x.housing_state, x.output_state, x.slip_sign))
    assert len(modes) == N_MODES


@pytest.mark.parametrize(
    ("state", "torque", "speed", "slip_torque", "backlash", "violation"),
    [
        (states.OVERRUNNING, 0.0, 0.0, -3.0, 0.0, 3.0),  # The slip would become negative.
        (states.OVERRUNNING, 0.0, 1.0, -3.0, 0.0, 0.0),
        (states.LOCKED, 4.0, 0.0, 0.0, 0.0, -4.5),
        (states.LOCKED, -2.0, 0.0, 0.0, 0.0, 1.5),  # The freewheel pulls with more than its drag.
        (states.LOCKED, 2.0, 0.0, 0.0, 0.1, 2.0),  # Inside the engagement angle only the drag can hold it.
        (states.IN_BACKLASH, 0.0, 0.0, 3.0, 0.1, 3.0),  # Link 2 would rotate forward.
    ],
)
def test_violation_of_a_freewheel_with_a_drag_of_half_a_newton_metre(
    state, torque, speed, slip_torque, backlash, violation
):
    assert complementarity_violation(state, 0.5, torque, speed, slip_torque, 0.0, backlash) == violation
