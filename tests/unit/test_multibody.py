import numpy as np
import pytest
from geometry import ratio
from scenes import LAYOUTS, parameters, started, vector

from inertia_module.kernel.layout import imbalance_in_fixed_frame
from inertia_module.kernel.links import accelerations, kinetic_energy, torques
from inertia_module.kernel.loads import write_loads

pytest.importorskip("mujoco")
from multibody import Multibody

STATES = 20
OWN = {
    "J16": {"drive_inertia": 0.004},
    "J16 and bodies": {
        "drive_inertia": 0.004,
        "satellite_inertia": 0.007,
        "satellite_transverse_inertia": 0.005,
    },
    "long bodies": {"satellite_inertia": 1e-4, "satellite_transverse_inertia": 0.02},
    "flat bodies, nearly alone": {
        "imbalance_mass": 1e-3,
        "satellite_inertia": 0.2,
        "satellite_transverse_inertia": 0.1,
    },
}


@pytest.fixture(params=LAYOUTS)
def layout(request):
    return LAYOUTS[request.param]


@pytest.fixture(params=[1, 2, 3])
def satellites(request):
    return request.param


@pytest.fixture(params=[1, 2])
def modules(request):
    return request.param


@pytest.fixture(params=OWN)
def multibody(layout, satellites, modules, request):
    inertias = {"imbalance_mass": 0.8, "input_inertia": 0.02, "link2_inertia": 0.006, **OWN[request.param]}
    return Multibody(parameters(**layout, satellites=satellites, modules=modules, **inertias))


@pytest.fixture
def states():
    """Random (q, theta1, omega1, alpha1, omega2, alpha2)."""
    scale = np.array([10.0, 10.0, 100.0, 3000.0, 100.0, 3000.0])
    return scale * np.random.default_rng(2020).uniform(-1.0, 1.0, (STATES, 6))


def derived(multibody):
    return started("plain", multibody.p).derived


def largest(values):
    return np.abs(values).max()


def test_torques_agree_with_inverse_dynamics_of_the_multibody_engine(multibody, states):
    d = derived(multibody)
    expected = np.array([multibody.prescribe(*state) for state in states])
    found = np.array([torques(d, q, *speeds) for q, _, *speeds in states])
    assert largest(found - expected) < 1e-8 * largest(expected)


@pytest.mark.parametrize(("inertia", "torque"), [(0.0, 0.0), (0.5, 30.0)], ids=["free", "driving"])
def test_link_2_accelerates_as_the_multibody_engine_says(multibody, states, inertia, torque):
    d = derived(multibody)
    for q, theta1, omega1, alpha1, omega2, _ in states:
        # the engine's mesh torque is linear in the acceleration of link 2
        _, still = multibody.prescribe(q, theta1, omega1, alpha1, omega2, 0.0)
        _, moved = multibody.prescribe(q, theta1, omega1, alpha1, omega2, 1000.0)
        carried = multibody.p["link2_inertia"] + inertia
        alpha2 = (still - torque) / (carried - (moved - still) / 1000.0)
        drive, mesh = multibody.prescribe(q, theta1, omega1, alpha1, omega2, alpha2)
        expected = (alpha1, alpha2, drive, torque + inertia * alpha2, mesh)
        scale = largest([still, drive, torque])
        *found, _ = accelerations(d, q, omega1, omega2, alpha1, False, inertia, 0.0, torque)
        found += torques(d, q, omega1, alpha1, omega2, found[1])
        found.insert(3, found[3] - multibody.p["link2_inertia"] * found[1])  # what link 2 passes on
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-8 * scale)


def test_imbalance_moves_and_accelerates_as_in_the_multibody_engine(multibody, states):
    d = derived(multibody)
    k = ratio(multibody.p)
    for q, theta1, omega1, alpha1, omega2, alpha2 in states:
        multibody.prescribe(q, theta1, omega1, alpha1, omega2, alpha2)
        found = imbalance_in_fixed_frame(
            d, q, theta1, omega1, alpha1, k * (omega1 - omega2), k * (alpha1 - alpha2), 0.0
        )
        for expected, values in zip(multibody.imbalance(), np.reshape(found, (3, 3)), strict=True):
            assert largest(values - expected) < 1e-8 * largest(expected)


def test_mount_feels_what_the_multibody_engine_says(multibody, states):
    module = started("plain", multibody.p)
    for q, theta1, omega1, alpha1, omega2, alpha2 in states:
        multibody.prescribe(q, theta1, omega1, alpha1, omega2, alpha2)
        motion = {"q": q, "theta1": theta1, "omega1": omega1, "alpha1": alpha1, "omega2": omega2}
        for name, value in motion.items():
            setattr(module.state, name, value)
        write_loads(module.parameters, module.derived, module.state, module.outputs, alpha2)
        largest_force = multibody.p["imbalance_mass"] * module["imbalance_acceleration"]
        scale = largest_force * multibody.p["modules"] * multibody.p["satellites"]
        for name, expected in zip(("force", "moment"), multibody.on_the_mount(), strict=True):
            scale = max(scale, largest(expected))
            assert largest(vector(module, f"shaking_{name}") - expected) < 1e-8 * scale


def test_kinetic_energy_is_that_of_the_multibody_engine(multibody, states):
    d = derived(multibody)
    for q, theta1, omega1, alpha1, omega2, alpha2 in states:
        multibody.prescribe(q, theta1, omega1, alpha1, omega2, alpha2)
        assert kinetic_energy(d, q, omega1, omega2, 0.0) == pytest.approx(multibody.energy(), rel=1e-8)
