"""Module and shaft as two FMUs, coupled as in the example, against the elastic module in one piece."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

from inertia_module.harness.fmu import Fmu
from inertia_module.harness.system import GAUSS_SEIDEL, JACOBI, Node, WiredFmus

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "two_fmus.py"))
HUB, WINDOW, WINDOWS = 0.02, 0.01, 30
WITH_DERIVATIVES = "with derivatives"


@pytest.fixture(scope="module")
def elastic(built):
    """Speeds of hub and driven mass at the end of each window, shape (windows, 2), in one piece."""
    parameters = {"fidelity": "elastic", "output_inertia": HUB, **EXAMPLE["SHAFT"]}
    with Fmu(built / "InertiaModule.fmu", parameters, {"omega1": 100.0, "load_torque": 10.0}, 1e-10) as fmu:
        rows = []
        for _ in range(WINDOWS):
            fmu.advance(WINDOW)
            rows.append(fmu.read(("omega_hub", "omega_out")))
    return np.array(rows)


def coupled(built, way, step, **shaft):
    """(speeds as above of two FMUs, share of the energy out of the module that is lost on the way)."""
    nodes = {
        "module": Node(built / "InertiaModule.fmu", EXAMPLE["MODULE"], {"omega1": 100.0}, 1e-9),
        "shaft": Node(built / "DrivenShaft.fmu", {**EXAMPLE["SHAFT"], **shaft}, {"load_torque": 10.0}),
    }
    order = JACOBI if way == WITH_DERIVATIVES else way
    with WiredFmus(nodes, EXAMPLE["WIRES"], step, order) as system:
        both = system.fmus["module"], system.fmus["shaft"]
        rows = []
        for _ in range(WINDOWS):
            for _ in range(round(WINDOW / step)):
                EXAMPLE["advance"](*both, step) if way == WITH_DERIVATIVES else system.advance()
            rows.append([fmu["omega_out"] for fmu in both])
        left, arrived = both[0]["energy_out"], both[1]["energy_in"]
    return np.array(rows), (left - arrived) / abs(left)


def error(found, expected):
    return math.sqrt(np.mean((found[:, 1] - expected[:, 1]) ** 2)) / np.abs(expected[:, 1]).max()


@pytest.mark.parametrize("way, order", [(JACOBI, 1.0), (GAUSS_SEIDEL, 1.0), (WITH_DERIVATIVES, 2.0)])
def test_two_fmus_tend_to_the_elastic_module_with_the_order_of_the_coupling(built, elastic, way, order):
    errors = [error(coupled(built, way, step)[0], elastic) for step in (5e-4, 1e-4)]
    assert math.log(errors[0] / errors[1]) / math.log(5.0) > 0.8 * order


def test_recommended_coupling_loses_no_energy_where_the_mean_torque_makes_some(built, elastic):
    _, made = coupled(built, JACOBI, 1e-3)
    assert made < -0.1
    found, lost = coupled(built, WITH_DERIVATIVES, 1e-3)
    assert abs(lost) < 1e-3
    assert error(found, elastic) < 2e-3


def swing(built, way, z, steps):
    """Growth of the swing of a free hub on an undamped shaft with a heavy mass; z = h^2 c/J3."""
    step, speed = 1e-4, 50.0
    free = {"output_inertia": HUB, "imbalance_mass": 1e-9, "omega_out_start": speed}
    shaft = {"shaft_stiffness": z * HUB / step**2, "shaft_damping": 0.0, "driven_inertia": 1e6}
    shaft |= {"twist_start": 1e-7, "omega_out_start": speed}
    nodes = {
        "module": Node(built / "InertiaModule.fmu", free, {"omega1": 100.0}, 1e-9),
        "shaft": Node(built / "DrivenShaft.fmu", shaft, {"load_torque": 0.0, "hub_speed": speed}),
    }
    twists = []
    with WiredFmus(nodes, EXAMPLE["WIRES"], step, JACOBI if way == WITH_DERIVATIVES else way) as system:
        both = system.fmus["module"], system.fmus["shaft"]
        for _ in range(steps):
            EXAMPLE["advance"](*both, step) if way == WITH_DERIVATIVES else system.advance()
            twists.append(abs(both[1]["twist"]))
    third = steps // 3
    return max(twists[-third:]) / max(twists[:third])


@pytest.mark.parametrize(
    "way, z, steps, least, most",
    [
        # up to two steps to a radian it neither swings up nor dies down
        *((WITH_DERIVATIVES, z, 120, 0.98, 1.02) for z in (0.04, 1.0, 3.0, 3.9)),
        (WITH_DERIVATIVES, 4.1, 15, 10.0, math.inf),
        # a mean torque makes it swing up at any step
        (JACOBI, 0.04, 120, 1.2, math.inf),
        (GAUSS_SEIDEL, 0.04, 120, 1.2, math.inf),
    ],
)
def test_undamped_hub_swings_up_beyond_its_limit_and_not_before(built, way, z, steps, least, most):
    assert least < swing(built, way, z, steps) < most
