"""Test the kernel with the independent reference, for the cases of a table.

The reference (verification.reference) shares no code with the kernel: it uses virtual work on its own
geometry. The tests compare angles, speeds, energies, torques and their means. test_losses.py tests closed
forms of losses, and tests/verification/test_lysenko.py other equations for them.
"""

import tomllib
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scenes
from geometry import direct_sums, ratio
from hypothesis import given
from hypothesis import strategies as st
from scenes import ALL_LOSSES, DRIVEN, ELASTIC, LOSSES, PLAY, SCENES, advanced, reference, started

from inertia_module.kernel.inertia import reduced_inertia
from verification.reference.cases import CAUSES, OMEGA1, OMEGA2, OMEGA3, OMEGA4, THETA1, TWIST, Q

OUTPUTS = {"rigid": {}, "elastic": {**ELASTIC, "driven_friction": 0.03, "balancer": 0.2}}
TABLE = tomllib.loads(Path(__file__).with_name("reference.toml").read_text(encoding="utf-8"))
PARTS = scenes.PARTS | LOSSES | scenes.FREEWHEELS | TABLE["parts"] | {"losses": ALL_LOSSES}
PARTS["springs"] = ELASTIC | ALL_LOSSES | {"housing_damping": 0.05}
# Impulses of the reference, and the outputs that are their means over a step.
IMPULSES = {
    "M1": "input_torque_mean",
    "M2": "mesh_torque_mean",
    "Tc": "output_torque_mean",
    "Th": "housing_torque_mean",
}


def expected(exact):
    omega1, omega2, omega3, omega4 = exact.state[OMEGA1 : OMEGA4 + 1]
    integrals = exact.integrals()
    return {
        "drive_angle": exact.state[Q],
        "input_angle": exact.state[THETA1],
        "shaft_twist": exact.state[TWIST] if exact.machine.elastic else 0.0,
        **{"input_speed": omega1, "omega2": omega2, "omega_hub": omega3, "omega_out": omega4},
        **{f"energy_{name}": integrals[f"energy_{name}"] for name in ("in", "out")},
        "energy_stored": exact.energy(),
        **{f"energy_lost_{name}": integrals[name] for name in CAUSES},
    }


def held_to(module, exact, accuracy):
    """Return differences by name: actual and expected value."""
    values = expected(exact)
    speed = max(1.0, abs(values["input_speed"]))
    energy = max(1.0, *(abs(values[f"energy_{name}"]) for name in ("in", "out", "stored")))
    angles = {"drive_angle": scenes.drive_angle, "input_angle": scenes.input_angle}
    apart = {}
    for name, value in values.items():
        got = angles[name](module) if name in angles else module[name]
        scale = energy if name.startswith("energy") else speed if "omega" in name or "speed" in name else 1.0
        if not abs(got - value) <= accuracy * scale:
            apart[name] = got, value
    return apart


def cases():
    """Return the rows of the table for every layout, drive and output, and with link 1 turning backwards."""
    for name, places, parts, more in TABLE["rows"]:
        for place, layout, drive, output in product(places.split(" / "), SCENES, scenes.DRIVES, OUTPUTS):
            if set(place.split()) <= {layout, drive, output}:
                values = scenes.DRIVES[drive][layout] | OUTPUTS[output]
                for part in filter(None, parts.split(", ")):
                    values = values | PARTS[part]
                yield name.format(layout=layout, drive=drive, output=output), values | more
    for layout, freewheels in product(SCENES, scenes.FREEWHEELS):
        values = DRIVEN[layout] | scenes.FREEWHEELS[freewheels]
        back = {"omega1": -100.0, "drive_torque": -values["drive_torque"]}
        yield f"{layout}-backwards-{freewheels.replace(' ', '-')}", values | back


# The ideal engines support friction and gears; the general engine supports all other parameters.
GENERAL = (ALL_LOSSES.keys() | PLAY.keys() | {"windage"}) - LOSSES["viscous"].keys()
IDEAL_CASES, GENERAL_CASES = (
    [pytest.param(values, id=name) for name, values in cases() if bool(GENERAL & values.keys()) == general]
    for general in (False, True)
)


def assert_same_motion(kernel, values, parts=(0.01, 0.03)):
    """Compare angles, speeds, energies, torques and means at these times, or under (time, load)."""
    module, exact = started(kernel, values, tolerance=1e-12), reference(values)
    accuracy = 1e-8 if "housing_damping" in values else 1e-9
    before = exact.integrals()
    for part in parts:
        time, load = part if isinstance(part, tuple) else (part, values["load_torque"])
        step = time - exact.time
        module.set(load_torque=load)
        exact.give(exact.machine.torque, load)
        module.advance(step)
        exact.advance(time)
        assert held_to(module, exact, accuracy) == {}, time
        torques = [module[f"{name}_torque"] for name in ("input", "mesh", "output", "housing")]
        largest = max(map(abs, exact.torques()))
        assert torques == pytest.approx(list(exact.torques()), rel=1e-6, abs=1e-6 * largest)
        after = exact.integrals()
        for impulse, mean in IMPULSES.items():
            gained = (after[impulse] - before[impulse]) / step
            assert module[mean] == pytest.approx(gained, abs=1e-7 * largest), mean
        before = after
    lost = sum(module[f"energy_lost_{cause}"] for cause in CAUSES)
    assert lost == pytest.approx(module["energy_lost"], rel=1e-12)
    assert abs(module["energy_residual"]) < 1e-9 * max(module["energy_stored"], module["energy_in"])


@pytest.mark.parametrize("values", IDEAL_CASES)
def test_motion_agrees_with_the_reference(compiled, values):
    assert_same_motion(compiled, values)


@pytest.mark.parametrize("values", GENERAL_CASES)
def test_motion_and_losses_agree_with_the_reference(compiled, values):
    assert_same_motion(compiled, values)


def test_changing_loads(compiled, scene):
    loads = [scene["load_torque"] * (1.0 if n % 4 < 2 else -0.5) for n in range(1, 7)]
    parts = [(0.01 * n, load) for n, load in enumerate(loads, 1)]
    assert_same_motion(compiled, {**scene, **ALL_LOSSES}, parts)


@pytest.mark.parametrize("more", [PLAY, PLAY | ALL_LOSSES], ids=["ideal", "losses"])
def test_jumps_of_the_input_speed_meet_freewheels_within_their_play(compiled, scene, more):
    module, exact = started(compiled, scene, more, tolerance=1e-12), reference(scene | more)
    for n, omega1 in enumerate((90.0, 150.0, 20.0, -80.0, -10.0, 70.0), 1):
        exact.turn(omega1)
        exact.advance(0.013 * n)
        advanced(module, 0.013, omega1=omega1)
        assert held_to(module, exact, 1e-9) == {}, omega1
    assert module["energy_lost_freewheel"] > 1.0


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8])
def test_input_impulse_equals_the_change_of_momentum(compiled, tolerance):
    lengths = {"layout": 1, "sun_radius": 0.085627, "satellite_radius": 0.36137, "eccentricity": 0.35929}
    values = {**lengths, "housing_freewheel": 0, "mesh_efficiency": 0.99, "tolerance": tolerance}
    load, duration = 2253.0, 0.331
    module = started(compiled, values, omega1=0.0, load_torque=load)
    assert module["energy_in"] == 0.0
    module.advance(duration)
    d, omega2 = module.derived, module["omega2"]
    _, _, b, *_ = reduced_inertia(d, module.state.q)
    links = (d.J2 - d.k * b) * omega2
    impulse = (module["input_torque_mean"] - load) * duration
    assert impulse == pytest.approx(links + d.J3 * omega2, abs=10.0 * tolerance * d.J3 * abs(omega2))


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_losses_of_several_satellites_follow_the_tolerance(compiled, tolerance):
    """Each sign change of a satellite's torque is an event."""
    values = {"satellites": 5, "gamma": 3.8, "satellite_mesh_efficiency": 0.5, "omega1": 200.0}
    result, exact = started(compiled, values, load_torque=6e4, tolerance=tolerance), reference(values)
    exact.give(0.0, 6e4)
    for module in (result, exact):
        module.advance(1.2031e-3)
    assert held_to(result, exact, 10.0 * tolerance) == {}


@pytest.mark.parametrize("name", scenes.FOUND["kinked"])
def test_energy_balance_meets_the_tolerance_for_all_steps(compiled, name):
    load, omega1, slope, duration, text = scenes.FOUND["kinked"][name]
    values = scenes.mechanism(text)
    exact = reference({**values, "load_torque": load, "omega1": omega1})
    exact.turn(omega1, slope)
    exact.advance(duration)
    for tolerance, cuts in product((1e-6, 1e-9), ((1.0,), (0.013, 0.37, 0.41, 1.0))):
        module, time = started(compiled, values, omega1=omega1, load_torque=load, tolerance=tolerance), 0.0
        for cut in cuts:
            module.set(omega1=omega1 + slope * time)
            module.set_rates(omega1=slope)
            module.advance(cut * duration - time)
            time = cut * duration
        assert held_to(module, exact, 3.0 * tolerance) == {}, (tolerance, cuts)


# --- a jump of the input speed: impulses from the 2 x 2 complementarity problem ---


MOMENT = 1e-13  # s; only the jump has an effect in this time
SPEEDS = st.floats(-200.0, 200.0)


@pytest.mark.parametrize("output", [True, False], ids=["output freewheel", "rigid with the shaft"])
@pytest.mark.parametrize("housing", [True, False], ids=["housing freewheel", "no housing freewheel"])
@given(
    omega1=SPEEDS,
    target=SPEEDS,
    omega2=st.one_of(st.just(0.0), SPEEDS),
    slip=st.one_of(st.just(0.0), st.floats(0.0, 50.0)),
    q=st.floats(-10.0, 10.0),
    inertia=st.sampled_from([0.0, 0.003]),
    shaft=st.sampled_from([{}, ELASTIC]),
)
def test_speeds_and_impulses_after_a_jump_solve_the_complementarity_problem(
    compiled, scene, housing, output, omega1, target, omega2, slip, q, inertia, shaft
):
    omega2 = abs(omega2) if housing else omega2
    values = {**scene, **shaft, "omega1": omega1, "drive_inertia": inertia, "input_inertia": 0.01}
    values |= {"housing_freewheel": housing, "output_freewheel": output, "drive_angle_start": q}
    values |= {"omega2_start": omega2, "omega_out_start": omega2 + (slip if output else 0.0)}
    module, exact = started(compiled, values), reference(values)
    omega3, stored, change = module["omega_hub"], module["energy_stored"], target - omega1
    exact.turn(target)
    advanced(module, MOMENT, omega1=target)
    end2, end3 = exact.state[[OMEGA2, OMEGA3]]
    (i, _, b, _, g, _), k = direct_sums(exact.machine.p, q), ratio(exact.machine.p)
    slipped = k * (change - (end2 - omega2))
    mesh = k * (b * change + g * slipped)
    driven = (0.01 + i) * change + b * slipped + mesh
    carried = module["output_inertia"] * (end3 - omega3)
    held = module["link2_inertia"] * (end2 - omega2) + carried - mesh
    speeds = [module[name] for name in ("omega2", "omega_hub")]
    speeds += [module[f"{name}_torque_mean"] * MOMENT for name in ("output", "input", "mesh", "housing")]
    expected = [end2, end3, carried, driven, mesh, held]
    assert speeds == pytest.approx(expected, rel=1e-7, abs=1e-6)
    # A speed is zero within rounding of the largest speed.
    fastest = max(abs(omega1), abs(target), abs(omega2), abs(omega3))
    turnover = stored + abs(module["energy_in"]) + module["output_inertia"] * fastest**2
    assert abs(module["energy_residual"]) <= 1e-12 * turnover + 1e-20
    assert abs(module["energy_lost"]) <= (1e-9 if shaft else 0.0)


# --- check values of an independent multibody engine; the error depends only on `tolerance` ---


TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]
DURATION = 1.0


@pytest.mark.parametrize(
    "case", scenes.TABLE["check_values"], ids=lambda case: "-".join(map(str, case["run"]))
)
def test_scenes_have_their_check_values(compiled, case):
    scene, part, tolerance, time = case["run"]
    module = advanced(started(compiled, SCENES[scene], scenes.PARTS.get(part, {}), tolerance=tolerance), time)
    actual = [
        scenes.drive_angle(module) if name == "drive_angle" else module[name] for name in case["values"]
    ]
    wanted = np.array(list(case["values"].values()))
    assert (np.abs(actual - wanted) <= np.multiply(case["within"], np.abs(wanted))).all(), actual


def test_error_falls_in_proportion_to_tolerance_and_stays_within_three_in_any_steps(compiled, scene):
    def speed(tolerance, step=DURATION):
        module = started(compiled, scene, tolerance=tolerance)
        return advanced(module, *[step] * round(DURATION / step))["omega_out"]

    exact = speed(1e-12)
    for step in (DURATION, 0.1, 1e-3):
        errors = [abs(speed(tolerance, step) - exact) / exact for tolerance in TOLERANCES]
        slope, _ = np.polyfit(np.log(TOLERANCES), np.log(errors), 1)
        assert step < DURATION or 0.8 < slope < 1.35
        for tolerance, error in zip(TOLERANCES, errors, strict=True):
            assert error <= 3.0 * tolerance, step
