"""Test the peers: each one agrees with the kernel within its own error."""

import functools

import numpy as np
import pytest
from scenes import DRIVEN, MECHANISMS, parameters, started

from benchmarks.peers import PEERS, integrators, mujoco_model
from benchmarks.trade_off import Case, converged
from inertia_module.common.errors import MissingDependencyError
from verification.reference.geometry import UnavailableError, ratio

CASES = {
    "R1": Case(stop_time=0.1, points=20),
    "planar": Case(MECHANISMS["planar"], omega1=120.0, load_torque=8.0, stop_time=0.1, points=20),
    "no output freewheel": Case({"output_freewheel": 0}, stop_time=0.1, points=20),
    "turning back": Case({"housing_freewheel": 0, "omega_out_start": 5.0}, stop_time=0.1, points=20),
}
both = pytest.mark.parametrize("name", ["R1", "planar"])


@functools.cache
def kernel_trajectory(name):
    """Return the trajectory of the converged kernel."""
    return converged(CASES[name])


def run(case, setting, method, stiffness=None):
    """Return the trajectory; skip the test if a library is missing."""
    try:
        if method in ("Euler", "RK4"):
            return mujoco_model.simulate(case, setting, method)
        return integrators.simulate(case, setting, method, stiffness)
    except MissingDependencyError as error:
        pytest.skip(str(error))


def distances(name, *settings):
    """Return the trajectory of a case, and its maximum relative errors of q, omega2 and omega3."""
    trajectory, exact = run(CASES[name], *settings), kernel_trajectory(name)
    max_speed = exact.omega_out.max()
    scales = abs(exact.motion[:, 0]).max(), max_speed, max_speed
    return trajectory, np.abs(trajectory.motion - exact.motion).max(axis=0) / scales


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA", "Adams", "BDF"])
def test_integrators_with_event_location_agree_with_the_kernel(name, method):
    trajectory, errors = distances(name, 1e-10 if method in ("Adams", "BDF") else 1e-9, method)
    assert max(errors) < 1e-6
    assert trajectory.switches == kernel_trajectory(name).switches


@both
def test_tighter_tolerance_and_stiffer_clutch_reduce_the_error(name):
    for errors in (
        [max(distances(name, tolerance, "BDF")[1]) for tolerance in (1e-5, 1e-7, 1e-9)],
        [distances(name, 1e-9, "odeint", stiffness)[1][1] for stiffness in (1e2, 1e3, 1e4)],
    ):
        assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2]


@pytest.mark.parametrize(
    ("name", "method", "tolerance", "stiffness"),
    [
        ("R1", "LSODA", 1e-9, 1e4),
        ("R1", "Radau", 1e-6, 1e4),
        ("R1", "BDF", 1e-9, 1e3),
        ("planar", "BDF", 1e-9, 1e3),
    ],
)
def test_stiff_methods_agree_with_clutches(name, method, tolerance, stiffness):
    case = CASES[name] if method == "BDF" else Case(stop_time=0.02, points=4)
    odeint, solver = run(case, 1e-9, "odeint", stiffness), run(case, tolerance, method, stiffness)
    assert solver.omega_out == pytest.approx(odeint.omega_out, abs=1e-5 * odeint.omega_out.max())


@pytest.mark.parametrize("name", CASES)
def test_mujoco_model_agrees_with_the_kernel(name):
    errors = distances(name, 5e-5, "RK4")[1]
    assert max(errors) < 2e-3
    if name in ("R1", "planar"):
        assert errors[2] < min(1e-3, distances(name, 1e-3, "RK4")[1][2])


def test_impact_at_the_end_of_the_engagement_angle_equals_a_limit_in_mujoco(compiled):
    """Link 2 turns backwards from rest until the freewheel engages; link 1 is light and its speed changes."""
    engine, step = pytest.importorskip("mujoco"), 1e-6
    scene = DRIVEN["planar"] | {"satellites": 1, "input_inertia": 0.002, "drive_torque": 0.0}
    # omega2_start is tiny, so that the freewheel has overrun; the output overruns all the time
    scene |= {"housing_engagement_angle": 0.02, "omega2_start": 1e-9, "omega_out_start": 500.0}
    module = started(compiled, scene, drive_angle_start=1.5, load_torque=0.0)
    before = module["energy_stored"]
    module.advance(2.1e-3)
    assert module["housing_engagements"] == 1
    k, solved = ratio(parameters(**scene)), f'="0 {-1.0 / step!r}"'
    joints = {"drive 0 0": 1.0, "link 1": -k, "link 2": k}
    mesh = "".join(f'<joint joint="{name}" coef="{value!r}"/>' for name, value in joints.items())
    limit = f'limited="true" range="-0.02 1e9" solreflimit{solved} solimplimit="0.9999 0.9999 1"'
    more = f"""<tendon><fixed {limit}><joint joint="link 2" coef="1"/></fixed>
        <fixed name="mesh">{mesh}</fixed></tendon>
        <equality><tendon tendon1="mesh" solref{solved} solimp="0.9999 0.9999 1"/></equality>"""
    text = mujoco_model.mechanism(parameters(**scene), f'timestep="{step!r}" tolerance="1e-14"', more)
    model = engine.MjModel.from_xml_string(text)
    model.tendon_invweight0[:] = model.dof_invweight0[:] = mujoco_model.INVERSE_INERTIA
    data = engine.MjData(model)
    data.joint("drive 0 0").qpos[0], data.joint("link 1").qvel[0] = 1.5, scene["omega1"]
    data.joint("drive 0 0").qvel[0] = k * scene["omega1"]
    engine.mj_forward(model, data)
    stored = data.energy[1]
    engine.mj_step(model, data, 2100)
    engine.mj_forward(model, data)
    assert module["omega2"] == 0.0 == pytest.approx(data.joint("link 2").qvel[0], abs=1e-6)
    assert module["input_speed"] == pytest.approx(data.joint("link 1").qvel[0], rel=1e-4)
    assert module["energy_lost_freewheel"] == pytest.approx(before - module["energy_stored"], rel=1e-4)
    assert module["energy_lost_freewheel"] == pytest.approx(stored - data.energy[1], rel=0.01)


@pytest.mark.parametrize(
    "parameters",
    [{"fidelity": 0}, {"fidelity": 3}, {"a": 1.0, "link2_inertia": 0.0}, {"link2_friction": 0.1}],
)
def test_unsupported_case_is_rejected_in_one_line(parameters):
    for simulate, *settings in (
        (integrators.simulate, 1e-6, "DOP853"),
        (integrators.simulate, 1e-6, "BDF"),
        (mujoco_model.simulate, 1e-3, "Euler"),
    ):
        with pytest.raises((UnavailableError, MissingDependencyError)) as error:
            simulate(Case(parameters), *settings)
        assert "\n" not in str(error.value)
    with pytest.raises((UnavailableError, MissingDependencyError), match=r"require both|not installed"):
        integrators.simulate(CASES["no output freewheel"], 1e-6, "odeint", 1e4)


def test_settings_of_peers_are_unique_and_integrate_a_case():
    assert len({(name, label) for name, label, _ in PEERS}) == len(PEERS)
    # the first setting of each peer, which is the loosest
    for integrate in {name: integrate for name, _, integrate in reversed(PEERS)}.values():
        try:
            assert integrate(Case(stop_time=0.002, points=2)).omega_out.shape == (3,)
        except MissingDependencyError:
            continue
