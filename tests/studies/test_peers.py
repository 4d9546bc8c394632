"""Each peer integrates the same mechanism: it agrees with the kernel within its own error."""

import numpy as np
import pytest
from scenes import SCENES

from inertia_module.common.extras import NotInstalled
from inertia_module.memory import Module
from studies.peers import PEERS, integrators, mujoco_model
from studies.reference.geometry import Unavailable
from studies.trade import Case

INPUTS = ("omega1", "load_torque")
PLANAR = {name: value for name, value in SCENES["planar"].items() if name not in INPUTS}
CASES = {
    "R1": Case(stop_time=0.1, points=20),
    "planar": Case(PLANAR, omega1=120.0, load_torque=8.0, stop_time=0.1, points=20),
}
RIGID_SHAFT = {"output_freewheel": 0}
TURNING_BACK = {"housing_freewheel": 0, "omega_out_start": 5.0}


def kernel_trajectory(case):
    """(q, omega2, omega3) at the sampling times and the number of switches."""
    module = Module().start(
        tolerance=1e-13, omega1=case.omega1, load_torque=case.load_torque, **case.parameters
    )
    rows = []
    for n in range(case.points + 1):
        if n:
            module.advance(case.stop_time / case.points)
        turned = module["drive_angle"] + 2.0 * np.pi * module["drive_turns"]
        rows.append([turned, module["omega2"], module["omega_out"]])
    return np.array(rows).T, module["contact_switches"]


def or_skip(run, *arguments):
    """The trajectory, or a skip that says which library is missing."""
    try:
        return run(*arguments)
    except NotInstalled as error:
        pytest.skip(str(error))


def distance(found, case):
    """Largest differences from the kernel in q, omega2 and omega3, relative to the largest value."""
    (q, omega2, omega3), _ = kernel_trajectory(case)
    scale = omega3.max()
    return (
        np.abs(found.drive_angle - q).max() / abs(q).max(),
        np.abs(found.omega2 - omega2).max() / scale,
        np.abs(found.omega_out - omega3).max() / scale,
    )


@pytest.fixture(params=CASES)
def case(request):
    return CASES[request.param]


@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA", "Adams", "BDF"])
def test_integrators_with_exact_events_follow_the_kernel_and_meet_the_same_events(case, method):
    found = or_skip(integrators.simulate, case, method, 1e-10 if method in ("Adams", "BDF") else 1e-9)
    assert max(distance(found, case)) < 1e-6
    assert found.number_of_switches == len(found.switches) == kernel_trajectory(case)[1]
    assert abs(found.energy_residual) < 1e-4


@pytest.mark.parametrize("parameters", [RIGID_SHAFT, TURNING_BACK], ids=["no output", "no housing freewheel"])
def test_peers_know_a_module_without_one_of_the_freewheels(parameters):
    case = Case(parameters, stop_time=0.1, points=20)
    assert max(distance(or_skip(integrators.simulate, case, "DOP853", 1e-9), case)) < 1e-6
    assert max(distance(or_skip(integrators.simulate, case, "Adams", 1e-10), case)) < 1e-6
    assert max(distance(or_skip(mujoco_model.simulate, case, "RK4", 5e-5), case)) < 2e-3


def test_events_located_at_a_tighter_tolerance_are_nearer_the_kernel(case):
    runs = [or_skip(integrators.simulate, case, "BDF", tolerance) for tolerance in (1e-5, 1e-7, 1e-9)]
    errors = [max(distance(run, case)) for run in runs]
    assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2]


def test_a_stiffer_clutch_slips_less(case):
    stiffnesses = (1e2, 1e3, 1e4)
    slips = [distance(or_skip(integrators.simulate, case, "odeint", 1e-9, c), case)[1] for c in stiffnesses]
    assert slips[0] > 5.0 * slips[1] > 25.0 * slips[2]


@pytest.mark.parametrize("method", ["LSODA", "Radau"])
def test_stiff_scipy_methods_agree_on_the_clutches(method):
    case = Case(stop_time=0.02, points=4)
    one = or_skip(integrators.simulate, case, "odeint", 1e-9, 1e4)
    other = integrators.simulate(case, method, 1e-6 if method == "Radau" else 1e-9, 1e4)
    assert other.omega_out == pytest.approx(one.omega_out, abs=1e-5 * one.omega_out.max())


def test_cvode_agrees_with_scipy_on_the_clutches(case):
    one = or_skip(integrators.simulate, case, "BDF", 1e-9, 1e3)
    other = or_skip(integrators.simulate, case, "odeint", 1e-9, 1e3)
    assert one.omega_out == pytest.approx(other.omega_out, abs=1e-5 * other.omega_out.max())


def test_a_mujoco_model_with_gears_and_freewheels_as_constraints_comes_near_the_kernel(case):
    coarse = distance(or_skip(mujoco_model.simulate, case, "RK4", 1e-3), case)[2]
    found = mujoco_model.simulate(case, "RK4", 5e-5)
    assert distance(found, case)[2] < 1e-3
    assert distance(found, case)[2] < coarse
    assert abs(found.energy_residual) < 0.1


def test_clutches_refuse_a_module_without_a_freewheel():
    with pytest.raises((Unavailable, NotInstalled), match=r"leaves one out|not installed"):
        integrators.simulate(Case(RIGID_SHAFT), "odeint", 1e-6, 1e4)


@pytest.mark.parametrize(
    "parameters",
    [{"fidelity": 0}, {"fidelity": 3}, {"a": 1.0, "link2_inertia": 0.0}, {"link2_friction": 0.1}],
)
def test_a_case_that_is_not_for_them_is_refused_in_one_line(parameters):
    for run, settings in (
        (integrators.simulate, ("DOP853", 1e-6)),
        (integrators.simulate, ("BDF", 1e-6)),
        (mujoco_model.simulate, ("Euler", 1e-3)),
    ):
        with pytest.raises((Unavailable, NotInstalled)) as refused:
            run(Case(parameters), *settings)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("module", ["sksundae.cvode", "mujoco"])
def test_a_missing_library_is_named_with_what_to_install(module, monkeypatch):
    runs = {
        "sksundae.cvode": lambda case: integrators.simulate(case, "BDF", 1e-6, 1e4),
        "mujoco": lambda case: mujoco_model.simulate(case, "Euler", 1e-3),
    }
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(NotInstalled, match=r"not installed.*inertia-module\[peers\]"):
        runs[module](Case(stop_time=0.01, points=2))


def test_every_peer_has_a_name_of_its_own_and_settings():
    assert len({peer.name for peer in PEERS}) == len(PEERS)
    assert all(peer.settings for peer in PEERS)
