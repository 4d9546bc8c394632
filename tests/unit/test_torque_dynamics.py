"""The torque of link 1 given: accelerations by the inverse dynamics of a multibody engine."""

from itertools import product

import numpy as np
import pytest
from scenes import LAYOUTS, parameters, started

from inertia_module.kernel.links import accelerations, motion

pytest.importorskip("mujoco")
from test_multibody import Multibody

STATES = 10
# inertia and torque of what link 2 carries, and whether it is held
CARRIED = [(0.0, 0.0, True), (0.0, 0.0, False), (0.5, 30.0, False)]  # held, free, driving


@pytest.fixture(params=product(LAYOUTS, [1, 2, 3], [2], [0.0, 0.004], [0.0, 0.006]), ids=str)
def mechanism(request):
    layout, satellites, modules, own, gear = request.param
    return parameters(
        **LAYOUTS[layout],
        satellites=satellites,
        modules=modules,
        imbalance_mass=0.8,
        drive_inertia=own,
        satellite_inertia=gear,
        satellite_transverse_inertia=0.6 * gear,
        input_inertia=0.02,
        link2_inertia=0.006,
        drive=1,
    )


@pytest.fixture
def states():
    """Random (q, theta1, omega1, omega2, M1)."""
    scale = np.array([10.0, 10.0, 100.0, 100.0, 200.0])
    return scale * np.random.default_rng(2020).uniform(-1.0, 1.0, (STATES, 5))


def test_accelerations_take_the_drive_torque_by_inverse_dynamics(mechanism, states):
    engine = Multibody(mechanism)
    d = started("plain", mechanism).derived
    for (q, theta1, omega1, omega2, torque), (inertia, load, held) in product(states, CARRIED):
        speed2 = 0.0 if held else omega2
        alpha1, alpha2, _ = accelerations(d, q, omega1, speed2, torque, held, inertia, 0.0, load)
        drive, mesh = engine.prescribe(q, theta1, omega1, alpha1, speed2, alpha2)
        scale = abs(torque) + abs(mesh) + abs(load)
        assert drive == pytest.approx(torque, abs=1e-8 * scale)
        if held:
            assert alpha2 == 0.0
            held_torque = motion(d, q, omega1, 0.0, torque, held, inertia, 0.0, load, 0.0)[3]
            assert held_torque == pytest.approx(mesh, abs=1e-8 * scale)
        else:
            taken = (mechanism["link2_inertia"] + inertia) * alpha2 + load
            assert mesh == pytest.approx(taken, abs=1e-8 * scale)
