"""Test fidelity `elastic`: hub, shaft and driven mass behind the output freewheel, for all dampings."""

import itertools
import math

import numpy as np
import pytest
from scenes import ELASTIC, PLANAR, REFERENCE, advanced, started

from inertia_module.kernel.links import slowest_rate


def damping(stiffness, share, hub=0.02, driven=0.5):
    """Return the damping for this fraction of critical damping, N m s/rad."""
    return 2.0 * share * math.sqrt(stiffness / (1.0 / hub + 1.0 / driven))


@pytest.mark.parametrize("share", [0.1, 1.1, 3.0, 100.0])
def test_slowest_rate_is_the_slowest_eigenvalue(share):
    d, compliance = started("plain", ELASTIC, shaft_damping=damping(400.0, share)).derived, 1.0 / 0.02
    mobility = compliance + 1.0 / ELASTIC["driven_inertia"]
    slowest = min(abs(np.roots([1.0, d.shaft_damping * mobility, d.shaft_stiffness * mobility])))
    assert slowest_rate(d, compliance) == pytest.approx(slowest, rel=1e-9)


def test_a_shaft_far_stiffer_than_the_pulses_is_rigid(compiled, scene):
    """See kernel.parameters.derive_shaft: a single body, and the twist is torque over stiffness."""
    shaft = {"fidelity": 3, "shaft_stiffness": 1e8, "output_inertia": 0.5, "driven_friction": 0.01}
    light, heavy = ({**shaft, "driven_inertia": inertia} for inertia in (9e-5, 1.1e-4))
    assert started("plain", scene, light).derived.rigid_shaft == 1.0
    assert started("plain", scene, heavy).derived.rigid_shaft == 0.0
    assert started("plain", scene, light, shaft_damping=1e3).derived.rigid_shaft == 0.0  # overdamped and slow
    module = advanced(started(compiled, scene, light), *[0.01] * 20)
    whole = started(compiled, scene, output_inertia=0.5 + 9e-5, output_friction=0.01)
    advanced(whole, *[0.01] * 20)
    for name in ("omega2", "omega_out", "omega_hub", "energy_in", "energy_stored", "rhs_evaluations"):
        assert module[name] == pytest.approx(whole[name], rel=1e-12), name
    torque = 9e-5 * module["output_acceleration"] + 0.01 * module["omega_out"] + module["load_torque"]
    assert module["shaft_twist"] == pytest.approx(torque / 1e8, rel=1e-9)


@pytest.mark.parametrize("balancer", [-0.5, 0.4])
def test_energies_of_a_rigid_shaft_balance_with_its_balancer(compiled, balancer):
    shaft = {"fidelity": 3, "shaft_stiffness": 1e8, "output_inertia": 1e-4, "driven_inertia": 9e-5}
    module = started(compiled, REFERENCE, shaft, balancer=balancer, tolerance=1e-9)
    for n in range(20):
        advanced(module, 0.002, omega1=100.0 + 20.0 * (n % 2))
        assert abs(module["energy_residual"]) < 1e-7 * module["energy_in"]
    assert module["energy_lost_shaft"] * balancer < 0.0


@pytest.mark.parametrize("balancer", [-0.5, 0.4, 0.9])
def test_the_work_of_the_balancer_is_in_the_audit(compiled, balancer):
    module = started(compiled, REFERENCE, ELASTIC, balancer=balancer, tolerance=1e-9)
    for n in range(30):
        advanced(module, 0.01, omega1=100.0 + 20.0 * (n % 2))  # Include jumps of the input.
        assert abs(module["energy_residual"]) < 1e-6 * module["energy_in"]


@pytest.mark.parametrize("light", ["output_inertia", "driven_inertia"])
@pytest.mark.parametrize("inertia", [1e-3, 1e-6])
@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_light_ends_of_the_shaft_are_finite(compiled, light, inertia, share):
    ends = {"output_inertia": 0.3, "driven_inertia": 0.3, light: inertia}
    critical = damping(400.0, share, ends["output_inertia"], ends["driven_inertia"])
    module = started(compiled, REFERENCE, ELASTIC, ends, shaft_damping=critical)
    advanced(module, 0.3)
    assert all(math.isfinite(value) for value in module.snapshot().values())
    assert abs(module["energy_residual"]) < 1e-4 * module["energy_in"]


@pytest.mark.parametrize("drag", [5e-3, 100.0], ids=["swinging", "overdamped"])
@pytest.mark.parametrize("stiffness", [40.0, 400.0, 1e4, 1e7])
@pytest.mark.parametrize("hub", [1e-4, 1e-3, 0.1])
def test_the_twist_of_a_shaft_pulled_by_its_load_follows_tolerance(compiled, drag, stiffness, hub):
    """The load pulls a driven mass of 1 kg m^2 from rest for 0.1 s; both masses are free."""
    shaft = {
        "output_inertia": hub,
        "driven_inertia": 1.0,
        "shaft_stiffness": stiffness,
        "shaft_damping": drag,
    }
    mobility = 1.0 / hub + 1.0
    fast, slow = np.roots([1.0, drag * mobility, stiffness * mobility])
    left = (fast * np.exp(0.1 * slow) - slow * np.exp(0.1 * fast)) / (fast - slow)
    twist = -10.0 / (stiffness * mobility) * (1.0 - left.real)
    for tolerance, steps in itertools.product((1e-4, 1e-6, 1e-8), (1, 10)):
        module = started(compiled, ELASTIC, shaft, load_torque=-10.0, tolerance=tolerance)
        advanced(module, *[0.1 / steps] * steps)
        # Oscillations have errors of phase. Errors of the twist scale with output speed over frequency.
        rate = abs(slow) if drag < 100.0 else math.sqrt(stiffness * mobility)
        scale = max(abs(twist) if drag == 100.0 else 0.0, module["omega_out"] / rate)
        assert abs(module["shaft_twist"] - twist) <= 30.0 * tolerance * scale


def test_resting_shaft_needs_few_evaluations(compiled):
    module = advanced(started(compiled, REFERENCE, ELASTIC, omega1=0.0), 1000.0)
    assert module["shaft_twist"] == pytest.approx(10.0 / 400.0, rel=1e-6)
    assert module["rhs_evaluations"] < 2e5


# Freewheels with strong damping on a light link 2: an error of the speed is a large error of the torque.
DAMPED = {
    "housing": {
        **REFERENCE,
        **{"link2_inertia": 9e-8, "output_inertia": 1.2e-3, "driven_inertia": 0.09, "mesh_efficiency": 0.93},
        **{"housing_stiffness": 6.4e4, "housing_damping": 1e3, "shaft_stiffness": 2.9e4, "omega1": 34.0},
    },
    "output": {
        **REFERENCE,
        **{"link2_inertia": 1.2e-6, "output_inertia": 7e-3, "driven_inertia": 0.2, "drive_inertia": 6e-4},
        **{"freewheel_stiffness": 1e6, "freewheel_damping": 1e3, "shaft_stiffness": 1.2e4, "omega1": 108.0},
    },
    "both": {
        **PLANAR,
        **{"link2_inertia": 1e-8, "output_inertia": 1.5e-3, "driven_inertia": 0.3, "drive_inertia": 1.3e-4},
        **{"housing_stiffness": 60.0, "housing_damping": 120.0, "shaft_stiffness": 1e3, "omega1": 71.0},
        **{"freewheel_stiffness": 1.6e5, "freewheel_damping": 1e3, "mesh_efficiency": 0.97},
    },
}


@pytest.mark.parametrize("damped", DAMPED)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-4])
def test_strong_damping_of_a_light_link_costs_no_more_at_a_loose_tolerance(compiled, damped, tolerance):
    precise, loose = (
        advanced(started(compiled, DAMPED[damped], fidelity=3, tolerance=share), *[0.01] * 5)
        for share in (1e-9, tolerance)
    )
    assert loose["rhs_evaluations"] < 1.5 * precise["rhs_evaluations"]
    assert loose["omega_out"] == pytest.approx(precise["omega_out"], abs=10.0 * tolerance * loose["omega1"])
    assert loose["energy_in"] == pytest.approx(precise["energy_in"], rel=100.0 * tolerance)
