"""Inertia module and elastic shaft as two FMUs, coupled at the communication points.

The rigid module drives the hub (its output shaft, J3); DrivenShaft is the shaft behind it with the driven
mass. Speed goes one way, torque the other:

    omega_out of the module          ->  hub_speed of the shaft
    shaft_torque_mean of the shaft   ->  load_torque of the module

Side by side (Jacobi) is what most hosts do, and its error falls with the first power of the step. With the
torque at an instant, the module first and the derivatives of both it falls with the second: see
docs/coupling.md. Run `inertia-module build` first. The last line is the elastic module in one piece.
"""

from pathlib import Path

from inertia_module.harness.fmu import Fmu
from inertia_module.harness.system import JACOBI, Node, Wire, WiredFmus

BUILD = Path("build")  # of `inertia-module build`
MODULE = {"output_inertia": 0.02, "fidelity": "rigid"}
SHAFT = {"driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
SPEED = 100.0  # rad/s
LOAD = 10.0  # N.m
WIRES = (
    Wire("module", "omega_out", "shaft", "hub_speed"),
    Wire("shaft", "shaft_torque_mean", "module", "load_torque"),
)
ONE_PIECE = 3.908460340, 16.766411224  # rad/s, hub and driven mass


def simulate(step, stop=1.0, folder=BUILD, order=JACOBI):
    """Speeds of hub and driven mass after stop seconds, rad/s, with the mean torque of each step."""
    nodes = {
        "module": Node(folder / "InertiaModule.fmu", MODULE, {"omega1": SPEED}, tolerance=1e-9),
        "shaft": Node(folder / "DrivenShaft.fmu", SHAFT, {"load_torque": LOAD}),
    }
    with WiredFmus(nodes, WIRES, step, order) as system:
        for _ in range(round(stop / step)):
            system.advance()
        return system.fmus["module"]["omega_out"], system.fmus["shaft"]["omega_out"]


def advance(module, shaft, step):
    """Advance both by a communication step, s: the module first, torque and speed with their derivatives."""
    speed = module["omega_out"]
    module.set(load_torque=shaft["shaft_torque"])
    module.set_rates(load_torque=shaft.rates("shaft_torque")[0])
    module.advance(step)
    shaft.set(hub_speed=speed)
    shaft.set_rates(hub_speed=(module["omega_out"] - speed) / step)
    shaft.advance(step)


def simulate_with_derivatives(step, stop=1.0, folder=BUILD):
    """Speeds of hub and driven mass after stop seconds, rad/s, with derivatives."""
    with (
        Fmu(folder / "InertiaModule.fmu", MODULE, {"omega1": SPEED}, tolerance=1e-9) as module,
        Fmu(folder / "DrivenShaft.fmu", SHAFT, {"load_torque": LOAD}) as shaft,
    ):
        for _ in range(round(stop / step)):
            advance(module, shaft, step)
        return module["omega_out"], shaft["omega_out"]


if __name__ == "__main__":
    print("             side by side               with derivatives")
    print("step, s      hub, rad/s  driven mass    hub, rad/s  driven mass")
    for step in (1e-3, 1e-4, 1e-5):
        speeds = *simulate(step), *simulate_with_derivatives(step)
        print("{:<10g} {:12.6f} {:12.6f}  {:12.6f} {:12.6f}".format(step, *speeds))
    print("one piece  {:12.6f} {:12.6f}".format(*ONE_PIECE))
