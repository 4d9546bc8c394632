"""The plain and the compiled kernel are one source: they give the same results."""

import pytest
from scenes import LEVELS, PLANAR, motions, started
from test_motions import led

from inertia_module.compiling.ir import llvm_text
from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.memory import DrivenShaft

COUNTERS = {"contact_mode", "contact_switches", "rhs_evaluations", "drive_turns", "input_turns"}
STEPS = [0.002, 0.003, 0.004] * 4
# maps of fidelity averaged take minutes in plain Python, but for the planar layout by its speed
QUICK = [level for level in LEVELS if level != "averaged"]


def assert_same(plain, fast):
    """That all values are the same to rounding, energies to that of the largest, and counters as they are."""
    assert {name: fast[name] for name in COUNTERS & plain.keys()} == {
        name: plain[name] for name in COUNTERS & plain.keys()
    }
    largest = max(abs(value) for name, value in plain.items() if name.startswith("energy"))
    for name, value in plain.items():
        scale = largest if name.startswith("energy") else abs(value)
        assert fast[name] == pytest.approx(value, abs=1e-12 * max(scale, 1.0)), name


def assert_led_alike(compiled, *scenes):
    modules = [started(kernel, *scenes, tolerance=1e-8) for kernel in ("plain", compiled)]
    for module in modules:
        for _ in led(module, STEPS):
            pass
    assert_same(*(module.snapshot() for module in modules))


@motions(levels=QUICK, added=("gears", "losses", "wind-up"))
def test_both_kernels_give_the_same_results(compiled, scene):
    fixed = {"max_step": 1e-3} if scene.get("method") else {}
    assert_led_alike(compiled, scene, fixed, {"satellites": 2, "epsilon": 0.4, "balancer": 0.3})


def test_both_kernels_give_the_same_mean_motion(compiled):
    assert_led_alike(compiled, PLANAR, LEVELS["averaged"], {"input_hold": 1})


def test_both_kernels_give_the_same_motion_of_a_driven_shaft(compiled):
    models = [DrivenShaft(kernel).start(balancer=0.7, input_hold=1) for kernel in ("plain", compiled)]
    for model in models:
        for n in range(40):
            model.set(hub_speed=20.0 * (n % 7 - 3), load_torque=n - 20.0)
            model.advance((1e-4, 0.01, 0.3, 20.0)[n % 4])
    assert_same(*(model.snapshot() for model in models))


def test_compiled_kernel_counts_no_references(compiled):
    # calls that count references of arrays made R1 slower by a fifth, with the same results
    assert compiled == "compiled"
    assert "NRT_" not in llvm_text(INERTIA_MODULE)
