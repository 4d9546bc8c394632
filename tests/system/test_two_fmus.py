"""Rigid module and DrivenShaft, coupled at the communication points, against the elastic module."""

import functools
import runpy
from pathlib import Path

import numpy as np
import pytest

from inertia_module.memory import DrivenShaft, Module

EXAMPLE = Path(__file__).parents[2] / "examples" / "two_fmus.py"
HUB = {"output_inertia": 0.02}
SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
# design, section 6: omega3, omega4 and delta at 1 s, found by a separate integration of the whole
CHECKED = {"omega_hub": 3.908460340, "omega_out": 16.766411224, "shaft_twist": -1.550114589e-3}
# without freewheels no event hides the order; a short run, for a torque that comes late feeds the swing
SMOOTH = {"housing_freewheel": False, "output_freewheel": False}


@functools.cache
def coupled(step, stop=1.0, free=False):
    """Hub speed, driven speed and twist at the end of two models that step side by side; and the models."""
    module = Module("compiled").start(omega1=100.0, tolerance=1e-10, **HUB, **(SMOOTH if free else {}))
    shaft = DrivenShaft("compiled").start(load_torque=10.0, **SHAFT)
    for _ in range(round(stop / step)):
        module.set(load_torque=shaft["shaft_torque_mean"])
        shaft.set(hub_speed=module["omega_out"])
        module.advance(step)
        shaft.advance(step)
    return np.array([module["omega_out"], shaft["omega_out"], shaft["twist"]]), shaft, module


@pytest.mark.parametrize("stop, free", [(1.0, False), (0.1, True)], ids=["freewheels", "no freewheels"])
def test_two_models_converge_to_the_elastic_module_in_one_piece_at_first_order(stop, free):
    """What the two finest steps point to is the elastic module, and the check values."""
    settings = {"omega1": 100.0, "load_torque": 10.0, "tolerance": 1e-10, **HUB, **SHAFT}
    whole = Module("compiled").start(fidelity=3, **settings, **(SMOOTH if free else {}))
    whole.advance(stop)
    references = [np.array([whole[name] for name in CHECKED])]
    if not free:
        references.append(np.array(list(CHECKED.values())))
    coarse, middle, fine = (coupled(step, stop, free)[0] for step in (8e-5, 2e-5, 1e-5))
    scale = np.array([10.0, 10.0, 0.05])  # what hub, mass and twist swing by
    for reference in references:
        order = np.log(np.abs(coarse - reference) / np.abs(fine - reference)) / np.log(8.0)
        assert (order > 0.8).all(), order
        assert (np.abs(2.0 * fine - middle - reference) < 1e-3 * scale).all()


def test_what_leaves_the_module_arrives_at_the_shaft():
    """Energies over the seam differ by what the communication step leaves open, and no more."""
    gaps = []
    for step in (8e-5, 1e-5):
        _, shaft, module = coupled(step, 1.0, False)
        gaps.append(abs(module["energy_out"] - shaft["energy_in"]) / module["energy_out"])
        assert abs(shaft["energy_residual"]) < 1e-13 * shaft["energy_in"]
    assert gaps[1] < 0.2 * gaps[0]
    assert gaps[1] < 5e-3


def test_example_does_the_same_with_two_fmus(built):
    simulate = runpy.run_path(str(EXAMPLE))["simulate"]
    ends, _, _ = coupled(1e-3, stop=0.3)
    assert simulate(1e-3, stop=0.3, folder=built) == pytest.approx(tuple(ends[:2]), rel=1e-4)
