"""Test module and shaft as two FMUs, coupled as in the example, against the monolithic elastic module."""

import contextlib
import math
import runpy
from pathlib import Path

import numpy as np
import pytest

from inertia_module.fmi.instance import Fmu
from inertia_module.fmi.simulate import simulate_fmu

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "two_fmus.py"))
SHAFT, JACOBI, WITH_DERIVATIVES = (EXAMPLE[name] for name in ("SHAFT", "advance", "advance_with_derivatives"))
HUB = {"output_inertia": 0.02}
WINDOW, WINDOWS = 0.01, 30


def gauss_seidel(module, shaft, step):
    module.set(load_torque=shaft["shaft_torque_mean"])
    module.advance(step)
    shaft.set(hub_speed=module["omega_out"])
    shaft.advance(step)


def test_a_run_from_a_table_gives_each_step_the_inputs_of_its_beginning(built):
    path, ends = built / "InertiaModule.fmu", {"omega1": [100.0, 120.0], "load_torque": 4.0}
    table = simulate_fmu(path, {"time": [0.0, 0.05], **ends}, 0.05, 0.01)
    assert table["omega1"] == pytest.approx([100.0, 104.0, 108.0, 112.0, 116.0, 120.0])
    with Fmu(path, inputs={"omega1": 100.0, "load_torque": 4.0}) as fmu:
        for speed, expected in zip(table["omega1"], table["omega_out"][1:], strict=False):
            fmu.set(omega1=speed)
            fmu.advance(0.01)
            assert fmu["omega_out"] == pytest.approx(expected, rel=1e-9)


@pytest.fixture(scope="module")
def elastic(built):
    """Return monolithic speeds of hub and driven mass at the end of each window, shape (windows, 2)."""
    parameters = {"fidelity": "elastic", **HUB, **SHAFT}
    with Fmu(built / "InertiaModule.fmu", parameters, {"omega1": 100.0, "load_torque": 10.0}, 1e-10) as fmu:
        rows = []
        for _ in range(WINDOWS):
            fmu.advance(WINDOW)
            rows.append(fmu.read(("omega_hub", "omega_out")))
    return np.array(rows)


def stepped(built, advance, step, steps, look, module=HUB, shaft=SHAFT, speed=0.0, load=10.0):
    """Return the results of `look` at the two FMUs after each step, and their exchanged energies."""
    with contextlib.ExitStack() as stack:
        both = (
            stack.enter_context(Fmu(built / "InertiaModule.fmu", module, {"omega1": 100.0}, 1e-9)),
            stack.enter_context(
                Fmu(built / "DrivenShaft.fmu", shaft, {"load_torque": load, "hub_speed": speed})
            ),
        )
        rows = []
        for _ in range(steps):
            advance(*both, step)
            rows.append(look(*both))
        return np.array(rows), both[0]["energy_out"], both[1]["energy_in"]


def coupled(built, advance, step):
    """Return the same speeds of two FMUs, and the relative loss of energy between them."""
    every = round(WINDOW / step)
    speeds, left, arrived = stepped(
        built, advance, step, WINDOWS * every, lambda *both: [fmu["omega_out"] for fmu in both]
    )
    return speeds[every - 1 :: every], (left - arrived) / abs(left)


def error(actual, expected):
    return math.sqrt(np.mean((actual[:, 1] - expected[:, 1]) ** 2)) / np.abs(expected[:, 1]).max()


@pytest.mark.parametrize("way, order", [(JACOBI, 1.0), (gauss_seidel, 1.0), (WITH_DERIVATIVES, 2.0)])
def test_two_fmus_tend_to_the_elastic_module_with_the_order_of_the_coupling(built, elastic, way, order):
    errors = [error(coupled(built, way, step)[0], elastic) for step in (5e-4, 1e-4)]
    assert math.log(errors[0] / errors[1]) / math.log(5.0) > 0.8 * order


def test_example_agrees_with_its_coupling(built):
    ends = EXAMPLE["simulate"](WITH_DERIVATIVES, 1e-3, stop=WINDOW * WINDOWS, folder=built)
    assert ends == pytest.approx(coupled(built, WITH_DERIVATIVES, 1e-3)[0][-1], rel=1e-4)


def test_recommended_coupling_conserves_energy(built, elastic):
    _, made = coupled(built, JACOBI, 1e-3)
    assert made < -0.1
    speeds, lost = coupled(built, WITH_DERIVATIVES, 1e-3)
    assert abs(lost) < 1e-3
    assert error(speeds, elastic) < 2e-3


def swing(built, way, z, steps):
    """Return the growth of the oscillation of a free hub on an undamped shaft; z = h^2 c/J3."""
    step, speed = 1e-4, 50.0
    free = {**HUB, "imbalance_mass": 1e-9, "omega_out_start": speed}
    shaft = {
        "shaft_stiffness": z * HUB["output_inertia"] / step**2,
        "shaft_damping": 0.0,
        "driven_inertia": 1e5,
    }
    shaft |= {"twist_start": 1e-7, "omega_out_start": speed}
    twists, _, _ = stepped(
        built, way, step, steps, lambda _, driven: abs(driven["twist"]), free, shaft, speed, 0.0
    )
    third = steps // 3
    return max(twists[-third:]) / max(twists[:third])


@pytest.mark.parametrize(
    "way, z, steps, least, most",
    [
        # Up to two steps per radian the amplitude is constant.
        *((WITH_DERIVATIVES, z, 120, 0.98, 1.02) for z in (0.04, 1.0, 3.0, 3.9)),
        (WITH_DERIVATIVES, 4.1, 15, 10.0, math.inf),
        # A mean torque makes the oscillation grow with each step size.
        (JACOBI, 0.04, 120, 1.2, math.inf),
        (gauss_seidel, 0.04, 120, 1.2, math.inf),
    ],
)
def test_undamped_hub_swings_up_beyond_its_limit_and_not_before(built, way, z, steps, least, most):
    assert least < swing(built, way, z, steps) < most
