"""Test extreme values: no hang, exception or energy gain; heavy masses and slow inputs keep their digits."""

import math

import pytest
from geometry import direct_sums, ratio
from hypothesis import given
from hypothesis import strategies as st
from rejected import assert_rejected
from scenes import DRIVEN, FREEWHEELS, TABLE, advanced, parameters, started

from inertia_module.kernel import engine

INERTIAS = [1e-9, 1e-6, 1e-3, 1e3, 1e5]
TORQUES = st.one_of(st.sampled_from([0.0, 15.0, -15.0]), st.floats(-100.0, 100.0))
ANGLES = st.one_of(st.sampled_from([0.0, math.pi]), st.floats(-7.0, 7.0))


@pytest.fixture(params=DRIVEN)
def driven(request):
    return DRIVEN[request.param]


def audited(module, *steps, **inputs):
    """Return the module after these steps; the energy balance of each closes within the tolerance."""
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


FAR_OFF = [
    *({"input_inertia": inertia, "tolerance": 1e-8} for inertia in INERTIAS),
    *(
        {"input_inertia": inertia, "omega1": 0.0, "drive_torque": 15.0 * max(inertia, 1e-3)}
        for inertia in INERTIAS
    ),
    *TABLE["far_off"],
]


@pytest.mark.parametrize("values", FAR_OFF, ids=str)
def test_extreme_load_tolerance_and_step_are_simulated(driven, values):
    for freewheels in FREEWHEELS.values():
        module = audited(started("auto", driven, freewheels, values), *(1e-9,) * 10, 1e-6, 1e-4, 1e-3)
        assert module["input_speed"] != 0.0
        if values != {"load_torque": 1e7}:  # This load accelerates the shaft without limit.
            audited(started("auto", driven, freewheels, values), 0.01, 0.05)


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
@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_torque_equal_to_the_load_at_standstill(driven, freewheels, off, angle):
    values = {**driven, **FREEWHEELS[freewheels], "omega1": 0.0, "drive_angle_start": angle}
    i, b, g = direct_sums(parameters(**values), angle)[::2]
    k = ratio(values | parameters(**values))
    coupling = k * (b + k * g)
    phi = values["input_inertia"] + i + 2.0 * k * b + k * k * g
    balance = values["load_torque"] * phi / coupling
    module = audited(started("auto", values, drive_torque=balance * (1.0 + off)), 1e-9, 1e-4, 1e-3)
    assert module["contact_switches"] < 20


# --- by speed ---


@pytest.mark.parametrize("mass", [1e4, 1e5])
def test_spike_of_link_2_at_a_cusp_is_not_stepped_over(compiled, mass):
    # J2 is 5e-6 of the inertia of the imbalance. Link 2 moves fast while the imbalance rests.
    values = {"omega1": 100.0, "load_torque": 10.0, "imbalance_mass": mass}
    tight = advanced(started(compiled, values, tolerance=1e-12), *[1e-3] * 1000)
    for tolerance in (1e-5, 1e-6, 1e-8):
        module = advanced(started(compiled, values, tolerance=tolerance), 1.0)
        assert module["contact_switches"] == tight["contact_switches"]
        assert module["omega_out"] == pytest.approx(tight["omega_out"], rel=3.0 * tolerance)


@pytest.mark.parametrize("power", [-10, -100])
def test_input_scales_exactly(compiled, power):
    # Powers of two change no bit of a mantissa. Steps are limited to 1e6 s, so speeds scale half the way.
    speed = 2.0**power
    ordinary = started(compiled, omega1=1.0, load_torque=0.0, drive_angle_start=0.3)
    slow = started(compiled, omega1=speed, load_torque=0.0, drive_angle_start=0.3)
    for name in ("input_torque", "mesh_torque", "energy_stored"):
        assert slow[name] == speed**2 * ordinary[name] != 0.0


@pytest.mark.parametrize("fidelity", [0, 2])
def test_work_of_a_step_is_bounded_and_an_abandoned_step_has_no_effect(monkeypatch, fidelity):
    # Plain Python with a low limit; tests/fmu tests the limit of the compiled kernel.
    assert engine.MAX_EVALUATIONS == 5e7
    monkeypatch.setattr(engine, "MAX_EVALUATIONS", 1e4)
    module = advanced(started("plain", fidelity=fidelity, omega1=1e5, load_torque=1e7), 1e-3)
    assert_rejected("rejected: it requires more than 5e7 right-hand-side evaluations", module.advance, 1e6)
    before = module["rhs_evaluations"]
    advanced(module, 1e-3)
    twin = advanced(started("plain", fidelity=fidelity, omega1=1e5, load_torque=1e7), 1e-3, 1e-3)
    assert bytes(module.state) == bytes(twin.state)
    assert 0.0 < module["rhs_evaluations"] - before < 1e4
    assert module.state.step_evaluations < 1e4
