"""Values far off: nothing hangs, raises or loses energy; heavy masses and slow inputs keep their digits."""

import math

import pytest
from geometry import direct_derivatives, ratio
from hypothesis import given
from hypothesis import strategies as st
from scenes import DRIVEN, FREEWHEELS, SCENES, advanced, parameters, started

from inertia_module.kernel import engine
from inertia_module.kernel.limits import SMALLEST_SPEED
from inertia_module.memory import Refused

TOLERANCE = 1e-8
TORQUES = st.one_of(st.sampled_from([0.0, 15.0, -15.0]), st.floats(-100.0, 100.0))
ANGLES = st.one_of(st.sampled_from([0.0, math.pi]), st.floats(-7.0, 7.0))
# parameters | steps (s) with a torque (N.m) each
COURSES = {
    # link 1 far lighter than the imbalances: where these let it go, all accelerations are immense
    "a percent allowed": (
        "satellites=3 modules=1000 satellite_radius=0.05 eccentricity=0.03 input_inertia=1e-3 tolerance=0.1 "
        "drive_angle_start=-4.893021955056157 omega2_start=0.42448085272330793 "
        "omega_out_start=0.42448085272330793 omega1=100 load_torque=0 layout=1"
        " | 0.0040718899 -9; 0.0370177748 1e-6"
    ),
    "link 2 without inertia": (
        "satellites=5 input_inertia=3.4430870273063655e-09 link2_inertia=0 load_torque=10 omega1=0 layout=1 "
        "output_inertia=0.09788774562742242 housing_freewheel=0"
        " | 0.002017060634913821 0; 0.0003985851532783533 0.550788711047062"
    ),
    "all digits asked for": (
        "satellite_radius=0.05 eccentricity=0.03 imbalance_mass=0.1 input_inertia=4.139779391464704e-09 "
        "link2_inertia=0 tolerance=1e-12 omega1=119.7998575172004 load_torque=10 layout=1"
        " | 0.000975982447262401 28.386563844434136; 0.0013891582368462 -63.58; 0.006882064394 15"
    ),
    # an event that is none must not come back for ever
    "F next to zero that grows too slowly to be waited for": (
        "satellites=5 modules=1000 input_inertia=0.2 output_freewheel=0"
        " | 0.001257847021713564 -15; 0.0014074200219290147 15"
    ),
    "a step whose inside is good to a percent only": (
        "layout=1 satellites=2 modules=1000 imbalance_mass=0.1 eccentricity=0.03 input_inertia=1e-3 "
        "link2_inertia=0.0020676194362722875 tolerance=0.1 | 0.005949275047865899 -52.78079963511959"
    ),
}


@pytest.fixture(params=SCENES)
def scene(request):
    return DRIVEN[request.param]


@pytest.fixture(params=FREEWHEELS)
def freewheels(request):
    return FREEWHEELS[request.param]


def audited(module, *steps, **inputs):
    """The module after these steps, the audit of each closed to a share that goes with the tolerance."""
    module.set(**inputs)
    heavy = module["energy_stored"]
    for step in steps:
        module.advance(step)
        assert all(math.isfinite(value) for value in module.snapshot().values())
        speed = max(abs(module[name]) for name in ("omega2", "omega_out"))
        energies = [abs(module[name]) for name in ("energy_in", "energy_out", "energy_stored")]
        heavy = max(heavy, *energies, module["output_inertia"] * speed**2)
        assert abs(module["energy_residual"]) <= (300.0 * module["tolerance"] + 1e-12) * heavy + 1e-300
        assert module["input_torque_mean"] == pytest.approx(module["drive_torque"], rel=1e-15)
    return module


@pytest.mark.parametrize("inertia", [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9])
def test_engine_of_any_inertia(scene, freewheels, inertia):
    engine = {"input_inertia": inertia}
    audited(started("auto", scene, freewheels, engine, tolerance=TOLERANCE), 1e-9, 0.01)
    starting = {"omega1": 0.0, "drive_torque": 15.0 * max(inertia, 1e-3)}
    assert audited(started("auto", scene, freewheels, engine, starting), 1e-9, 1e-3)["input_speed"] != 0.0


@pytest.mark.parametrize("tolerance", [1e-13, 1e-6, 0.1])
def test_any_tolerance_and_step(scene, freewheels, tolerance):
    for steps in ((1e-9,) * 10, (0.05,)):
        audited(started("auto", scene, freewheels, tolerance=tolerance), 0.01, *steps)


@pytest.mark.parametrize(
    "values",
    [
        {"link2_inertia": 0.0, "drive_inertia": 1e-3},
        {"link2_inertia": 0.0, "drive_inertia": 1e-3, "satellites": 5, "modules": 1000},
        {"link2_inertia": 0.0, "a": 0.7, "drive_inertia": 1e-9},
        {"link2_inertia": 0.0, "output_freewheel": False},
        {"a": 0.7, "b": 0.7, "satellites": 2},
        {"imbalance_mass": 0.0},
        {"satellite_radius": 0.02, "eccentricity": 0.02},
        {"omega1": 1e5, "tolerance": 1e-9},
        {"drive_torque": 1e9, "input_inertia": 1e3, "omega1": 0.0},
        {"load_torque": 1e9},
        {"load_torque": -1e6},
        {"output_inertia": 1e-9},
        {"output_inertia": 1e9},
    ],
    ids=str,
)
def test_any_mechanism_and_load(scene, values):
    audited(started("auto", scene, values), 1e-6, 1e-4, 1e-3)


@pytest.mark.parametrize("course", COURSES)
def test_engine_far_lighter_than_the_imbalances_neither_leaves_the_doubles_nor_stalls(course):
    parameters, _, steps = COURSES[course].partition(" | ")
    values = {name: float(value) for name, value in (part.split("=") for part in parameters.split())}
    module = started("auto", values, drive=1)
    for one in steps.split(";"):
        step, torque = map(float, one.split())
        audited(module, step, drive_torque=torque)
    assert module["contact_switches"] < 100


@given(torque=TORQUES, angle=ANGLES, load=st.sampled_from([0.0, 1e-9, 10.0]))
def test_engine_turns_round_again_and_again(torque, angle, load):
    values = {"omega1": 0.0, "load_torque": load, "drive_angle_start": angle}
    for scene in DRIVEN.values():
        module = started("auto", scene, values)
        for step in (0.003, 0.003, 0.006, 0.003):
            audited(module, step, drive_torque=torque)
            torque = -torque


@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-15, 1e-9, -1e-9])
@pytest.mark.parametrize("angle", [0.5, math.pi, 4.0])
def test_torque_that_just_balances_the_load_at_standstill(scene, freewheels, off, angle):
    values = {**scene, **freewheels, "omega1": 0.0, "drive_angle_start": angle}
    i, b, g = direct_derivatives(parameters(**values), angle)[:, 0]
    k = ratio(values | parameters(**values))
    coupling = k * (b + k * g)
    phi = values["input_inertia"] + i + 2.0 * k * b + k * k * g
    balance = values["load_torque"] * phi / coupling
    module = audited(started("auto", values, drive_torque=balance * (1.0 + off)), 1e-9, 1e-4, 1e-3)
    assert module["contact_switches"] < 20


@pytest.mark.parametrize("satellites", [1, 2, 5])
@pytest.mark.parametrize("output", [{}, {"fidelity": 3, "output_inertia": 0.02}], ids=["rigid", "elastic"])
def test_timestepping_where_link_2_and_the_imbalances_rest(satellites, output):
    # at the drive angle 0 the imbalance is in the rolling pole: nothing is behind link 2 but the shaft
    values = {"link2_inertia": 0.0, "output_freewheel": False, "satellites": satellites, "load_torque": 1.0}
    course = []
    for method in ({"method": 1, "max_step": 1e-5}, {"tolerance": 1e-9}):
        module = started("auto", DRIVEN["bevel"], values, output, method, omega1=0.0)
        course.append(advanced(module, 1e-4, 5e-3))
    for name in ("input_speed", "omega2", "omega_out", "drive_angle"):
        assert course[0][name] == pytest.approx(course[1][name], rel=1e-2, abs=1e-6), name


@pytest.mark.parametrize(
    "values",
    [
        {"drive_torque": 15.0, "load_torque": 1e4, "omega2_start": 5.0, "omega_out_start": 5.0},
        {"drive_torque": -15.0, "load_torque": 10.0, "omega_out_start": 20.0, "output_inertia": 1e-5},
        {"drive_torque": 0.0, "load_torque": 10.0, "omega_out_start": 0.5, "input_inertia": 1.0},
    ],
    ids=["braked at once", "backwards behind a light shaft", "nothing drives"],
)
def test_mean_motion_from_standstill_with_the_shaft_ahead(compiled, scene, values):
    module = started(compiled, scene, values, fidelity=1, omega1=0.0, tolerance=1e-6)
    for step in (1e-7, 1e-3, 0.01):
        module.advance(step)
        energies = abs(module["energy_in"]) + abs(module["energy_out"]) + module["energy_stored"]
        assert abs(module["energy_residual"]) < 1e-4 * energies
        assert module["input_torque"] == pytest.approx(module["drive_torque"], rel=1e-6, abs=1e-9)
    assert module["input_speed"] * module["drive_torque"] >= 0.0
    assert (module["input_speed"] == 0.0) == (module["drive_torque"] == 0.0)


# --- by speed ---


@pytest.mark.parametrize("mass", [1e7, 1e8, 1e9])
def test_spike_of_link_2_at_a_cusp_is_not_stepped_over(compiled, mass):
    # J2 is down to 5e-10 of the inertia of the imbalance: where that rests, link 2 darts
    values = {"omega1": 100.0, "load_torque": 10.0, "imbalance_mass": mass}
    tight = advanced(started(compiled, values, tolerance=1e-12), *[1e-3] * 1000)
    for tolerance in (1e-5, 1e-6, 1e-8):
        one = advanced(started(compiled, values, tolerance=tolerance), 1.0)
        assert one["contact_switches"] == tight["contact_switches"]
        assert one["omega_out"] == pytest.approx(tight["omega_out"], rel=3.0 * tolerance)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("fidelity", [0, 2])
@given(exponent=st.floats(-323.0, -150.1), sign=st.sampled_from([1.0, -1.0]), load=st.floats(-10.0, 10.0))
def test_input_too_slow_to_be_squared_counts_as_none(compiled, scene, fidelity, exponent, sign, load):
    omega1 = sign * 10.0**exponent
    assert abs(omega1) < SMALLEST_SPEED
    states = []
    for speed in (omega1, 0.0):
        module = started(compiled, SCENES[scene], fidelity=fidelity, omega1=speed, load_torque=load)
        advanced(module, 1e-3, 0.1, omega1=100.0)
        advanced(module, 1e-9, 0.05, omega1=speed)
        states.append(bytes(module.state))
    assert states[0] == states[1]


@pytest.mark.parametrize("power", [-100, -300, -480])
def test_input_that_can_be_squared_scales_exactly(compiled, power):
    # powers of two change no bit of a mantissa; steps may be no longer than 1e6 s, so speeds meet half way
    speed = 2.0**power
    ordinary = started(compiled, omega1=1.0, load_torque=0.0, drive_angle_start=0.3)
    slow = started(compiled, omega1=speed, load_torque=0.0, drive_angle_start=0.3)
    for name in ("input_torque", "mesh_torque", "energy_stored"):
        assert slow[name] == speed**2 * ordinary[name] != 0.0


@pytest.mark.parametrize("fidelity", [0, 2])
def test_work_of_a_step_is_bounded_and_a_step_given_up_leaves_no_trace(monkeypatch, fidelity):
    # in plain Python with a limit that is soon met; tests/fmu has that of the compiled kernel
    assert engine.MAX_EVALUATIONS == 5e7
    monkeypatch.setattr(engine, "MAX_EVALUATIONS", 1e5)
    module = advanced(started("plain", fidelity=fidelity, omega1=1e5, load_torque=1e9), 1e-3)
    state, outputs = bytes(module.state), bytes(module.outputs)
    with pytest.raises(Refused, match="abandoned: it takes more than 5e7 evaluations"):
        module.advance(1e6)
    assert (bytes(module.state), bytes(module.outputs)) == (state, outputs)
    before = module["rhs_evaluations"]
    advanced(module, 1e-3)
    twin = advanced(started("plain", fidelity=fidelity, omega1=1e5, load_torque=1e9), 1e-3, 1e-3)
    assert bytes(module.state) == bytes(twin.state)
    assert 0.0 < module["rhs_evaluations"] - before < 1e4
    assert module.state.step_evaluations < 1e4
