"""The torque of link 1 given: accelerations, and the contact mode that follows."""

from itertools import product

import numpy as np
import pytest
from scenes import FREEWHEELS, LAYOUTS, parameters, started

from inertia_module.kernel.links import accelerations, motion

pytest.importorskip("mujoco")
from multibody import Multibody

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


@pytest.mark.parametrize("freewheels", FREEWHEELS)
@pytest.mark.parametrize("resting", [False, True], ids=["moving", "link 2 at rest"])
def test_contact_mode_fulfils_all_conditions_on_velocities_accelerations_and_torques(
    mechanism, states, freewheels, resting
):
    engine = Multibody(mechanism)
    for n, (q, _, omega1, omega2, torque) in enumerate(states):
        speed2 = 0.0 if resting else abs(omega2)
        touching = n % 2 == 0 or not FREEWHEELS[freewheels].get("output_freewheel", True)
        module = started(
            "plain",
            mechanism,
            FREEWHEELS[freewheels],
            omega1=omega1,
            omega2_start=speed2,
            omega_out_start=speed2 + (0.0 if touching else 7.0),
            drive_angle_start=q,
            drive_torque=torque,
            load_torque=30.0 - 12.0 * n,
        )
        house, clutch, mesh = (module[f"{name}_torque"] for name in ("housing", "output", "mesh"))
        alpha1, alpha2 = module.state.alpha1, (mesh - clutch + house) / module["link2_inertia"]
        alpha3 = (clutch - module["load_torque"]) / module["output_inertia"]
        drive, expected = engine.prescribe(q, 0.0, omega1, alpha1, speed2, alpha2)
        scale = abs(torque) + abs(mesh) + abs(clutch) + abs(house)
        tiny = 1e-8 * scale / module["link2_inertia"]
        assert (drive, expected) == pytest.approx((torque, mesh), abs=1e-8 * scale)
        assert module["input_torque"] == pytest.approx(torque, abs=1e-10 * scale)
        # a freewheel that is there and touches pushes or opens, any other one has no torque
        if module["housing_freewheel"] and speed2 == 0.0:
            assert house >= 0.0
            assert alpha2 >= -tiny
            assert house * alpha2 <= tiny * scale
        else:
            assert house == 0.0
        if not module["output_freewheel"]:
            assert alpha3 == pytest.approx(alpha2, abs=tiny)
        elif touching:
            assert clutch >= 0.0
            assert alpha3 >= alpha2 - tiny
            assert clutch * (alpha3 - alpha2) <= tiny * scale
        else:
            assert clutch == 0.0
