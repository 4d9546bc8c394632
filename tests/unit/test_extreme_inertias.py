"""What double precision and a cusp would spoil: heavy links, spikes of link 2, inputs too slow to square."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import SCENES, advanced, started

from inertia_module.kernel import engine, run
from inertia_module.kernel.limits import SMALLEST_SPEED
from inertia_module.memory import Refused


@pytest.mark.parametrize("ratio", [1e-3, 1e-6, 1e-9, 1e-12])
def test_light_imbalance_has_the_work_of_a_heavy_one_in_proportion(compiled, ratio):
    # behind inertias that hardly move, all torques and works are those of the held mechanism times the mass
    heavy = {"link2_inertia": 1e9, "output_inertia": 1e9, "omega1": 100.0, "load_torque": 0.0}
    one = advanced(started(compiled, heavy, tolerance=1e-9, imbalance_mass=1.0), 0.5)
    light = advanced(started(compiled, heavy, tolerance=1e-9, imbalance_mass=ratio), 0.5)
    assert light["omega2"] == pytest.approx(ratio * one["omega2"], rel=1e-5)
    assert light["energy_in"] == pytest.approx(ratio * one["energy_in"], rel=1e-5)
    assert abs(light["energy_residual"]) < 1e-5 * abs(light["energy_stored"])
    assert light["contact_switches"] == one["contact_switches"]


@pytest.mark.parametrize("scene", SCENES)
def test_heavy_link_2_ends_where_it_does_at_a_tighter_tolerance(compiled, scene):
    for inertia in (1e3, 1e5, 1e7):
        values = {**SCENES[scene], "link2_inertia": inertia, "load_torque": 0.0}
        one = advanced(started(compiled, values), 1.0)
        tight = advanced(started(compiled, values, tolerance=1e-10), 1.0)
        assert one["omega_out"] == pytest.approx(tight["omega_out"], rel=1e-2)
        assert abs(one["energy_residual"]) < 1e-3 * one["energy_stored"]


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
    for part in (engine, run):
        assert part.MAX_EVALUATIONS == 5e7
        monkeypatch.setattr(part, "MAX_EVALUATIONS", 1e5)
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
