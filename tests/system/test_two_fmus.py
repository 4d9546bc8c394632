"""Rigid module and DrivenShaft, coupled at the communication points, against the elastic module."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from inertia_module.fmu.builder import build
from inertia_module.memory import DrivenShaft, Module, Refused

EXAMPLE = Path(__file__).parents[2] / "examples" / "two_fmus.py"
HUB = {"output_inertia": 0.02}
SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
# design, section 6: omega3, omega4 and delta at 1 s, found by a separate integration of the whole
CHECKED = {"omega_hub": 3.908460340, "omega_out": 16.766411224, "shaft_twist": -1.550114589e-3}
# without freewheels no event hides the order; a short run, for a torque that comes late feeds the swing
SMOOTH = {"housing_freewheel": False, "output_freewheel": False}


def coupled(step, stop=1.0, **settings):
    """Hub speed, driven speed and twist at the end of two models that step side by side."""
    module = Module("compiled").start(omega1=100.0, tolerance=1e-10, **HUB, **settings)
    shaft = DrivenShaft("compiled").start(load_torque=10.0, **SHAFT)
    for _ in range(round(stop / step)):
        module.set(load_torque=shaft["shaft_torque_mean"])
        shaft.set(hub_speed=module["omega_out"])
        module.advance(step)
        shaft.advance(step)
    return np.array([module["omega_out"], shaft["omega_out"], shaft["twist"]]), shaft, module


def one_piece(stop=1.0, **settings):
    try:
        module = Module("compiled").start(
            fidelity=3, omega1=100.0, load_torque=10.0, tolerance=1e-10, **HUB, **SHAFT, **settings
        )
    except Refused as reason:
        pytest.skip(str(reason))
    module.advance(stop)
    return np.array([module[name] for name in CHECKED])


def assert_converges(reference, stop=1.0, **settings):
    """First order in the step, and what the two finest steps point to is the reference."""
    coarse, middle, fine = (coupled(step, stop, **settings)[0] for step in (8e-5, 2e-5, 1e-5))
    order = np.log(np.abs(coarse - reference) / np.abs(fine - reference)) / np.log(8.0)
    assert (order > 0.8).all(), order
    scale = np.array([10.0, 10.0, 0.05])  # what hub, mass and twist swing by
    assert (np.abs(2.0 * fine - middle - reference) < 1e-3 * scale).all()


def test_two_models_converge_to_the_check_values_at_first_order():
    assert_converges(np.array(list(CHECKED.values())))


@pytest.mark.parametrize("settings, stop", [({}, 1.0), (SMOOTH, 0.1)], ids=["freewheels", "no freewheels"])
def test_two_models_converge_to_the_elastic_module_in_one_piece(settings, stop):
    assert_converges(one_piece(stop, **settings), stop, **settings)


def test_what_leaves_the_module_arrives_at_the_shaft():
    """Energies over the seam differ by what the communication step leaves open, and no more."""
    gaps = []
    for step in (1e-4, 1e-5):
        _, shaft, module = coupled(step)
        gaps.append(abs(module["energy_out"] - shaft["energy_in"]) / module["energy_out"])
        assert abs(shaft["energy_residual"]) < 1e-13 * shaft["energy_in"]
    assert gaps[1] < 0.2 * gaps[0]
    assert gaps[1] < 5e-3


def test_example_does_the_same_with_two_fmus(tmp_path):
    build(tmp_path)
    simulate = runpy.run_path(str(EXAMPLE))["simulate"]
    ends, _, _ = coupled(1e-3, stop=0.3)
    assert simulate(1e-3, stop=0.3, folder=tmp_path) == pytest.approx(tuple(ends[:2]), rel=1e-4)
