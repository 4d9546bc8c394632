"""Each peer integrates the same mechanism: it agrees with the kernel within its own error."""

import functools

import numpy as np
import pytest
from scenes import DRIVEN, MECHANISMS, parameters, started

from inertia_module.common.extras import NotInstalled
from inertia_module.scene.satellite import Satellite
from studies.peers import PEERS, integrators, mujoco_model
from studies.reference.geometry import Unavailable, ratio
from studies.trade import Case, converged

CASES = {
    "R1": Case(stop_time=0.1, points=20),
    "planar": Case(MECHANISMS["planar"], omega1=120.0, load_torque=8.0, stop_time=0.1, points=20),
    "no output freewheel": Case({"output_freewheel": 0}, stop_time=0.1, points=20),
    "turning back": Case({"housing_freewheel": 0, "omega_out_start": 5.0}, stop_time=0.1, points=20),
}
both = pytest.mark.parametrize("name", ["R1", "planar"])


@functools.cache
def kernel_trajectory(name):
    """Trajectory by the converged kernel."""
    return converged(CASES[name])


def run(case, setting, method, stiffness=None):
    """The trajectory, or a skip that says which library is missing."""
    try:
        if method in ("Euler", "RK4"):
            return mujoco_model.simulate(case, setting, method)
        return integrators.simulate(case, setting, method, stiffness)
    except NotInstalled as error:
        pytest.skip(str(error))


def distances(name, *settings):
    """Trajectory of a case and its largest differences from the kernel in q, omega2 and omega3, relative."""
    found, exact = run(CASES[name], *settings), kernel_trajectory(name)
    largest = exact.omega_out.max()
    scales = abs(exact.motion[:, 0]).max(), largest, largest
    return found, np.abs(found.motion - exact.motion).max(axis=0) / scales


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA", "Adams", "BDF"])
def test_integrators_with_exact_events_follow_the_kernel_and_meet_the_same_events(name, method):
    found, off = distances(name, 1e-10 if method in ("Adams", "BDF") else 1e-9, method)
    assert max(off) < 1e-6
    assert found.switches == kernel_trajectory(name).switches


@both
def test_a_tighter_tolerance_is_nearer_the_kernel_and_a_stiffer_clutch_slips_less(name):
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
def test_stiff_methods_agree_on_the_clutches(name, method, tolerance, stiffness):
    case = CASES[name] if method == "BDF" else Case(stop_time=0.02, points=4)
    one, other = run(case, 1e-9, "odeint", stiffness), run(case, tolerance, method, stiffness)
    assert other.omega_out == pytest.approx(one.omega_out, abs=1e-5 * one.omega_out.max())


@pytest.mark.parametrize("name", CASES)
def test_a_mujoco_model_with_gears_and_freewheels_as_constraints_comes_near_the_kernel(name):
    off = distances(name, 5e-5, "RK4")[1]
    assert max(off) < 2e-3
    if name in ("R1", "planar"):
        assert off[2] < min(1e-3, distances(name, 1e-3, "RK4")[1][2])


def half_disc(radius, thickness, place, density, segments=720):
    """A mesh and a geom of MuJoCo: a prism whose base is half of a regular polygon, to the side of x."""
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, segments + 1)
    rim = radius * np.array([np.cos(angles), np.sin(angles)]).T
    points = [f"{x:.17g} {y:.17g} {side * thickness:.17g}" for side in (-0.5, 0.5) for x, y in rim.tolist()]
    name = f"half {place:g}"
    mesh = f'<mesh name="{name}" inertia="exact" vertex="{" ".join(points)}"/>'
    return mesh, f'<geom type="mesh" mesh="{name}" pos="0 0 {place:.17g}" density="{density!r}"/>'


@pytest.mark.parametrize("layout", ["planar", "bevel"])
def test_a_satellite_by_its_sizes_has_the_inertia_that_mujoco_finds_of_its_shapes(layout):
    mujoco = pytest.importorskip("mujoco")
    pitch, width, radius, thickness = 0.03, 0.012, 0.025, 0.02
    sizes = {"width": width, "weight_radius": radius, "weight_width": thickness}
    satellite = Satellite(**sizes, material="aluminium", weight_material="brass")
    given = {"layout": 1.0, "satellite_radius": pitch}
    if layout == "bevel":
        given = {"layout": 0.0, "wheel_radius": pitch * 1.7, "z17": 34.0, "z6": 20.0}
    found = satellite.parameters(given)
    places = [side * 0.5 * (width + 0.5 * thickness) for side in (-1.0, 1.0)]
    halves = [half_disc(radius, 0.5 * thickness, place, 8500.0) for place in places]
    gear = f'<geom type="cylinder" size="{pitch!r} {0.5 * width!r}" density="2700"/>'
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler inertiafromgeom="true"/><asset>{"".join(mesh for mesh, _ in halves)}</asset>
        <worldbody><body>{gear}{"".join(geom for _, geom in halves)}</body></worldbody></mujoco>"""
    )
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    inertia = np.diag(turn.reshape(3, 3) @ np.diag(model.body_inertia[1]) @ turn.reshape(3, 3).T)
    offset = found["a"] * pitch if layout == "bevel" else found["eccentricity"]
    # half a polygon of 1,440 sides is smaller than half a disc by 3e-6 of it
    assert model.body_mass[1] == pytest.approx(found["imbalance_mass"], rel=1e-5)
    assert model.body_ipos[1] == pytest.approx([offset, 0.0, 0.0], rel=1e-5, abs=1e-9)
    assert inertia[2] == pytest.approx(found["satellite_inertia"], rel=1e-5)
    if layout == "bevel":
        assert np.mean(inertia[:2]) == pytest.approx(found["satellite_transverse_inertia"], rel=1e-5)


def test_an_impact_at_the_end_of_the_play_is_that_at_a_limit_in_mujoco(compiled):
    """Link 2 turns back from rest until it is caught; link 1 is light, and answers."""
    engine, step = pytest.importorskip("mujoco"), 1e-6
    scene = DRIVEN["planar"] | {"satellites": 1, "input_inertia": 0.002, "drive_torque": 0.0}
    # (a speed that is none, so that it has overrun), and the output overruns throughout
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
def test_a_case_that_is_not_for_them_is_refused_in_one_line(parameters):
    for simulate, *settings in (
        (integrators.simulate, 1e-6, "DOP853"),
        (integrators.simulate, 1e-6, "BDF"),
        (mujoco_model.simulate, 1e-3, "Euler"),
    ):
        with pytest.raises((Unavailable, NotInstalled)) as refused:
            simulate(Case(parameters), *settings)
        assert "\n" not in str(refused.value)
    with pytest.raises((Unavailable, NotInstalled), match=r"leaves one out|not installed"):
        integrators.simulate(CASES["no output freewheel"], 1e-6, "odeint", 1e4)


def test_every_peer_and_setting_is_there_once_and_integrates_a_case():
    assert len({(name, label) for name, label, _ in PEERS}) == len(PEERS)
    # of each the loosest, which comes first
    for integrate in {name: integrate for name, _, integrate in reversed(PEERS)}.values():
        try:
            assert integrate(Case(stop_time=0.002, points=2)).omega_out.shape == (3,)
        except NotInstalled:
            continue
